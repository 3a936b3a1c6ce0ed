//! Errors in the command's own words: remedies name its flags.

use std::error::Error;

use umbmark_core::action::{Action, Wording};
use umbmark_core::plan::PlanError;
use umbmark_core::remedy;
use umbmark_io::export::ExportError;
use umbmark_io::{DatasetError, Words};

/// How the command names its arguments.
pub const WORDS: Words = Words { replace: "say --force", before: "--", between: " ", actions: Some(ACTIONS) };

/// How the command names what is done next.
pub const ACTIONS: Wording = |action| match action {
    Action::ListEffects => "`umbmark effects`",
    Action::Begin => "`umbmark init`",
    Action::CheckData => "`umbmark inspect DATA`",
    Action::CheckLog => "`umbmark inspect LOG`",
    Action::ReadReturns => "umbmark inspect, score, calibrate",
    Action::Score => "`umbmark score`",
    Action::Learn => "`umbmark learn DATA`",
    Action::WriteNumbers => {
        "`umbmark solve DATA -o model.toml`, then `umbmark export model.toml --to ros2_control -o robot.yaml` (or toml, c, urdf)"
    }
    Action::WriteFitted => {
        "`umbmark fit DATA -o plain.toml`, then `umbmark export plain.toml --to ros2_control -o robot.yaml`"
    }
    Action::WriteTable => {
        "`umbmark solve DATA -o model.toml`, then `umbmark export model.toml --to embedded -o model.h`"
    }
    Action::CorrectLogs => "`umbmark apply LOG --model model.toml -o corrected.csv`",
    other => other.plain(),
};

/// The message of an error, and those of what caused it.
pub fn worded(error: &anyhow::Error) -> String {
    let mut said: Vec<String> = Vec::new();
    for cause in error.chain().map(one) {
        // Some messages end in that of their cause.
        if !said.last().is_some_and(|told| told.ends_with(&cause)) {
            said.push(cause);
        }
    }
    said.join(": ")
}

fn one(error: &(dyn Error + 'static)) -> String {
    if let Some(error) = error.downcast_ref::<DatasetError>() {
        error.worded(&WORDS)
    } else if let Some(error) = error.downcast_ref::<ExportError>() {
        error.worded(&WORDS)
    } else if let Some(PlanError::NoScatter) = error.downcast_ref() {
        format!("{error} (--wheel-noise 0.001)")
    } else {
        remedy::worded(error, ACTIONS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::changed::ChangeError;
    use umbmark_core::evidence::FitError;

    #[test]
    fn an_error_that_tells_its_cause_tells_it_once_with_the_verb_that_helps() {
        let error = anyhow::Error::new(ChangeError::Fit { test: "before", source: FitError::NoRobot });
        assert_eq!(
            worded(&error.context("a")),
            "a: before: the nominal robot is not known: no robot.toml beside the data; `umbmark init` writes one to fill in"
        );
    }

    #[test]
    fn every_action_is_a_verb() {
        for action in Action::ALL {
            let verb = ACTIONS(action).trim_start_matches('`').strip_prefix("umbmark ");
            let verb = verb.and_then(|rest| rest.split([' ', '`', ',']).next()).unwrap();
            assert!(crate::command().find_subcommand(verb).is_some(), "{action:?}: {verb}");
        }
    }
}
