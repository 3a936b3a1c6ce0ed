//! A reference whose clock runs slow.

use super::words::{either, size};
use super::{About, ActsOn, ClockLaw, Effect, Entry};
use crate::drive::{DriveKinds, Robot};
use crate::geometry::Real;
use crate::parameter::Parameter;

/// Rate at which the clocks of reference and encoders drift apart.
pub struct ReferenceClockRate;

pub(super) static EFFECT: Entry = Entry::of::<ReferenceClockRate>().late::<ReferenceClockRate>();

impl Effect for ReferenceClockRate {
    const ABOUT: About = About {
        name: "reference_clock_rate",
        title: "clock rate of the reference",
        acts_on: ActsOn::Reference,
        parameters: &[Parameter::size(
            "ratio",
            "reference-clock-rate",
            "",
            2e-4,
            (-0.5, 0.5),
            "delay of the measured poses that builds up per time since the run began",
        )],
        equation: "seen(t) = true(t - ρ t)",
        physics: "Robot and reference stamp their data with separate clocks. These agree at the start of a run and then drift apart, at \
                  the rate error of their oscillators or of a software timer.",
        signature: "It looks like a delay that grows during the run: the first legs are on time, the last ones are late. Return poses, \
                    which are measured at rest, do not show it.",
        confused_with: &["reference_delay"],
        separated_by: "comparing the delay of the first leg with that of the last; stamping both streams with one clock",
        source: "two free-running clocks; 200 parts in a million are assumed",
    };

    const DRIVES: DriveKinds = DriveKinds::ALL;

    fn means(p: &[f64], _robot: &Robot) -> String {
        format!("The clock of the reference {} {} ms in a minute.", either(p[0], "loses", "gains"), size(6e4 * p[0]))
    }
}

impl ClockLaw for ReferenceClockRate {
    fn late<T: Real>(p: &[T], time: f64, late: &mut T) {
        *late += p[0] * time;
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests::{along_with, ccw_and_cw};

    #[test]
    fn the_lag_is_the_ratio_of_the_time_gone_times_the_speed() {
        // At constant speed half a second is lost to the ramp: 2 m take 10.5 s, the middle of leg 3 is 40 s and two turns on.
        let turn = 0.17 * std::f64::consts::FRAC_PI_2 / 0.2 + 1.0;
        let later = 2.0 * (21.0 + 1.0) + 2.0 * (turn + 1.0) + 10.5;
        for ratio in [1e-3, -1e-3] {
            let model = [("reference_clock_rate", "ratio", ratio)];
            for (direction, _) in ccw_and_cw() {
                for (way, time) in [(2.0, 10.5), (10.0, later)] {
                    let lag = along_with(&model, direction, way).forward;
                    assert!((lag + ratio * time * 0.2).abs() < 1e-3 * ratio.abs() * time, "{lag} at {time} s");
                }
            }
        }
    }
}
