//! The most significant laws, of each shape a few.

use super::laws::Laws;
use super::signs::Asked;
use super::steps::TrackStep;
use crate::diagnose::tracks::smooth::Motion;
use crate::likelihood::{Column, ObservedRun};

/// Maximum number of laws that are fitted, and of one shape.
const TRIED: usize = 16;
const OF_A_SHAPE: usize = 2;

/// A law that is tried: its term, which motion it acts on, and whether it turns over with the sense of the run.
#[derive(Clone)]
pub struct Pick {
    pub term: usize,
    /// The numbers that shape it.
    pub shapes: Vec<f64>,
    pub motion: usize,
    pub with_sense: bool,
}

impl Pick {
    /// The columns of its term, and of its twin, in a run: for each of some numbers that shape it.
    pub fn columns(&self, shapes: &[&[f64]], run: &ObservedRun, laws: &Laws, steps: &[TrackStep]) -> Vec<Column> {
        let sense = if self.with_sense { sense_of(run) } else { 1.0 };
        let shaped = shapes.iter().flat_map(|by| laws.both(self.term).map(move |term| (term, *by)));
        let columns = laws.shaped_columns(&shaped.collect::<Vec<_>>(), run, steps);
        let own = columns.into_iter().skip(self.motion).step_by(Motion::ALL.len());
        own.map(|column| column.into_iter().map(|c| c.map(|value| sense * value)).collect()).collect()
    }
}

/// The sense of a run: 1 counter-clockwise, -1 clockwise.
pub fn sense_of(run: &ObservedRun) -> f64 {
    run.track.contexts().first().map_or(0.0, |at| at.direction)
}

/// The most significant laws, and the square of the greatest score of a column in standard deviations.
pub fn picks(asked: &[&Asked], laws: &Laws) -> (Vec<Pick>, f64) {
    let each = Motion::ALL.len();
    let mut all: Vec<(f64, Pick)> = Vec::new();
    let mut greatest: f64 = 0.0;
    for (group, asked) in asked.iter().enumerate() {
        for (term, about) in laws.terms.iter().enumerate() {
            for motion in 0..each {
                let of = |term: usize| asked.square(each * term + motion);
                let twin = about.twin.map_or(0.0, of);
                greatest = greatest.max(of(term)).max(twin);
                if about.twin.is_none_or(|twin| twin > term) {
                    let worth = of(term) + twin - 3.0 * laws.numbers(term) as f64;
                    all.push((worth, Pick { term, shapes: Vec::new(), motion, with_sense: group > 0 }));
                }
            }
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut shapes = Vec::new();
    let mut picks = Vec::new();
    for (worth, pick) in all {
        let shape = (laws.shape(pick.term), pick.motion, laws.terms[pick.term].per.name(), pick.with_sense);
        let known = shapes.iter().filter(|known| **known == shape).count();
        if picks.len() < TRIED && known < OF_A_SHAPE && (worth > 0.0 || picks.is_empty()) {
            shapes.push(shape);
            picks.push(Pick { shapes: laws.shapes(pick.term), ..pick });
        }
    }
    (picks, greatest)
}
