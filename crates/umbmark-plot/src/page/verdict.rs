//! The study in one sentence.

use umbmark_core::diagnose::{Diagnosis, Verdict};

use crate::study::Study;

/// What has to be known before any figure is believed: faults of the columns, jumps of tracks, runs far from the others. A sentence each.
pub fn notices(study: &Study) -> Vec<String> {
    let told = |setup: &umbmark_core::setup::Setup| setup.notices();
    let notices = study.inspection().setup.as_ref().map(told).unwrap_or_default();
    notices.iter().map(|notice| format!("{}.", super::spoken(notice))).collect()
}

/// What a study comes to, in one sentence.
pub fn verdict(study: &Study) -> String {
    let robot = study.data.robot.as_ref().map_or("The robot", |robot| robot.name.as_str());
    let missed = match study.score() {
        Ok(score) => {
            score.summary.e_max_sys().map_or("has no E_max,sys, being driven in one direction".into(), |e_max| {
                format!("comes back {:.0} mm off START (E_max,sys)", 1e3 * e_max)
            })
        }
        Err(why) => format!("has no score ({why})"),
    };
    let cause = study.diagnosis().map_or_else(|why| format!("what is missing cannot be said: {why}"), cause);
    let left = study.exact().and_then(|exact| exact.e_max_sys_after);
    let left = left.map(|after| format!("; calibrated, {:.0} mm would be left", 1e3 * after)).unwrap_or_default();
    format!("{robot} {missed}; {cause}{left}.")
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
