//! Errors against the heading in the room.

use umbmark_core::compare::tracks::Rate;

use super::FigureKind;
use super::residuals::by;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "residuals_by_heading",
    about: "errors against the heading in the room",
    build: |study| by(study, FIGURE.name, "the heading in the room", &["heading"], &Rate::DEPENDING),
};
