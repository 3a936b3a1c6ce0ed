//! Covariances of odometry from the sizes of its noise.
//!
//! The noise of a model grows with the way L and the rotation Φ:
//!
//! ```text
//! heading  h² L + r² Φ      forward  f² L      sideways  s² L
//! ```
//!
//! Programs want a variance per message, of speeds. A filter that integrates N independent speeds over their period T adds variance
//! q T² each time, so that q T per second has to be what the noise adds per second:
//!
//! ```text
//! q = rate · (h² v + r² ω)   of the turn rate,     q = rate · f² v   of the speed
//! ```

use super::{Export, Usual};
use umbmark_core::likelihood::Noise;

/// The way for which the constant covariance of a pose is computed \[m\].
pub const WAY: f64 = 10.0;
/// Variance of what a robot on a floor does not do: heave, roll and pitch.
const UNUSED: f64 = 1e-6;

/// Variances of x, y and heading, in the order of every covariance here.
pub type Variances = [f64; 3];

/// Variances of the speed ahead, the speed to the side \[m²/s²\] and the turn rate \[rad²/s²\] of one message.
pub fn of_twist(noise: &Noise, usual: &Usual) -> Variances {
    let Usual { speed, turn_rate, rate } = *usual;
    let square = |size: f64| size * size;
    [
        rate * square(noise.forward_per_metre) * speed,
        rate * square(noise.sideways_per_metre) * speed,
        rate * (square(noise.heading_per_metre) * speed + square(noise.heading_per_radian) * turn_rate),
    ]
}

/// Variances of the pose \[m², m², rad²\] after [`WAY`] straight ahead: the heading's noise bends the way to the side.
pub fn of_pose(noise: &Noise) -> Variances {
    let square = |size: f64| size * size;
    let heading = square(noise.heading_per_metre);
    [
        square(noise.forward_per_metre) * WAY,
        heading * WAY * WAY * WAY / 3.0 + square(noise.sideways_per_metre) * WAY,
        heading * WAY,
    ]
}

/// The diagonal of six that messages of ROS have: x, y, z, roll, pitch, yaw.
pub fn diagonal([x, y, yaw]: Variances) -> [f64; 6] {
    [x, y, UNUSED, UNUSED, UNUSED, yaw]
}

/// What the constant covariances mean, in sentences.
pub fn sentences(usual: &Usual) -> [String; 2] {
    let Usual { speed, turn_rate, rate } = usual;
    [
        format!(
            "twist covariance: right at {speed} m/s and {turn_rate} rad/s with {rate} messages a second; in proportion to each"
        ),
        format!("pose covariance: of {WAY} m straight ahead; the true one grows with the way, so fuse the twist"),
    ]
}

/// Why covariances are left out.
pub const NO_NOISE: &str = "no covariances: the model has no [noise]; learn or fit it on tick logs, which show it";

impl Export<'_> {
    /// The noise, where it was fitted, or a note.
    pub(super) fn noise_or(&self, notes: &mut Vec<String>) -> Option<Noise> {
        if self.noise.is_none() {
            notes.push(NO_NOISE.to_owned());
        }
        self.noise
    }
}
