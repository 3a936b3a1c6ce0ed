//! Calibration of drives other than the differential one: their own first effects.

use std::io::Write;
use std::process::ExitCode;

use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose;
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;
use umbmark_core::learn::{GearCalibration, calibrate_gears};
use umbmark_core::result;
use umbmark_core::solve::{Solution, solve};

use super::{Arguments, write_targets};
use crate::Session;
use crate::answer::answer_text;
use crate::model_report::estimates_table;
use crate::table::table;

pub(super) fn run(arguments: &Arguments, data: &Dataset, session: &mut Session) -> anyhow::Result<ExitCode> {
    let robot = data.nominal_robot()?;
    let calibration = calibrate_gears(data)?;
    if calibration.estimates.is_empty() {
        anyhow::bail!(
            "nothing can be calibrated from these runs: drive a closed path in both directions, or measure poses on the way"
        );
    }
    let testing = diagnose::Options { seed: session.seed(), ..diagnose::Options::default() };
    let start = Model::new(robot);
    let answer =
        session.watched("% of the steps of learning at most", |watch| solve(data, &start, &testing, watch))??;
    let withheld = !answer.is_trusted() && !arguments.force;
    let learnt = (&answer.learnt.model, answer.learnt.noise);
    let (model, noise) = if answer.changes.is_empty() { (&calibration.model, None) } else { learnt };
    let written = if withheld { Vec::new() } else { write_targets(arguments, data, model, noise)? };
    if session.json() {
        session.print_json(&result::GearCalibration::new(
            robot,
            &calibration,
            arguments.intervals.level,
            &data.warnings,
        ))?;
        return super::told_what_is_withheld(arguments, withheld);
    }
    for warning in &data.warnings {
        session.message("warning", warning);
    }
    for effect in &calibration.not_shown {
        session.message(
            "warning",
            &format!("{effect} is not determined: this data does not show it, or cannot separate it from the others"),
        );
    }
    let text = told(robot, &calibration, Some(&answer), arguments.intervals.level, testing.size);
    write!(session.out(), "{text}")?;
    for file in written {
        writeln!(session.out(), "wrote {file}")?;
    }
    super::told_what_is_withheld(arguments, withheld)
}

/// The fitted sizes, what they change, and what `solve` answers to tests of this size, where it was asked.
pub fn told(robot: &Robot, calibration: &GearCalibration, answer: Option<&Solution>, level: f64, size: f64) -> String {
    let mut text = format!("Calibration of {}, drive = \"{}\"\n\n", robot.name, robot.drive.kind().name());
    text += &estimates_table(&calibration.estimates, level);
    if let Some(i) = &calibration.identifiability {
        text += &format!(
            "\n\nReturn poses of this path determine {} of the {} combinations of them that matter.",
            i.rank,
            i.shares.len()
        );
    }
    let mm = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{:.1} mm", v * 1e3));
    let (before, after) = (mm(calibration.e_max_sys_before), mm(calibration.e_max_sys_after));
    text += &format!("\n\nE_max,sys as driven: {before}; with the correction: {after}\n\n");
    let rows = calibration
        .changes(robot)
        .into_iter()
        .map(|(key, old, new)| vec![key.to_owned(), format!("{old}"), format!("{new:.9}")]);
    text += &(table(&["robot.toml", "nominal", "corrected"], rows) + "\n");
    text + &answer.map_or_else(String::new, |answer| format!("\n{}", answer_text(answer, 1.0 - size)))
}
