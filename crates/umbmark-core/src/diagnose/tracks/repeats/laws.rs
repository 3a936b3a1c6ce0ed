//! The laws that are asked about: functions of how and where the robot drives, for each second, metre or radian.

use super::super::smooth::Motion;
use crate::drive::Robot;
use crate::effect::{Chain, Formula, Model, Target};
use crate::geometry::{Displacement2, Pose2};
use crate::likelihood::{Column, Observed, ObservedRun};
use std::f64::consts::TAU;

/// What a law is in proportion to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Time, driving or not.
    Second,
    /// Way driven, ahead or back.
    Metre,
    /// Rotation, either way.
    Radian,
}

impl Per {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Per::Second => "second",
            Per::Metre => "metre",
            Per::Radian => "radian turned",
        }
    }

    fn of(self, step: &Step) -> f64 {
        match self {
            Per::Second => step.duration,
            Per::Metre => step.way,
            Per::Radian => step.rotation.abs(),
        }
    }
}

/// A short part of a run, with means over it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Step {
    /// The block that it belongs to.
    block: usize,
    /// Where the robot is in the middle of it, and how it stands.
    middle: Pose2,
    /// \[s\]
    duration: f64,
    /// Way driven, ahead or back \[m\].
    way: f64,
    /// \[rad\]; nothing where both wheels roll nearly alike: what is left then is made of single counts.
    rotation: f64,
    /// Since the run began \[s\] and \[m\], in its middle.
    time: f64,
    distance: f64,
    /// \[m/s\], ahead positive.
    speed: f64,
    /// \[rad/s\]; nothing where both wheels roll nearly alike.
    turn_rate: f64,
    /// \[m/s²\] and \[rad/s²\]
    acceleration: f64,
    turn_acceleration: f64,
    /// Of the left and the right wheel \[rad\].
    wheel_angle: [f64; 2],
    /// Way since the last turn \[m\], and its sense.
    since_turn: f64,
    last_turn: f64,
}

/// The name that a law has as an effect.
const NAME: &str = "unlisted";
/// A step ends after so much way \[m\], rotation \[rad\] or time \[s\].
const STEP: (f64, f64, f64) = (0.02, 0.05, 0.1);
/// Wheels roll alike where they differ by less than this share.
const ALIKE: f64 = 0.05;

/// The steps of a run.
fn steps(run: &ObservedRun, chain: &Chain<f64>) -> Vec<Step> {
    let track = &run.track;
    let (mut pose, mut made, mut steps) = (track.start(chain), 0, Vec::new());
    for (block, own) in run.blocks.iter().enumerate() {
        let until = run.made_at(own).max(made);
        let (mut step, mut wheels, mut change) = (Step::default(), [0.0; 2], [0.0; 2]);
        let mut begin = pose;
        let pieces = track.travel()[made..until].iter().zip(&track.contexts()[made..until]);
        let count = until - made;
        for (index, (travel, at)) in pieces.enumerate() {
            if step.duration == 0.0 {
                begin = pose;
                step = Step {
                    block,
                    time: at.time,
                    distance: at.distance,
                    wheel_angle: at.wheel_angle,
                    since_turn: at.since_turn,
                    last_turn: at.last_turn,
                    ..Step::default()
                };
                (wheels, change) = ([0.0; 2], [0.0; 2]);
            }
            let motion = chain.displacement(&at.at_pose(&pose), travel);
            pose = pose.moved(&motion);
            step.duration += at.duration;
            step.way += at.length.abs();
            step.speed += at.speed * at.duration;
            step.rotation += motion.rotation;
            wheels = [wheels[0] + travel.left, wheels[1] + travel.right];
            change = [change[0] + at.acceleration() * at.duration, change[1] + at.turn_acceleration() * at.duration];
            let full = step.way >= STEP.0 || step.rotation.abs() >= STEP.1 || step.duration >= STEP.2;
            if (full || index + 1 == count) && step.duration > 0.0 {
                let Step { duration, way, rotation, .. } = step;
                let between = begin.between(&pose);
                step.middle = begin.moved(&Displacement2 {
                    forward: 0.5 * between.x,
                    sideways: 0.5 * between.y,
                    rotation: 0.5 * rotation,
                });
                step.speed /= duration;
                let alike = (wheels[1] - wheels[0]).abs() < ALIKE * wheels[0].abs().max(wheels[1].abs());
                step.rotation = if alike { 0.0 } else { rotation };
                step.turn_rate = step.rotation / duration;
                (step.acceleration, step.turn_acceleration) = (change[0] / duration, change[1] / duration);
                (step.time, step.distance) = (step.time + 0.5 * duration, step.distance + 0.5 * way);
                (0..2).for_each(|wheel| {
                    step.wheel_angle[wheel] +=
                        0.5 * (at.wheel_angle[wheel] + at.wheel_rotation[wheel] - step.wheel_angle[wheel]);
                });
                step.since_turn += 0.5 * way;
                steps.push(step);
                step.duration = 0.0;
            }
        }
        made = until;
    }
    steps
}

/// A function of a step.
struct Function {
    /// What it is: "a wave of the time with a period of about 18.9 s".
    words: String,
    /// The same as a formula of the user's own, with a parameter c where it has a value; none where formulas lack what it depends on.
    formula: Option<(String, Option<f64>)>,
    value: Box<dyn Fn(&Step) -> f64 + Send + Sync>,
}

/// A formula without a parameter.
fn written(text: impl Into<String>) -> Option<(String, Option<f64>)> {
    Some((text.into(), None))
}

/// A formula of a parameter c.
fn shaped(text: &str, c: f64) -> Option<(String, Option<f64>)> {
    Some((text.to_owned(), Some(c)))
}

/// A function for each second, metre or radian.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    function: usize,
    /// What it is in proportion to.
    pub per: Per,
    /// The term that goes with it: the cosine to a sine.
    pub twin: Option<usize>,
}

/// Number of periods, from the least to the largest \[s\] and \[m\].
const PERIODS: usize = 48;
const TIMES: (f64, f64) = (1.5, 80.0);
const WAYS: (f64, f64) = (0.25, 30.0);
/// Decays over so much time \[s\], and way since a turn or from a wall \[m\].
const DECAYS: [f64; 4] = [5.0, 12.0, 30.0, 75.0];
const NEAR: [f64; 3] = [0.1, 0.3, 1.0];
/// Sizes of what a robot does, as shares of the largest.
const SHARES: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
/// Humps on the floor are so far apart at least \[m\], and so many at most.
const HUMPS: (f64, usize) = (0.5, 80);

/// All laws that some runs may follow.
pub struct Laws {
    functions: Vec<Function>,
    /// Each with three motions.
    pub terms: Vec<Term>,
}

/// The extent of what runs do.
struct Extent {
    time: f64,
    distance: f64,
    speed: f64,
    turn_rate: f64,
    acceleration: f64,
    turn_acceleration: f64,
    low: [f64; 2],
    high: [f64; 2],
}

impl Extent {
    fn of(steps: &[Step]) -> Extent {
        let most = |of: fn(&Step) -> f64| steps.iter().map(of).fold(1e-9, f64::max);
        let least = |of: fn(&Step) -> f64| steps.iter().map(of).fold(0.0, f64::min);
        Extent {
            time: most(|s| s.time),
            distance: most(|s| s.distance),
            speed: most(|s| s.speed.abs()),
            turn_rate: most(|s| s.turn_rate.abs()),
            acceleration: most(|s| s.acceleration.abs()),
            turn_acceleration: most(|s| s.turn_acceleration.abs()),
            low: [least(|s| s.middle.x), least(|s| s.middle.y)],
            high: [most(|s| s.middle.x), most(|s| s.middle.y)],
        }
    }
}

impl Laws {
    /// Those of some runs along a model.
    pub fn of(observed: &Observed, chain: &Chain<f64>) -> Laws {
        let all: Vec<Step> = observed.runs.iter().flat_map(|run| steps(run, chain)).collect();
        let mut laws = Laws { functions: Vec::new(), terms: Vec::new() };
        laws.fill(&Extent::of(&all));
        laws
    }

    fn add(
        &mut self,
        words: String,
        formula: Option<(String, Option<f64>)>,
        per: &[Per],
        value: impl Fn(&Step) -> f64 + Send + Sync + 'static,
    ) {
        let function = self.functions.len();
        self.functions.push(Function { words, formula, value: Box::new(value) });
        self.terms.extend(per.iter().map(|per| Term { function, per: *per, twin: None }));
    }

    /// A cosine and a sine of an angle, times a size; of the latter two, formulas.
    fn wave(
        &mut self,
        words: String,
        (size_text, angle_text, value): (&str, &str, Option<f64>),
        per: &[Per],
        size: impl Fn(&Step) -> f64 + Copy + Send + Sync + 'static,
        angle: impl Fn(&Step) -> f64 + Copy + Send + Sync + 'static,
    ) {
        let first = self.terms.len();
        let formula = |wave: &str| Some((format!("{size_text}{wave}({angle_text})"), value));
        self.add(words.clone(), formula("cos"), per, move |s| size(s) * libm::cos(angle(s)));
        self.add(words, formula("sin"), per, move |s| size(s) * libm::sin(angle(s)));
        for k in 0..per.len() {
            self.terms[first + k].twin = Some(first + per.len() + k);
            self.terms[first + per.len() + k].twin = Some(first + k);
        }
    }

    fn fill(&mut self, extent: &Extent) {
        use Per::{Metre, Radian, Second};
        self.add("a constant".into(), written("1"), &[Second, Metre, Radian], |_| 1.0);
        let periods = |(low, high): (f64, f64)| -> Vec<f64> {
            let ratio = (high / low).powf(1.0 / (PERIODS - 1) as f64);
            (0..PERIODS).map(|k| low * ratio.powi(k as i32)).collect()
        };
        for period in periods(TIMES).into_iter().filter(|period| *period < 1.5 * extent.time) {
            let words = format!("a wave of the time with a period of about {period:.1} s");
            let about = ("", "2 * pi * time / c", Some(period));
            self.wave(words, about, &[Second, Metre], |_| 1.0, move |s| TAU * s.time / period);
        }
        for period in periods(WAYS).into_iter().filter(|period| *period < 1.5 * extent.distance) {
            let words = format!("a wave of the way with a period of about {period:.2} m");
            let about = ("", "2 * pi * distance / c", Some(period));
            self.wave(words, about, &[Metre], |_| 1.0, move |s| TAU * s.distance / period);
        }
        for c in DECAYS {
            self.add(
                format!("what dies away within {c} s of the start"),
                shaped("exp(-time / c)", c),
                &[Second, Metre],
                move |s| libm::exp(-s.time / c),
            );
        }
        self.add("the time in the run".into(), written("time"), &[Second, Metre], |s| s.time);
        self.add("the square of the time in the run".into(), written("time^2"), &[Second, Metre], |s| s.time * s.time);
        for n in 1..=4 {
            let times = if n == 1 { String::new() } else { format!("{n} times ") };
            let angle = |of: &str| format!("{n} * {of}");
            let n = f64::from(n);
            let words = format!("a wave of {times}the heading");
            let about = angle("heading");
            self.wave(words, ("", &about, None), &[Second, Metre, Radian], |_| 1.0, move |s| n * s.middle.heading);
            for (wheel, name) in ["left", "right"].into_iter().enumerate() {
                let words = format!("a wave of {times}the angle of the {name} wheel");
                let about = angle(&format!("wheel_angle_{name}"));
                self.wave(words, ("", &about, None), &[Metre], |_| 1.0, move |s| n * s.wheel_angle[wheel]);
            }
            if n < 3.0 {
                let words = format!("the speed times a wave of {times}the heading");
                let about = ("abs(speed) * ", &*about, None);
                self.wave(words, about, &[Metre], |s| s.speed.abs(), move |s| n * s.middle.heading);
            }
        }
        self.of_motion(extent);
        self.of_place(extent);
    }

    fn of_motion(&mut self, extent: &Extent) {
        use Per::{Metre, Radian, Second};
        let (fastest, quickest) = (extent.speed, extent.turn_rate);
        self.add("the speed".into(), written("abs(speed)"), &[Metre], |s| s.speed.abs());
        self.add("the sense of driving".into(), written("sign(speed)"), &[Metre, Second], |s| s.speed.signum());
        self.add("the square of the speed".into(), written("speed^2"), &[Metre], |s| s.speed * s.speed);
        self.add("the root of the speed".into(), written("sqrt(abs(speed))"), &[Metre], |s| s.speed.abs().sqrt());
        for share in SHARES {
            let v = share * fastest;
            self.add(
                format!("a speed above {v:.2} m/s"),
                written(format!("(1 + sign(abs(speed) - {v:.4})) / 2")),
                &[Metre],
                move |s| f64::from(s.speed.abs() > v),
            );
            self.add(format!("the speed beyond {v:.2} m/s"), shaped("max(abs(speed) - c, 0)", v), &[Metre], move |s| {
                (s.speed.abs() - v).max(0.0)
            });
            self.add(format!("tanh(speed / {v:.2} m/s)"), shaped("tanh(abs(speed) / c)", v), &[Metre], move |s| {
                libm::tanh(s.speed.abs() / v)
            });
            let w = share * quickest;
            self.add(
                format!("a turn rate above {w:.2} rad/s"),
                written(format!("(1 + sign(abs(turn_rate) - {w:.4})) / 2")),
                &[Radian],
                move |s| f64::from(s.turn_rate.abs() > w),
            );
            self.add(
                format!("a turn rate above {w:.2} rad/s, with its sense"),
                written(format!("sign(turn_rate) * (1 + sign(abs(turn_rate) - {w:.4})) / 2")),
                &[Radian],
                move |s| s.turn_rate.signum() * f64::from(s.turn_rate.abs() > w),
            );
            self.add(
                format!("tanh(turn rate / {w:.2} rad/s)"),
                shaped("tanh(turn_rate / c)", w),
                &[Second],
                move |s| libm::tanh(s.turn_rate / w),
            );
        }
        self.add("the sense of the turn".into(), written("sign(turn_rate)"), &[Radian], |s| s.turn_rate.signum());
        self.add("the turn rate".into(), written("turn_rate"), &[Radian], |s| s.turn_rate);
        self.add("the size of the turn rate".into(), written("abs(turn_rate)"), &[Radian], |s| s.turn_rate.abs());
        self.add("the square of the turn rate".into(), written("turn_rate^2"), &[Radian], |s| {
            s.turn_rate * s.turn_rate
        });
        self.add("the turn rate times its size".into(), written("turn_rate * abs(turn_rate)"), &[Radian], |s| {
            s.turn_rate * s.turn_rate.abs()
        });
        self.add("the speed times the turn rate".into(), written("speed * turn_rate"), &[Second], |s| {
            s.speed * s.turn_rate
        });
        self.add(
            "the speed times the size of the turn rate".into(),
            written("speed * abs(turn_rate)"),
            &[Second],
            |s| s.speed * s.turn_rate.abs(),
        );
        let sharp = 0.25 * extent.acceleration;
        self.add("the acceleration".into(), written("acceleration"), &[Second, Metre], |s| s.acceleration);
        self.add("the size of the acceleration".into(), written("abs(acceleration)"), &[Second, Metre], |s| {
            s.acceleration.abs()
        });
        self.add(
            format!("braking by more than {sharp:.2} m/s²"),
            written(format!("(1 + sign(-acceleration * sign(speed) - {sharp:.4})) / 2")),
            &[Second, Metre],
            move |s| f64::from(s.acceleration * s.speed.signum() < -sharp),
        );
        self.add(
            format!("speeding up by more than {sharp:.2} m/s²"),
            written(format!("(1 + sign(acceleration * sign(speed) - {sharp:.4})) / 2")),
            &[Second, Metre],
            move |s| f64::from(s.acceleration * s.speed.signum() > sharp),
        );
        let sharp = 0.25 * extent.turn_acceleration;
        self.add("the change of the turn rate".into(), written("turn_acceleration"), &[Second], |s| {
            s.turn_acceleration
        });
        self.add("the size of the change of the turn rate".into(), written("abs(turn_acceleration)"), &[Second], |s| {
            s.turn_acceleration.abs()
        });
        self.add(
            format!("turns that grow by more than {sharp:.2} rad/s², with their sense"),
            written(format!("sign(turn_rate) * (1 + sign(turn_acceleration * sign(turn_rate) - {sharp:.4})) / 2")),
            &[Second],
            move |s| {
                let grows = s.turn_acceleration * s.turn_rate.signum() > sharp;
                s.turn_rate.signum() * f64::from(grows)
            },
        );
        self.add(
            format!("turns that end by more than {sharp:.2} rad/s², with their sense"),
            written(format!("sign(turn_rate) * (1 + sign(-turn_acceleration * sign(turn_rate) - {sharp:.4})) / 2")),
            &[Second],
            move |s| {
                let ends = s.turn_acceleration * s.turn_rate.signum() < -sharp;
                s.turn_rate.signum() * f64::from(ends)
            },
        );
        self.add("the sense of the last turn".into(), written("last_turn"), &[Metre], |s| s.last_turn);
        for c in NEAR {
            self.add(
                format!("what dies away within {c} m of a turn"),
                shaped("exp(-since_turn / c)", c),
                &[Metre],
                move |s| libm::exp(-s.since_turn / c),
            );
            self.add(
                format!("what dies away within {c} m of a turn, with its sense"),
                shaped("last_turn * exp(-since_turn / c)", c),
                &[Metre],
                move |s| s.last_turn * libm::exp(-s.since_turn / c),
            );
        }
    }

    fn of_place(&mut self, extent: &Extent) {
        use Per::{Metre, Second};
        let ([x0, y0], [x1, y1]) = (extent.low, extent.high);
        let (wide, deep) = (x1 - x0, y1 - y0);
        if wide.max(deep) < HUMPS.0 {
            return;
        }
        self.add("x in the room".into(), None, &[Metre, Second], |s| s.middle.x);
        self.add("y in the room".into(), None, &[Metre, Second], |s| s.middle.y);
        self.add("the square of x in the room".into(), None, &[Metre], |s| s.middle.x * s.middle.x);
        self.add("the square of y in the room".into(), None, &[Metre], |s| s.middle.y * s.middle.y);
        self.add("x times y in the room".into(), None, &[Metre], |s| s.middle.x * s.middle.y);
        for c in NEAR {
            let words = |wall: &str| format!("what dies away within {c} m of the {wall}");
            self.add(words("least x"), None, &[Metre], move |s| libm::exp(-(s.middle.x - x0) / c));
            self.add(words("greatest x"), None, &[Metre], move |s| libm::exp(-(x1 - s.middle.x) / c));
            self.add(words("least y"), None, &[Metre], move |s| libm::exp(-(s.middle.y - y0) / c));
            self.add(words("greatest y"), None, &[Metre], move |s| libm::exp(-(y1 - s.middle.y) / c));
        }
        let apart = HUMPS.0.max((wide * deep / HUMPS.1 as f64).sqrt()).max(wide.max(deep) / HUMPS.1 as f64);
        let along = |from: f64, length: f64| {
            let count = (length / apart).floor() as usize;
            let margin = 0.5 * (length - count as f64 * apart);
            (0..=count).map(move |k| from + margin + k as f64 * apart)
        };
        for x in along(x0, wide) {
            for y in along(y0, deep) {
                self.add(format!("a place on the floor near ({x:.1}, {y:.1}) m"), None, &[Metre], move |s| {
                    let square = (s.middle.x - x).powi(2) + (s.middle.y - y).powi(2);
                    libm::exp(-0.5 * square / (0.6 * apart).powi(2))
                });
            }
        }
    }

    /// A model that holds a term alone, and its twin, with these sizes: for each motion, with the sense of the run or without.
    pub fn model(&self, term: usize, sizes: &[f64], motion: Motion, with_sense: bool, robot: &Robot) -> Option<Model> {
        let about = self.terms[term];
        let (target, factor) = match (motion, about.per) {
            (Motion::Yaw, Per::Metre) => (Target::HeadingPerMetre, ""),
            (Motion::Yaw, Per::Radian) => (Target::TurnScale, "sign(turn_rate) * "),
            (Motion::Yaw, Per::Second) => (Target::HeadingPerSecond, ""),
            (Motion::Forward, Per::Metre) => (Target::ForwardScale, "sign(speed) * "),
            (Motion::Forward, Per::Radian) => (Target::ForwardPerRadian, ""),
            (Motion::Forward, Per::Second) => (Target::ForwardPerSecond, ""),
            (Motion::Sideways, Per::Metre) => (Target::SidewaysPerMetre, ""),
            (Motion::Sideways, Per::Radian) => (Target::SidewaysPerRadian, ""),
            (Motion::Sideways, Per::Second) => (Target::SidewaysPerSecond, ""),
        };
        let sense = if with_sense { "direction * " } else { "" };
        let (first, shape) = self.functions[about.function].formula.as_ref()?;
        let second = about.twin.and_then(|twin| self.functions[self.terms[twin].function].formula.as_ref());
        let text = match second {
            Some((second, _)) if sense.is_empty() && factor.is_empty() => format!("a * {first} + b * {second}"),
            Some((second, _)) => format!("{sense}{factor}(a * {first} + b * {second})"),
            None => format!("a * {sense}{factor}{first}"),
        };
        let names: Vec<&str> = ["a", "b"].into_iter().take(sizes.len()).chain(shape.map(|_| "c")).collect();
        let rounded = sizes.iter().copied().chain(*shape).map(|value| format!("{value:.4e}").parse().unwrap_or(value));
        let formula = Formula::new(NAME, target, &text, &names).ok()?;
        let mut model = Model::new(robot);
        model.add_formula(formula, &rounded.collect::<Vec<f64>>()).ok()?.free = true;
        Some(model)
    }

    /// What a term depends on, in words.
    pub fn words(&self, term: usize) -> &str {
        &self.functions[self.terms[term].function].words
    }

    /// The columns of some terms for each motion in turn, in a run.
    pub fn columns(&self, terms: &[usize], run: &ObservedRun, chain: &Chain<f64>) -> Vec<Column> {
        let own: Vec<Term> = terms.iter().map(|term| self.terms[*term]).collect();
        let mut sums: [Vec<f64>; 5] = std::array::from_fn(|_| vec![0.0; own.len()]);
        let mut columns = vec![vec![[0.0; 3]; run.blocks.len()]; 3 * own.len()];
        let mut values = vec![0.0; own.len()];
        let steps = steps(run, chain);
        let mut next = 0;
        for (block, about) in run.blocks.iter().enumerate() {
            while let Some(step) = steps.get(next).filter(|step| step.block == block) {
                let mut last = (usize::MAX, 0.0);
                for (value, term) in values.iter_mut().zip(&own) {
                    if last.0 != term.function {
                        last = (term.function, (self.functions[term.function].value)(step));
                    }
                    *value = last.1 * term.per.of(step);
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
            }
        }
        columns
    }
}
