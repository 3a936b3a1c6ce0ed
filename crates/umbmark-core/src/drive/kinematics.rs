//! What a drive's own file says of it.

use super::{ClapperDrive, Counting, DifferentialDrive, DriveError, Encoder, Rollers, Wheel, WheelTravel};
use crate::parameter::Parameter;
use umbmark_odometry::gearing::Gearing;

/// Another key for numbers of a drive in files.
#[derive(Debug)]
pub struct Spelling {
    /// The key, and what it may be.
    pub parameter: Parameter,
    /// The numbers that it says, which are all alike.
    pub of: &'static [&'static str],
    /// By what it is multiplied to be one of them.
    pub factor: f64,
}

/// One drive: its numbers, and how its two counters become travel of its axle. Where nothing else is said, the counters are
/// those of the axle's two wheels.
pub(super) trait Kinematics: Copy {
    /// As in files.
    const NAME: &'static str;

    /// What it is, in a sentence.
    const ABOUT: &'static str;

    /// What its two counters are called in files.
    const COUNTERS: [&'static str; 2] = ["left", "right"];

    /// What the counters of its wheels with rollers are called in files, which stand there in place of the two; none without such.
    const WHEELS: &'static [&'static str] = &[];

    /// Whether the wheels that are counted are those that drive the robot.
    const IS_DRIVEN: bool = true;

    /// The numbers of its nominal robot beside those of the encoder.
    const PARAMETERS: &'static [Parameter];

    /// Other keys for those numbers in files.
    const SPELLINGS: &'static [Spelling] = &[];

    /// See [`Drive::first_effects`](super::Drive::first_effects); those of all robots of the kind, unless it says otherwise.
    const FIRST_EFFECTS: [&'static str; 3] = ["wheel_diameter_ratio", "wheelbase", "scale"];

    /// See [`Drive::own_effects`](super::Drive::own_effects): those beside the first ones.
    const OWN_EFFECTS: &'static [&'static str] = &[];

    /// Effects that it may have beside those which name it in their [`DRIVES`](crate::effect::Effect::DRIVES).
    const EFFECTS: &'static [&'static str] = &[];

    /// See [`DriveKind::has_tick_logs`](super::DriveKind::has_tick_logs).
    const HAS_TICK_LOGS: bool = true;

    /// See [`DriveKind::has_axle_wheels`](super::DriveKind::has_axle_wheels).
    const HAS_AXLE_WHEELS: bool = false;

    /// See [`DriveKind::steers`](super::DriveKind::steers).
    const STEERS: bool = false;

    /// See [`DriveKind::drives_front_wheel`](super::DriveKind::drives_front_wheel).
    const DRIVES_FRONT_WHEEL: bool = false;

    /// See [`DriveKind::has_trucks`](super::DriveKind::has_trucks).
    const HAS_TRUCKS: bool = false;

    /// See [`Drive::first_effects`](super::Drive::first_effects).
    fn first_effects(&self) -> [&'static str; 3] {
        Self::FIRST_EFFECTS
    }

    /// A drive from the values of [`Kinematics::PARAMETERS`], if they are within their bounds.
    fn from_values(values: &[f64]) -> Result<Self, DriveError>;

    /// The values of [`Kinematics::PARAMETERS`].
    fn values(&self) -> Vec<f64>;

    /// The drive, if its numbers are within their bounds.
    fn checked(self) -> Result<Self, DriveError> {
        for (parameter, value) in Self::PARAMETERS.iter().zip(self.values()) {
            parameter.check(value)?;
        }
        Ok(self)
    }

    /// See [`Drive::trucks`](super::Drive::trucks).
    fn trucks(&self) -> Option<&ClapperDrive> {
        None
    }

    /// See [`Drive::rollers`](super::Drive::rollers).
    fn rollers(&self) -> Option<Rollers> {
        None
    }

    /// See [`Drive::wheel_layout`](super::Drive::wheel_layout).
    fn wheel_layout(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Its axle, real or virtual.
    fn axle(&self) -> &DifferentialDrive;

    /// The drive as its odometry must believe it to be, where these are the true values of its first effects.
    fn corrected(&self, first: [f64; 3]) -> Result<Self, DriveError>;

    /// The same for the true values of its [own effects](Kinematics::OWN_EFFECTS), one each.
    fn also_corrected(&self, _own: &[f64]) -> Result<Self, DriveError> {
        Ok(*self)
    }

    /// Distance of the steered wheel from the axle \[m\]; for a drive without one, that of a wheel which would steer it as far
    /// before the axle as its wheels are apart.
    fn axle_distance(&self) -> f64 {
        self.axle().wheelbase()
    }

    /// See [`Drive::track_width`](super::Drive::track_width).
    fn track_width(&self) -> f64 {
        self.axle().wheelbase()
    }

    /// What the counters do in a move; `None` for a turn that the drive cannot make.
    fn counting(&self, encoder: &Encoder, forward: f64, rotation: f64) -> Option<Counting> {
        let (per_tick, travel) = (self.axle().metres_per_tick(encoder), self.axle().wheel_travel(forward, rotation));
        let left = WheelTravel { left: per_tick.left, right: 0.0 };
        let right = WheelTravel { left: 0.0, right: per_tick.right };
        let gain = [travel.left / per_tick.left, travel.right / per_tick.right];
        Some(Counting { per_count: [left, right], gain, held: 0 })
    }

    /// What its counters mean.
    fn gearing(&self, encoder: &Encoder) -> Gearing {
        Gearing::Wheels(self.axle().metres_per_tick(encoder))
    }

    /// Travel of the axle's wheels from one reading to another.
    fn travel(&self, encoder: &Encoder, before: [f64; 2], after: [f64; 2]) -> WheelTravel {
        self.gearing(encoder).travel(self.axle().wheelbase(), before, after)
    }

    /// The counts that gained this travel, from a reading on.
    fn reading(&self, encoder: &Encoder, before: [f64; 2], travel: &WheelTravel) -> [f64; 2] {
        let per_tick = self.axle().metres_per_tick(encoder);
        [before[0] + travel.left / per_tick.left, before[1] + travel.right / per_tick.right]
    }

    /// The counts while it stands, before it makes these travels.
    fn standing(&self, _encoder: &Encoder, before: [f64; 2], _ahead: &[WheelTravel]) -> [f64; 2] {
        before
    }

    /// What the axle's wheels make of a bump under a wheel on one side, which costs that wheel so much way \[m\].
    fn bumped(&self, wheel: Wheel, lost: f64) -> WheelTravel {
        match wheel {
            Wheel::Left => WheelTravel { left: -lost, right: 0.0 },
            Wheel::Right => WheelTravel { left: 0.0, right: -lost },
        }
    }
}
