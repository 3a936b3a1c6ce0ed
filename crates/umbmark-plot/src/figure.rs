//! What a figure is: numbers, their meaning and three sentences, before anything is drawn.

mod gaps;
mod table;

use serde::{Deserialize, Deserializer, Serialize};
use umbmark_core::path::Direction;

use crate::kind;
use crate::tone::Tone;

pub use table::Table;

/// The name of a kind of figure.
// Behind this name serde does not take it for text that is borrowed.
pub type Name = &'static str;

/// A figure. It can be written down (serde); infinite numbers come back as none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Its name in files and on the command line.
    #[serde(deserialize_with = "kind_of")]
    pub kind: Name,
    /// A few words.
    pub title: String,
    /// What it shows, what good looks like, and what this one says: a sentence or two each.
    pub told: Told,
    /// What is drawn, from top to bottom.
    pub panels: Vec<Panel>,
    /// Its message as numbers, for those who cannot see it.
    pub table: Table,
}

/// The name of a kind, which is one of those that there are.
fn kind_of<'de, D: Deserializer<'de>>(from: D) -> Result<Name, D::Error> {
    let name = String::deserialize(from)?;
    let known = kind::find(&name).ok_or_else(|| serde::de::Error::custom(format!("no kind of figure \"{name}\"")))?;
    Ok(known.name)
}

/// The sentences of a figure.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// What it shows.
    pub shows: String,
    /// What would be good.
    pub good: String,
    /// What this one says.
    pub says: String,
}

/// A pair of axes and what is drawn in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// What stands above it; may be empty.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Whether a unit is as long on both axes.
    pub equal: bool,
    /// From the lowest to the uppermost.
    pub layers: Vec<Layer>,
}

/// An axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// What it shows, with its unit in brackets.
    pub title: String,
    /// Names at 0, 1, 2, ...; where there are some, the axis has no numbers.
    pub names: Vec<String>,
    /// Both ends, where they are not left to the data.
    pub range: Option<[f64; 2]>,
    /// Whether values fall along it.
    pub falling: bool,
}

impl Axis {
    /// An axis of numbers.
    pub fn of(title: impl Into<String>) -> Axis {
        Axis { title: title.into(), ..Axis::default() }
    }

    /// An axis of names, the first at 0.
    pub fn named(names: Vec<String>) -> Axis {
        Axis { names, ..Axis::default() }
    }

    /// The same from the top down.
    pub fn falling(self) -> Axis {
        Axis { falling: true, ..self }
    }

    /// The same with given ends.
    pub fn from_to(self, low: f64, high: f64) -> Axis {
        Axis { range: Some([low, high]), ..self }
    }
}

/// How the places of a layer are drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Mark {
    /// Full circles; diamonds where a model says so.
    Dots,
    /// Empty circles or diamonds.
    Rings,
    /// Upright crosses.
    Crosses,
    /// A line from place to place; a place that is no number breaks it.
    Line,
    /// The same, dashed.
    Dashes,
    /// Bars from zero upwards, so wide.
    Bars(f64),
    /// A dot with an interval to the left and right: lower and upper ends.
    Spans(#[serde(with = "gaps")] Vec<f64>, #[serde(with = "gaps")] Vec<f64>),
    /// Squares of side one, shaded by their values from -1 to 1.
    Cells(#[serde(with = "gaps")] Vec<f64>),
    /// Words beside the places.
    Words(Vec<String>),
}

/// Places that are drawn alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// Its colour.
    pub tone: Tone,
    /// How it is drawn.
    pub mark: Mark,
    /// To the right.
    #[serde(with = "gaps")]
    pub x: Vec<f64>,
    /// Upwards.
    #[serde(with = "gaps")]
    pub y: Vec<f64>,
    /// What is said of each place where it is pointed at; empty where its coordinates say it.
    pub said: Vec<String>,
    /// The run that each place belongs to, as its index in the dataset; empty for what is no run's.
    pub runs: Vec<usize>,
    /// Where in its run each place is: how far the wheels had rolled by then, on average and whatever way \[m\], not a number where that is
    /// not known. Empty where a place stands for a run as a whole.
    #[serde(default, with = "gaps")]
    pub rolled: Vec<f64>,
    /// The direction that all of it is about.
    pub direction: Option<Direction>,
}

impl Layer {
    /// Places with a name in the legend.
    pub fn new(name: impl Into<String>, tone: Tone, mark: Mark, places: impl IntoIterator<Item = [f64; 2]>) -> Layer {
        let (x, y) = places.into_iter().map(|[x, y]| (x, y)).unzip();
        let (said, runs, rolled) = (Vec::new(), Vec::new(), Vec::new());
        Layer { name: name.into(), tone, mark, x, y, said, runs, rolled, direction: None }
    }

    /// The same about runs of one direction.
    pub fn of(self, direction: Direction) -> Layer {
        Layer { direction: Some(direction), ..self }
    }

    /// The same with words for each place.
    pub fn saying(self, said: Vec<String>) -> Layer {
        Layer { said, ..self }
    }

    /// The same with the run of each place.
    pub fn from_runs(self, runs: Vec<usize>) -> Layer {
        Layer { runs, ..self }
    }

    /// The same with the run of each place, and how far its wheels had rolled there \[m\].
    pub fn along_runs(self, runs: Vec<usize>, rolled: Vec<f64>) -> Layer {
        Layer { runs, rolled, ..self }
    }

    /// Whether nothing of it can be drawn.
    pub fn is_empty(&self) -> bool {
        !self.x.iter().zip(&self.y).any(|(x, y)| x.is_finite() && y.is_finite())
    }
}

/// A circle or an ellipse as a closed line about (`x`, `y`), half axes `a` and `b`, the first turned by `angle` \[rad\].
pub fn ellipse(x: f64, y: f64, a: f64, b: f64, angle: f64) -> impl Iterator<Item = [f64; 2]> {
    const CORNERS: u32 = 96;
    let (sine, cosine) = angle.sin_cos();
    (0..=CORNERS).map(move |i| {
        let (s, c) = (f64::from(i) / f64::from(CORNERS) * std::f64::consts::TAU).sin_cos();
        [x + a * c * cosine - b * s * sine, y + a * c * sine + b * s * cosine]
    })
}
