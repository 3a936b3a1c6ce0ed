//! Whether the data is any good, and how the models do on it.

use umbmark_core::compare::Judged;
use umbmark_core::compare::tracks::TrackErrors;
use umbmark_core::evidence::Level;

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

/// The nominal robot and the model: of tracks their errors along the way, else of the returns. Which of them explains the runs is the verdict's
/// to say.
fn models(study: &Study) -> Option<List> {
    if study.diagnosis().is_ok_and(|diagnosis| diagnosis.level == Level::Tracks) {
        let along = study.along().ok()?;
        let row = |model: &TrackErrors| vec![model.name.clone(), mm(model.along.position), mm(model.end.position)];
        let header = ["model", "error along the way [mm]", "at the ends [mm]"];
        return Some(table("Models compared with the tracks", &header, along.iter().map(row).collect()));
    }
    let comparison = study.comparison().ok()?;
    let row = |model: &Judged| {
        let heading = model.heading_rmse.map_or("–".to_owned(), |h| format!("{:.2}", h.to_degrees()));
        vec![model.name.clone(), mm(model.rmse), heading]
    };
    let header = ["model", "error of the ends [mm]", "[deg]"];
    Some(table("Models compared with the return poses", &header, comparison.models.iter().map(row).collect()))
}

fn mm(metres: f64) -> String {
    format!("{:.1}", 1e3 * metres)
}

fn table(title: &str, header: &[&str], rows: Vec<Vec<String>>) -> List {
    let header = header.iter().map(|word| (*word).to_owned()).collect();
    List { title: title.into(), sentences: Vec::new(), table: Some(Rows { header, rows }) }
}
