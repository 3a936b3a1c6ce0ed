//! How far the fitted numbers are tied to one another.

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::study::{Absent, Study};
use crate::tone::Tone;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "correlations", about: "correlations of the model's numbers", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let diagnosis = study.diagnosis()?;
    let names: Vec<String> = diagnosis.fitted.iter().map(|e| format!("{}: {}", e.effect, e.parameter)).collect();
    let values = &diagnosis.correlations;
    if values.len() < 2 {
        return Err(Absent("Correlations need two fitted numbers and their covariance.".into()));
    }
    let told = Told {
        shows: "Correlations of the estimates: how far an error of one fitted number can compensate for an error of another."
            .into(),
        good: "Pale off the diagonal. Near +1 or −1 the runs determine only a combination of the two.".into(),
        says: strongest(&names, values),
    };
    let layers = vec![cells(&names, values, |a, b, value| format!("{a} and {b}: {value:+.2}"))];
    let axis = || Axis::named(names.clone());
    let panel = Panel { title: String::new(), x: axis(), y: axis().falling(), equal: true, layers };
    let rows = names.iter().zip(values).map(|(name, row)| {
        std::iter::once(name.clone()).chain(row.iter().map(|value| format!("{value:+.2}"))).collect()
    });
    let header = std::iter::once(String::new()).chain(names.iter().cloned()).collect();
    let table = Table { header, rows: rows.collect() };
    Ok(Figure { kind: "correlations", title: "Correlations of the numbers".into(), told, panels: vec![panel], table })
}

/// A square of cells, row by row from the top.
pub(super) fn cells(names: &[String], values: &[Vec<f64>], said: impl Fn(&str, &str, f64) -> String) -> Layer {
    let all = || (0..names.len()).flat_map(|i| (0..names.len()).map(move |j| (i, j)));
    let shades = all().map(|(i, j)| values[i][j]).collect();
    let words = all().map(|(i, j)| said(&names[i], &names[j], values[i][j])).collect();
    Layer::new("", Tone::Model, Mark::Cells(shades), all().map(|(i, j)| [j as f64, i as f64])).saying(words)
}

/// The pair that is tied most.
fn strongest(names: &[String], values: &[Vec<f64>]) -> String {
    let pairs = (0..names.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let most = pairs.max_by(|(i, j), (k, l)| values[*i][*j].abs().total_cmp(&values[*k][*l].abs()));
    most.map_or(String::new(), |(i, j)| {
        format!("The strongest is {:+.2}, between {} and {}.", values[i][j], names[j], names[i])
    })
}
