//! Meaning of a formula for the robot, for waves over time or distance.

use super::{Formula, Target};
use std::f64::consts::TAU;

/// a cos(2π q/c) + b sin(2π q/c), q the time or the way, in a sentence of its own; `None` of other formulas.
pub(super) fn meaning(formula: &Formula, values: &[f64]) -> Option<String> {
    let is_wave_of = |quantity: &str| {
        formula.text() == format!("a * cos(2 * pi * {quantity} / c) + b * sin(2 * pi * {quantity} / c)")
    };
    let (_, unit, place) = [("time", "s", "after START"), ("distance", "m", "behind START")]
        .into_iter()
        .find(|(quantity, ..)| is_wave_of(quantity))?;
    let number = |name: &str| {
        let place = formula.parameters().iter().position(|parameter| parameter.name == name)?;
        values.get(place).copied()
    };
    let (a, period) = (number("a")?, number("c")?);
    // A period below zero turns the sine over.
    let (b, period) = (number("b")? * period.signum(), period.abs());
    let size = a.hypot(b);
    let first = (b.atan2(a) / TAU).rem_euclid(1.0) * period;
    let (what, most) = match formula.target() {
        Target::HeadingPerMetre => (turns(size, "on each metre"), "most to the left"),
        Target::HeadingPerSecond => (turns(size, "in each second"), "most to the left"),
        Target::ForwardScale => (
            format!("A metre by odometry is up to {:.3} mm longer and shorter on the floor in turn", 1e3 * size),
            "longest",
        ),
        Target::SidewaysPerMetre => (
            format!(
                "The robot slides by up to {:.3} mm on each metre, to the left and to the right in turn",
                1e3 * size
            ),
            "most to the left",
        ),
        _ => return None,
    };
    Some(format!("{what}, once in {period:.2} {unit}; {most} {first:.1} {unit} {place}."))
}

fn turns(size: f64, on: &str) -> String {
    format!("The robot turns by up to {:.3} deg {on}, to the left and to the right in turn", size.to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 (cos φ cos x + sin φ sin x) is greatest at x = φ.
    #[test]
    fn a_wave_is_told_by_its_size_its_period_and_where_it_is_greatest() {
        let wave = |quantity: &str, target| {
            let text = format!("a * cos(2 * pi * {quantity} / c) + b * sin(2 * pi * {quantity} / c)");
            Formula::new("wave", target, &text, &["a", "b", "c"]).unwrap()
        };
        let (sine, cosine) = libm::sincos(TAU * 3.0 / 8.0);
        let size = 0.5f64.to_radians();
        assert_eq!(
            meaning(&wave("time", Target::HeadingPerMetre), &[size * cosine, size * sine, 8.0]).unwrap(),
            "The robot turns by up to 0.500 deg on each metre, to the left and to the right in turn, once in 8.00 s; most to the left \
             3.0 s after START."
        );
        let said = meaning(&wave("distance", Target::ForwardScale), &[0.0, -2e-3, 4.0]).unwrap();
        assert!(said.contains("up to 2.000 mm longer") && said.ends_with("longest 3.0 m behind START."), "{said}");
        assert_eq!(
            meaning(&wave("distance", Target::ForwardScale), &[0.0, 2e-3, -4.0]),
            meaning(&wave("distance", Target::ForwardScale), &[0.0, -2e-3, 4.0])
        );
        let other = Formula::new("other", Target::HeadingPerMetre, "a * time", &["a"]).unwrap();
        assert_eq!(meaning(&other, &[1.0]), None);
        assert_eq!(meaning(&wave("time", Target::TurnScale), &[0.1, 0.1, 8.0]), None);
    }
}
