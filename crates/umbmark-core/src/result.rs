//! Results as users have them: what `--json` prints, and Python's classes.
//!
//! One file for each kind of result. A field is a key: its name carries the unit, and its documentation says what it means and when it is
//! null. A number that is not finite is null. Python's classes and their docstrings are written from these structs, by a test of the command
//! (`python_classes`).

use schemars::SchemaGenerator;

use crate::stats::Interval;

/// Each kind of result by its file, with those of its structs that are whole documents.
macro_rules! results {
    ($($file:ident $(: $($document:ident),+)?;)*) => {
        $(mod $file;
        pub use $file::*;)*

        /// Gives a generator the schemas of all results, and names those that are whole documents.
        pub fn describe(generator: &mut SchemaGenerator) -> Vec<&'static str> {
            $($($(generator.subschema_for::<$document>();)+)?)*
            vec![$($($(stringify!($document)),+ ,)?)*]
        }
    };
}

results! {
    applied;
    calibration: Calibration;
    changed: Changed;
    clock;
    closure;
    comparison: Comparison;
    conditions: Conditions;
    diagnosis: Diagnosis;
    effect;
    findings;
    fitted: Fitted;
    gears: GearCalibration;
    inspection: Inspection;
    keyed;
    law;
    learnt: Learnt;
    model;
    nominal;
    paper: Paper;
    plan: Plan, Separation;
    remains;
    report: Report;
    score: Score;
    sensitivity: Sensitivity;
    setup;
    solution: Solution;
    study: MonteCarlo;
    survey: Survey;
    sweep: Sweep;
    tolerance: Tolerance;
    track_comparison: TrackComparison;
    watched: Watched;
}

/// A number, or nothing where it is not finite.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The ends of an interval, or nothing where one is not finite.
fn ends(interval: Interval) -> Option<[f64; 2]> {
    pair(interval.low, interval.high)
}

/// Two numbers, or nothing where one is not finite.
fn pair(first: f64, second: f64) -> Option<[f64; 2]> {
    (first.is_finite() && second.is_finite()).then_some([first, second])
}
