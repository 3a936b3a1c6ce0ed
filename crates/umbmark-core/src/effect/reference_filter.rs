//! A reference that smooths its poses.

use super::words::{percent, size};
use super::{About, ActsOn, Effect, Entry, Filter, FilterLaw};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::Real;
use crate::parameter::Parameter;
use std::ops::Range;

/// A filter between the robot's pose and the pose that is written.
pub struct ReferenceFilter;

pub(super) static EFFECT: Entry = Entry::of::<ReferenceFilter>().filter::<ReferenceFilter>();

/// Shares that a filter can have, with what is left for the error of an estimate: a delay beside it may hold a part of its mean lag, and more than all is
/// not filtered.
const SHARES: Range<f64> = 0.25..1.15;

impl Effect for ReferenceFilter {
    const ABOUT: About = About {
        name: "reference_filter",
        title: "low-pass filter of the reference",
        acts_on: ActsOn::Reference,
        parameters: &[
            Parameter::share(
                "share",
                "reference-filter",
                (-10.0, 10.0),
                "share of the pose that is filtered; 1 where the whole pose is",
            ),
            Parameter::shape(
                "time_constant_s",
                "reference-filter-time",
                "s",
                0.15,
                (0.02, 1.0),
                "time after which the filter has followed all but 1/e of a step",
            ),
        ],
        equation: "seen ← seen - κ ℓ,  dℓ/dt = d seen/dt - ℓ/τ",
        physics: "Motion capture, receivers of satellites and filters of maps smooth what they show: each pose holds something of those \
                  before it. At 1 m/s, a time constant of 100 ms leaves the pose 100 mm behind, and rounds every corner.",
        signature: "The measured pose is behind by v τ along the course, as by a delay; beyond that, tracks shrink to the inside of every \
                    curve, by τ²/2 times the acceleration. At rest it is correct.",
        confused_with: &["reference_delay", "wheel_lag"],
        separated_by: "a quick change between two curves: a delay leaves the shape of the track, a filter rounds it; the settings of the \
                       reference",
        source: "first-order low-pass filter; 0.15 s is assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        let what = if p[0] == 1.0 {
            "What the reference shows".to_owned()
        } else {
            format!("{} of what the reference shows", percent(p[0]))
        };
        format!(
            "{what} is a mean of the poses before, with a time constant of {} ms: at 0.5 m/s it is {} mm behind.",
            size(1e3 * p[1]),
            size(1e3 * p[0] * 0.5 * p[1])
        )
    }

    /// A small share, or far more than all, stands for something else, as a delay.
    fn is_credible(p: &[f64]) -> bool {
        SHARES.contains(&p[0])
    }
}

impl FilterLaw for ReferenceFilter {
    fn filter<T: Real>(p: &[T], filter: &mut Filter<T>) {
        *filter = Filter { share: p[0], time_constant: p[1] };
    }
}

#[cfg(test)]
mod tests {
    use crate::drive::Robot;
    use crate::effect::tests::{ccw_and_cw, circle, model_with, recorded_log, stops_with, watched_with};
    use crate::replay::Track;

    const FILTERED: [(&str, &str, f64); 2] =
        [("reference_filter", "share", 1.0), ("reference_filter", "time_constant_s", 0.5)];

    #[test]
    fn a_circle_is_seen_smaller_and_late_as_a_first_order_filter_shows_it() {
        for (direction, sign) in ccw_and_cw() {
            let (track, seen) = watched_with(&FILTERED, &circle(), direction);
            let (_, truth) = watched_with(&[], &circle(), direction);
            let middle = seen.len() / 2;
            let rate = track.sights()[middle].turn_rate;
            // About the centre, a frequency ω comes out of the filter as 1/(1 + iωτ) of it.
            let behind = 0.5 * rate;
            let (from_x, from_y) = (truth[middle].x, truth[middle].y - sign * 2.0);
            let square = 1.0 + behind * behind;
            let (x, y) = ((from_x + behind * from_y) / square, (from_y - behind * from_x) / square);
            assert!(
                (seen[middle].x - x).abs() < 1e-4 && (seen[middle].y - sign * 2.0 - y).abs() < 1e-4,
                "{:?} {x} {y}",
                seen[middle]
            );
            assert!((seen[middle].heading - (truth[middle].heading - behind)).abs() < 1e-4);
        }
    }

    #[test]
    fn the_robot_is_seen_where_it_is_once_it_rests() {
        let track = Track::from_log(&recorded_log(), &Robot::labmate()).unwrap();
        let filtered = [("reference_filter", "share", 1.0), ("reference_filter", "time_constant_s", 0.1)];
        let [told, seen] = [&[][..], &filtered].map(|settings| track.poses(&model_with(settings).chain()));
        let gaps: Vec<f64> =
            told.iter().zip(&seen).map(|(told, seen)| (told.x - seen.x).hypot(told.y - seen.y)).collect();
        let worst = gaps.iter().copied().fold(0.0, f64::max);
        assert!((worst / (0.2 * 0.1) - 1.0).abs() < 0.01, "{worst}");
        assert!(*gaps.last().unwrap() < 1e-4, "{gaps:?}");
        for (direction, _) in ccw_and_cw() {
            let end = stops_with(&FILTERED, direction)[7];
            assert!(end.x.hypot(end.y) < 1e-3, "{end:?}");
        }
    }
}
