//! What was found of an experiment before anything was fitted.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Keyed, ends, finite};
use crate::diagnose::Reason;
use crate::{likelihood, setup, stats};

/// A quantity with its standard error and its 95 % interval, in the unit that its key names.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Measured {
    /// The estimate.
    pub value: f64,
    /// Its standard error; null if the data does not determine it.
    pub std_error: Option<f64>,
    /// Its 95 % interval; null if the data does not determine it.
    pub interval: Option<[f64; 2]>,
}

impl From<&stats::Measured> for Measured {
    fn from(m: &stats::Measured) -> Self {
        Measured { value: m.value, std_error: finite(m.std_error), interval: ends(m.interval) }
    }
}

/// A column, unit or frame that contradicts its name, and how to correct it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Fault {
    /// The fault, in a sentence.
    pub fault: String,
    /// What to do.
    pub remedy: String,
}

/// How the poses of the reference relate to the wheels, over all runs.
///
/// A quantity is null if the motion does not determine it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Mounting {
    /// Age of a pose at its time stamp, in the middle of a run, in s.
    pub delay_s: Measured,
    /// Growth of the delay, in s/s.
    pub clock_rate: Option<Measured>,
    /// Distance of the tracked point ahead of the axle's centre, in m.
    pub ahead_m: Option<Measured>,
    /// Distance of the tracked point to the left of the axle's centre, in m.
    pub left_m: Option<Measured>,
    /// Heading of the tracked body minus heading of the robot, in rad.
    pub yaw_rad: Option<Measured>,
    /// Distance by the reference divided by distance by the wheels.
    pub scale: Option<Measured>,
    /// Turning by the reference divided by turning by the wheels.
    pub gain: Option<Measured>,
    /// Turning by the reference for each metre driven ahead, in rad/m.
    pub drift_rad_per_m: Option<Measured>,
}

impl From<&setup::Mounting> for Mounting {
    fn from(m: &setup::Mounting) -> Self {
        let of = |quantity: &Option<stats::Measured>| quantity.as_ref().map(Measured::from);
        Mounting {
            delay_s: (&m.delay).into(),
            clock_rate: of(&m.rate),
            ahead_m: of(&m.ahead),
            left_m: of(&m.left),
            yaw_rad: of(&m.yaw),
            scale: of(&m.scale),
            gain: of(&m.gain),
            drift_rad_per_m: of(&m.drift),
        }
    }
}

/// The delay of the reference in a run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Delay {
    /// Name of the run.
    pub run: String,
    /// The delay, in s; null without enough motion.
    pub delay_s: Option<Measured>,
    /// By how much the time stamps were set back before that, in s, because the clocks of the runs differ; else 0.
    pub own_clock_s: f64,
}

/// A place where a track jumps, or a few seconds in which robot and wheels disagree.
///
/// A wheel slipped, the robot was pushed or carried, or the reference lost it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Jump {
    /// Name of the run.
    pub run: String,
    /// Time of the last pose before it since the log began, in s.
    pub since_s: f64,
    /// Time of the first pose behind it, in s.
    pub time_s: f64,
    /// Motion of the tracked point that the wheels did not make, in m.
    pub moved_m: f64,
    /// Rotation that the wheels did not make, in rad; null without headings.
    pub turned_rad: Option<f64>,
    /// Size of the jump, in standard deviations of the motion from pose to pose; null where that is not known.
    pub standard_deviations: Option<f64>,
    /// How long the log has no rows within it, in s: the way of the wheels is not known then; null where rows are as close as usual.
    pub unrecorded_s: Option<f64>,
}

impl Jump {
    fn new(run: &setup::RunSetup, jump: &setup::Jump) -> Jump {
        Jump {
            run: run.run.clone(),
            since_s: jump.since,
            time_s: jump.time,
            moved_m: jump.moved,
            turned_rad: jump.turned,
            standard_deviations: finite(jump.deviations),
            unrecorded_s: jump.unrecorded,
        }
    }
}

/// A wrong pose: its neighbours contradict it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct WrongPose {
    /// Name of the run.
    pub run: String,
    /// Time since the log began, in s.
    pub time_s: f64,
    /// Distance from the place that its neighbours imply, in m.
    pub moved_m: f64,
    /// The same for the heading, in rad; null without headings.
    pub turned_rad: Option<f64>,
}

/// A coordinate of a return error that is far from those of the other runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Deviant {
    /// "x", "y" or "heading".
    pub coordinate: &'static str,
    /// Its value, in m, a heading in rad.
    pub value: f64,
    /// Mean of the other runs, in the same unit.
    pub mean_of_others: f64,
    /// Distance from that mean, in standard deviations of a run about it; null if the others do not scatter.
    pub standard_deviations: Option<f64>,
}

impl From<&setup::Deviant> for Deviant {
    fn from(d: &setup::Deviant) -> Self {
        Deviant {
            coordinate: d.coordinate.name(),
            value: d.value,
            mean_of_others: d.usual,
            standard_deviations: finite(d.deviations),
        }
    }
}

/// A run whose return error is far from those of the other runs of its direction and test.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OutlyingReturn {
    /// Name of the run.
    pub run: String,
    /// "systematic" or "bumps".
    pub test: &'static str,
    /// "cw" or "ccw"; null where the run has neither.
    pub direction: Option<&'static str>,
    /// Number of the other runs that it was compared with.
    pub others: usize,
    /// Distance of its end position from their mean, in m.
    pub moved_m: f64,
    /// Its heading minus their mean, in rad; null without headings.
    pub turned_rad: Option<f64>,
    /// Distance of the farthest coordinate, in standard deviations; null if the others do not scatter.
    pub standard_deviations: Option<f64>,
    /// The outlying coordinates, the farthest first.
    pub deviants: Vec<Deviant>,
    /// The finding in words.
    pub said: String,
    /// What to do.
    pub remedy: String,
}

impl From<&setup::OutlyingReturn> for OutlyingReturn {
    fn from(run: &setup::OutlyingReturn) -> Self {
        OutlyingReturn {
            run: run.run.clone(),
            test: run.test.name(),
            direction: run.direction.map(|direction| direction.name()),
            others: run.others,
            moved_m: run.moved,
            turned_rad: run.turned,
            standard_deviations: finite(run.deviations()),
            deviants: run.deviants.iter().map(Deviant::from).collect(),
            said: run.sentence(),
            remedy: run.remedy(),
        }
    }
}

/// What was found of an experiment before any model was fitted.
///
/// All of it follows from the motion and the return errors alone. It is empty for return errors in arrays and without a nominal robot.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Setup {
    /// Columns, units and frames that contradict their names. Correct these first: until then no number describes the robot.
    pub faults: Vec<Fault>,
    /// What makes ticks or tracks suspicious although no fault is certain, a sentence each.
    pub doubts: Vec<String>,
    /// Clock and mounting of the reference; null without enough absolute poses.
    pub reference: Option<Mounting>,
    /// The delay of the reference in each run with poses.
    pub delays: Vec<Delay>,
    /// Places where tracks jump.
    pub jumps: Vec<Jump>,
    /// Single poses that are wrong; they are left out of fits.
    pub wrong_poses: Vec<WrongPose>,
    /// Runs whose return error is far from the others.
    pub returns: Vec<OutlyingReturn>,
}

impl From<&setup::Setup> for Setup {
    fn from(setup: &setup::Setup) -> Self {
        let fault = |fault: &setup::Fault| Fault { fault: fault.sentence(), remedy: fault.remedy() };
        let delay = |run: &setup::RunSetup| Delay {
            run: run.run.clone(),
            delay_s: run.delay.as_ref().map(Into::into),
            own_clock_s: run.own_clock,
        };
        let wrong = |run: &setup::RunSetup, wrong: &setup::WrongPose| WrongPose {
            run: run.run.clone(),
            time_s: wrong.time,
            moved_m: wrong.moved,
            turned_rad: wrong.turned,
        };
        let runs = || setup.runs.iter();
        Setup {
            faults: setup.all_faults().map(fault).collect(),
            doubts: setup.doubts.iter().map(setup::Suspicion::sentence).collect(),
            reference: setup.mounting.as_ref().map(Mounting::from),
            delays: runs().map(delay).collect(),
            jumps: runs().flat_map(|run| run.jumps.iter().map(|jump| Jump::new(run, jump))).collect(),
            wrong_poses: runs().flat_map(|run| run.wrong.iter().map(move |pose| wrong(run, pose))).collect(),
            returns: setup.returned.outlying.iter().map(OutlyingReturn::from).collect(),
        }
    }
}

/// An effect of the reference whose values were taken from the motion before any fit.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Taken {
    /// Name of the effect.
    pub effect: &'static str,
    /// Its values, in the units of its parameters.
    pub parameters: Keyed<Measured>,
    /// Probability of values this large if the effect is absent.
    pub p: f64,
}

/// The effects of the reference that were estimated from the motion.
pub(super) fn taken(taken: &[likelihood::Taken]) -> Vec<Taken> {
    let one = |own: &likelihood::Taken| Taken {
        effect: own.effect,
        parameters: own.values.iter().flatten().map(|(name, value)| (*name, Measured::from(value))).collect(),
        p: own.p,
    };
    taken.iter().map(one).collect()
}

/// Why the verdict is not "explained", a sentence each.
pub(super) fn reasons(reasons: &[Reason]) -> Vec<String> {
    reasons.iter().map(Reason::sentence).collect()
}
