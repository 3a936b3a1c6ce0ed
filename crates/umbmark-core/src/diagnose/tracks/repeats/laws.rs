//! The laws that are tested: functions of how and where the robot drives, per second, metre or radian.

use super::extent::Extent;
use super::steps::{Per, TrackStep};
use crate::diagnose::tracks::smooth::Motion;
use crate::drive::Robot;
use crate::effect::{Formula, Model, Target};
use crate::likelihood::{Column, ObservedRun};

/// A function of a step.
pub(super) struct Function {
    /// What it is: "a wave of the time with a period of {c} s".
    pub words: String,
    /// The same as a formula.
    pub formula: Written,
    /// Of a step and of the numbers that shape it, in the order of the formula's.
    pub value: Box<Value>,
}

/// A number for a step and the numbers that shape a function.
pub(super) type Value = dyn Fn(&TrackStep, &[f64]) -> f64 + Send + Sync;

/// A formula of the user's own, and the parameters that shape it, with start values.
pub(super) type Written = (String, Vec<(&'static str, f64)>);

/// A function for each second, metre or radian.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    pub function: usize,
    /// What it is in proportion to.
    pub per: Per,
    /// The term that goes with it: the cosine to a sine.
    pub twin: Option<usize>,
}

/// Runs drive back where more than this share of the way is back.
const BACK: f64 = 0.02;
/// The name of the number that shapes a law: a period, a scale, a threshold.
pub const SHAPE: &str = "c";
/// The names of the sizes of a law.
pub const SIZES: [&str; 2] = ["a", "b"];

/// All laws that some runs may follow.
pub struct Laws {
    pub(super) functions: Vec<Function>,
    /// Whether some runs drive back.
    reverses: bool,
    /// Nominal distance of the wheels \[m\].
    wheelbase: f64,
    /// Each with three motions.
    pub terms: Vec<Term>,
}

impl Laws {
    /// Those of the steps of some runs of a robot; none of turns where `turns` says that the runs do not turn.
    pub fn of(steps: &[Vec<TrackStep>], robot: &Robot, turns: bool) -> Laws {
        let wheelbase = robot.drive.wheelbase();
        let extent = Extent::of(steps, wheelbase);
        let reverses = extent.back > BACK * extent.way;
        let mut laws = Laws { functions: Vec::new(), reverses, wheelbase, terms: Vec::new() };
        laws.fill(&extent);
        if robot.drive.kind().has_axle_wheels() {
            laws.of_wheels(&extent);
        }
        if laws.reverses {
            laws.add_signed(Per::Metre, Per::Ahead);
        }
        laws.add_signed(Per::Radian, Per::Turned);
        if !turns {
            laws.drop_turns();
        }
        laws
    }

    /// Drops what depends on turning: where runs do not turn, turn rates and rotations are single counts.
    fn drop_turns(&mut self) {
        let is_of_turns = |term: &Term| {
            matches!(term.per, Per::Radian | Per::Turned) || self.functions[term.function].formula.0.contains("turn")
        };
        let kept: Vec<usize> = (0..self.terms.len()).filter(|term| !is_of_turns(&self.terms[*term])).collect();
        let place = |term: usize| kept.binary_search(&term).ok();
        let with_places = |term: &usize| Term { twin: self.terms[*term].twin.and_then(place), ..self.terms[*term] };
        self.terms = kept.iter().map(with_places).collect();
    }

    /// The name that a term has as an effect: "periodic_yaw", "forward_by_speed".
    fn name(&self, term: usize, motion: Motion) -> String {
        let text = &self.functions[self.terms[term].function].formula.0;
        let words: Vec<&str> = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect();
        let known = |word: &&str| Formula::variables().iter().any(|variable| variable.name == *word);
        let by = words.into_iter().find(known);
        let motion = self.acts_on(term, motion).replace(' ', "_");
        match by {
            Some("time" | "distance") if text.contains("pi") => format!("periodic_{motion}"),
            Some("x" | "y") => format!("{motion}_by_place"),
            Some(variable) => format!("{motion}_by_{variable}"),
            None => format!("steady_{motion}"),
        }
    }

    /// What a term acts on: a motion of the robot, or a wheel.
    pub fn acts_on(&self, term: usize, motion: Motion) -> &'static str {
        match self.terms[term].per {
            Per::LeftWheel => "left wheel",
            Per::RightWheel => "right wheel",
            _ => motion.name(),
        }
    }

    /// A word for the shape of a term's function, whatever its numbers are.
    pub fn shape(&self, term: usize) -> String {
        let Function { words, formula, .. } = &self.functions[self.terms[term].function];
        if formula.1.is_empty() { words.clone() } else { formula.0.chars().filter(|c| !c.is_ascii_digit()).collect() }
    }

    /// How many numbers a term and its twin have as a law.
    pub fn numbers(&self, term: usize) -> usize {
        let shapes = self.functions[self.terms[term].function].formula.1.len();
        1 + usize::from(self.terms[term].twin.is_some()) + shapes
    }

    /// The numbers that shape a term, as it was tested.
    pub fn shapes(&self, term: usize) -> Vec<f64> {
        self.functions[self.terms[term].function].formula.1.iter().map(|shape| shape.1).collect()
    }

    /// Which of these numbers are lengths, times or thresholds, and no places or directions.
    pub fn scales(&self, term: usize) -> Vec<bool> {
        self.functions[self.terms[term].function].formula.1.iter().map(|shape| shape.0 == SHAPE).collect()
    }

    /// Upper bound of these numbers: no wave is longer than the longest that is tested, which is as long as a run.
    pub fn most(&self, term: usize) -> f64 {
        let text = |function: usize| &self.functions[function].formula.0;
        let own = self.terms[term].function;
        if self.terms[term].twin.is_none() {
            return f64::INFINITY;
        }
        let alike = (0..self.functions.len()).filter(|function| text(*function) == text(own));
        let shapes = alike.flat_map(|function| self.functions[function].formula.1.iter().map(|shape| shape.1));
        shapes.fold(0.0, f64::max)
    }

    /// A term and its twin.
    pub fn both(&self, term: usize) -> impl Iterator<Item = usize> {
        std::iter::once(term).chain(self.terms[term].twin)
    }

    /// A model that holds a term alone, and its twin, with these sizes and shapes: for each motion, with the sense of the run or without.
    pub fn model(
        &self,
        term: usize,
        (sizes, by): (&[f64], &[f64]),
        (motion, with_sense): (Motion, bool),
        robot: &Robot,
    ) -> Option<Model> {
        let about = self.terms[term];
        let (target, factor) = match (motion, about.per) {
            (Motion::Forward, Per::LeftWheel) => (Target::LeftWheelScale, ""),
            (Motion::Forward, Per::RightWheel) => (Target::RightWheelScale, ""),
            (_, Per::LeftWheel | Per::RightWheel) => return None,
            (Motion::Yaw, Per::Metre) => (Target::HeadingPerMetre, ""),
            (Motion::Yaw, Per::Ahead) => (Target::HeadingPerMetre, "sign(speed) * "),
            (Motion::Yaw, Per::Radian) => (Target::TurnScale, "sign(turn_rate) * "),
            (Motion::Yaw, Per::Turned) => (Target::TurnScale, ""),
            (Motion::Yaw, Per::Second) => (Target::HeadingPerSecond, ""),
            (Motion::Forward, Per::Metre) if self.reverses => (Target::ForwardScale, "sign(speed) * "),
            (Motion::Forward, Per::Metre | Per::Ahead) => (Target::ForwardScale, ""),
            (Motion::Forward, Per::Radian) => (Target::ForwardPerRadian, ""),
            (Motion::Forward, Per::Turned) => (Target::ForwardPerRadian, "sign(turn_rate) * "),
            (Motion::Forward, Per::Second) => (Target::ForwardPerSecond, ""),
            (Motion::Sideways, Per::Metre) => (Target::SidewaysPerMetre, ""),
            (Motion::Sideways, Per::Ahead) => (Target::SidewaysPerMetre, "sign(speed) * "),
            (Motion::Sideways, Per::Radian) => (Target::SidewaysPerRadian, ""),
            (Motion::Sideways, Per::Turned) => (Target::SidewaysPerRadian, "sign(turn_rate) * "),
            (Motion::Sideways, Per::Second) => (Target::SidewaysPerSecond, ""),
        };
        let sense = if with_sense { "direction * " } else { "" };
        let (first, shapes) = &self.functions[about.function].formula;
        let second = about.twin.map(|twin| &self.functions[self.terms[twin].function].formula);
        let text = match second {
            Some((second, _)) if sense.is_empty() && factor.is_empty() => format!("a * {first} + b * {second}"),
            Some((second, _)) => format!("{sense}{factor}(a * {first} + b * {second})"),
            None if first == "1" => format!("a * {sense}{factor}").trim_end_matches(" * ").to_owned(),
            None => format!("a * {sense}{factor}{first}"),
        };
        let names: Vec<&str> = SIZES.into_iter().take(sizes.len()).chain(shapes.iter().map(|s| s.0)).collect();
        let values = sizes.iter().chain(by).copied();
        let rounded = values.map(|value| format!("{value:.4e}").parse().unwrap_or(value));
        let formula = Formula::new(&self.name(term, motion), target, &text, &names).ok()?;
        let mut model = Model::new(robot);
        model.add_formula(formula, &rounded.collect::<Vec<f64>>()).ok()?.free = true;
        Some(model)
    }

    /// What a term depends on, in words, with {c} for the number that it has.
    pub fn words(&self, term: usize) -> &str {
        &self.functions[self.terms[term].function].words
    }

    /// The columns of some terms for each motion in turn, in the [`steps`] of a run; a wheel has one, and nothing for the other motions.
    pub fn columns(&self, terms: &[usize], run: &ObservedRun, steps: &[TrackStep]) -> Vec<Column> {
        let shapes: Vec<Vec<f64>> = terms.iter().map(|term| self.shapes(*term)).collect();
        let shaped: Vec<(usize, &[f64])> = terms.iter().copied().zip(shapes.iter().map(Vec::as_slice)).collect();
        self.shaped_columns(&shaped, run, steps)
    }

    /// The same of terms with the numbers that shape each.
    pub fn shaped_columns(&self, terms: &[(usize, &[f64])], run: &ObservedRun, steps: &[TrackStep]) -> Vec<Column> {
        let own_terms: Vec<(Term, &[f64])> = terms.iter().map(|(term, by)| (self.terms[*term], *by)).collect();
        let mut sums: [Vec<f64>; 5] = std::array::from_fn(|_| vec![0.0; own_terms.len()]);
        let mut columns = vec![vec![[0.0; 3]; run.blocks.len()]; 3 * own_terms.len()];
        let mut values = vec![0.0; own_terms.len()];
        let mut next = 0;
        for (block, about) in run.blocks.iter().enumerate() {
            while let Some(step) = steps.get(next).filter(|step| step.block == block) {
                let mut last: (usize, &[f64], f64) = (usize::MAX, &[], 0.0);
                for (value, (term, by)) in values.iter_mut().zip(&own_terms) {
                    if last.0 != term.function || last.1 != *by {
                        last = (term.function, by, (self.functions[term.function].value)(step, by));
                    }
                    *value = last.2 * term.per.of(step, self.wheelbase);
                }
                let (sine, cosine) = libm::sincos(step.middle.heading);
                for (sum, by) in sums.iter_mut().zip([cosine, sine, step.middle.x, step.middle.y, 1.0]) {
                    sum.iter_mut().zip(&values).for_each(|(sum, value)| *sum += by * value);
                }
                next += 1;
            }
            for (term, own) in columns.chunks_exact_mut(Motion::ALL.len()).enumerate() {
                let [cosine, sine, x, y, one] = sums.each_ref().map(|sum| sum[term]);
                own[0][block] = [cosine, sine, 0.0];
                own[1][block] = [-sine, cosine, 0.0];
                own[2][block] = [y - about.place.y * one, about.place.x * one - x, one];
                // A wheel that rolls further moves the middle of the axle by half of that, and turns the robot away from itself.
                let turns = match own_terms[term].0.per {
                    Per::LeftWheel => -1.0 / self.wheelbase,
                    Per::RightWheel => 1.0 / self.wheelbase,
                    _ => continue,
                };
                own[0][block] = std::array::from_fn(|k| 0.5 * own[0][block][k] + turns * own[2][block][k]);
                (own[1][block], own[2][block]) = ([0.0; 3], [0.0; 3]);
            }
        }
        columns
    }
}
