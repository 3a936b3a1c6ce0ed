//! Variables that errors may depend on, and how their ranges are cut into bins.

use super::followed::{Conditions, ErrorIncrement};
use crate::drive::Robot;
use std::f64::consts::{SQRT_2, TAU};
use umbmark_odometry::pace::HALF_WINDOW;

/// Bins are separate if the ticks blur a value by less than this share of a bin.
const BLUR: f64 = 0.25;

/// An error, in proportion to what was driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// Forward error per distance driven straight or in arcs \[m/m\].
    Forward,
    /// Error to the left per distance driven straight or in arcs \[m/m\].
    Sideways,
    /// Rotation error to the left per distance driven straight or in arcs \[rad/m\].
    Yaw,
    /// Rotation error per rotation in turns on the spot \[rad/rad\].
    Turn,
    /// Forward displacement of the axle's centre, per rotation in turns on the spot \[m/rad\].
    TurnForward,
    /// Displacement to the left, per rotation in turns on the spot \[m/rad\].
    TurnSideways,
}

impl Rate {
    /// All.
    pub const ALL: [Rate; 6] =
        [Rate::Forward, Rate::Sideways, Rate::Yaw, Rate::Turn, Rate::TurnForward, Rate::TurnSideways];

    /// Rates that are tested for dependence on covariates.
    pub const DEPENDING: [Rate; 4] = [Rate::Forward, Rate::Sideways, Rate::Yaw, Rate::Turn];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Rate::Forward => "forward",
            Rate::Sideways => "sideways",
            Rate::Yaw => "yaw",
            Rate::Turn => "rotation in turns",
            Rate::TurnForward => "forward in turns",
            Rate::TurnSideways => "sideways in turns",
        }
    }

    /// As a key, with its unit.
    pub fn key(self) -> &'static str {
        match self {
            Rate::Forward => "forward_m_per_m",
            Rate::Sideways => "sideways_m_per_m",
            Rate::Yaw => "yaw_rad_per_m",
            Rate::Turn => "turn_rad_per_rad",
            Rate::TurnForward => "turn_forward_m_per_rad",
            Rate::TurnSideways => "turn_sideways_m_per_rad",
        }
    }

    /// Factor and unit of the report.
    pub fn display(self) -> (f64, &'static str) {
        match self {
            Rate::Forward | Rate::Sideways => (1e3, "mm/m"),
            Rate::Yaw => (1f64.to_degrees(), "deg/m"),
            Rate::Turn => (100.0, "%"),
            Rate::TurnForward | Rate::TurnSideways => (1e3, "mm/rad"),
        }
    }

    /// Whether it is one of turns on the spot.
    pub fn of_turns(self) -> bool {
        matches!(self, Rate::Turn | Rate::TurnForward | Rate::TurnSideways)
    }

    /// Standard deviation by which whole ticks leave one end of a move undetermined \[m, rad\]: the reading of each wheel is uniform within
    /// a tick q, which makes q/√24 of way and q/√6 over the wheelbase of rotation.
    pub(super) fn resolution(self, robot: &Robot) -> f64 {
        let tick = robot.metres_per_tick();
        let q = tick.left.abs().max(tick.right.abs());
        match self {
            Rate::Yaw | Rate::Turn => q / 6f64.sqrt() / robot.drive.wheelbase(),
            _ => q / 24f64.sqrt(),
        }
    }

    /// Error and amount of driving of a step, if it counts for this rate.
    pub(super) fn of(self, step: &ErrorIncrement) -> Option<[f64; 2]> {
        let ([forward, sideways, yaw], [way, rotation]) = (step.own, step.motion);
        let amount = if self.of_turns() { rotation } else { way };
        let error = match self {
            Rate::Forward => forward * way.signum(),
            Rate::Sideways | Rate::TurnSideways => sideways,
            Rate::Yaw => yaw,
            Rate::Turn => yaw * rotation.signum(),
            Rate::TurnForward => forward,
        };
        (step.turning == self.of_turns() && amount != 0.0).then_some([error, amount.abs()])
    }

    /// The error of a step \[m, m, rad\] at a value of this rate, if the step counts for it.
    pub(super) fn made(self, step: &ErrorIncrement, value: f64) -> Option<[f64; 3]> {
        let [_, amount] = self.of(step)?;
        let ([way, rotation], error) = (step.motion, value * amount);
        Some(match self {
            Rate::Forward => [error * way.signum(), 0.0, 0.0],
            Rate::Sideways | Rate::TurnSideways => [0.0, error, 0.0],
            Rate::Yaw => [0.0, 0.0, error],
            Rate::Turn => [0.0, 0.0, error * rotation.signum()],
            Rate::TurnForward => [error, 0.0, 0.0],
        })
    }
}

/// How the range of a covariate is cut.
#[derive(Clone, Copy, Debug)]
enum Cut {
    /// Number of equal bins from 0 to the greatest size.
    FromZero(usize),
    /// Number of equal bins from the most negative to the most positive value.
    Around(usize),
    /// Number of bins of a full turn, the first centred on 0.
    Cyclic(usize),
    /// At these, the last open.
    At(&'static [f64]),
    /// Maximum number of bins of whole numbers.
    Whole(usize),
}

pub(super) type Value = fn(&Conditions) -> f64;

/// A variable that an error may depend on.
#[derive(Clone, Copy, Debug)]
pub struct Covariate {
    /// Its name; the same as in formulas, if these have it.
    pub name: &'static str,
    /// In words.
    pub title: &'static str,
    /// Unit of its values: for straights and arcs, and for turns.
    pub units: [&'static str; 2],
    /// For straights and arcs.
    going: Option<Value>,
    /// For turns on the spot.
    turning: Option<Value>,
    cut: Cut,
    /// Separates the bins by sense: those of sense -1 first.
    split: Option<Value>,
    /// Whether runs may differ in it.
    pub between_runs: bool,
    /// How it follows from the counts, where it is a derivative of them.
    derived: Option<Derived>,
}

/// A derivative of the counts with respect to time.
#[derive(Clone, Copy, Debug)]
struct Derived {
    /// 1 for a speed, 2 for an acceleration.
    order: i32,
    /// The rates of the same unit in straights and arcs, and in turns.
    of: [Rate; 2],
}

const PLAIN: Covariate = Covariate {
    name: "",
    title: "",
    units: ["", ""],
    going: None,
    turning: None,
    cut: Cut::Around(2),
    split: None,
    between_runs: false,
    derived: None,
};

/// All that is tested.
pub static COVARIATES: [Covariate; 11] = [
    Covariate {
        name: "speed",
        title: "the speed",
        units: ["m/s", ""],
        going: Some(|at| at.speed.abs()),
        cut: Cut::FromZero(6),
        between_runs: true,
        derived: Some(Derived { order: 1, of: [Rate::Forward; 2] }),
        ..PLAIN
    },
    Covariate {
        name: "turn_rate",
        title: "the turn rate",
        units: ["rad/s", "rad/s"],
        going: Some(|at| at.turn_rate),
        turning: Some(|at| at.turn_rate.abs()),
        cut: Cut::Around(7),
        between_runs: true,
        derived: Some(Derived { order: 1, of: [Rate::Yaw; 2] }),
        ..PLAIN
    },
    Covariate {
        name: "acceleration",
        title: "the acceleration",
        units: ["m/s^2", "rad/s^2"],
        going: Some(|at| at.acceleration),
        turning: Some(|at| at.turn_acceleration),
        cut: Cut::Around(5),
        derived: Some(Derived { order: 2, of: [Rate::Forward, Rate::Turn] }),
        ..PLAIN
    },
    Covariate {
        name: "wheel_angle_left",
        title: "the angle of the left wheel",
        units: ["rad", "rad"],
        going: Some(|at| at.wheel_angle[0]),
        turning: Some(|at| at.wheel_angle[0]),
        cut: Cut::Cyclic(8),
        ..PLAIN
    },
    Covariate {
        name: "wheel_angle_right",
        title: "the angle of the right wheel",
        units: ["rad", "rad"],
        going: Some(|at| at.wheel_angle[1]),
        turning: Some(|at| at.wheel_angle[1]),
        cut: Cut::Cyclic(8),
        ..PLAIN
    },
    Covariate {
        name: "heading",
        title: "the heading in the room",
        units: ["rad", "rad"],
        going: Some(|at| at.heading),
        turning: Some(|at| at.heading),
        cut: Cut::Cyclic(8),
        ..PLAIN
    },
    Covariate {
        name: "distance",
        title: "the place in the run and its sense",
        units: ["", ""],
        going: Some(|at| at.place),
        turning: Some(|at| at.place),
        cut: Cut::At(&[0.0, 0.25, 0.5, 0.75]),
        split: Some(|at| at.direction),
        ..PLAIN
    },
    Covariate {
        name: "time",
        title: "the time in the run",
        units: ["s", "s"],
        going: Some(|at| at.time),
        turning: Some(|at| at.time),
        cut: Cut::FromZero(6),
        ..PLAIN
    },
    Covariate {
        name: "run",
        title: "the place of the run in the session",
        units: ["", ""],
        going: Some(|at| at.run),
        turning: Some(|at| at.run),
        cut: Cut::Whole(8),
        between_runs: true,
        ..PLAIN
    },
    Covariate {
        name: "since_turn",
        title: "the way since the last turn and its sense",
        units: ["m", ""],
        going: Some(|at| at.since_turn),
        cut: Cut::At(&[0.0, 0.05, 0.15, 0.5]),
        split: Some(|at| at.last_turn),
        ..PLAIN
    },
    Covariate {
        name: "last_turn",
        title: "the sense of the last turn",
        units: ["", ""],
        going: Some(|at| at.last_turn),
        turning: Some(|at| at.turn_rate.signum()),
        cut: Cut::At(&[-1.0, 0.0, 1.0]),
        between_runs: true,
        ..PLAIN
    },
];

/// A bin of a covariate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// From here,
    pub low: f64,
    /// to here; infinite where it is open.
    pub high: f64,
    /// Of steps in this sense (+1 left or ccw, -1 right or cw); 0 for both.
    pub sense: f64,
}

/// The bins of a covariate on some data.
pub(super) struct Bins {
    edges: Vec<f64>,
    cyclic: bool,
    split: Option<Value>,
    value: Value,
}

impl Covariate {
    /// Whether its values repeat after a full turn.
    pub fn cyclic(&self) -> bool {
        matches!(self.cut, Cut::Cyclic(_))
    }

    /// Its value for steps that count for a rate.
    pub(super) fn value(&self, rate: Rate) -> Option<Value> {
        if rate.of_turns() { self.turning } else { self.going }
    }

    /// Whether one tick blurs its bins in these steps.
    ///
    /// A step whose counts are too few by chance appears to be slower than it is and to have an error ahead: where ticks blur the bins,
    /// every error depends on the speed.
    pub(super) fn blurred<'a>(
        &self,
        rate: Rate,
        spans: &[Span],
        robot: &Robot,
        steps: impl Iterator<Item = &'a ErrorIncrement>,
    ) -> bool {
        let (Some(Derived { order, of }), Some(span)) = (self.derived, spans.first()) else { return false };
        let resolution = of[usize::from(rate.of_turns())].resolution(robot);
        let blur = |step: &ErrorIncrement| {
            let window = step.seconds.max(2.0 * HALF_WINDOW);
            resolution * (SQRT_2 / window).powi(order)
        };
        let (squares, count) = steps.fold((0.0, 0.0), |(sum, n), step| (sum + blur(step).powi(2), n + 1.0));
        (squares / f64::max(count, 1.0)).sqrt() >= BLUR * (span.high - span.low)
    }

    /// Cuts its range in some steps into bins.
    pub(super) fn bins<'a>(&self, rate: Rate, steps: impl Iterator<Item = &'a ErrorIncrement>) -> Option<Bins> {
        let value = self.value(rate)?;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in steps.map(|step| value(&step.at)) {
            (least, most) = (least.min(v), most.max(v));
        }
        if most <= least {
            return None;
        }
        let even = |low: f64, high: f64, n: usize| {
            (0..=n).map(|i| low + (high - low) * i as f64 / n as f64).collect::<Vec<f64>>()
        };
        let edges = match self.cut {
            Cut::FromZero(n) => even(0.0, most, n),
            Cut::Around(n) if least >= 0.0 => even(0.0, most, n - 1),
            Cut::Around(n) => even(-most.abs().max(least.abs()), most.abs().max(least.abs()), n),
            Cut::Cyclic(n) => even(-0.5 * TAU / n as f64, TAU * (1.0 - 0.5 / n as f64), n),
            Cut::At(edges) => edges.iter().copied().chain([f64::INFINITY]).collect(),
            Cut::Whole(n) => {
                let each = ((most + 1.0) / n as f64).ceil();
                even(-0.5, each * ((most + 1.0) / each).ceil() - 0.5, ((most + 1.0) / each).ceil() as usize)
            }
        };
        Some(Bins { edges, cyclic: self.cyclic(), split: self.split, value })
    }
}

impl Bins {
    fn parts(&self) -> usize {
        self.edges.len() - 1
    }

    /// All of them.
    pub fn spans(&self) -> Vec<Span> {
        let senses = if self.split.is_some() { &[-1.0, 1.0][..] } else { &[0.0][..] };
        let of = |sense: &f64| {
            let sense = *sense;
            self.edges.windows(2).map(move |pair| Span { low: pair[0], high: pair[1], sense })
        };
        senses.iter().flat_map(of).collect()
    }

    /// The bin of a step; `None` if the step has no sense.
    pub fn index(&self, step: &ErrorIncrement) -> Option<usize> {
        let mut value = (self.value)(&step.at);
        if self.cyclic {
            value = self.edges[0] + libm::fmod(libm::fmod(value - self.edges[0], TAU) + TAU, TAU);
        }
        let part = self.edges.partition_point(|edge| *edge <= value).saturating_sub(1).min(self.parts() - 1);
        match self.split.map(|split| split(&step.at)) {
            None => Some(part),
            Some(sense) if sense < 0.0 => Some(part),
            Some(sense) if sense > 0.0 => Some(part + self.parts()),
            Some(_) => None,
        }
    }
}
