//! Whether the data is any good, and how the models do on it.

use umbmark_core::compare::Judged;

use super::{List, Rows};
use crate::study::Study;

pub(super) fn quality(study: &Study) -> Vec<List> {
    let inspection = study.inspection();
    let checks = inspection.checks.iter().map(|check| {
        let mark = if check.ok { "ok" } else { "LOOK" };
        vec![mark.to_owned(), check.name.to_owned(), check.found.clone(), check.good.to_owned()]
    });
    let determined = inspection.determined.iter().map(|answer| {
        let yes = if answer.yes { "yes" } else { "no" };
        vec![answer.quantity.to_owned(), yes.to_owned(), answer.because.to_owned()]
    });
    let mut lists = vec![
        table("Checks", &["", "what", "found", "good"], checks.collect()),
        table("What the data can determine", &["quantity", "", "because"], determined.collect()),
    ];
    lists.extend(models(study));
    lists.extend(left(study));
    if !inspection.warnings.is_empty() {
        let (title, sentences) = ("Noticed while reading".into(), inspection.warnings.clone());
        lists.push(List { title, sentences, table: None });
    }
    lists
}

/// What the model of the diagnosis leaves.
fn left(study: &Study) -> Option<List> {
    let sentences = study.diagnosis().ok()?.remains.as_ref()?.sentences();
    Some(List { title: "What the fitted model leaves".into(), sentences, table: None })
}

/// Models beside the return poses.
fn models(study: &Study) -> Option<List> {
    let comparison = study.comparison().ok()?;
    let size = study.options.diagnose.size;
    let row = |model: &Judged| {
        let verdict = if model.explains(size) { "agrees with the runs" } else { "does not explain the runs" };
        let heading = model.heading_rmse.map_or("–".to_owned(), |h| format!("{:.2}", h.to_degrees()));
        vec![model.name.clone(), format!("{:.1}", 1e3 * model.rmse), heading, format!("{:.3}", model.p), verdict.into()]
    };
    let header = ["model", "error of ends [mm]", "[deg]", "p", ""];
    Some(table("Models compared with the return poses", &header, comparison.models.iter().map(row).collect()))
}

fn table(title: &str, header: &[&str], rows: Vec<Vec<String>>) -> List {
    let header = header.iter().map(|word| (*word).to_owned()).collect();
    List { title: title.into(), sentences: Vec::new(), table: Some(Rows { header, rows }) }
}
