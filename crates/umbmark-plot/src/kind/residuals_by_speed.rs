//! Errors against the speed.

use umbmark_core::compare::tracks::Rate;

use super::FigureKind;
use super::residuals::by;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "residuals_by_speed",
    about: "errors against the speed",
    build: |study| by(study, FIGURE.name, "the speed", &["speed"], &Rate::DEPENDING),
};
