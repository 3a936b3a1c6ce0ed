//! Small pictures made of characters.

/// A horizontal bar of `width` characters' full length: in eighths of a character, or of `#`.
pub fn bar(share: f64, width: usize, unicode: bool) -> String {
    const EIGHTHS: [char; 8] = [' ', '▏', '▎', '▍', '▌', '▋', '▊', '▉'];
    if !unicode {
        return "#".repeat((share * width as f64).round() as usize);
    }
    let eighths = (share * width as f64 * 8.0).round() as usize;
    let mut bar = "█".repeat(eighths / 8);
    if let rest @ 1.. = eighths % 8 {
        bar.push(EIGHTHS[rest]);
    }
    bar
}

/// A histogram: one line a class, with its lower edge, a bar and its share of the whole.
///
/// `classes` are (lower edge, share); the edges are printed in the `unit`.
pub fn histogram(classes: &[(f64, f64)], unit: &str, width: usize, unicode: bool) -> String {
    let most = classes.iter().map(|(_, share)| *share).fold(f64::MIN_POSITIVE, f64::max);
    let step = classes.windows(2).map(|w| w[1].0 - w[0].0).fold(f64::INFINITY, f64::min);
    let decimals = if step.is_finite() && step > 0.0 { (-step.log10().floor()).clamp(0.0, 9.0) as usize } else { 1 };
    let label = |edge: f64| format!("{edge:.decimals$} {unit}");
    let wide = classes.iter().map(|(edge, _)| label(*edge).len()).max().unwrap_or(0);
    let rule = if unicode { '│' } else { '|' };
    let line = |(edge, share): &(f64, f64)| {
        let bar = bar(share / most, width, unicode);
        format!("{:>wide$} {rule}{bar:<width$} {:>5.1} %\n", label(*edge), 100.0 * share)
    };
    classes.iter().map(line).collect()
}

/// Values as one line of `width` marks, from nothing to the greatest: blocks on a terminal, ASCII elsewhere.
pub fn sparkline(values: &[f64], width: usize, terminal: bool) -> String {
    const BLOCKS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    const PLAIN: [char; 9] = [' ', '.', ':', '-', '=', '+', '*', '#', '@'];
    let marks = if terminal { BLOCKS } else { PLAIN };
    let most = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let width = width.min(values.len());
    let mean = |i: usize| {
        let piece = &values[i * values.len() / width..(i + 1) * values.len() / width];
        piece.iter().sum::<f64>() / piece.len() as f64
    };
    let mark = |i: usize| marks[((mean(i) / most * 8.0).round() as usize).min(8)];
    (0..width).map(mark).collect::<String>().trim_end().to_owned()
}

/// Two sets of places seen from above, in `width` by `height` characters with one scale for both axes (a character is twice
/// as high as wide): `.` for the first, `o` for the second, `8` for both; and how many metres a character is wide.
pub fn plan(first: &[(f64, f64)], second: &[(f64, f64)], width: usize, height: usize) -> (String, f64) {
    let all = || first.iter().chain(second);
    let range = |of: fn(&(f64, f64)) -> f64| {
        let fold = |start: f64, pick: fn(f64, f64) -> f64| all().map(of).fold(start, pick);
        (fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max))
    };
    let ((left, right), (low, high)) = (range(|p| p.0), range(|p| p.1));
    let scale = ((right - left) / (width - 1) as f64).max((high - low) / (2 * (height - 1)) as f64).max(1e-9);
    let mut marks = vec![vec![b' '; width]; height];
    for (places, mark) in [(first, b'.'), (second, b'o')] {
        for (x, y) in places {
            let column = ((x - left) / scale).round() as usize;
            let row = ((high - y) / (2.0 * scale)).round() as usize;
            if let Some(place) = marks.get_mut(row).and_then(|row| row.get_mut(column)) {
                *place = if *place != b' ' && *place != mark { b'8' } else { mark };
            }
        }
    }
    let line = |row: &Vec<u8>| String::from_utf8_lossy(row).trim_end().to_owned();
    let lines: Vec<String> = marks.iter().map(line).collect();
    (lines.join("\n").trim_end().to_owned() + "\n", scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_marks_rises_with_its_values() {
        assert_eq!(sparkline(&[0.0, 0.0, 1.0, 1.0, 2.0, 2.0], 3, false), " =@");
        assert_eq!(sparkline(&[2.0, 1.0], 80, true), "█▄");
        assert_eq!(sparkline(&[0.0], 5, false), "");
    }

    #[test]
    fn a_plan_has_x_to_the_right_and_y_up() {
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)];
        let (text, scale) = plan(&square, &[(2.0, 2.0), (1.0, 0.0)], 5, 3);
        assert_eq!(text, ".   8\n\n. o .\n");
        assert_eq!(scale, 0.5);
        assert_eq!(plan(&[(1.0, 1.0)], &[], 5, 3).0, ".\n");
    }

    #[test]
    fn bars_are_as_long_as_their_share_of_the_greatest() {
        let classes = [(0.0, 0.25), (10.0, 0.5), (20.0, 0.0)];
        let text = histogram(&classes, "mm", 8, false);
        assert_eq!(text, " 0 mm |####      25.0 %\n10 mm |########  50.0 %\n20 mm |           0.0 %\n");
        let text = histogram(&classes, "mm", 8, true);
        assert_eq!(text, " 0 mm │████      25.0 %\n10 mm │████████  50.0 %\n20 mm │           0.0 %\n");
    }
}
