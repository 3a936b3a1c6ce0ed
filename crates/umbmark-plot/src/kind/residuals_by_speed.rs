//! Errors against the speed.

use umbmark_core::compare::tracks::Rate;

use super::Kind;
use super::residuals::by;

pub(super) static FIGURE: Kind = Kind {
    name: "residuals_by_speed",
    about: "errors against the speed",
    build: |study| by(study, FIGURE.name, "the speed", &["speed"], &Rate::DEPENDING),
};
