//! Errors against the turn rate.

use umbmark_core::compare::tracks::Rate;

use super::FigureKind;
use super::residuals::by;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "residuals_by_turn_rate",
    about: "errors against the turn rate",
    build: |study| by(study, FIGURE.name, "the turn rate", &["turn_rate"], &[Rate::Forward, Rate::Yaw, Rate::Turn]),
};
