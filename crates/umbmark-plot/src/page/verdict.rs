//! The study in one sentence.

use umbmark_core::diagnose::{Diagnosis, Verdict};
use umbmark_core::evidence::Level;
use umbmark_core::result::Said;

use crate::study::Study;

/// What a study comes to.
pub fn said(study: &Study) -> Said {
    Said { name: study.name.clone(), notices: notices(study), verdict: verdict(study) }
}

/// What has to be known before any figure is believed: faults of the columns, jumps of tracks, runs far from the others. A sentence each.
fn notices(study: &Study) -> Vec<String> {
    let told = |setup: &umbmark_core::setup::Setup| setup.notices();
    let notices = study.inspection().setup.as_ref().map(told).unwrap_or_default();
    notices.iter().map(|notice| format!("{}.", super::spoken(notice))).collect()
}

/// What a study comes to, in one sentence.
fn verdict(study: &Study) -> String {
    let robot = study.data.robot.as_ref().map_or("The robot", |robot| robot.name.as_str());
    let missed = match study.score() {
        Ok(score) => {
            score.summary.e_max_sys().map_or("has no E_max,sys, being driven in one direction".into(), |e_max| {
                format!("comes back {:.0} mm off START (E_max,sys)", 1e3 * e_max)
            })
        }
        Err(why) => format!("has no score ({why})"),
    };
    let diagnosis = study.diagnosis();
    let left = diagnosis.as_ref().ok().and_then(|diagnosis| left_by(diagnosis)).unwrap_or_default();
    let cause = diagnosis.map_or_else(|why| format!("what is missing cannot be said: {why}"), cause);
    format!("{robot} {missed}; {cause}{left}.")
}

/// What the model of a diagnosis leaves: of return poses, or along tracks.
fn left_by(diagnosis: &Diagnosis) -> Option<String> {
    let left = 1e3 * diagnosis.remains.as_ref()?.position.rms;
    Some(match diagnosis.level {
        Level::Tracks => format!("; {left:.1} mm are left along the way"),
        Level::Ends => format!("; {left:.0} mm are left of the return errors"),
    })
}

fn cause(diagnosis: &Diagnosis) -> String {
    let parts = diagnosis.model.parts().iter().filter(|part| part.free).map(|part| part.effect.name());
    let names: Vec<&str> = parts.collect();
    let model = if names.is_empty() { "its model".to_owned() } else { joined(&names, "and") };
    let missing = || diagnosis.certified().iter().map(|s| joined(&s.class, "or")).collect::<Vec<_>>().join("; and ");
    match diagnosis.verdict {
        Verdict::Explained => {
            format!("{model} {} what these runs can show, with no sign of a further effect", explains(&names))
        }
        Verdict::MissingEffect => format!("beside {model} one class of effects is missing: {}", missing()),
        Verdict::SeveralMissing => format!("beside {model} several classes of effects are missing: {}", missing()),
        Verdict::UnlistedEffect if diagnosis.dependence.is_none() && has_formula(diagnosis) => format!(
            "{model} {} what these runs can show, by a law that the catalogue does not list and with no sign of a further effect",
            explains(&names)
        ),
        Verdict::UnlistedEffect => {
            let on = diagnosis.dependence.as_ref().map(|told| format!("; it depends on {}", told.title));
            format!("beside {model} something is missing that the catalogue does not list{}", on.unwrap_or_default())
        }
        Verdict::NotExplained => {
            format!("{model} does not explain these runs, though no single effect is certified as missing")
        }
        Verdict::NotEnoughData => "these runs are not enough to say what is missing".into(),
    }
}

/// Whether a formula is fitted.
fn has_formula(diagnosis: &Diagnosis) -> bool {
    diagnosis.model.parts().iter().any(|part| part.free && part.effect.formula().is_some())
}

/// The verb for one subject or for many.
fn explains(names: &[&str]) -> &'static str {
    if names.len() > 1 { "explain" } else { "explains" }
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
        assert_eq!([explains(&[]), explains(&["a"]), explains(&["a", "b"])], ["explains", "explains", "explain"]);
        assert_eq!(joined(&["a"], "and"), "a");
        assert_eq!(joined(&["a", "b", "c"], "or"), "a, b or c");
    }
}
