//! The study in one sentence.

use umbmark_core::diagnose::{Diagnosis, Reason, Verdict};
use umbmark_core::evidence::Level;
use umbmark_core::result::Said;

use crate::study::Study;

/// The result of a study.
pub fn said(study: &Study) -> Said {
    let outcome = Outcome::of(study).name();
    Said { name: study.name.clone(), notices: notices(study), outcome, verdict: verdict(study) }
}

/// What a study comes to, in a word; it decides the colour of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The model accounts for the error.
    Explained,
    /// The model accounts for the error, but the runs do not say which of several effects is in it.
    BySeveral,
    /// The model accounts for the error with a law that is fitted and belongs to no known effect.
    ByLaw,
    /// Effects were found, but something remains.
    Partly,
    /// No model accounts for the error.
    NotExplained,
    /// The data contradict their names.
    Fault,
    /// The runs are too few.
    NotEnoughData,
}

impl Outcome {
    /// Of the diagnosis, which is the one verdict of all verbs.
    pub(super) fn of(study: &Study) -> Outcome {
        let Ok(diagnosis) = study.diagnosis() else { return Outcome::NotEnoughData };
        if diagnosis.setup.all_faults().next().is_some() {
            return Outcome::Fault;
        }
        let is_unsure = study.learnt().is_ok_and(|learnt| learnt.steps.iter().any(|step| step.class.len() > 1));
        let has_law = diagnosis.model.parts().iter().any(|part| part.free && part.effect.formula().is_some());
        match diagnosis.verdict {
            _ if diagnosis.reasons.iter().any(Reason::is_of_data) => Outcome::NotExplained,
            Verdict::Explained if has_law => Outcome::ByLaw,
            Verdict::Explained if is_unsure => Outcome::BySeveral,
            Verdict::Explained => Outcome::Explained,
            Verdict::UnlistedEffect if has_law => Outcome::ByLaw,
            Verdict::MissingEffect | Verdict::SeveralMissing | Verdict::UnlistedEffect => Outcome::Partly,
            Verdict::NotExplained => Outcome::NotExplained,
            Verdict::NotEnoughData => Outcome::NotEnoughData,
        }
    }

    /// As in files.
    fn name(self) -> &'static str {
        match self {
            Outcome::Explained => "explained",
            Outcome::BySeveral | Outcome::ByLaw | Outcome::Partly => "partly",
            Outcome::NotExplained => "not_explained",
            Outcome::Fault => "fault",
            Outcome::NotEnoughData => "not_enough_data",
        }
    }

    /// As people say it.
    pub(super) fn words(self) -> &'static str {
        match self {
            Outcome::Explained => "Explained",
            Outcome::BySeveral => "Explained, by one effect or another",
            Outcome::ByLaw => "Explained, by a law without a name",
            Outcome::Partly => "Explained in part",
            Outcome::NotExplained => "Not explained",
            Outcome::Fault => "The data have a fault",
            Outcome::NotEnoughData => "Not enough data",
        }
    }
}

/// What has to be known before any figure is believed: faults of the columns, jumps of tracks, runs far from the others, clocks that differ. A
/// sentence each.
fn notices(study: &Study) -> Vec<String> {
    let told = |setup: &umbmark_core::setup::Setup| setup.notices();
    let notices = study.inspection().setup.as_ref().map(told).unwrap_or_default();
    let clocks = study.diagnosis().ok().and_then(|diagnosis| diagnosis.setup.clocks());
    notices.iter().chain(&clocks).map(|notice| format!("{}.", super::spoken(notice))).collect()
}

/// What a study comes to: the answer of the model that was learnt; of one that was given, what it leaves unexplained.
fn verdict(study: &Study) -> String {
    match study.solution() {
        Ok(solution) => solution.sentence(),
        Err(_) => of_given(study),
    }
}

fn of_given(study: &Study) -> String {
    let robot = study.data.robot.as_ref().map_or("The robot", |robot| robot.name.as_str());
    let missed = match study.score() {
        Ok(score) => score
            .summary
            .e_max_sys()
            .map_or("has no E_max,sys, because it was driven in one direction only".into(), |e_max| {
                format!("ends {:.0} mm from START (E_max,sys)", 1e3 * e_max)
            }),
        Err(why) => format!("has no score ({why})"),
    };
    let diagnosis = study.diagnosis();
    let left = diagnosis.as_ref().ok().and_then(|diagnosis| left_by(diagnosis)).unwrap_or_default();
    let cause = diagnosis.map_or_else(|why| format!("the runs cannot be diagnosed: {why}"), cause);
    format!("{robot} {missed}; {cause}{left}.")
}

/// What the model of a diagnosis leaves: of return poses, or along tracks.
fn left_by(diagnosis: &Diagnosis) -> Option<String> {
    let left = 1e3 * diagnosis.remains.as_ref()?.position.rms;
    Some(match diagnosis.level {
        Level::Tracks => format!("; the error along the way is then {left:.1} mm"),
        Level::Ends => format!("; the return error is then {left:.0} mm"),
    })
}

fn cause(diagnosis: &Diagnosis) -> String {
    let parts = diagnosis.model.parts().iter().filter(|part| part.free).map(|part| part.effect.name());
    let names: Vec<&str> = parts.collect();
    let model =
        if names.is_empty() { "the model".to_owned() } else { format!("the model with {}", joined(&names, "and")) };
    let missing = || diagnosis.certified().iter().map(|s| joined(&s.class, "or")).collect::<Vec<_>>().join("; and ");
    match diagnosis.verdict {
        Verdict::Explained => {
            format!("{model} fully accounts for the measured error, with no sign of a further effect")
        }
        Verdict::MissingEffect => format!("it has an error source that {model} cannot explain: {}", missing()),
        Verdict::SeveralMissing => format!("it has several error sources that {model} cannot explain: {}", missing()),
        Verdict::UnlistedEffect if diagnosis.dependence.is_none() && has_formula(diagnosis) => format!(
            "{model} fully accounts for the measured error, by a law that the catalogue does not list and with no sign of a further effect"
        ),
        Verdict::UnlistedEffect => {
            let on = diagnosis.dependence.as_ref().map(|told| format!("; it depends on {}", told.title));
            format!(
                "it has an error source that the catalogue does not list, besides {model}{}",
                on.unwrap_or_default()
            )
        }
        Verdict::NotExplained => {
            format!("{model} does not account for the measured error, but no single missing effect is certified")
        }
        Verdict::NotEnoughData => "these runs are not enough to find what is missing".into(),
    }
}

/// Whether a formula is fitted.
fn has_formula(diagnosis: &Diagnosis) -> bool {
    diagnosis.model.parts().iter().any(|part| part.free && part.effect.formula().is_some())
}

fn joined(names: &[&str], word: &str) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [rest @ .., last] => format!("{} {word} {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_joined_as_people_do() {
        assert_eq!(joined(&["a"], "and"), "a");
        assert_eq!(joined(&["a", "b", "c"], "or"), "a, b or c");
    }
}
