//! Laws that no catalogue lists: error left out against length.

use umbmark_core::diagnose::{Repeated, UnlistedLaw};
use umbmark_core::learn::Learnt;

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::kind::p_is;
use crate::study::{Absent, Study};
use crate::tone::Tone;

const MM: f64 = 1e3;
/// Laws by which the error rises beyond so many times that without are not drawn.
const HIGHEST: f64 = 1.2;
/// Labels no farther apart than this share of the height, and that would lie on one another, are one.
const APART: f64 = 0.05;
/// A character is so wide, in lengths.
const WIDE: f64 = 0.45;
/// Labels stand so far to the right of their marks, in lengths.
const BESIDE: f64 = 0.3;

pub(super) static FIGURE: FigureKind = FigureKind {
    name: "laws",
    about: "laws that no catalogue lists: cross-validated error against length",
    build: figure,
};

fn figure(study: &Study) -> Result<Figure, Absent> {
    let learnt = study.learnt()?;
    let laws = added(learnt);
    if laws.is_empty() {
        return Err(Absent("No law that the catalogue does not list was added.".into()));
    }
    Ok(Figure {
        kind: "laws",
        title: "Laws that were tried".into(),
        told: told(&laws),
        panels: laws.iter().map(|(name, repeated)| panel(name, repeated)).collect(),
        table: table(&laws),
    })
}

/// Steps of which a law was added, with their names.
fn added(learnt: &Learnt) -> Vec<(&'static str, &Repeated)> {
    learnt.steps.iter().filter_map(|step| Some((step.added?, step.law.as_deref()?))).collect()
}

/// The law that was taken and the others, each with its number.
fn tried(repeated: &Repeated) -> impl Iterator<Item = (usize, &UnlistedLaw)> {
    std::iter::once(&repeated.law).chain(&repeated.others).map(|law| (law.number, law))
}

fn panel(name: &str, repeated: &Repeated) -> Panel {
    let before = repeated.law.left_out[0];
    let most = HIGHEST * before;
    let shown: Vec<(usize, &UnlistedLaw)> =
        tried(repeated).filter(|(_, law)| law.model.is_some() && law.left_out[1] <= most).collect();
    let place = |law: &UnlistedLaw| [law.length as f64, MM * law.left_out[1]];
    let longest = shown.iter().map(|(_, law)| law.length).max().unwrap_or(1) as f64 + 4.0;
    let said = shown.iter().map(|(number, law)| format!("{number}: {}, {:.1} mm", law.words(), MM * law.left_out[1]));
    let places = shown.iter().map(|(number, law)| (*number, place(law)));
    let (labels, beside): (Vec<String>, Vec<[f64; 2]>) = labels(places, APART * MM * most).into_iter().unzip();
    let layers = vec![
        Layer::new("without a law", Tone::Quiet, Mark::Dashes, [[0.0, MM * before], [longest, MM * before]]),
        Layer::new("best law up to this length", Tone::Model, Mark::Line, front(&shown, longest)),
        Layer::new("laws", Tone::Computed, Mark::Rings, shown.iter().map(|(_, law)| place(law))).saying(said.collect()),
        Layer::new("the chosen law", Tone::Model, Mark::Dots, [place(&repeated.law)]),
        Layer::new("", Tone::Quiet, Mark::Words(labels), beside),
    ];
    Panel {
        title: name.to_owned(),
        x: Axis::of("length of the formula").from_to(0.0, longest),
        y: Axis::of("cross-validated error [mm]").from_to(0.0, 1.05 * MM * most),
        equal: false,
        layers,
    }
}

/// A label for each law, and one for several that are closer than `high` and would lie on one another: it stands right of the last.
fn labels(places: impl Iterator<Item = (usize, [f64; 2])>, high: f64) -> Vec<(String, [f64; 2])> {
    let mut labels: Vec<(String, [f64; 2])> = Vec::new();
    for (number, [x, y]) in places {
        let x = x + BESIDE;
        let own = WIDE * (number.to_string().len() + 1) as f64;
        let meets = |(text, [u, v]): &&mut (String, [f64; 2])| {
            (y - *v).abs() < high && x < *u + WIDE * (text.len() + 1) as f64 && *u < x + own
        };
        match labels.iter_mut().find(meets) {
            Some((text, [u, _])) => {
                *text += &format!(", {number}");
                *u = u.max(x);
            }
            None => labels.push((number.to_string(), [x, y])),
        }
    }
    labels
}

/// The least error among laws that are no longer than each, as stairs.
fn front(shown: &[(usize, &UnlistedLaw)], longest: f64) -> Vec<[f64; 2]> {
    let mut sorted: Vec<&UnlistedLaw> = shown.iter().map(|(_, law)| *law).collect();
    sorted.sort_by(|a, b| a.length.cmp(&b.length).then(a.left_out[1].total_cmp(&b.left_out[1])));
    let mut stairs: Vec<[f64; 2]> = Vec::new();
    for law in sorted {
        let (length, error) = (law.length as f64, MM * law.left_out[1]);
        match stairs.last().copied() {
            Some([_, least]) if least <= error => {}
            Some([_, least]) => stairs.extend([[length, least], [length, error]]),
            None => stairs.push([length, error]),
        }
    }
    stairs.extend(stairs.last().map(|[_, least]| [longest, *least]));
    stairs
}

fn told(laws: &[(&'static str, &Repeated)]) -> Told {
    let one = |(name, repeated): &(&str, &Repeated)| {
        let [before, after] = repeated.law.left_out.map(|error| MM * error);
        let law = repeated.law.words();
        format!("{name}: {law} ({}; cross-validated error {before:.1} to {after:.1} mm).", p_is(repeated.p))
    };
    Told {
        shows: "The cross-validated error with each law that was tried, against the length of its formula: operations, variables and numbers. \
                The numbers are those of `umbmark learn --law`."
            .into(),
        good: "One short law far below the rest. If several are as low, the shortest is chosen; a drive that separates them is \
               worth more than their order."
            .into(),
        says: laws.iter().map(one).collect::<Vec<_>>().join(" "),
    }
}

fn table(laws: &[(&'static str, &Repeated)]) -> Table {
    let rows = laws.iter().flat_map(|(name, repeated)| {
        tried(repeated).map(move |(number, law)| {
            let formula = law.model.as_ref().and_then(|model| model.parts().first()?.effect.formula());
            [
                (*name).to_owned(),
                number.to_string(),
                formula
                    .map_or_else(|| law.words(), |formula| format!("{} = {}", formula.target().name(), formula.text())),
                formula.map_or("–".into(), |_| law.length.to_string()),
                format!("{:.1}", MM * law.left_out[1]),
            ]
        })
    });
    Table::new(["added as", "law", "formula", "length", "left out [mm]"], rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_has_its_number_and_near_ones_share_a_label() {
        let places = [(1, [21.0, 3.3]), (2, [21.0, 3.5]), (3, [21.0, 9.0]), (4, [15.0, 3.3])];
        let labels: Vec<String> = labels(places.into_iter(), 0.7).into_iter().map(|(text, _)| text).collect();
        assert_eq!(labels, ["1, 2", "3", "4"]);
    }
}
