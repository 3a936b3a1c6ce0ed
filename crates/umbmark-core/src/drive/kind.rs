//! The kinds of drives, by name.

use crate::parameter::Parameter;

/// A kind of drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Two driven wheels on one axle.
    Differential,
    /// Wheels that are driven together and steered together.
    Synchro,
    /// A driven axle and a steered wheel, or two, before it: cars and tricycles.
    Ackermann,
    /// Two differential trucks and a link that corrects their headings.
    Clapper,
}

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 4] = [Kind::Differential, Kind::Synchro, Kind::Clapper, Kind::Ackermann];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Differential => "differential",
            Kind::Synchro => "synchro",
            Kind::Ackermann => "ackermann",
            Kind::Clapper => "clapper",
        }
    }

    /// What its two counters are called in files.
    pub fn counters(self) -> [&'static str; 2] {
        match self {
            Kind::Differential | Kind::Clapper => ["left", "right"],
            Kind::Synchro | Kind::Ackermann => ["drive", "steering"],
        }
    }

    /// The numbers of its nominal robot beside those of the encoder. In files, those of a differential drive have other names
    /// too.
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Kind::Differential => &super::differential::PARAMETERS,
            Kind::Synchro => &super::synchro::PARAMETERS,
            Kind::Ackermann => &super::ackermann::PARAMETERS,
            Kind::Clapper => &super::clapper::PARAMETERS,
        }
    }

    /// The effects that are fitted before anything is asked: what bends a leg, what changes a turn, and what lengthens the
    /// way. On a square driven both ways, the first shows as Type B of the paper's companion and the second as Type A.
    pub fn first_effects(self) -> [&'static str; 3] {
        match self {
            Kind::Differential | Kind::Clapper => ["wheel_diameter_ratio", "wheelbase", "scale"],
            Kind::Synchro => ["steer_coupling", "steer_scale", "drive_scale"],
            Kind::Ackermann => ["steering_zero", "steering_gain", "scale"],
        }
    }
}

/// Some kinds of drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds(u8);

impl Kinds {
    /// Every drive.
    pub const ALL: Kinds = Kinds(0b1111);

    /// Those whose motion is that of one axle.
    pub const OF_ONE_AXLE: Kinds = Kinds(0b0111);

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
        Kind::ALL.into_iter().filter(move |kind| self.contains(*kind))
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
