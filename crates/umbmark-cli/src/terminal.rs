//! Small pictures made of characters.

/// A horizontal bar of `width` characters' full length, in eighths of a character.
fn bar(share: f64, width: usize) -> String {
    const EIGHTHS: [char; 8] = [' ', '▏', '▎', '▍', '▌', '▋', '▊', '▉'];
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
pub fn histogram(classes: &[(f64, f64)], unit: &str, width: usize) -> String {
    let most = classes.iter().map(|(_, share)| *share).fold(f64::MIN_POSITIVE, f64::max);
    let step = classes.windows(2).map(|w| w[1].0 - w[0].0).fold(f64::INFINITY, f64::min);
    let decimals = if step.is_finite() && step > 0.0 { (-step.log10().floor()).clamp(0.0, 9.0) as usize } else { 1 };
    let label = |edge: f64| format!("{edge:.decimals$} {unit}");
    let wide = classes.iter().map(|(edge, _)| label(*edge).len()).max().unwrap_or(0);
    classes
        .iter()
        .map(|(edge, share)| {
            format!("{:>wide$} │{:<width$} {:>5.1} %\n", label(*edge), bar(share / most, width), 100.0 * share)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_as_long_as_their_share_of_the_greatest() {
        let text = histogram(&[(0.0, 0.25), (10.0, 0.5), (20.0, 0.0)], "mm", 8);
        assert_eq!(text, " 0 mm │████      25.0 %\n10 mm │████████  50.0 %\n20 mm │           0.0 %\n");
    }
}
