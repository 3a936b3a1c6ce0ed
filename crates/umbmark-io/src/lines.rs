//! Where rows stood in their file.

/// The line of each row. Most rows stand on the line after the one before, so only where they do not is it kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lines {
    rows: usize,
    /// The first row, and its line, of each stretch of rows on lines that follow each other.
    stretches: Vec<(usize, usize)>,
}

impl Lines {
    pub fn push(&mut self, line: usize) {
        let next = self.stretches.last().map(|(row, first)| first + (self.rows - row));
        if next != Some(line) {
            self.stretches.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// The line of a row that was pushed.
    pub fn of(&self, row: usize) -> usize {
        let (first, line) = self.stretches[self.stretches.partition_point(|(first, _)| *first <= row) - 1];
        line + (row - first)
    }
}

impl FromIterator<usize> for Lines {
    fn from_iter<I: IntoIterator<Item = usize>>(lines: I) -> Lines {
        let mut kept = Lines::default();
        lines.into_iter().for_each(|line| kept.push(line));
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_keeps_its_line_in_any_order() {
        let lines = [2, 3, 4, 9, 10, 4, 3, 2, 2, 3, 100];
        let kept: Lines = lines.into_iter().collect();
        assert_eq!((0..lines.len()).map(|row| kept.of(row)).collect::<Vec<_>>(), lines);
        assert_eq!((1..=1000).collect::<Lines>().stretches.len(), 1);
    }
}
