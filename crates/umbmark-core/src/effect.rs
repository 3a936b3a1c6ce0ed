//! What makes a robot's true motion differ from what its odometry believes.
//!
//! An [`Effect`] is written once, in one file, as a change of motion from believed to true. The same change serves
//! simulation (believed = commanded) and replay (believed = recorded ticks), with values (`f64`) or with derivatives
//! ([`Dual`](crate::geometry::Dual)). To add one: write its file, and its line in the [`CATALOGUE`].
//!
//! ```text
//! believed wheel travel -> [wheels] -> true wheel travel -> kinematics -> [body] -> true motion -> true pose
//!                                                               ^ diffusion, bumps                    | [start]
//!                                                                          measured pose <- [measured] <- [seen]
//! ```
//!
//! The variables that an effect may depend on (speed, heading, wheel angle, distance since the last turn ...) are in a [`Context`], which
//! the engine fills for each piece of the path.

mod chain;
mod changes;
mod context;
mod conversion;
mod entry;
mod formula;
mod law;
mod laws;
mod model;
mod name;
mod number;
mod own;
mod rollers;
mod slip_powers;
mod text;
mod words;

use crate::drive::{DriveKind, DriveKinds, Robot, Wheel, WheelTravel};
use crate::parameter::{Parameter, Role, nearest};
use crate::path::Direction;
use crate::register;

pub use bumps::extra_travel;
pub use chain::Chain;
pub use changes::Changes;
pub use context::{Aside, Context, Filter, Here, Progress, RunContext, Sight};
pub(crate) use conversion::differences;
pub use conversion::{CONVERTED, Conversion};
pub use entry::{Entry, Evaluate, MeanLaws, RandomLaws};
pub use formula::{Formula, FormulaError, FormulaVariable, Target};
pub use law::Law;
pub use laws::{
    BodyLaw, BumpLaw, ClockLaw, DiffusionLaw, FilterLaw, LinkLaw, MeasurementLaw, SightLaw, StartLaw, WheelLaw,
};
pub use model::{Model, ModelError, Part};
pub use number::{Derived, MAX_SHAPES, Number, Shapes};
pub use text::{effects_text, effects_text_with};

register! {
    /// Every effect there is, in the order in which they act.
    ///
    /// The order is that of cause: counts, shape and drive of the wheels, grip, floor, and last the start pose and the measurement. Within
    /// a kind, effects on all motion come before effects on some of it. Effects on the wheels always act before effects on the body, so for
    /// small effects another order would change return poses only by products of two of them.
    pub CATALOGUE: Entry = EFFECT in
    // The encoders.
    wheel_lag,
    missed_counts,
    encoder_skew,
    encoder_sampling,
    encoder_resolution,
    lost_cycles,
    // The wheels' shape, and their play.
    wheel_diameter_ratio,
    wheelbase,
    scale,
    wheel_eccentricity_left,
    wheel_eccentricity_right,
    diameter_drift,
    centripetal_load,
    backlash,
    // The gears of other drives.
    drive_scale,
    steer_scale,
    steer_coupling,
    contact_trail,
    base_yaw,
    front_wheel_zero,
    front_wheel_gain,
    axle_distance,
    steering_zero,
    steering_gain,
    understeer,
    // Wheels with rollers.
    side_diameter_ratio,
    diagonal_diameter_ratio,
    axle_diameter_ratio,
    front_diameter_ratio,
    rear_diameter_ratio,
    omni_side_ratio,
    omni_axle_ratio,
    omni_pair_ratio,
    along_diameter_ratio,
    across_diameter_ratio,
    across_wheel_offset,
    roller_scale,
    lateral_scale,
    sideways_turn_slip,
    // Two trucks, and the link between them.
    rear_truck,
    link_length,
    rotary_zero_difference,
    rotary_zero_mean,
    rotary_gain,
    // The contact with the floor, smooth.
    crab,
    speed_slip,
    speed_slip_left,
    speed_slip_right,
    body_speed_slip,
    forward_slip,
    squared_speed_slip,
    squared_forward_slip,
    acceleration_slip,
    turn_slip,
    turn_slip_rate,
    direction_dependent_wheelbase,
    caster_kick,
    leg_kick,
    // The floor.
    floor_slope,
    floor_slope_yaw,
    carpet_nap,
    placed_bumps,
    bumps,
    wheel_noise,
    // START, and the measurement.
    start_pose,
    reference_delay,
    reference_filter,
    reference_clock_rate,
    marker_offset,
    marker_yaw,
    reference_heading_drift,
    reference_heading_scale,
    reference_lens,
    reference_stretch,
    reference_noise,
}

/// The largest number of parameters of one effect.
pub const MAX_PARAMETERS: usize = 6;

/// The effects that a robot with this drive may have.
pub fn of_drive(kind: DriveKind) -> impl Iterator<Item = &'static Entry> + Clone {
    CATALOGUE.iter().copied().filter(move |entry| entry.drives().contains(kind))
}

/// The entry of an effect by its name in files.
pub fn find(name: &str) -> Result<&'static Entry, ModelError> {
    CATALOGUE.iter().copied().find(|entry| entry.about.name == name).ok_or_else(|| ModelError::UnknownEffect {
        name: name.to_owned(),
        nearest: nearest(name, CATALOGUE.iter().map(|entry| entry.about.name)),
    })
}

/// A parameter of an effect of the catalogue, by the names of both.
pub fn parameter_of(effect: &str, name: &str) -> Option<&'static Parameter> {
    find(effect).ok()?.about.parameters.iter().find(|parameter| parameter.name == name)
}

/// Where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActsOn {
    /// The wheels' true travel.
    Wheels,
    /// The body's true motion.
    Body,
    /// Where the robot stands when its odometry is set to START.
    Start,
    /// The measurement of the absolute pose.
    Reference,
    /// The robot's odometry, with wheels that roll correctly.
    Odometry,
}

impl ActsOn {
    /// All of them, the most usual first.
    pub const ALL: [ActsOn; 5] = [ActsOn::Wheels, ActsOn::Body, ActsOn::Odometry, ActsOn::Start, ActsOn::Reference];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            ActsOn::Wheels => "the wheels' true travel",
            ActsOn::Body => "the body's true motion",
            ActsOn::Start => "the robot's place at START",
            ActsOn::Reference => "the absolute measurement",
            ActsOn::Odometry => "what odometry makes of the wheels",
        }
    }
}

/// The description of an effect.
#[derive(Debug)]
pub struct About {
    /// Its name in files.
    pub name: &'static str,
    /// Its name in the field.
    pub title: &'static str,
    /// Where it acts.
    pub acts_on: ActsOn,
    /// Its numbers.
    pub parameters: &'static [Parameter],
    /// The law, in plain unicode.
    pub equation: &'static str,
    /// The cause.
    pub physics: &'static str,
    /// Its influence on a square driven in both directions.
    pub signature: &'static str,
    /// Effects that look the same in return poses, or in tracks if return poses do not show them.
    pub confused_with: &'static [&'static str],
    /// The experiment that separates it from those.
    pub separated_by: &'static str,
    /// The source of this description.
    pub source: &'static str,
}

/// Which test a run belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub enum TestKind {
    /// UMBmark on a smooth floor.
    Systematic,
    /// Extended UMBmark, with bumps placed on the first leg.
    Bumps,
}

impl TestKind {
    /// "systematic" or "bumps", as in files.
    pub fn name(self) -> &'static str {
        match self {
            TestKind::Systematic => "systematic",
            TestKind::Bumps => "bumps",
        }
    }
}

/// A stretch of driving at constant ratio of the wheel speeds, as bumps see it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Its number in the run, from 0.
    pub index: usize,
    /// Sense of the run.
    pub direction: Direction,
    /// Test that the run belongs to.
    pub test: TestKind,
    /// Believed wheel travel \[m\].
    pub travel: WheelTravel,
    /// Believed way to the left \[m\].
    pub left: f64,
}

impl Stretch {
    /// Way of the wheels on either side of the course \[m\]: those of an axle that stands across it. Where the robot does not move sideways,
    /// that is its own.
    pub fn across(&self) -> WheelTravel {
        across(&self.travel, self.left)
    }
}

/// A way to the left by less than this share of what the wheels of the axle roll is what their counters leave of whole ticks.
const STRAY: f64 = 1e-3;

/// Cosine and sine of the course from the heading, of a robot that moves sideways; `None` where it does not.
#[inline]
pub(crate) fn course(travel: &WheelTravel, left: f64) -> Option<[f64; 2]> {
    if left.abs() <= STRAY * travel.farthest() {
        return None;
    }
    let ahead = 0.5 * (travel.left + travel.right);
    let way = libm::hypot(ahead, left);
    Some([ahead / way, left / way])
}

/// The same as an angle \[rad\]; 0 where it does not.
#[inline]
pub(crate) fn course_angle(travel: &WheelTravel, left: f64) -> f64 {
    course(travel, left).map_or(0.0, |[cosine, sine]| libm::atan2(sine, cosine))
}

/// The travel of an axle that stands across the course of a robot that also moves to the left by so much \[m\].
#[inline]
pub(crate) fn across(travel: &WheelTravel, left: f64) -> WheelTravel {
    if course(travel, left).is_none() {
        return *travel;
    }
    let apart = 0.5 * (travel.right - travel.left);
    let way = libm::hypot(0.5 * (travel.left + travel.right), left);
    WheelTravel { left: way - apart, right: way + apart }
}

/// A wheel rolls over an obstacle, and its travel over ground is less than its encoder counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Where in the stretch, as a share of its travel in [0, 1].
    pub at: f64,
    /// The wheel that meets it.
    pub wheel: Wheel,
    /// Travel counted but not made over ground \[m\].
    pub lost: f64,
}

/// Variance of each wheel's true travel about its mean \[m²\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelVariance {
    /// \[m²\]
    pub left: f64,
    /// \[m²\]
    pub right: f64,
}

/// A physical cause of odometry error. `p` are its numbers, in the order of [`About::parameters`]. What it changes stands in its
/// [laws](WheelLaw).
pub trait Effect {
    /// What people should know of it.
    const ABOUT: About;

    /// The drives that may have it.
    const DRIVES: DriveKinds = DriveKinds::DIFFERENTIAL;

    /// Meaning of these values for the robot, in a sentence; empty if there is none.
    fn means(_p: &[f64], _robot: &Robot) -> String {
        String::new()
    }

    /// Share by which E_s may be off either way beside these values, because no pose of this reference says more.
    fn unknown_scale(_p: &[f64]) -> f64 {
        0.0
    }

    /// Whether a robot can have these values; where it cannot, something else is the cause.
    fn is_credible(_p: &[f64]) -> bool {
        true
    }

    /// Whether, with these values, it depends on the [`Context`], so that the path must be cut into small pieces.
    fn varies(_p: &[f64]) -> bool {
        false
    }

    /// What the same cause may do by another power of the speed, itself among them or not, in the catalogue or not: where runs do not tell
    /// them apart, the intervals of what is learnt allow for them.
    fn powers() -> &'static [&'static Entry] {
        &[]
    }

    /// Values of its shapes at which it is tested whether it is missing, [`MAX_SHAPES`] at most; those that are not named keep their usual
    /// values. By default the first shape is tried at its usual value and at multiples of it.
    fn tried(shown: &Shown) -> Vec<Tried> {
        match Self::ABOUT.parameters.iter().find(|parameter| parameter.role == Role::Shape) {
            Some(shape) => {
                let usual = shape.default.resolve(shown.robot);
                MULTIPLES.iter().map(|factor| vec![(shape.name, factor * usual)]).collect()
            }
            None => vec![Vec::new()],
        }
    }
}

/// A shape is tried at these multiples of its usual value.
const MULTIPLES: [f64; 7] = [1.0, 0.5, 0.7, 1.4, 2.0, 2.8, 4.0];

/// Names and values of shapes that are tried together.
pub type Tried = Vec<(&'static str, f64)>;

/// What is known of runs before it is tested what moved their poses.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The robot, as it is entered.
    pub robot: &'a Robot,
    /// Smallest and largest x and y of what the reference measured, in its own frame \[m\]; `None` without positions.
    pub extent: Option<[[f64; 2]; 2]>,
}

/// Whether an effect whose numbers are all sizes is active.
fn at_work(sizes: &[f64]) -> bool {
    sizes.iter().any(|size| *size != 0.0)
}

#[cfg(test)]
pub(crate) mod tests;
