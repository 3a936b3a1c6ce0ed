//! Maps of values over a grid.

/// Marks from the least to the greatest value: shades on a terminal, ASCII elsewhere.
const SHADES: [char; 5] = ['·', '░', '▒', '▓', '█'];
const PLAIN: [char; 9] = ['.', ':', '-', '=', '+', 'x', '*', '#', '@'];

/// The most characters and lines of a map.
const WIDEST: usize = 60;
const HIGHEST: usize = 24;

/// A grid of values, rows from the top down, with labels at its edges; none where a value is not known.
#[derive(Debug)]
pub struct HeatMap<'a> {
    /// Values by row and column.
    pub rows: &'a [Vec<Option<f64>>],
    /// First and last label of the columns.
    pub columns: [String; 2],
    /// First and last label of the rows.
    pub sides: [String; 2],
    /// Whether people look at it on a terminal.
    pub terminal: bool,
}

impl HeatMap<'_> {
    /// The map; where the grid is larger than a screen, means of neighbours.
    pub fn text(&self) -> String {
        let (height, width) = (self.rows.len(), self.rows.iter().map(Vec::len).max().unwrap_or(0));
        let (lines, columns) = (height.min(HIGHEST), width.min(WIDEST));
        let cell = |line: usize, column: usize| {
            let rows = &self.rows[line * height / lines..(line + 1) * height / lines];
            let part = column * width / columns..(column + 1) * width / columns;
            let known: Vec<f64> =
                rows.iter().flat_map(|row| row.get(part.clone()).unwrap_or_default()).copied().flatten().collect();
            (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
        };
        let cells: Vec<Vec<Option<f64>>> =
            (0..lines).map(|line| (0..columns).map(|column| cell(line, column)).collect()).collect();
        let known = || cells.iter().flatten().flatten();
        let (least, most) =
            (known().copied().fold(f64::INFINITY, f64::min), known().copied().fold(f64::NEG_INFINITY, f64::max));
        let marks: &[char] = if self.terminal { &SHADES } else { &PLAIN };
        let mark = |value: f64| {
            let share = if most > least { (value - least) / (most - least) } else { 0.0 };
            marks[((share * marks.len() as f64) as usize).min(marks.len() - 1)]
        };
        // Few columns are drawn wide, so that a map is about as wide as high.
        let wide = (WIDEST / 2 / columns.max(1)).clamp(1, 4);
        let margin = self.sides.iter().map(|side| side.chars().count()).max().unwrap_or(0);
        let mut text = String::new();
        for (line, cells) in cells.iter().enumerate() {
            let side = match line {
                0 => &self.sides[0],
                last if last + 1 == lines => &self.sides[1],
                _ => "",
            };
            let marks: String = cells.iter().flat_map(|c| std::iter::repeat_n(c.map_or(' ', mark), wide)).collect();
            text += &format!("{side:>margin$} |{marks}|\n");
        }
        let [first, last] = &self.columns;
        let gap = (wide * columns).saturating_sub(first.chars().count());
        text + &format!("{:margin$}  {first}{last:>gap$}\n", "")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(rows: &[Vec<Option<f64>>], terminal: bool) -> String {
        let label = |a: &str, b: &str| [a.to_owned(), b.to_owned()];
        HeatMap { rows, columns: label("0", "1"), sides: label("top", "low"), terminal }.text()
    }

    #[test]
    fn values_grow_darker_and_unknown_ones_are_blank() {
        let rows = [vec![Some(0.0), Some(1.0)], vec![Some(4.0), None]];
        assert_eq!(map(&rows, true), "top |····░░░░|\nlow |████    |\n     0      1\n");
        assert_eq!(map(&rows, false), "top |....----|\nlow |@@@@    |\n     0      1\n");
    }

    #[test]
    fn a_large_grid_is_drawn_as_means_of_neighbours() {
        let rows: Vec<Vec<Option<f64>>> = (0..100).map(|i| vec![Some(f64::from(i)); 200]).collect();
        let text = map(&rows, false);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!((lines.len(), lines[0].chars().count()), (HIGHEST + 1, WIDEST + 6));
        assert!(lines[0].contains(".....") && lines[HIGHEST - 1].contains("@@@@@"));
    }
}
