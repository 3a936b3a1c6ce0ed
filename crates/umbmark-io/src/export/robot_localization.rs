//! Parameters of the filters of robot_localization.

use super::covariance::{diagonal, of_twist, sentences};
use super::text::list;
use super::{Comment, Export, ExportError, Target, Written};

/// Order of the filter's state: x, y, z, roll, pitch, yaw, their speeds, and three accelerations.
const STATE: usize = 15;
/// Its process noise where nothing is said, along the diagonal.
const USUAL: [f64; STATE] =
    [0.05, 0.05, 0.06, 0.03, 0.03, 0.06, 0.025, 0.025, 0.04, 0.01, 0.01, 0.02, 0.01, 0.01, 0.015];
/// Process noise of the pose: next to nothing, so that the pose gets the noise of the speeds and no other.
const POSE: f64 = 1e-9;
/// Which of the state are taken from wheels: speeds ahead, to the side (0) and of turning. Their pose is a sum of these.
const FUSED: [usize; 3] = [6, 7, 11];

/// What of odometry to fuse. The filter takes covariances from the messages, so they stand in a comment.
pub static TARGET: Target = Target {
    name: "robot_localization",
    about: "YAML for ekf_node or ukf_node of robot_localization: which values of the odometry to fuse",
    holds_all: false,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let mut notes = export.uncorrected();
    if let Some(noise) = export.noise_or(&mut notes) {
        let twist = list(&diagonal(of_twist(&noise, &export.usual)));
        notes.push(format!(
            "the filter takes covariances from the messages: the robot has to publish twist covariances of {twist}, \
             as the file for ros2_control sets them"
        ));
        notes.push(sentences(&export.usual)[0].clone());
    }
    let head = Comment::Hash.line(&export.heading()) + &Comment::Hash.lines(&notes);
    let fused: Vec<&str> = (0..STATE).map(|i| if FUSED.contains(&i) { "true" } else { "false" }).collect();
    let mut noise = [0.0; STATE * STATE];
    for (i, usual) in USUAL.into_iter().enumerate() {
        noise[i * STATE + i] = if i < 6 { POSE } else { usual };
    }
    let text = format!(
        "{head}ekf_filter_node:\n  ros__parameters:\n    two_d_mode: true\n    odom0: odom\n    \
         # x, y, z, roll, pitch, yaw, their speeds, accelerations: the speeds alone, the pose is their sum\n    \
         odom0_config: [{}]\n    odom0_differential: false\n    odom0_relative: false\n    \
         # that of the speeds is usual; that of the pose is next to nothing, or it would be larger than the noise of the wheels\n    \
         process_noise_covariance: {}\n",
        fused.join(", "),
        list(&noise)
    );
    Ok(Written { text, notes })
}
