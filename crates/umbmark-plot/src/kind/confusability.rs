//! Which effects look alike.

use umbmark_core::diagnose::classes::ALIKE;
use umbmark_core::prose::counted;

use super::FigureKind;
use super::correlations::cells;
use crate::figure::{Axis, Figure, Panel, Table, Told};
use crate::study::{Absent, Study};

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "confusability", about: "which effects look alike in these runs", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let likeness = &study.diagnosis()?.likeness;
    if likeness.effects.len() < 2 {
        return Err(Absent("These runs can show fewer than two effects outside the model.".into()));
    }
    let order = neighbours(&likeness.values);
    let names: Vec<String> = order.iter().map(|i| likeness.effects[*i].to_owned()).collect();
    let values: Vec<Vec<f64>> = order.iter().map(|i| order.iter().map(|j| likeness.values[*i][*j]).collect()).collect();
    let alike = alike(&names, &values);
    let says = match alike.len() {
        0 => format!(
            "These runs can distinguish each of the {} effects that they would show from all others.",
            names.len()
        ),
        _ => format!("Cannot be distinguished here: {}.", phrases(&alike)),
    };
    let told = Told {
        shows: "Similarity of effects outside the model in these runs, relative to the noise and beside the model: 1 is the \
                same trace, 0 a different one."
            .into(),
        good: "Pale except for the diagonal: any missing effect can be named. Dark squares are classes; the next experiment \
               should separate them."
            .into(),
        says,
    };
    let layers = vec![cells(&names, &values, |a, b, value| format!("{a} and {b}: {value:.2}"))];
    let axis = || Axis::named(names.clone());
    let panel = Panel { title: String::new(), x: axis(), y: axis().falling(), equal: true, layers };
    let rows = alike.iter().map(|(a, b, value)| [a.clone(), b.clone(), format!("{value:.3}")]);
    let table = Table::new(["effect", "looks like", "likeness"], rows);
    Ok(Figure { kind: "confusability", title: "Effects that look alike".into(), told, panels: vec![panel], table })
}

/// An order in which each is followed by the one of the rest that is most like it.
fn neighbours(values: &[Vec<f64>]) -> Vec<usize> {
    let mut rest: Vec<usize> = (1..values.len()).collect();
    let mut order = vec![0];
    while !rest.is_empty() {
        let last = &values[order[order.len() - 1]];
        let next = (0..rest.len()).max_by(|a, b| last[rest[*a]].total_cmp(&last[rest[*b]])).unwrap_or(0);
        order.push(rest.remove(next));
    }
    order
}

/// Pairs that are one class, the most alike first.
fn alike(names: &[String], values: &[Vec<f64>]) -> Vec<(String, String, f64)> {
    let pairs = (0..names.len()).flat_map(|i| (i + 1..names.len()).map(move |j| (i, j)));
    let mut alike: Vec<(String, String, f64)> = pairs
        .filter(|(i, j)| values[*i][*j] > ALIKE)
        .map(|(i, j)| (names[i].clone(), names[j].clone(), values[i][j]))
        .collect();
    alike.sort_by(|a, b| b.2.total_cmp(&a.2));
    alike
}

fn phrases(alike: &[(String, String, f64)]) -> String {
    const MAX_PAIRS: usize = 4;
    let first: Vec<String> = alike.iter().take(MAX_PAIRS).map(|(a, b, _)| format!("{a} and {b}")).collect();
    match alike.len().saturating_sub(MAX_PAIRS) {
        0 => first.join("; "),
        rest => format!("{}; and {}", first.join("; "), counted(rest, "more pair")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_alike_stands_side_by_side() {
        let values = vec![
            vec![1.0, 0.1, 0.9, 0.2],
            vec![0.1, 1.0, 0.2, 0.95],
            vec![0.9, 0.2, 1.0, 0.3],
            vec![0.2, 0.95, 0.3, 1.0],
        ];
        assert_eq!(neighbours(&values), [0, 2, 3, 1]);
        assert_eq!(neighbours(&[vec![1.0]]), [0]);
    }
}
