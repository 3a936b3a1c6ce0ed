//! Errors against the wheels' angles.

use umbmark_core::compare::tracks::Rate;

use super::FigureKind;
use super::residuals::by;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "residuals_by_wheel_angle",
    about: "errors against the wheels' angles",
    build: |study| {
        by(
            study,
            FIGURE.name,
            "the angle of a wheel",
            &["wheel_angle_left", "wheel_angle_right"],
            &[Rate::Forward, Rate::Yaw],
        )
    },
};
