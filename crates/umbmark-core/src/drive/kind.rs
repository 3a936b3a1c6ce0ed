//! The kinds of drives: what is known of one before there is a robot.

use super::kinematics::{Kinematics, Spelling};
use super::{Drive, DriveError, Robot};
use crate::parameter::Parameter;

/// Makes the kinds from the list of drives.
macro_rules! kinds {
    ($($kind:ident($file:ident::$drive:ident),)+) => {
        /// A kind of drive.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum DriveKind {
            $(#[doc = concat!("That of [`", stringify!($drive), "`](super::", stringify!($drive), ").")] $kind,)+
        }

        impl DriveKind {
            /// All of them.
            pub const ALL: &[DriveKind] = &[$(DriveKind::$kind,)+];

            const fn facts(self) -> &'static Facts {
                match self {
                    $(DriveKind::$kind => const { &Facts::of::<super::$drive>() },)+
                }
            }
        }
    };
}
every_drive!(kinds);

/// What a drive's file says of its kind.
struct Facts {
    about: &'static str,
    name: &'static str,
    counters: [&'static str; 2],
    wheels: &'static [&'static str],
    parameters: &'static [Parameter],
    spellings: &'static [Spelling],
    effects: &'static [&'static str],
    has_tick_logs: bool,
    has_axle_wheels: bool,
    steers: bool,
    drives_front_wheel: bool,
    has_trucks: bool,
    is_driven: bool,
    from_values: fn(&[f64]) -> Result<Drive, DriveError>,
}

impl Facts {
    const fn of<D: Kinematics + Into<Drive>>() -> Facts {
        Facts {
            about: D::ABOUT,
            name: D::NAME,
            counters: D::COUNTERS,
            wheels: D::WHEELS,
            parameters: D::PARAMETERS,
            spellings: D::SPELLINGS,
            effects: D::EFFECTS,
            has_tick_logs: D::HAS_TICK_LOGS,
            has_axle_wheels: D::HAS_AXLE_WHEELS,
            steers: D::STEERS,
            drives_front_wheel: D::DRIVES_FRONT_WHEEL,
            has_trucks: D::HAS_TRUCKS,
            is_driven: D::IS_DRIVEN,
            from_values: |values| D::from_values(values).map(Into::into),
        }
    }
}

impl Default for DriveKind {
    /// Two driven wheels on one axle, as in the paper.
    fn default() -> DriveKind {
        DriveKind::Differential
    }
}

impl DriveKind {
    /// As in files.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// What it is, in a sentence.
    pub fn about(self) -> &'static str {
        self.facts().about
    }

    /// What its two counters are called in files.
    pub fn counters(self) -> [&'static str; 2] {
        self.facts().counters
    }

    /// What the counters are called in files whose readings become ticks of the axle: its two, or one for each wheel with rollers.
    pub fn columns(self) -> Vec<&'static str> {
        if self.moves_sideways() { self.facts().wheels.to_vec() } else { self.counters().to_vec() }
    }

    /// Whether it stands on wheels with rollers and moves sideways too.
    pub fn moves_sideways(self) -> bool {
        !self.facts().wheels.is_empty()
    }

    /// The numbers of its nominal robot beside those of the encoder.
    pub fn parameters(self) -> &'static [Parameter] {
        self.facts().parameters
    }

    /// Other keys for those numbers in files.
    pub fn spellings(self) -> &'static [Spelling] {
        self.facts().spellings
    }

    /// What another key for its numbers stands for.
    pub(super) fn spelling(self, name: &str) -> Option<&'static Spelling> {
        self.spellings().iter().find(|spelling| spelling.parameter.name == name)
    }

    /// Whether its two counters say all that its odometry knows, so that there are tick logs of it; not where a link corrects two
    /// trucks, each with counters of its own.
    pub fn has_tick_logs(self) -> bool {
        self.facts().has_tick_logs
    }

    /// Whether its counters are those of two wheels on one axle, each driven by itself: what the paper's E_d and E_b are defined
    /// for.
    pub fn has_axle_wheels(self) -> bool {
        self.facts().has_axle_wheels
    }

    /// Whether its second counter shows the angle of a steered wheel before the axle: driven backward, that turns the robot the
    /// other way.
    pub fn steers(self) -> bool {
        self.facts().steers
    }

    /// Whether the steered wheel is also the one that is driven and counted, so that it can turn the robot on the spot.
    pub fn drives_front_wheel(self) -> bool {
        self.facts().drives_front_wheel
    }

    /// Whether it is two trucks with a link.
    pub fn has_trucks(self) -> bool {
        self.facts().has_trucks
    }

    /// Whether the wheels that are counted are those that drive the robot; tracking wheels only roll along.
    pub fn is_driven(self) -> bool {
        self.facts().is_driven
    }

    /// Whether it may have an effect that does not name it.
    pub(crate) fn adopts(self, effect: &str) -> bool {
        self.facts().effects.contains(&effect)
    }

    /// A drive of usual numbers.
    pub fn usual(self) -> Drive {
        let usual: Vec<f64> = self.parameters().iter().map(|p| p.default.resolve(&Robot::labmate())).collect();
        self.drive(&usual).expect("usual numbers make a drive")
    }

    /// A drive from the numbers that the kind [lists](DriveKind::parameters), in that order.
    pub(super) fn drive(self, values: &[f64]) -> Result<Drive, DriveError> {
        (self.facts().from_values)(values)
    }
}

/// Some kinds of drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveKinds(u32);

// A bit for each kind.
const _: () = assert!(DriveKind::ALL.len() < u32::BITS as usize);

impl DriveKinds {
    /// Every drive.
    pub const ALL: DriveKinds = DriveKinds((1 << DriveKind::ALL.len()) - 1);

    /// Two wheels, or two rows of wheels, that do not steer: the robot turns by the difference of their speeds.
    pub const DIFFERENTIAL: DriveKinds = DriveKinds::of(DriveKind::Differential).and(DriveKind::SkidSteer);

    /// One kind.
    pub const fn of(kind: DriveKind) -> DriveKinds {
        DriveKinds(1 << kind as u8)
    }

    /// These and another.
    pub const fn and(self, kind: DriveKind) -> DriveKinds {
        DriveKinds(self.0 | 1 << kind as u8)
    }

    /// Whether a kind is among them.
    pub const fn contains(self, kind: DriveKind) -> bool {
        self.0 & 1 << kind as u8 != 0
    }

    /// Each of them.
    pub fn each(self) -> impl Iterator<Item = DriveKind> {
        DriveKind::ALL.iter().copied().filter(move |kind| self.contains(*kind))
    }
}

impl std::fmt::Display for DriveKinds {
    /// "synchro", "differential and ackermann", "differential, synchro and clapper", "all".
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == DriveKinds::ALL {
            return f.write_str("all");
        }
        let names: Vec<&str> = self.each().map(DriveKind::name).collect();
        match names.split_last() {
            Some((last, others)) if !others.is_empty() => write!(f, "{} and {last}", others.join(", ")),
            _ => f.write_str(&names.concat()),
        }
    }
}
