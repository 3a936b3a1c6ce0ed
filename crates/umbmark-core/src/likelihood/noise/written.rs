//! The sizes of the noise as numbers in files.

use super::Noise;
use crate::parameter::Parameter;

/// No size of a file is larger.
const LARGEST: f64 = 10.0;

const fn size(name: &'static str, unit: &'static str, usual: f64, meaning: &'static str) -> Parameter {
    Parameter::scatter(name, "", unit, usual, (0.0, LARGEST), meaning)
}

impl Noise {
    /// The sizes that data shows, as `model.toml` has them in `[noise]`, each 0 where it is not given.
    ///
    /// The scatter of START is none of them: it is assumed.
    pub const WRITTEN: [Parameter; 10] = [
        size("heading_rad_per_sqrt_m", "rad/√m", 1.5e-3, "heading noise per square root of way"),
        size("heading_rad_per_sqrt_rad", "rad/√rad", 1e-3, "heading noise per square root of rotation"),
        size("forward_m_per_sqrt_m", "m/√m", 3e-4, "noise of the way forward per square root of the wheels' mean way"),
        size("sideways_m_per_sqrt_m", "m/√m", 1e-4, "noise to the side per square root of the wheels' mean way"),
        size(
            "reference_position_m",
            "m",
            5e-4,
            "noise of the reference that neighbouring poses share, each coordinate",
        ),
        size("reference_heading_rad", "rad", 5e-4, "the same of the heading"),
        size("reference_time_s", "s", 5e-4, "scatter of the moments at which the reference was taken"),
        size("reference_delay_s", "s", 1e-3, "scatter of the delay of the reference from run to run"),
        size("reference_pose_position_m", "m", 5e-4, "noise of the reference from pose to pose, each coordinate"),
        size("reference_pose_heading_rad", "rad", 5e-4, "the same of the heading"),
    ];

    /// Their values, in that order.
    pub fn written(&self) -> [f64; 10] {
        [
            self.heading_per_metre,
            self.heading_per_radian,
            self.forward_per_metre,
            self.sideways_per_metre,
            self.reference_position,
            self.reference_heading,
            self.reference_time,
            self.reference_delay,
            self.within_position,
            self.within_heading,
        ]
    }

    /// The noise of these values, in that order, with START marked on the floor.
    pub fn of_written(sizes: [f64; 10]) -> Noise {
        let [
            heading_per_metre,
            heading_per_radian,
            forward_per_metre,
            sideways_per_metre,
            reference_position,
            reference_heading,
            reference_time,
            reference_delay,
            within_position,
            within_heading,
        ] = sizes;
        Noise {
            heading_per_metre,
            heading_per_radian,
            forward_per_metre,
            sideways_per_metre,
            reference_position,
            reference_heading,
            reference_time,
            reference_delay,
            within_position,
            within_heading,
            ..Noise::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_size_has_a_key_of_its_own_and_usual_sizes_are_those_of_the_defaults() {
        let sizes: [f64; 10] = std::array::from_fn(|i| 1e-3 * (i + 1) as f64);
        assert_eq!(Noise::of_written(sizes).written(), sizes);
        let usual = Noise::default().written();
        for (parameter, usual) in Noise::WRITTEN[..8].iter().zip(usual) {
            assert_eq!(parameter.typical, usual, "{}", parameter.name);
        }
    }
}
