//! What makes a robot's true motion differ from what its odometry believes.
//!
//! An [`Effect`] is written once, in one file, as a change of motion from believed to true. The same change serves
//! simulation (believed = commanded) and replay (believed = recorded ticks), with values (`f64`) or with derivatives
//! ([`Dual`]). To add one: write its file, and its line in the [`CATALOGUE`].
//!
//! ```text
//! believed wheel travel -> [wheels] -> true wheel travel -> kinematics -> [body] -> true motion -> true pose
//!                                                               ^ diffusion, bumps                    | [start]
//!                                                                          measured pose <- [measured] <- [seen]
//! ```
//!
//! What an effect may depend on (speed, heading, wheel angle, way since the last turn ...) stands in a [`Context`], which
//! the engine fills for each piece of the way.

mod acceleration_slip;
mod axle_distance;
mod backlash;
mod base_yaw;
mod bumps;
mod carpet_nap;
mod caster_kick;
mod centripetal_load;
mod chain;
mod changes;
mod contact_trail;
mod context;
mod conversion;
mod crab;
mod diameter_drift;
mod direction_dependent_wheelbase;
mod drive_scale;
mod encoder_resolution;
mod encoder_sampling;
mod encoder_skew;
mod floor_slope;
mod floor_slope_yaw;
mod formula;
mod law;
mod leg_kick;
mod link_length;
mod marker_offset;
mod marker_yaw;
mod missed_counts;
mod model;
mod name;
mod number;
mod placed_bumps;
mod rear_truck;
mod reference_clock_rate;
mod reference_delay;
mod reference_noise;
mod rotary_gain;
mod rotary_zero_difference;
mod rotary_zero_mean;
mod scale;
mod speed_slip;
mod speed_slip_left;
mod speed_slip_right;
mod start_pose;
mod steer_coupling;
mod steer_scale;
mod steering_gain;
mod steering_zero;
mod text;
mod turn_slip;
mod turn_slip_rate;
mod understeer;
mod wheel_diameter_ratio;
mod wheel_eccentricity_left;
mod wheel_eccentricity_right;
mod wheel_noise;
mod wheelbase;
mod words;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::drive::{Kind, Kinds, LinkReading, Robot, Wheel, WheelTravel};
use crate::geometry::{Displacement2, Dual, Pose2, Real};
use crate::parameter::{Parameter, nearest};
use crate::path::Direction;
use crate::random::Stream;

pub use bumps::extra_travel;
pub use chain::Chain;
pub use changes::Changes;
pub use context::{Context, Place, Progress, Sight};
pub use conversion::{CONVERTED, Conversion};
pub use formula::{Formula, FormulaError, FormulaVariable, Target};
pub use law::Law;
pub use model::{Model, ModelError, Part};
pub use number::{Derived, Number};
pub use text::{effects_text, effects_text_with};

/// The largest number of parameters of one effect.
pub const MAX_PARAMETERS: usize = 6;

/// The effects that a robot with this drive may have.
pub fn of_drive(kind: Kind) -> impl Iterator<Item = &'static Entry> + Clone {
    CATALOGUE.iter().filter(move |entry| entry.drives.contains(kind))
}

/// Every effect there is, in the order in which they act.
///
/// The order is that of cause: what was counted, what shape the wheels have and what drives them, how they grip, what the
/// floor does, and last where the robot was put and how it was measured. Within a kind, what changes all motion stands
/// before what changes some of it. Effects on the wheels act before effects on the body wherever they stand, so for small
/// effects another order would change return poses by products of two of them only.
pub static CATALOGUE: &[Entry] = &[
    // What the encoders make of the wheels' rotation.
    Entry::of::<missed_counts::MissedCounts>(),
    Entry::of::<encoder_skew::EncoderSkew>(),
    Entry::of::<encoder_sampling::EncoderSampling>(),
    Entry::of::<encoder_resolution::EncoderResolution>(),
    // The wheels' shape, and their play.
    Entry::of::<wheel_diameter_ratio::WheelDiameterRatio>(),
    Entry::of::<wheelbase::Wheelbase>(),
    Entry::of::<scale::Scale>(),
    Entry::of::<wheel_eccentricity_left::WheelEccentricityLeft>(),
    Entry::of::<wheel_eccentricity_right::WheelEccentricityRight>(),
    Entry::of::<diameter_drift::DiameterDrift>(),
    Entry::of::<centripetal_load::CentripetalLoad>(),
    Entry::of::<backlash::Backlash>(),
    // The gears of other drives.
    Entry::of::<drive_scale::DriveScale>(),
    Entry::of::<steer_scale::SteerScale>(),
    Entry::of::<steer_coupling::SteerCoupling>(),
    Entry::of::<contact_trail::ContactTrail>(),
    Entry::of::<base_yaw::BaseYaw>(),
    Entry::of::<axle_distance::AxleDistance>(),
    Entry::of::<steering_zero::SteeringZero>(),
    Entry::of::<steering_gain::SteeringGain>(),
    Entry::of::<understeer::Understeer>(),
    // Two trucks, and the link between them.
    Entry::of::<rear_truck::RearTruck>(),
    Entry::of::<link_length::LinkLength>(),
    Entry::of::<rotary_zero_difference::RotaryZeroDifference>(),
    Entry::of::<rotary_zero_mean::RotaryZeroMean>(),
    Entry::of::<rotary_gain::RotaryGain>(),
    // The contact with the floor, smooth.
    Entry::of::<crab::Crab>(),
    Entry::of::<speed_slip::SpeedSlip>(),
    Entry::of::<speed_slip_left::SpeedSlipLeft>(),
    Entry::of::<speed_slip_right::SpeedSlipRight>(),
    Entry::of::<acceleration_slip::AccelerationSlip>(),
    Entry::of::<turn_slip::TurnSlip>(),
    Entry::of::<turn_slip_rate::TurnSlipRate>(),
    Entry::of::<direction_dependent_wheelbase::DirectionDependentWheelbase>(),
    Entry::of::<caster_kick::CasterKick>(),
    Entry::of::<leg_kick::LegKick>(),
    // The floor.
    Entry::of::<floor_slope::FloorSlope>(),
    Entry::of::<floor_slope_yaw::FloorSlopeYaw>(),
    Entry::of::<carpet_nap::CarpetNap>(),
    Entry::of::<placed_bumps::PlacedBumps>(),
    Entry::of::<bumps::Bumps>(),
    Entry::of::<wheel_noise::WheelNoise>(),
    // START, and the measurement.
    Entry::of::<start_pose::StartPose>(),
    Entry::of::<reference_delay::ReferenceDelay>(),
    Entry::of::<reference_clock_rate::ReferenceClockRate>(),
    Entry::of::<marker_offset::MarkerOffset>(),
    Entry::of::<marker_yaw::MarkerYaw>(),
    Entry::of::<reference_noise::ReferenceNoise>(),
];

/// The entry of an effect by its name in files.
pub fn find(name: &str) -> Result<&'static Entry, ModelError> {
    CATALOGUE.iter().find(|entry| entry.about.name == name).ok_or_else(|| ModelError::UnknownEffect {
        name: name.to_owned(),
        nearest: nearest(name, CATALOGUE.iter().map(|entry| entry.about.name)),
    })
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
    /// What the robot's odometry makes of its wheels, while they roll as they should.
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

/// What people should know of an effect.
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
    /// What it does to a square driven both ways.
    pub signature: &'static str,
    /// What looks the same in return poses, or in a track where those do not show it.
    pub confused_with: &'static [&'static str],
    /// The experiment that tells it from those.
    pub separated_by: &'static str,
    /// Where all this is from.
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
}

/// A wheel rolls over something, and its travel over ground falls short of what its encoder counts.
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

/// A physical cause of odometry error. `p` are its parameters, in the order of [`About::parameters`].
///
/// Each method that is not overridden changes nothing. [`wheels`](Effect::wheels) and [`body`](Effect::body), and what they call, are best
/// marked `#[inline(always)]`: then derivatives are worked out in registers as wide as the machine has.
pub trait Effect {
    /// What people should know of it.
    const ABOUT: About;

    /// The drives that may have it.
    const DRIVES: Kinds = Kinds::of(Kind::Differential);

    /// Which of the methods from [`wheels`](Effect::wheels) on it overrides: the others are not called.
    const CHANGES: Changes = Changes::ALL;

    /// What these values mean for the robot: a sentence. Empty where there is nothing to say.
    fn means(_p: &[f64], _robot: &Robot) -> String {
        String::new()
    }

    /// Whether with these values its change of motion depends on the [`Context`], so that driving has to be cut into small
    /// pieces for it.
    fn varies(_p: &[f64]) -> bool {
        false
    }

    /// Changes believed into true wheel travel \[m\].
    fn wheels<T: Real>(_p: &[T], _at: &Context<T>, _travel: &mut WheelTravel<T>) {}

    /// Changes the body motion that true wheel travel makes.
    fn body<T: Real>(_p: &[T], _at: &Context<T>, _motion: &mut Displacement2<T>) {}

    /// Changes what the encoders of a link between two trucks show of it.
    fn link<T: Real>(_p: &[T], _shown: &mut LinkReading<T>) {}

    /// Adds by how much older than its stamp an absolute measurement is that is stamped `time` after the run began \[s\].
    fn late<T: Real>(_p: &[T], _time: f64, _late: &mut T) {}

    /// Changes what an absolute measurement shows of a true pose, other than by chance.
    fn seen<T: Real>(_p: &[T], _pose: &mut Pose2<T>) {}

    /// Variance that white noise on the wheels gathers over a true travel.
    fn diffusion(_p: &[f64], _travel: &WheelTravel) -> WheelVariance {
        WheelVariance::default()
    }

    /// Adds the bumps that the wheels meet in a stretch, in any order.
    fn bumps(_p: &[f64], _stretch: &Stretch, _stream: &mut Stream, _met: &mut Vec<Bump>) {}

    /// Where the robot truly stands at START on average, seen from where it is believed to stand.
    fn start<T: Real>(_p: &[T]) -> Pose2<T> {
        Pose2::IDENTITY.lift()
    }

    /// How far from there it stands in one run.
    fn start_scatter(_p: &[f64], _stream: &mut Stream) -> Pose2 {
        Pose2::IDENTITY
    }

    /// Changes a true pose into the measured one.
    fn measured(_p: &[f64], _stream: &mut Stream, _pose: &mut Pose2) {}
}

/// Whether an effect whose numbers are all sizes is at work.
fn at_work(sizes: &[f64]) -> bool {
    sizes.iter().any(|size| *size != 0.0)
}

/// The deterministic part of an effect, for one kind of number.
#[derive(Clone, Copy, Debug)]
pub struct Mean<T: Real> {
    /// See [`Effect::start`].
    pub start: fn(&[T]) -> Pose2<T>,
    /// See [`Effect::wheels`].
    pub wheels: fn(&[T], &Context<T>, &mut WheelTravel<T>),
    /// See [`Effect::body`].
    pub body: fn(&[T], &Context<T>, &mut Displacement2<T>),
    /// See [`Effect::link`].
    pub link: fn(&[T], &mut LinkReading<T>),
    /// See [`Effect::late`].
    pub late: fn(&[T], f64, &mut T),
    /// See [`Effect::seen`].
    pub seen: fn(&[T], &mut Pose2<T>),
}

impl Mean<Dual> {
    const fn of_duals<E: Effect>() -> Mean<Dual> {
        Mean {
            start: E::start::<Dual>,
            wheels: E::wheels::<Dual>,
            body: E::body::<Dual>,
            link: E::link::<Dual>,
            late: E::late::<Dual>,
            seen: E::seen::<Dual>,
        }
    }
}

/// The random part of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// See [`Effect::diffusion`].
    pub diffusion: fn(&[f64], &WheelTravel) -> WheelVariance,
    /// See [`Effect::bumps`].
    pub bumps: fn(&[f64], &Stretch, &mut Stream, &mut Vec<Bump>),
    /// See [`Effect::start_scatter`].
    pub start_scatter: fn(&[f64], &mut Stream) -> Pose2,
    /// See [`Effect::measured`].
    pub measured: fn(&[f64], &mut Stream, &mut Pose2),
}

/// An effect as data: of the catalogue, or of a program that adds its own by [`Model::add_entry`].
///
/// ```
/// use umbmark_core::{drive::Robot, geometry::{Displacement2, Real}, parameter::Parameter};
/// use umbmark_core::effect::{About, ActsOn, Context, Effect, Entry, Model};
/// struct Draught;
/// impl Effect for Draught {
///     const ABOUT: About = About {
///         name: "draught",
///         title: "a door left open",
///         acts_on: ActsOn::Body,
///         parameters: &[Parameter::size("push_m_per_m", "", "m/m", 1e-3, (-1.0, 1.0), "drift to the left per metre")],
///         equation: "sideways ← sideways + k · length",
///         physics: "Wind.",
///         signature: "A drift to the left on every leg.",
///         confused_with: &["crab"],
///         separated_by: "closing the door",
///         source: "none",
///     };
///     fn body<T: Real>(p: &[T], at: &Context<T>, motion: &mut Displacement2<T>) {
///         motion.sideways += p[0] * at.length;
///     }
///     fn varies(p: &[f64]) -> bool {
///         p[0] != 0.0
///     }
/// }
/// static DRAUGHT: Entry = Entry::of::<Draught>();
/// let mut model = Model::new(&Robot::labmate());
/// model.add_entry(&DRAUGHT)?.free = true;
/// model.set("draught", "push_m_per_m", 2e-3)?;
/// assert!(model.varies() && model.set("draught", "push_m_per_m", 2.0).is_err());
/// # Ok::<(), umbmark_core::effect::ModelError>(())
/// ```
#[derive(Debug)]
pub struct Entry {
    /// What people should know of it.
    pub about: About,
    /// See [`Effect::DRIVES`].
    pub drives: Kinds,
    /// See [`Effect::CHANGES`].
    pub changes: Changes,
    /// See [`Effect::means`].
    pub means: fn(&[f64], &Robot) -> String,
    /// See [`Effect::varies`].
    pub varies: fn(&[f64]) -> bool,
    pub(crate) values: Mean<f64>,
    duals: Mean<Dual>,
    #[cfg(target_arch = "x86_64")]
    wide: x86::Wide,
    pub(crate) scatter: Scatter,
}

impl Entry {
    /// The entry of an effect. One with more than [`MAX_PARAMETERS`] parameters does not compile.
    pub const fn of<E: Effect>() -> Entry {
        assert!(E::ABOUT.parameters.len() <= MAX_PARAMETERS);
        Entry {
            about: E::ABOUT,
            drives: E::DRIVES,
            changes: E::CHANGES,
            means: E::means,
            varies: E::varies,
            values: Mean {
                start: E::start::<f64>,
                wheels: E::wheels::<f64>,
                body: E::body::<f64>,
                link: E::link::<f64>,
                late: E::late::<f64>,
                seen: E::seen::<f64>,
            },
            duals: Mean::of_duals::<E>(),
            #[cfg(target_arch = "x86_64")]
            wide: x86::Wide::of::<E>(),
            scatter: Scatter {
                diffusion: E::diffusion,
                bumps: E::bumps,
                start_scatter: E::start_scatter,
                measured: E::measured,
            },
        }
    }

    /// A number that names the effect's random stream: a hash of its name (FNV-1a), so that the order of the catalogue
    /// does not matter.
    pub(crate) fn purpose(&self) -> u64 {
        self.about
            .name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Entry) -> bool {
        self.about.name == other.about.name
    }
}

/// A kind of number that effects can be asked for.
pub trait Evaluate: Real {
    /// The deterministic part of an effect for this kind of number.
    fn mean(entry: &Entry) -> &Mean<Self>;
}

impl Evaluate for f64 {
    fn mean(entry: &Entry) -> &Mean<f64> {
        &entry.values
    }
}

impl Evaluate for Dual {
    fn mean(entry: &Entry) -> &Mean<Dual> {
        #[cfg(target_arch = "x86_64")]
        if let Some(wide) = entry.wide.best() {
            return wide;
        }
        &entry.duals
    }
}

#[cfg(test)]
mod tests;
