//! Errors against the heading in the room.

use umbmark_core::compare::tracks::Rate;

use super::Kind;
use super::residuals::by;

pub(super) static FIGURE: Kind = Kind {
    name: "residuals_by_heading",
    about: "errors against the heading in the room",
    build: |study| by(study, FIGURE.name, "the heading in the room", &["heading"], &Rate::DEPENDING),
};
