//! Strip charts: how a number runs along a way, in braille dots.

use super::braille::{ACROSS, DOTS, DOWN, character};

/// The line through `points` (way, value) in `height` lines of `width` characters, for ways in [0, `span`] and values
/// within ±`limit`. An odd height has a dotted line at zero.
pub fn strip(points: &[(f64, f64)], span: f64, limit: f64, width: usize, height: usize) -> Vec<String> {
    let mut cells = vec![vec![0_u32; width]; height];
    let last = ((width * ACROSS - 1) as f64, (height * DOWN - 1) as f64);
    let column = |way: f64| (way / span * last.0).clamp(0.0, last.0);
    let row = |value: f64| (0.5 * (1.0 - value / limit) * last.1).clamp(0.0, last.1);
    for pair in points.windows(2) {
        let (x0, y0, x1, y1) = (column(pair[0].0), row(pair[0].1), column(pair[1].0), row(pair[1].1));
        let (first, end) = (x0.round() as usize, x1.round() as usize);
        for x in first..=end {
            // The part of the segment that lies in this column of dots, a little less so that a slant stays thin.
            let at = |x: f64| if x1 > x0 { y0 + (y1 - y0) * ((x - x0) / (x1 - x0)).clamp(0.0, 1.0) } else { y1 };
            let (a, b) = if first == end { (y0, y1) } else { (at(x as f64 - 0.49), at(x as f64 + 0.49)) };
            for y in a.min(b).round() as usize..=a.max(b).round() as usize {
                cells[y / DOWN][x / ACROSS] |= DOTS[y % DOWN][x % ACROSS];
            }
        }
    }
    let blank = |line: usize| if 2 * line + 1 == height { '·' } else { ' ' };
    let text = |(line, row): (usize, &Vec<u32>)| row.iter().map(|dots| character(*dots, blank(line))).collect();
    cells.iter().enumerate().map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rising_line_goes_from_the_lower_left_to_the_upper_right() {
        assert_eq!(strip(&[(0.0, -1.0), (1.0, 1.0)], 1.0, 1.0, 4, 2), ["  ⡠⠊", "⡠⠊  "]);
    }

    #[test]
    fn a_step_is_a_wall_and_zero_is_dotted_where_the_line_is_elsewhere() {
        let step = [(0.0, 1.0), (0.5, 1.0), (0.5, -1.0), (1.0, -1.0)];
        assert_eq!(strip(&step, 1.0, 1.0, 3, 3), ["⠉⢹ ", "·⢸·", " ⢸⣀"]);
    }

    #[test]
    fn what_lies_outside_is_drawn_at_the_edge() {
        assert_eq!(strip(&[(-1.0, 5.0), (2.0, 5.0)], 1.0, 1.0, 2, 1), ["⠉⠉"]);
    }
}
