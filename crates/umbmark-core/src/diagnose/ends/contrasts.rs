//! The headline pictures of a square: four closure contrasts, and the circle through START.
//!
//! Any error that repeats on every side rotates the end point about the centre of the square, by the return heading error. Four of the six
//! mean values must then vanish, c1 to c4, and every end point lies on a circle through START.

use super::Moments;
use crate::evidence::ends::{Ends, Fitted, mirrored};
use crate::path::{Direction, SQUARE};
use crate::stats::{Interval, student_t_quantile};
use nalgebra::Vector3;

/// A closure contrast: zero for every effect that is the same on every side of the square.
///
/// With S and D the halves of the mean residuals that are equal and opposite in the mirrored frame: c1 = S_x + S_y,
/// c2 = S_θ - (S_x - S_y)/L, c3 and c4 the same of D. c1 and c3 in metres, c2 and c4 in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Contrast {
    /// "c1" to "c4".
    pub name: &'static str,
    /// "m" or "rad".
    pub unit: &'static str,
    /// After the fit.
    pub value: f64,
    /// With the probability that was asked for.
    pub interval: Interval,
    /// What a value other than zero means.
    pub meaning: &'static str,
}

const MEANINGS: [(&str, &str, &str); 4] = [
    ("c1", "m", "floor drift or START misplacement along the first leg"),
    ("c2", "rad", "caster kick, backlash; or drift along the first leg"),
    ("c3", "m", "floor drift or START misplacement across the first leg; E_d changing on the way"),
    ("c4", "rad", "START heading; drift across the first leg"),
];

/// Length of the side, where the path is a square.
fn side(ends: &Ends) -> Option<f64> {
    ends.path.as_ref().filter(|path| std::ptr::eq(path.shape(), &SQUARE)).map(|path| path.values()[0])
}

/// The contrasts of a fitted model's residuals; none for other paths, one direction or single runs.
pub(crate) fn contrasts(ends: &Ends, fitted: &Fitted, level: f64) -> Vec<Contrast> {
    let Some(side) = side(ends) else { return Vec::new() };
    if ends.counts().contains(&0) {
        return Vec::new();
    }
    let of_run = |r: &Vector3<f64>| Vector3::new(r.x + r.y, r.z - (r.x - r.y) / side, 0.0);
    let runs: Vec<(usize, Vector3<f64>)> =
        ends.runs.iter().zip(&fitted.residuals).map(|(run, r)| (run.direction as usize, of_run(r))).collect();
    let moments = Moments::of(&runs, 2);
    if moments.freedom() < 1.0 {
        return Vec::new();
    }
    let t = student_t_quantile(0.5 + 0.5 * level, moments.freedom());
    let spread = 0.5 * (1.0 / moments.count(0) + 1.0 / moments.count(1)).sqrt();
    let [cw, ccw] = &moments.means;
    let halves = [(ccw + cw) * 0.5, (ccw - cw) * 0.5];
    let mut contrasts = Vec::new();
    for (i, (name, unit, meaning)) in MEANINGS.into_iter().enumerate() {
        let component = i % 2;
        if component == 1 && !ends.with_heading {
            continue;
        }
        let value = halves[i / 2][component];
        let deviation = (moments.scatter[(component, component)] / moments.freedom()).sqrt();
        contrasts.push(Contrast {
            name,
            unit,
            value,
            interval: Interval::around(value, t * spread * deviation),
            meaning,
        });
    }
    contrasts
}

/// The end points of one direction beside the circle about the centre of the square through START.
///
/// The circle is first order. Where the fitted model itself predicts an end off the circle (by millimetres, for errors of some
/// decimetres), that much is taken off.
#[derive(Clone, Debug, PartialEq)]
pub struct OnCircle {
    /// Of the runs.
    pub direction: Direction,
    /// Distance of each end point outside the circle \[m\], run by run.
    pub off: Vec<f64>,
    /// Mean of these distances \[m\].
    pub mean_off: f64,
    /// Its interval.
    pub off_interval: Interval,
    /// Distance of the mean end point from START \[m\].
    pub distance: f64,
    /// The distance that follows if the mean return heading alone had rotated the end point \[m\]; `None` without headings.
    pub implied: Option<f64>,
    /// Mean angle by which the end points turned about the centre, less the mean return heading \[rad\].
    pub turned_less_heading: Option<f64>,
    /// Its interval.
    pub turned_interval: Option<Interval>,
}

impl OnCircle {
    /// Whether E_d and E_b, or another error that repeats on every side, can cause these end poses.
    pub fn explained(&self) -> bool {
        self.off_interval.contains(0.0) && self.turned_interval.is_none_or(|i| i.contains(0.0))
    }
}

/// The end points of each direction relative to the circle; empty for other paths or single runs.
pub(crate) fn circle(ends: &Ends, fitted: &Fitted, level: f64) -> Vec<OnCircle> {
    let Some(side) = side(ends) else { return Vec::new() };
    let errors: Vec<Vector3<f64>> =
        ends.runs.iter().zip(ends.errors()).map(|(run, e)| mirrored(run.direction, &e)).collect();
    let of = |direction: Direction| {
        let all = ends.runs.iter().zip(&errors).zip(&fitted.residuals);
        let runs: Vec<Run> = all
            .filter(|((run, _), _)| run.direction == direction)
            .map(|((_, error), residual)| Run { error: *error, predicted: error - residual })
            .collect();
        on_circle(direction, &runs, side, ends.with_heading, level)
    };
    Direction::BOTH.into_iter().filter_map(of).collect()
}

/// Measured and predicted return error of a run, mirrored.
struct Run {
    error: Vector3<f64>,
    predicted: Vector3<f64>,
}

/// How far a return error lies outside the circle \[m\], and the angle about the centre less the heading \[rad\].
fn beside(error: &Vector3<f64>, side: f64) -> (f64, f64) {
    let (x, y) = (error.x - 0.5 * side, error.y - 0.5 * side);
    // The angle from START, at (-1, -1) seen from the centre, to the end point.
    (libm::hypot(x, y) - side / std::f64::consts::SQRT_2, libm::atan2(x - y, -x - y) - error.z)
}

fn on_circle(direction: Direction, runs: &[Run], side: f64, with_heading: bool, level: f64) -> Option<OnCircle> {
    if runs.len() < 2 {
        return None;
    }
    let n = runs.len() as f64;
    let t = student_t_quantile(0.5 + 0.5 * level, n - 1.0);
    let interval = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        (mean, Interval::around(mean, t * (squares / (n - 1.0) / n).sqrt()))
    };
    let pairs: Vec<_> = runs.iter().map(|run| (beside(&run.error, side), beside(&run.predicted, side))).collect();
    let off: Vec<f64> = pairs.iter().map(|(seen, own)| seen.0 - own.0).collect();
    let turned: Vec<f64> = pairs.iter().map(|(seen, own)| seen.1 - own.1).collect();
    let (mean_off, off_interval) = interval(&off);
    let (less, turned_interval) = interval(&turned);
    let mean = runs.iter().fold(Vector3::zeros(), |sum, run| sum + run.error) / n;
    Some(OnCircle {
        direction,
        off,
        mean_off,
        off_interval,
        distance: libm::hypot(mean.x, mean.y),
        implied: with_heading.then(|| std::f64::consts::SQRT_2 * side * libm::sin(0.5 * mean.z.abs())),
        turned_less_heading: with_heading.then_some(less),
        turned_interval: with_heading.then_some(turned_interval),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_point_turned_about_the_centre_lies_on_the_circle_and_its_heading_agrees() {
        let side = 4.0;
        let turned = |angle: f64, extra: f64| {
            let (s, c) = angle.sin_cos();
            // c - R c with c = (L/2, L/2).
            let h = 0.5 * side;
            Vector3::new(h - (c * h - s * h), h - (s * h + c * h), angle + extra)
        };
        let run = |error| Run { error, predicted: Vector3::zeros() };
        let seen = |errors: [Vector3<f64>; 2]| on_circle(Direction::Ccw, &errors.map(run), side, true, 0.95).unwrap();
        let on = seen([turned(0.1, 0.0), turned(-0.05, 0.0)]);
        assert!(on.off.iter().all(|off| off.abs() < 1e-12) && on.turned_less_heading.unwrap().abs() < 1e-12);
        let other = seen([turned(0.1, 0.02), turned(0.1, 0.02)]);
        assert!((other.turned_less_heading.unwrap() + 0.02).abs() < 1e-12 && !other.explained());
    }

    /// Textbook: two values 2 mm apart have a mean with a standard error of 1 mm, and t of 97.5 % with one degree of freedom is 12.706.
    #[test]
    fn the_distance_from_the_circle_is_that_outside_of_it_with_the_interval_of_its_mean() {
        let out = |by: f64| {
            let outward = by / std::f64::consts::SQRT_2;
            Run { error: Vector3::new(-outward, -outward, 0.0), predicted: Vector3::zeros() }
        };
        let circle = on_circle(Direction::Cw, &[out(1e-3), out(3e-3)], 4.0, true, 0.95).unwrap();
        assert!((circle.mean_off - 2e-3).abs() < 1e-12 && (circle.distance - 2e-3).abs() < 1e-12, "{circle:?}");
        let Interval { low, high } = circle.off_interval;
        assert!((low - 2e-3 + 12.706e-3).abs() < 1e-6 && (high - 2e-3 - 12.706e-3).abs() < 1e-6, "{low} {high}");
    }
}
