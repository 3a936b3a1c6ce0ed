//! How far off a robot is, and what of it is what.

use crate::compare::tracks::error_along;
use crate::dataset::{Dataset, ReturnError};
use crate::effect::{ActsOn, Model};
use crate::evidence::{AnyEvidence, Ends, Estimate};
use crate::learn::Learnt;
use crate::likelihood::Observed;
use crate::path::Direction;
use crate::score::{noise_band, summarise};
use rayon::prelude::*;

/// The confidence with which chance stays below what is said of it.
const LEVEL: f64 = 0.95;
/// So many effects are asked in all orders; of more, each is asked after those before it.
const MOST_ORDERED: usize = 5;

/// What is measured of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// E_max,sys: the larger distance of the two mean returns from where odometry says they are.
    Returns,
    /// Root mean square distance of the ends of runs from where odometry says they are.
    Ends,
    /// The same of all measured poses along the way.
    Along,
    /// The same of all measured steps, each from where it began.
    Steps,
}

impl Measure {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Returns => "e_max_sys",
            Measure::Ends => "end_rmse",
            Measure::Along => "rmse_along",
            Measure::Steps => "rmse_steps",
        }
    }
}

/// A part of an error.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The effect.
    pub name: &'static str,
    /// By how much the error falls with it \[m\]; below 0 where it had hidden a part of another.
    pub worth: f64,
}

/// How far off a robot is \[m\], and what of it is what. Each list adds up to the fall between the two errors that it stands between.
#[derive(Clone, Debug, PartialEq)]
pub struct Off {
    /// What was measured.
    pub measure: Measure,
    /// As it was driven.
    pub driven: f64,
    /// Effects of the reference and of START: they are not the robot's.
    pub reference: Vec<Part>,
    /// Effects that become numbers of the robot.
    pub written: Vec<Part>,
    /// The error with these numbers in the robot, in the recorded runs.
    pub with_numbers: f64,
    /// Effects that are known, and that no number of the robot holds.
    pub known: Vec<Part>,
    /// What all of the model leaves.
    pub rest: f64,
    /// What chance alone would stay below in 95 % of tests; `None` where that is not known.
    pub chance: Option<f64>,
}

impl Off {
    /// The parts of the error of the runs of a learnt model.
    pub(super) fn of(meter: &Meter, learnt: &Learnt) -> Off {
        let model = &learnt.model;
        let own = model.robot().drive.own_effects();
        let group = |name: &'static str, acts_on: Option<ActsOn>| match acts_on {
            _ if own.contains(&name) => 1,
            Some(ActsOn::Reference | ActsOn::Start) => 0,
            _ => 2,
        };
        let mut groups: [Vec<&'static str>; 3] = Default::default();
        for part in model.parts() {
            let (name, entry) = (part.effect.name(), part.effect.entry());
            groups[group(name, entry.map(|entry| entry.about.acts_on))].push(name);
        }
        let mut there = Vec::new();
        let driven = meter.off(&Model::new(model.robot()));
        let mut errors = [driven; 3];
        let parts = [0, 1, 2].map(|group| {
            let parts = shares(&groups[group], |some| meter.off(&only(model, &[&there, some].concat())));
            there.extend(&groups[group]);
            errors[group] = meter.off(&only(model, &there));
            parts
        });
        let [reference, written, known] = parts;
        let [_, with_numbers, rest] = errors;
        Off {
            measure: meter.measure,
            driven,
            reference,
            written,
            with_numbers,
            known,
            rest,
            chance: meter.chance(model),
        }
    }
}

impl Off {
    /// Whether chance alone would leave as much of an error; false where that is not known.
    pub fn is_chance(&self, error: f64) -> bool {
        self.chance.is_some_and(|chance| error <= chance)
    }
}

/// The largest error \[m\] of a learnt model with one number of the robot at an end of its interval; infinite where one has none.
pub(super) fn at_ends_of_intervals(meter: &Meter, learnt: &Learnt, level: f64) -> f64 {
    let model = &learnt.model;
    let own = model.robot().drive.own_effects();
    let of_robot = learnt.diagnosis.fitted.iter().filter(|fitted| own.contains(&fitted.effect));
    let at_ends = |own: &Estimate| {
        let Some(interval) = own.interval(level) else { return f64::INFINITY };
        let at = |value: f64| {
            let mut moved = model.clone();
            moved.set(own.effect, own.parameter, value).map_or(f64::INFINITY, |()| meter.off(&moved))
        };
        at(interval.low).max(at(interval.high))
    };
    of_robot.map(at_ends).fold(0.0, f64::max)
}

/// A model with some of its effects.
fn only(model: &Model, effects: &[&str]) -> Model {
    let mut some = Model::new(model.robot());
    model.parts().iter().filter(|part| effects.contains(&part.effect.name())).for_each(|part| some.adopt(part));
    some
}

/// What each effect is worth: the mean fall of the error when it is added, over all orders in which they could be.
fn shares(effects: &[&'static str], error: impl Fn(&[&'static str]) -> f64 + Sync) -> Vec<Part> {
    let n = effects.len();
    let some = |set: usize| -> Vec<&'static str> { (0..n).filter(|k| set >> k & 1 == 1).map(|k| effects[k]).collect() };
    if n > MOST_ORDERED {
        let errors: Vec<f64> = (0..=n).into_par_iter().map(|k| error(&effects[..k])).collect();
        return (0..n).map(|k| Part { name: effects[k], worth: errors[k] - errors[k + 1] }).collect();
    }
    let errors: Vec<f64> = (0..1usize << n).into_par_iter().map(|set| error(&some(set))).collect();
    let factorial = |k: usize| (1..=k).map(|i| i as f64).product::<f64>();
    let worth = |k: usize| {
        let without = (0..1usize << n).filter(|set| set >> k & 1 == 0);
        let fall = |set: usize| {
            let size = set.count_ones() as usize;
            let weight = factorial(size) * factorial(n - size - 1) / factorial(n);
            weight * (errors[set] - errors[set | 1 << k])
        };
        without.map(fall).sum()
    };
    (0..n).map(|k| Part { name: effects[k], worth: worth(k) }).collect()
}

/// Measures the error of a model in recorded runs.
pub(crate) struct Meter<'a> {
    pub measure: Measure,
    runs: Runs<'a>,
}

enum Runs<'a> {
    Ends(Box<Ends>),
    Along(&'a Observed),
}

impl Meter<'_> {
    /// Returns of both directions where there are some; of logs, only with a known path, because other drives may end anywhere. Else poses
    /// along the way, or the ends.
    pub fn new<'a>(data: &Dataset, evidence: &'a AnyEvidence) -> Option<Meter<'a>> {
        let ends = match evidence {
            AnyEvidence::Ends(ends) => Some(ends.clone()),
            AnyEvidence::Tracks(_) => Ends::new(data).ok(),
        };
        let both = |ends: &Ends| {
            let driven = |direction| data.runs.iter().any(|run| run.direction == Some(direction));
            Direction::BOTH.into_iter().all(driven) && ends.counts().iter().all(|n| *n > 0)
        };
        let is_told = |ends: &Ends| match evidence {
            AnyEvidence::Ends(_) => ends.come_back(),
            AnyEvidence::Tracks(_) => data.path.is_some(),
        };
        match (ends, evidence) {
            (Some(ends), _) if both(&ends) && is_told(&ends) => {
                Some(Meter { measure: Measure::Returns, runs: Runs::Ends(Box::new(ends)) })
            }
            (_, AnyEvidence::Tracks(observed)) => {
                let steps = observed.runs.iter().all(|run| run.relative && !run.headings_only);
                let measure = if steps { Measure::Steps } else { Measure::Along };
                Some(Meter { measure, runs: Runs::Along(observed) })
            }
            (Some(ends), _) => Some(Meter { measure: Measure::Ends, runs: Runs::Ends(Box::new(ends)) }),
            (None, _) => None,
        }
    }

    /// The error that a model leaves \[m\].
    pub fn off(&self, model: &Model) -> f64 {
        match &self.runs {
            Runs::Along(observed) => error_along(observed, model),
            Runs::Ends(ends) => {
                let left = returns(ends, model);
                let all = left[0].iter().chain(&left[1]);
                let squares = all.clone().map(|r| r.x * r.x + r.y * r.y).sum::<f64>();
                let rms = || (squares / all.count().max(1) as f64).sqrt();
                match self.measure {
                    Measure::Returns => summarise(&left[0], &left[1]).e_max_sys().unwrap_or_else(rms),
                    _ => rms(),
                }
            }
        }
    }

    /// What chance alone would stay below, by the scatter that a model leaves.
    fn chance(&self, model: &Model) -> Option<f64> {
        match &self.runs {
            Runs::Ends(ends) if self.measure == Measure::Returns => {
                let [cw, ccw] = returns(ends, model);
                let sigma = summarise(&cw, &ccw).sigma_axis()?;
                Some(noise_band(sigma, cw.len(), ccw.len(), LEVEL))
            }
            _ => None,
        }
    }
}

/// What a model leaves of the return errors, direction by direction.
fn returns(ends: &Ends, model: &Model) -> [Vec<ReturnError>; 2] {
    let mut left: [Vec<ReturnError>; 2] = Default::default();
    for (run, residual) in ends.runs.iter().zip(ends.residuals(model)) {
        left[run.direction as usize].push(ReturnError { x: residual.x, y: residual.y, heading: None });
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two that hide each other in part, and one by itself.
    #[test]
    fn shares_add_up_and_do_not_depend_on_the_order() {
        let error = |there: &[&'static str]| {
            let has = |name: &str| f64::from(u8::from(there.contains(&name)));
            f64::abs(3.0 * (1.0 - has("a")) - 2.0 * (1.0 - has("b"))) + 5.0 * (1.0 - has("c"))
        };
        let of = |names: &[&'static str]| {
            let mut parts = shares(names, error);
            parts.sort_by_key(|part| part.name);
            parts
        };
        let near = |a: &[Part], b: &[Part]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.name == b.name && (a.worth - b.worth).abs() < 1e-12)
        };
        let parts = of(&["a", "b", "c"]);
        // a first: 1 - 2 and b then 2; b first: 1 - 3 and a then 3.
        let expected = [("a", 1.0), ("b", 0.0), ("c", 5.0)].map(|(name, worth)| Part { name, worth });
        assert!(near(&parts, &expected), "{parts:?}");
        assert!(near(&parts, &of(&["c", "b", "a"])), "{parts:?}");
        let many = shares(&["a", "b", "c", "d", "e", "f"], error);
        assert!((many.iter().map(|part| part.worth).sum::<f64>() - 6.0).abs() < 1e-12, "{many:?}");
    }
}
