//! Errors against what the report does not show: whatever else is tested.

use umbmark_core::compare::tracks::Rate;

use super::FigureKind;
use super::residuals::by;

/// Drawn where they are asked for, in no report.
pub(super) static FIGURES: [FigureKind; 6] = [
    FigureKind {
        name: "residuals_by_acceleration",
        about: "errors against the acceleration",
        build: |study| by(study, "residuals_by_acceleration", "the acceleration", &["acceleration"], &Rate::DEPENDING),
    },
    FigureKind {
        name: "residuals_by_place",
        about: "errors against the place in the run",
        build: |study| by(study, "residuals_by_place", "the place in the run", &["distance"], &Rate::DEPENDING),
    },
    FigureKind {
        name: "residuals_by_time",
        about: "errors against the time in the run",
        build: |study| by(study, "residuals_by_time", "the time in the run", &["time"], &Rate::DEPENDING),
    },
    FigureKind {
        name: "residuals_by_run",
        about: "errors against the place of the run in the session",
        build: |study| by(study, "residuals_by_run", "the place of the run in the session", &["run"], &Rate::DEPENDING),
    },
    FigureKind {
        name: "residuals_by_way_since_turn",
        about: "errors against the way since the last turn",
        build: |study| {
            by(study, "residuals_by_way_since_turn", "the way since the last turn", &["since_turn"], &Rate::DEPENDING)
        },
    },
    FigureKind {
        name: "residuals_by_last_turn",
        about: "errors against the sense of the last turn",
        build: |study| {
            by(study, "residuals_by_last_turn", "the sense of the last turn", &["last_turn"], &Rate::DEPENDING)
        },
    },
];

#[cfg(test)]
mod tests {
    use umbmark_core::compare::tracks::COVARIATES;

    use crate::kind::all;

    #[test]
    fn every_covariate_that_is_tested_has_a_figure() {
        // Named as covariates are, but for these.
        let other = |name: &str| match name {
            "distance" => "place".to_owned(),
            "since_turn" => "way_since_turn".to_owned(),
            name => name.trim_end_matches("_left").trim_end_matches("_right").to_owned(),
        };
        for covariate in &COVARIATES {
            let name = format!("residuals_by_{}", other(covariate.name));
            assert!(all().any(|kind| kind.name == name), "{name}");
        }
    }
}
