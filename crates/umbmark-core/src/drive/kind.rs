//! The kinds of drives: what is known of one before there is a robot.

use super::kinematics::Kinematics;
use super::{AckermannDrive, ClapperDrive, DifferentialDrive, Drive, DriveError, SynchroDrive};
use crate::parameter::Parameter;

/// Makes the kinds from the list of drives.
macro_rules! kinds {
    ($($(#[$about:meta])* $kind:ident($drive:ident),)+) => {
        /// A kind of drive.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Kind {
            $($(#[$about])* $kind,)+
        }

        impl Kind {
            /// All of them.
            pub const ALL: &[Kind] = &[$(Kind::$kind,)+];

            const fn facts(self) -> &'static Facts {
                match self {
                    $(Kind::$kind => const { &Facts::of::<$drive>() },)+
                }
            }
        }
    };
}
every_drive!(kinds);

/// What a drive's file says of its kind.
struct Facts {
    name: &'static str,
    counters: [&'static str; 2],
    parameters: &'static [Parameter],
    has_tick_logs: bool,
    from_values: fn(&[f64]) -> Result<Drive, DriveError>,
}

impl Facts {
    const fn of<D: Kinematics + Into<Drive>>() -> Facts {
        Facts {
            name: D::NAME,
            counters: D::COUNTERS,
            parameters: D::PARAMETERS,
            has_tick_logs: D::HAS_TICK_LOGS,
            from_values: |values| D::from_values(values).map(Into::into),
        }
    }
}

impl Kind {
    /// As in files.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// What its two counters are called in files.
    pub fn counters(self) -> [&'static str; 2] {
        self.facts().counters
    }

    /// The numbers of its nominal robot beside those of the encoder. In files, those of a differential drive have other names
    /// too.
    pub fn parameters(self) -> &'static [Parameter] {
        self.facts().parameters
    }

    /// Whether its two counters say all that its odometry knows, so that there are tick logs of it; not where a link corrects two
    /// trucks, each with counters of its own.
    pub fn has_tick_logs(self) -> bool {
        self.facts().has_tick_logs
    }

    /// A drive from the numbers that the kind [lists](Kind::parameters), in that order.
    pub(super) fn drive(self, values: &[f64]) -> Result<Drive, DriveError> {
        (self.facts().from_values)(values)
    }
}

/// Some kinds of drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds(u8);

impl Kinds {
    /// Every drive.
    pub const ALL: Kinds = Kinds((1 << Kind::ALL.len()) - 1);

    /// One kind.
    pub const fn of(kind: Kind) -> Kinds {
        Kinds(1 << kind as u8)
    }

    /// These and another.
    pub const fn and(self, kind: Kind) -> Kinds {
        Kinds(self.0 | 1 << kind as u8)
    }

    /// Whether a kind is among them.
    pub const fn contains(self, kind: Kind) -> bool {
        self.0 & 1 << kind as u8 != 0
    }

    /// Each of them.
    pub fn each(self) -> impl Iterator<Item = Kind> {
        Kind::ALL.iter().copied().filter(move |kind| self.contains(*kind))
    }
}

impl std::fmt::Display for Kinds {
    /// "synchro", "differential and ackermann", "all".
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == Kinds::ALL {
            return f.write_str("all");
        }
        let names: Vec<&str> = self.each().map(Kind::name).collect();
        f.write_str(&names.join(" and "))
    }
}
