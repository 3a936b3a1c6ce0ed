//! The families of laws: waves and decays of time and way, functions of the motion, and places in the room.

use super::extent::{Extent, along, direction};
use super::laws::{Function, Laws, SHAPE, Term, Written};
use super::steps::{Per, TrackStep};
use std::f64::consts::TAU;

/// Periods from the least to the largest \[s\] and \[m\].
const TIMES: (f64, f64) = (1.5, 80.0);
const WAYS: (f64, f64) = (0.25, 30.0);
/// Neighbouring waves differ by half a cycle over a run, so that a wave between two of them is nearly one of them. This many from the
/// longest; beyond, each period is shorter by this factor.
const PERIODS: usize = 96;
const SHORTER: f64 = 1.1;
/// Decays over so much time \[s\], and way since a turn or from a wall \[m\].
const DECAYS: [f64; 7] = [3.0, 6.0, 12.0, 20.0, 35.0, 60.0, 100.0];
const NEAR: [f64; 5] = [0.1, 0.2, 0.35, 0.6, 1.0];
/// Sizes of what a robot does, as shares of the largest.
const SHARES: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Where one floor may end and another begin, as shares of the room's extent along a direction; half of the width of the border \[m\].
const BORDERS: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
const BORDER: f64 = 0.05;
/// Minimum distance between humps on the floor \[m\], and their maximum number.
const HUMPS: (f64, usize) = (0.5, 80);

/// A formula without a parameter.
fn written(text: impl Into<String>) -> Written {
    (text.into(), Vec::new())
}

/// A formula of a parameter c.
fn shaped(text: &str, c: f64) -> Written {
    (text.to_owned(), vec![(SHAPE, c)])
}

/// A smooth step: values above c count, values below do not. A sharp step could not be fitted.
fn above(quantity: &str) -> String {
    format!("(1 + tanh(20 * ({quantity} / c - 1))) / 2")
}

/// The same as a number.
fn beyond(quantity: f64, c: f64) -> f64 {
    0.5 * (1.0 + libm::tanh(20.0 * (quantity / c - 1.0)))
}

/// A number taken off, as a formula has it.
fn less(number: f64) -> String {
    if number < 0.0 { format!("+ {:.3}", -number) } else { format!("- {number:.3}") }
}

/// The periods to test for runs of a given duration or distance.
fn periods((low, high): (f64, f64), extent: f64) -> Vec<f64> {
    let longest = high.min(extent);
    let mut periods: Vec<f64> = (0..PERIODS).map(|k| 1.0 / (1.0 / longest + k as f64 / (2.0 * extent))).collect();
    while let Some(last) = periods.last().filter(|last| **last > low) {
        periods.push(last / SHORTER);
    }
    periods.retain(|period| *period >= low);
    periods
}

impl Laws {
    /// Adds every law that runs of this extent could show.
    pub fn fill(&mut self, extent: &Extent) {
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
        self.add("the time in the run".into(), written("time"), &[Second, Metre, Radian], |s| s.time);
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
                "tanh(turn rate / {c} rad/s)".into(),
                shaped("tanh(turn_rate / c)", w),
                &[Second],
                |s, by| libm::tanh(s.turn_rate / by[0]),
            );
        }
        self.add("the size of the turn rate".into(), written("abs(turn_rate)"), &[Radian], |s| s.turn_rate.abs());
        self.add("the square of the turn rate".into(), written("turn_rate^2"), &[Radian], |s| {
            s.turn_rate * s.turn_rate
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

    /// What two wheels on an axle do: they roll against each other, or one of them rolls further, or less far, backward, or as it
    /// warms up. What depends on the speed of a wheel is in the catalogue.
    pub fn of_wheels(&mut self, extent: &Extent) {
        let arm = 0.5 * extent.wheelbase;
        self.add(
            "whether the wheels roll against each other".into(),
            written(format!("(1 - sign(speed^2 - ({arm:.4} * turn_rate)^2)) / 2")),
            &[Per::Radian],
            move |s| 0.5 * (1.0 - (s.speed.powi(2) - (arm * s.turn_rate).powi(2)).signum()),
        );
        for (per, side, sign) in [(Per::LeftWheel, -arm, "-"), (Per::RightWheel, arm, "+")] {
            let speed = move |s: &TrackStep| s.speed + side * s.turn_rate;
            let text = format!("speed {sign} {arm:.4} * turn_rate");
            self.add(
                "whether it rolls backward".into(),
                written(format!("(1 - sign({text})) / 2")),
                &[per],
                move |s| 0.5 * (1.0 - speed(s).signum()),
            );
            self.add("the time in the run".into(), written("time"), &[per], |s| s.time);
            for c in DECAYS {
                let words = "what dies away within {c} s of the start".into();
                self.add_shaped(words, shaped("exp(-time / c)", c), &[per], |s, by| libm::exp(-s.time / by[0]));
            }
        }
    }

    fn of_place(&mut self, extent: &Extent) {
        use Per::{Metre, Radian, Second};
        let ([x0, y0], [x1, y1]) = (extent.low, extent.high);
        let (wide, deep) = (x1 - x0, y1 - y0);
        if wide.max(deep) < HUMPS.0 {
            return;
        }
        self.pair("the place in the room, along a line", ["x", "y"], &[Metre, Second, Radian], |s| {
            [s.middle.x, s.middle.y]
        });
        for k in 0..4 {
            let (from, to) = (extent.edges[k], -extent.edges[k + 4]);
            for d in BORDERS.map(|share| from + share * (to - from)) {
                self.add_shaped(
                    "the side of a line on the floor where the robot is".into(),
                    (
                        format!("(1 + tanh((x * cos(h) + y * sin(h) - d) / {BORDER})) / 2"),
                        vec![("d", d), ("h", direction(k))],
                    ),
                    &[Metre, Radian],
                    |s, by| 0.5 * (1.0 + libm::tanh((along(s, by[1]) - by[0]) / BORDER)),
                );
            }
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

    /// For each law in proportion to a size, the same in proportion to it with its sign.
    pub fn add_signed(&mut self, size: Per, signed: Per) {
        let own: Vec<usize> = (0..self.terms.len()).filter(|term| self.terms[*term].per == size).collect();
        let first = self.terms.len();
        let place = |term: usize| own.iter().position(|other| *other == term).map(|place| first + place);
        let with_sign: Vec<Term> = own
            .iter()
            .map(|term| Term { per: signed, twin: self.terms[*term].twin.and_then(place), ..self.terms[*term] })
            .collect();
        self.terms.extend(with_sign);
    }

    fn add(
        &mut self,
        words: String,
        formula: Written,
        per: &[Per],
        value: impl Fn(&TrackStep) -> f64 + Send + Sync + 'static,
    ) {
        self.add_shaped(words, formula, per, move |step, _| value(step));
    }

    /// The same of a function with numbers that shape it.
    fn add_shaped(
        &mut self,
        words: String,
        formula: Written,
        per: &[Per],
        value: impl Fn(&TrackStep, &[f64]) -> f64 + Send + Sync + 'static,
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
        size: impl Fn(&TrackStep) -> f64 + Copy + Send + Sync + 'static,
        angle: impl Fn(&TrackStep, &[f64]) -> f64 + Copy + Send + Sync + 'static,
    ) {
        let first = self.terms.len();
        let shapes: Vec<_> = value.map(|c| (SHAPE, c)).into_iter().collect();
        let formula = |wave: &str| (format!("{size_text}{wave}({angle_text})"), shapes.clone());
        self.add_shaped(words.clone(), formula("cos"), per, move |s, by| size(s) * libm::cos(angle(s, by)));
        self.add_shaped(words, formula("sin"), per, move |s, by| size(s) * libm::sin(angle(s, by)));
        self.join(first, per.len());
    }

    /// Two functions that go together, with their formulas.
    fn pair(
        &mut self,
        words: &str,
        formulas: [&str; 2],
        per: &[Per],
        values: impl Fn(&TrackStep) -> [f64; 2] + Copy + Send + Sync + 'static,
    ) {
        let first = self.terms.len();
        for (k, formula) in formulas.into_iter().enumerate() {
            self.add(words.to_owned(), written(formula), per, move |s| values(s)[k]);
        }
        self.join(first, per.len());
    }

    /// Makes twins of `count` terms and the `count` terms behind them.
    fn join(&mut self, first: usize, count: usize) {
        for k in 0..count {
            self.terms[first + k].twin = Some(first + count + k);
            self.terms[first + count + k].twin = Some(first + k);
        }
    }
}
