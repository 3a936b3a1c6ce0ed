//! Ends and round marks of axes.

use crate::figure::{Layer, Mark, Panel};

/// Least and greatest number, widened so that nothing touches the frame.
pub fn ends(panel: &Panel) -> ([f64; 2], [f64; 2]) {
    let mut x = Ends::default();
    let mut y = Ends::default();
    for layer in &panel.layers {
        reach(layer, &mut x, &mut y);
    }
    let named = |names: &[String]| (!names.is_empty()).then(|| [-0.5, names.len() as f64 - 0.5]);
    let x = panel.x.range.or_else(|| named(&panel.x.names)).unwrap_or_else(|| x.widened());
    let y = panel.y.range.or_else(|| named(&panel.y.names)).unwrap_or_else(|| y.widened());
    (x, y)
}

fn reach(layer: &Layer, x: &mut Ends, y: &mut Ends) {
    for (at, over) in layer.x.iter().zip(&layer.y).filter(|(a, b)| a.is_finite() && b.is_finite()) {
        x.take(*at);
        y.take(*over);
        if let Mark::Bars(width) = layer.mark {
            x.take(at - 0.5 * width);
            x.take(at + 0.5 * width);
            y.floor = Some(0.0);
        }
    }
    if let Mark::Spans(low, high) = &layer.mark {
        low.iter().chain(high).filter(|end| end.is_finite()).for_each(|end| x.take(*end));
    }
}

#[derive(Default)]
struct Ends {
    taken: Option<[f64; 2]>,
    /// Where bars stand.
    floor: Option<f64>,
}

impl Ends {
    fn take(&mut self, value: f64) {
        let [low, high] = self.taken.unwrap_or([value, value]);
        self.taken = Some([low.min(value), high.max(value)]);
    }

    fn widened(&self) -> [f64; 2] {
        let [low, high] = self.taken.unwrap_or([0.0, 1.0]);
        let span = if high > low { high - low } else { low.abs().max(1.0) };
        match self.floor {
            Some(floor) if low >= floor => [floor, high + 0.06 * span],
            _ => [low - 0.05 * span, high + 0.05 * span],
        }
    }
}

/// Round numbers between two ends, at most `most` of them, and their decimals.
pub fn marks([low, high]: [f64; 2], most: usize) -> (Vec<f64>, usize) {
    let step = round_up((high - low) / most.max(1) as f64);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    ((first..=last).map(|i| i as f64 * step).collect(), decimals)
}

/// The next 1, 2 or 5 times a power of ten.
pub fn round_up(width: f64) -> f64 {
    if !(width > 1e-12 && width.is_finite()) {
        return 1e-12;
    }
    let power = 10f64.powf(width.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|w| *w >= width * 0.999).unwrap_or(width)
}

/// A number with so many decimals and a true minus sign.
pub fn written(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| c == '0' || c == '.') => zero.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_and_lie_between_the_ends() {
        assert_eq!(marks([-0.3, 12.0], 5), (vec![0.0, 5.0, 10.0], 0));
        assert_eq!(marks([0.0, 0.25], 5), (vec![0.0, 0.05, 0.1, 0.15000000000000002, 0.2, 0.25], 2));
        assert_eq!(marks([3.0, 3.0], 5).0.len(), 1);
    }

    #[test]
    fn widths_are_rounded_up() {
        assert_eq!([0.7, 1.0, 1.2, 3.0, 60.0].map(round_up), [1.0, 1.0, 2.0, 5.0, 100.0]);
        assert_eq!(round_up(0.0), 1e-12);
    }

    #[test]
    fn numbers_have_no_negative_zero() {
        assert_eq!([written(-0.001, 2), written(-1.5, 1), written(2.0, 0)], ["0.00", "\u{2212}1.5", "2"]);
    }
}
