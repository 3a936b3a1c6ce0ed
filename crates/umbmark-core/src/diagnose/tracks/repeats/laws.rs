//! The laws that are asked about: functions of how and where the robot drives, for each second, metre or radian.

use super::super::smooth::Motion;
use super::{SHAPE, SIZES};
use crate::drive::Robot;
use crate::effect::{Chain, Formula, Model, Target};
use crate::geometry::{Displacement2, Pose2};
use crate::likelihood::{Column, ObservedRun};
use std::f64::consts::TAU;

/// What a law is in proportion to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Time, driving or not.
    Second,
    /// Way driven, ahead or back.
    Metre,
    /// Way ahead, and back against it.
    Ahead,
    /// Rotation, either way.
    Radian,
}

impl Per {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Per::Second => "second",
            Per::Metre => "metre",
            Per::Ahead => "metre ahead or back, against each other",
            Per::Radian => "radian turned",
        }
    }

    fn of(self, step: &Step) -> f64 {
        match self {
            Per::Second => step.duration,
            Per::Metre => step.way,
            Per::Ahead => step.way * step.speed.signum(),
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

/// A step ends after so much way \[m\], rotation \[rad\] or time \[s\].
const STEP: (f64, f64, f64) = (0.02, 0.05, 0.1);
/// Wheels roll alike where they differ by less than this share.
const ALIKE: f64 = 0.05;

/// The steps of a run along a model.
pub fn steps(run: &ObservedRun, chain: &Chain<f64>) -> Vec<Step> {
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
    /// What it is: "a wave of the time with a period of {c} s".
    words: String,
    /// The same as a formula.
    formula: Written,
    /// Of a step and of the numbers that shape it, in the order of the formula's.
    value: Box<Value>,
}

/// A number for a step and the numbers that shape a function.
type Value = dyn Fn(&Step, &[f64]) -> f64 + Send + Sync;

/// A formula of the user's own, and the parameters that shape it, with start values.
type Written = (String, Vec<(&'static str, f64)>);

/// A formula without a parameter.
fn written(text: impl Into<String>) -> Written {
    (text.into(), Vec::new())
}

/// A formula of a parameter c.
fn shaped(text: &str, c: f64) -> Written {
    (text.to_owned(), vec![(SHAPE, c)])
}

/// What is above c counts, what is below does not, and about c it passes from the one to the other: a place where it jumps could not be fitted.
fn above(quantity: &str) -> String {
    format!("(1 + tanh(20 * ({quantity} / c - 1))) / 2")
}

/// The same as a number.
fn beyond(quantity: f64, c: f64) -> f64 {
    0.5 * (1.0 + libm::tanh(20.0 * (quantity / c - 1.0)))
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

/// Periods from the least to the largest \[s\] and \[m\].
const TIMES: (f64, f64) = (1.5, 80.0);
const WAYS: (f64, f64) = (0.25, 30.0);
/// Waves one after the other go out of step by half a cycle over a run: a wave between two of them is nearly one of them. So many of these,
/// from the longest; beyond, each period is shorter by this factor.
const PERIODS: usize = 96;
const SHORTER: f64 = 1.1;
/// Decays over so much time \[s\], and way since a turn or from a wall \[m\].
const DECAYS: [f64; 7] = [3.0, 6.0, 12.0, 20.0, 35.0, 60.0, 100.0];
const NEAR: [f64; 5] = [0.1, 0.2, 0.35, 0.6, 1.0];
/// Sizes of what a robot does, as shares of the largest.
const SHARES: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Runs drive back where more than this share of the way is back.
const BACK: f64 = 0.02;
/// Humps on the floor are so far apart at least \[m\], and so many at most.
const HUMPS: (f64, usize) = (0.5, 80);

/// All laws that some runs may follow.
pub struct Laws {
    functions: Vec<Function>,
    /// Whether some runs drive back.
    reverses: bool,
    /// Each with three motions.
    pub terms: Vec<Term>,
}

/// The periods to ask about where runs last so long, or go so far.
fn periods((low, high): (f64, f64), extent: f64) -> Vec<f64> {
    let longest = high.min(extent);
    let mut periods: Vec<f64> = (0..PERIODS).map(|k| 1.0 / (1.0 / longest + k as f64 / (2.0 * extent))).collect();
    while let Some(last) = periods.last().filter(|last| **last > low) {
        periods.push(last / SHORTER);
    }
    periods.retain(|period| *period >= low);
    periods
}

/// The extent of what runs do.
struct Extent {
    /// Way in all runs, and how much of it back.
    way: f64,
    back: f64,
    time: f64,
    distance: f64,
    speed: f64,
    turn_rate: f64,
    acceleration: f64,
    turn_acceleration: f64,
    low: [f64; 2],
    high: [f64; 2],
    /// How far the runs reach against each of eight [directions](direction) \[m\].
    edges: [f64; 8],
}

/// How far along a direction in the room a step is \[m\].
fn along(step: &Step, direction: f64) -> f64 {
    let (sine, cosine) = libm::sincos(direction);
    step.middle.x * cosine + step.middle.y * sine
}

/// A number taken off, as a formula has it.
fn less(number: f64) -> String {
    if number < 0.0 { format!("+ {:.3}", -number) } else { format!("- {number:.3}") }
}

/// One of eight directions in the room \[rad\].
fn direction(k: usize) -> f64 {
    TAU * k as f64 / 8.0
}

impl Extent {
    fn of(steps: &[Vec<Step>]) -> Extent {
        let most = |of: fn(&Step) -> f64| steps.iter().flatten().map(of).fold(1e-9, f64::max);
        let least = |of: fn(&Step) -> f64| steps.iter().flatten().map(of).fold(0.0, f64::min);
        let sum = |of: fn(&Step) -> f64| steps.iter().flatten().map(of).sum::<f64>();
        Extent {
            way: sum(|s| s.way),
            back: sum(|s| if s.speed < 0.0 { s.way } else { 0.0 }),
            time: most(|s| s.time),
            distance: most(|s| s.distance),
            speed: most(|s| s.speed.abs()),
            turn_rate: most(|s| s.turn_rate.abs()),
            acceleration: most(|s| s.acceleration.abs()),
            turn_acceleration: most(|s| s.turn_acceleration.abs()),
            edges: std::array::from_fn(|k| {
                steps.iter().flatten().map(|s| along(s, direction(k))).fold(f64::INFINITY, f64::min)
            }),
            low: [least(|s| s.middle.x), least(|s| s.middle.y)],
            high: [most(|s| s.middle.x), most(|s| s.middle.y)],
        }
    }
}

impl Laws {
    /// Those of the steps of some runs.
    pub fn of(steps: &[Vec<Step>]) -> Laws {
        let extent = Extent::of(steps);
        let mut laws = Laws { functions: Vec::new(), reverses: extent.back > BACK * extent.way, terms: Vec::new() };
        laws.fill(&extent);
        if laws.reverses {
            laws.add_ahead();
        }
        laws
    }

    /// For each law per metre driven, the same per metre ahead.
    fn add_ahead(&mut self) {
        let own: Vec<usize> = (0..self.terms.len()).filter(|term| self.terms[*term].per == Per::Metre).collect();
        let first = self.terms.len();
        let place = |term: usize| own.iter().position(|other| *other == term).map(|place| first + place);
        let ahead: Vec<Term> = own
            .iter()
            .map(|term| Term { per: Per::Ahead, twin: self.terms[*term].twin.and_then(place), ..self.terms[*term] })
            .collect();
        self.terms.extend(ahead);
    }

    fn add(
        &mut self,
        words: String,
        formula: Written,
        per: &[Per],
        value: impl Fn(&Step) -> f64 + Send + Sync + 'static,
    ) {
        self.add_shaped(words, formula, per, move |step, _| value(step));
    }

    /// The same of a function with numbers that shape it.
    fn add_shaped(
        &mut self,
        words: String,
        formula: Written,
        per: &[Per],
        value: impl Fn(&Step, &[f64]) -> f64 + Send + Sync + 'static,
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
        angle: impl Fn(&Step, &[f64]) -> f64 + Copy + Send + Sync + 'static,
    ) {
        let first = self.terms.len();
        let shapes: Vec<_> = value.map(|c| (SHAPE, c)).into_iter().collect();
        let formula = |wave: &str| (format!("{size_text}{wave}({angle_text})"), shapes.clone());
        self.add_shaped(words.clone(), formula("cos"), per, move |s, by| size(s) * libm::cos(angle(s, by)));
        self.add_shaped(words, formula("sin"), per, move |s, by| size(s) * libm::sin(angle(s, by)));
        self.join(first, per.len());
    }

    fn fill(&mut self, extent: &Extent) {
        use Per::{Metre, Radian, Second};
        self.add("a constant".into(), written("1"), &[Second, Metre, Radian], |_| 1.0);
        for period in periods(TIMES, extent.time) {
            let words = "a wave of the time with a period of {c} s".to_owned();
            let about = ("", "2 * pi * time / c", Some(period));
            self.wave(words, about, &[Second, Metre], |_| 1.0, |s, by| TAU * s.time / by[0]);
        }
        for period in periods(WAYS, extent.distance) {
            let words = "a wave of the way with a period of {c} m".to_owned();
            let about = ("", "2 * pi * distance / c", Some(period));
            self.wave(words, about, &[Metre], |_| 1.0, |s, by| TAU * s.distance / by[0]);
        }
        for c in DECAYS {
            self.add_shaped(
                "what dies away within {c} s of the start".into(),
                shaped("exp(-time / c)", c),
                &[Second, Metre],
                |s, by| libm::exp(-s.time / by[0]),
            );
        }
        self.add("the time in the run".into(), written("time"), &[Second, Metre], |s| s.time);
        self.add("the square of the time in the run".into(), written("time^2"), &[Second, Metre], |s| s.time * s.time);
        for n in 1..=4 {
            let times = if n == 1 { String::new() } else { format!("{n} times ") };
            let angle = |of: &str| if n == 1 { of.to_owned() } else { format!("{n} * {of}") };
            let n = f64::from(n);
            let words = format!("a wave of {times}the heading");
            let about = angle("heading");
            self.wave(words, ("", &about, None), &[Second, Metre, Radian], |_| 1.0, move |s, _| n * s.middle.heading);
            for (wheel, name) in ["left", "right"].into_iter().enumerate() {
                let words = format!("a wave of {times}the angle of the {name} wheel");
                let about = angle(&format!("wheel_angle_{name}"));
                self.wave(words, ("", &about, None), &[Metre], |_| 1.0, move |s, _| n * s.wheel_angle[wheel]);
            }
            if n < 3.0 {
                let words = format!("the speed times a wave of {times}the heading");
                let about = ("abs(speed) * ", &*about, None);
                self.wave(words, about, &[Metre], |s| s.speed.abs(), move |s, _| n * s.middle.heading);
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
            self.add_shaped("a speed above {c} m/s".into(), shaped(&above("abs(speed)"), v), &[Metre], |s, by| {
                beyond(s.speed.abs(), by[0])
            });
            self.add_shaped(
                "the speed beyond {c} m/s".into(),
                shaped("max(abs(speed) - c, 0)", v),
                &[Metre],
                |s, by| (s.speed.abs() - by[0]).max(0.0),
            );
            self.add_shaped("tanh(speed / {c} m/s)".into(), shaped("tanh(abs(speed) / c)", v), &[Metre], |s, by| {
                libm::tanh(s.speed.abs() / by[0])
            });
            let w = share * quickest;
            self.add_shaped(
                "a turn rate above {c} rad/s".into(),
                shaped(&above("abs(turn_rate)"), w),
                &[Radian],
                |s, by| beyond(s.turn_rate.abs(), by[0]),
            );
            self.add_shaped(
                "a turn rate above {c} rad/s, with its sense".into(),
                shaped(&format!("sign(turn_rate) * {}", above("abs(turn_rate)")), w),
                &[Radian],
                |s, by| s.turn_rate.signum() * beyond(s.turn_rate.abs(), by[0]),
            );
            self.add_shaped(
                "tanh(turn rate / {c} rad/s)".into(),
                shaped("tanh(turn_rate / c)", w),
                &[Second],
                |s, by| libm::tanh(s.turn_rate / by[0]),
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
        self.add_shaped(
            "braking by more than {c} m/s²".into(),
            shaped(&above("-acceleration * sign(speed)"), sharp),
            &[Second, Metre],
            |s, by| beyond(-s.acceleration * s.speed.signum(), by[0]),
        );
        self.add_shaped(
            "speeding up by more than {c} m/s²".into(),
            shaped(&above("acceleration * sign(speed)"), sharp),
            &[Second, Metre],
            |s, by| beyond(s.acceleration * s.speed.signum(), by[0]),
        );
        let sharp = 0.25 * extent.turn_acceleration;
        self.add("the change of the turn rate".into(), written("turn_acceleration"), &[Second], |s| {
            s.turn_acceleration
        });
        self.add("the size of the change of the turn rate".into(), written("abs(turn_acceleration)"), &[Second], |s| {
            s.turn_acceleration.abs()
        });
        self.add_shaped(
            "turns that grow by more than {c} rad/s², with their sense".into(),
            shaped(&format!("sign(turn_rate) * {}", above("turn_acceleration * sign(turn_rate)")), sharp),
            &[Second],
            |s, by| s.turn_rate.signum() * beyond(s.turn_acceleration * s.turn_rate.signum(), by[0]),
        );
        self.add_shaped(
            "turns that end by more than {c} rad/s², with their sense".into(),
            shaped(&format!("sign(turn_rate) * {}", above("-turn_acceleration * sign(turn_rate)")), sharp),
            &[Second],
            |s, by| s.turn_rate.signum() * beyond(-s.turn_acceleration * s.turn_rate.signum(), by[0]),
        );
        self.add("the sense of the last turn".into(), written("last_turn"), &[Metre], |s| s.last_turn);
        for c in NEAR {
            self.add_shaped(
                "what dies away within {c} m of a turn".into(),
                shaped("exp(-since_turn / c)", c),
                &[Metre],
                |s, by| libm::exp(-s.since_turn / by[0]),
            );
            self.add_shaped(
                "what dies away within {c} m of a turn, with its sense".into(),
                shaped("last_turn * exp(-since_turn / c)", c),
                &[Metre],
                |s, by| s.last_turn * libm::exp(-s.since_turn / by[0]),
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
        self.pair("the place in the room, along a line", ["x", "y"], &[Metre, Second], |s| [s.middle.x, s.middle.y]);
        for k in 0..4 {
            let (from, to) = (extent.edges[k], -extent.edges[k + 4]);
            for d in [from, 0.5 * (from + to), to] {
                self.add_shaped(
                    "the square of the distance from a line in the room".into(),
                    ("(x * cos(h) + y * sin(h) - d)^2".to_owned(), vec![("d", d), ("h", direction(k))]),
                    &[Metre],
                    |s, by| (along(s, by[1]) - by[0]).powi(2),
                );
            }
        }
        for (k, edge) in extent.edges.iter().copied().enumerate() {
            let towards = direction(k);
            for c in NEAR {
                self.add_shaped(
                    format!(
                        "what dies away within {{c}} m of the edge of the room at {:.0} deg",
                        towards.to_degrees() - 180.0
                    ),
                    (format!("exp(-(x * cos(h) + y * sin(h) {}) / c)", less(edge)), vec![("c", c), ("h", towards)]),
                    &[Metre],
                    move |s, by| libm::exp(-(along(s, by[1]) - edge) / by[0]),
                );
            }
        }
        let apart = HUMPS.0.max((wide * deep / HUMPS.1 as f64).sqrt()).max(wide.max(deep) / HUMPS.1 as f64);
        let grid = |from: f64, length: f64| {
            let count = (length / apart).floor() as usize;
            let margin = 0.5 * (length - count as f64 * apart);
            (0..=count).map(move |k| from + margin + k as f64 * apart)
        };
        for x in grid(x0, wide) {
            for y in grid(y0, deep) {
                self.add_shaped(
                    "a place on the floor near ({p}, {q}) m, {c} m wide".to_owned(),
                    (
                        "exp(-((x - p)^2 + (y - q)^2) / (2 * c^2))".to_owned(),
                        vec![("c", 0.6 * apart), ("p", x), ("q", y)],
                    ),
                    &[Metre],
                    |s, by| {
                        let square = (s.middle.x - by[1]).powi(2) + (s.middle.y - by[2]).powi(2);
                        libm::exp(-0.5 * square / (by[0] * by[0]))
                    },
                );
            }
        }
    }

    /// Two functions that go together, with their formulas.
    fn pair(
        &mut self,
        words: &str,
        formulas: [&str; 2],
        per: &[Per],
        values: impl Fn(&Step) -> [f64; 2] + Copy + Send + Sync + 'static,
    ) {
        let first = self.terms.len();
        for (k, formula) in formulas.into_iter().enumerate() {
            self.add(words.to_owned(), written(formula), per, move |s| values(s)[k]);
        }
        self.join(first, per.len());
    }

    /// Makes twins of so many terms and as many behind them.
    fn join(&mut self, first: usize, count: usize) {
        for k in 0..count {
            self.terms[first + k].twin = Some(first + count + k);
            self.terms[first + count + k].twin = Some(first + k);
        }
    }

    /// The name that a term has as an effect: "periodic_yaw", "forward_by_speed".
    fn name(&self, term: usize, motion: Motion) -> String {
        let text = &self.functions[self.terms[term].function].formula.0;
        let words: Vec<&str> = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect();
        let known = |word: &&str| Formula::variables().iter().any(|variable| variable.name == *word);
        let by = words.into_iter().find(known);
        let motion = motion.name();
        match by {
            Some("time" | "distance") if text.contains("pi") => format!("periodic_{motion}"),
            Some("x" | "y") => format!("{motion}_by_place"),
            Some(variable) => format!("{motion}_by_{variable}"),
            None => format!("steady_{motion}"),
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

    /// The numbers that shape a term, as it was asked about.
    pub fn shapes(&self, term: usize) -> Vec<f64> {
        self.functions[self.terms[term].function].formula.1.iter().map(|shape| shape.1).collect()
    }

    /// Which of these numbers are lengths, times or thresholds, and no places or directions.
    pub fn scales(&self, term: usize) -> Vec<bool> {
        self.functions[self.terms[term].function].formula.1.iter().map(|shape| shape.0 == SHAPE).collect()
    }

    /// The most that these numbers may be: no wave is longer than the longest that is asked about, which is as long as a run.
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
            (Motion::Yaw, Per::Metre) => (Target::HeadingPerMetre, ""),
            (Motion::Yaw, Per::Ahead) => (Target::HeadingPerMetre, "sign(speed) * "),
            (Motion::Yaw, Per::Radian) => (Target::TurnScale, "sign(turn_rate) * "),
            (Motion::Yaw, Per::Second) => (Target::HeadingPerSecond, ""),
            (Motion::Forward, Per::Metre) if self.reverses => (Target::ForwardScale, "sign(speed) * "),
            (Motion::Forward, Per::Metre | Per::Ahead) => (Target::ForwardScale, ""),
            (Motion::Forward, Per::Radian) => (Target::ForwardPerRadian, ""),
            (Motion::Forward, Per::Second) => (Target::ForwardPerSecond, ""),
            (Motion::Sideways, Per::Metre) => (Target::SidewaysPerMetre, ""),
            (Motion::Sideways, Per::Ahead) => (Target::SidewaysPerMetre, "sign(speed) * "),
            (Motion::Sideways, Per::Radian) => (Target::SidewaysPerRadian, ""),
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

    /// The columns of some terms for each motion in turn, in the [`steps`] of a run.
    pub fn columns(&self, terms: &[usize], run: &ObservedRun, steps: &[Step]) -> Vec<Column> {
        let shapes: Vec<Vec<f64>> = terms.iter().map(|term| self.shapes(*term)).collect();
        let shaped: Vec<(usize, &[f64])> = terms.iter().copied().zip(shapes.iter().map(Vec::as_slice)).collect();
        self.shaped_columns(&shaped, run, steps)
    }

    /// The same of terms with the numbers that shape each.
    pub fn shaped_columns(&self, terms: &[(usize, &[f64])], run: &ObservedRun, steps: &[Step]) -> Vec<Column> {
        let own: Vec<(Term, &[f64])> = terms.iter().map(|(term, by)| (self.terms[*term], *by)).collect();
        let mut sums: [Vec<f64>; 5] = std::array::from_fn(|_| vec![0.0; own.len()]);
        let mut columns = vec![vec![[0.0; 3]; run.blocks.len()]; 3 * own.len()];
        let mut values = vec![0.0; own.len()];
        let mut next = 0;
        for (block, about) in run.blocks.iter().enumerate() {
            while let Some(step) = steps.get(next).filter(|step| step.block == block) {
                let mut last: (usize, &[f64], f64) = (usize::MAX, &[], 0.0);
                for (value, (term, by)) in values.iter_mut().zip(&own) {
                    if last.0 != term.function || last.1 != *by {
                        last = (term.function, by, (self.functions[term.function].value)(step, by));
                    }
                    *value = last.2 * term.per.of(step);
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
