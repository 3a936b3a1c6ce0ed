//! What the runs cannot show, and what would.

use umbmark_core::diagnose::Diagnosis;

use super::{List, Rows};
use crate::study::Study;

/// Experiments that are told.
const MAX_EXPERIMENTS: usize = 6;

pub(super) fn unseen(study: &Study) -> Vec<List> {
    let Ok(diagnosis) = study.diagnosis() else { return vec![nothing("There is no diagnosis.")] };
    let mut sentences = hidden(diagnosis);
    sentences.extend(diagnosis.remarks.iter().cloned());
    if sentences.is_empty() && diagnosis.minimum_detectable.is_empty() {
        return vec![nothing("No test was possible, so it is unknown what cannot be seen.")];
    }
    let rows = diagnosis
        .least_sizes()
        .into_iter()
        .flatten()
        .map(|d| vec![d.effect.to_owned(), d.parameter.to_owned(), format!("{:.2e}", d.size)]);
    let table = Rows { header: ["effect", "parameter", "least size"].map(str::to_owned).into(), rows: rows.collect() };
    let mut lists = vec![List { sentences, ..List::default() }];
    if !table.rows.is_empty() {
        let title = "Smallest sizes that would be seen with 80 % probability".into();
        lists.push(List { title, table: Some(table), ..List::default() });
    }
    lists
}

fn hidden(diagnosis: &Diagnosis) -> Vec<String> {
    let absorbed = diagnosis.absorbed().into_iter();
    let mut sentences: Vec<String> = absorbed
        .map(|(by, names)| {
            format!("Indistinguishable from {} of the model with this path: {}.", by.join(" with "), names.join(", "))
        })
        .collect();
    let below = diagnosis.below_noise();
    if !below.is_empty() {
        sentences.push(format!("Smaller than the scatter of the runs at the usual size: {}.", below.join(", ")));
    }
    sentences.extend(diagnosis.confounding());
    sentences
}

pub(super) fn next(study: &Study) -> Vec<List> {
    let Ok(diagnosis) = study.diagnosis() else { return vec![nothing("There is no diagnosis.")] };
    let experiments = &diagnosis.next_experiments;
    if experiments.is_empty() {
        return vec![nothing("No further experiment is needed to separate effects.")];
    }
    let row = |e: &umbmark_core::diagnose::Experiment| {
        let [a, b] = e.separates;
        vec![e.experiment.clone(), format!("{a} from {b}"), format!("{:.1}", e.sd), format!("{:.0}", e.minutes)]
    };
    let header = ["experiment", "separates", "standard deviations", "minutes"].map(str::to_owned).into();
    let table = Rows { header, rows: experiments.iter().take(MAX_EXPERIMENTS).map(row).collect() };
    let sentence =
        "The most informative per minute first; 3.3 standard deviations are seen in 90 % of cases.".to_owned();
    vec![List { sentences: vec![sentence], table: Some(table), ..List::default() }]
}

fn nothing(sentence: &str) -> List {
    List { sentences: vec![sentence.to_owned()], ..List::default() }
}
