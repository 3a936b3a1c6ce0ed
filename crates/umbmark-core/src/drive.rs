//! The nominal robot: what its odometry believes about itself.
//!
//! Every drive has an axle, real or virtual: two wheels beside each other that would roll as the robot moves. Believed travel
//! is that of the axle's wheels, whatever the drive, so what predicts, simulates, fits and tests is written once. A drive's own
//! file says how its two counters become travel of the axle, and back; [`Encoder`] is what they count with.

/// Hands every drive to a macro: its kind, its file and the type in it.
macro_rules! every_drive {
    ($make:ident) => {
        $make! {
            Differential(differential::DifferentialDrive),
            Synchro(synchro::SynchroDrive),
            Clapper(clapper::ClapperDrive),
            Ackermann(ackermann::AckermannDrive),
            Tricycle(tricycle::TricycleDrive),
            Mecanum(mecanum::MecanumDrive),
            Omni3(omni3::Omni3Drive),
            Omni4(omni4::Omni4Drive),
            DeadWheels(dead_wheels::DeadWheelsDrive),
            SkidSteer(skid_steer::SkidSteerDrive),
        }
    };
}

mod encoder;
mod kind;
mod kinematics;
mod rollers;

pub use clapper::LinkReading;
pub use differential::WheelTravel;
pub use encoder::{Encoder, MAX_COUNTER_BITS, Wiring, roll_over};
pub use kind::{DriveKind, DriveKinds};
pub use kinematics::Spelling;
pub use rollers::{MOST_WHEELS, RollerWheel, Rollers};

use crate::parameter::{Parameter, ParameterError, Sizes};
use kinematics::Kinematics;
use std::ops::Deref;
use umbmark_odometry::context::Nominal;
use umbmark_odometry::gearing::Gearing;

/// One of the two drive wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wheel {
    /// The wheel to the left of the heading.
    Left,
    /// The wheel to the right of the heading.
    Right,
}

impl Wheel {
    /// Both wheels, in the order of every pair (left, right).
    pub const BOTH: [Wheel; 2] = [Wheel::Left, Wheel::Right];
}

impl std::fmt::Display for Wheel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Wheel::Left => "left",
            Wheel::Right => "right",
        })
    }
}

/// What makes a drive or an encoder impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// A number that is out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A number that a drive does not have.
    #[error("a robot with drive = \"{drive}\" has no {quantity}; give its own numbers in a robot.toml")]
    NotOf {
        /// What was meant.
        quantity: &'static str,
        /// Kind of the drive.
        drive: &'static str,
    },
}

/// Makes the `mod` lines of the files of drives, exports the types in them, and makes the type of all of them.
macro_rules! drives {
    ($($kind:ident($file:ident::$drive:ident),)+) => {
        $(mod $file;
        pub use $file::$drive;)+

        /// A drive: its axle, and what its counters count.
        ///
        /// It [derefs](Deref) to the axle, real or virtual.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Drive {
            $(#[doc = concat!("A [`", stringify!($drive), "`].")] $kind($drive),)+
        }

        $(impl From<$drive> for Drive {
            fn from(drive: $drive) -> Drive {
                Drive::$kind(drive)
            }
        })+

        impl Deref for Drive {
            type Target = DifferentialDrive;

            #[inline]
            fn deref(&self) -> &DifferentialDrive {
                match self {
                    $(Drive::$kind(drive) => drive.axle(),)+
                }
            }
        }

        impl Drive {
            /// Its kind.
            pub fn kind(&self) -> DriveKind {
                match self {
                    $(Drive::$kind(_) => DriveKind::$kind,)+
                }
            }

            /// The numbers that its kind [lists](DriveKind::parameters), in that order.
            pub fn values(&self) -> Vec<f64> {
                match self {
                    $(Drive::$kind(drive) => drive.values(),)+
                }
            }

            /// The effects that are fitted before anything is asked: what bends a leg, what changes a turn, and what
            /// lengthens the way. On a square driven both ways, the first shows as Type B of the paper's companion and the
            /// second as Type A.
            pub fn first_effects(&self) -> [&'static str; 3] {
                match self {
                    $(Drive::$kind(drive) => drive.first_effects(),)+
                }
            }

            /// The effects that become numbers of the drive: the [first ones](Drive::first_effects), then those which numbers hold besides.
            pub fn own_effects(&self) -> Vec<&'static str> {
                let more = match self {
                    $(Drive::$kind(_) => <$drive as Kinematics>::OWN_EFFECTS,)+
                };
                self.first_effects().into_iter().chain(more.iter().copied()).collect()
            }

            /// The drive as its odometry must believe it to be, where these are the true values of its [first
            /// effects](Drive::first_effects).
            pub fn corrected(&self, first: [f64; 3]) -> Result<Drive, DriveError> {
                match self {
                    $(Drive::$kind(drive) => drive.corrected(first).map(Drive::$kind),)+
                }
            }

            /// The same for the true values of its [own effects](Drive::own_effects).
            pub(crate) fn with_own(&self, own: &[f64]) -> Result<Drive, DriveError> {
                match self {
                    $(Drive::$kind(drive) => {
                        drive.corrected([own[0], own[1], own[2]])?.also_corrected(&own[3..]).map(Drive::$kind)
                    })+
                }
            }

            /// Distance of the steered wheel from the axle \[m\]; for a drive without one, that of a wheel which would steer it
            /// as far before the axle as its wheels are apart.
            pub fn axle_distance(&self) -> f64 {
                match self {
                    $(Drive::$kind(drive) => drive.axle_distance(),)+
                }
            }

            /// Distance of the wheels on the left from those on the right, as a tape measures it \[m\].
            pub fn track_width(&self) -> f64 {
                match self {
                    $(Drive::$kind(drive) => drive.track_width(),)+
                }
            }

            /// Its two trucks and their link, where it has them.
            pub fn trucks(&self) -> Option<&ClapperDrive> {
                match self {
                    $(Drive::$kind(drive) => drive.trucks(),)+
                }
            }

            /// Its wheels with rollers, where it has them: it then also moves sideways.
            pub fn rollers(&self) -> Option<Rollers> {
                match self {
                    $(Drive::$kind(drive) => drive.rollers(),)+
                }
            }

            /// How wheels with rollers stand, where laws have to know: of four omni wheels, cosine and sine of twice the direction of the first
            /// from straight ahead; of tracking wheels, how far the one across stands ahead, over half the distance of the other two, and zero;
            /// zeros of other drives.
            pub fn wheel_layout(&self) -> [f64; 2] {
                match self {
                    $(Drive::$kind(drive) => drive.wheel_layout(),)+
                }
            }

            /// What the axle's wheels make of a bump under a wheel on one side, which costs that wheel so much way \[m\].
            #[inline]
            pub fn bumped(&self, wheel: Wheel, lost: f64) -> WheelTravel {
                match self {
                    $(Drive::$kind(drive) => drive.bumped(wheel, lost),)+
                }
            }

            fn counting(&self, encoder: &Encoder, forward: f64, rotation: f64) -> Option<Counting> {
                match self {
                    $(Drive::$kind(drive) => drive.counting(encoder, forward, rotation),)+
                }
            }

            fn gearing(&self, encoder: &Encoder) -> Gearing {
                match self {
                    $(Drive::$kind(drive) => drive.gearing(encoder),)+
                }
            }

            fn travel(&self, encoder: &Encoder, before: [f64; 2], after: [f64; 2]) -> WheelTravel {
                match self {
                    $(Drive::$kind(drive) => drive.travel(encoder, before, after),)+
                }
            }

            fn reading(&self, encoder: &Encoder, before: [f64; 2], travel: &WheelTravel) -> [f64; 2] {
                match self {
                    $(Drive::$kind(drive) => drive.reading(encoder, before, travel),)+
                }
            }

            fn standing(&self, encoder: &Encoder, before: [f64; 2], ahead: &[WheelTravel]) -> [f64; 2] {
                match self {
                    $(Drive::$kind(drive) => drive.standing(encoder, before, ahead),)+
                }
            }
        }
    };
}
every_drive!(drives);

impl Drive {
    /// A drive from the numbers that its kind [lists](DriveKind::parameters), in that order.
    pub fn from_values(kind: DriveKind, values: &[f64]) -> Result<Drive, DriveError> {
        kind.drive(values)
    }

    /// One of its numbers, by any of its names in files; of several that go by that name, the first.
    pub fn number(&self, name: &str) -> Option<f64> {
        let kind = self.kind();
        let (own, factor) = match kind.spelling(name) {
            Some(spelling) => (spelling.of[0], spelling.factor),
            None => (name, 1.0),
        };
        let place = kind.parameters().iter().position(|p| p.name == own)?;
        Some(self.values()[place] / factor)
    }

    /// The drive with another value of one of its numbers, by any of its names in files.
    pub fn with(&self, name: &'static str, value: f64) -> Result<Drive, DriveError> {
        let (kind, mut values) = (self.kind(), self.values());
        let own = [name];
        let (names, value) = match kind.spelling(name) {
            Some(spelling) => (spelling.of, spelling.factor * spelling.parameter.check(value)?),
            None => (&own[..], value),
        };
        let mut found = false;
        for (parameter, own) in kind.parameters().iter().zip(&mut values) {
            if names.contains(&parameter.name) {
                (*own, found) = (value, true);
            }
        }
        if !found {
            return Err(DriveError::NotOf { quantity: name, drive: kind.name() });
        }
        Drive::from_values(kind, &values)
    }
}

/// What a drive's two counters do in a move, and what their counts mean there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counting {
    /// Travel of the axle's wheels a count of each counter \[m\].
    pub per_count: [WheelTravel; 2],
    /// Counts that each gains over the move, fractions included.
    pub gain: [f64; 2],
    /// What an absolute counter shows all along the move; 0 where both count on.
    pub held: i64,
}

/// A nominal robot: its drive and its encoders.
///
/// ```
/// use umbmark_core::drive::Robot;
/// let robot = Robot::labmate();
/// assert_eq!(robot.drive.wheelbase(), 0.340);
/// assert!((robot.metres_per_tick().left - 0.23562e-3).abs() < 1e-8);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// What people call it.
    pub name: String,
    /// Nominal kinematics.
    pub drive: Drive,
    /// Encoders, the same kind on all wheels.
    pub encoder: Encoder,
}

impl Sizes for Robot {
    fn wheelbase(&self) -> f64 {
        self.drive.wheelbase()
    }

    fn wheel_radius(&self) -> f64 {
        0.25 * (self.drive.wheel_diameter_left() + self.drive.wheel_diameter_right())
    }
}

impl Robot {
    /// The TRC LabMate of the paper: nominal wheelbase 0.340 m (section 4.1). The wheel diameter, 0.150 m, and 2000 ticks
    /// per wheel revolution are assumptions; the paper gives neither.
    pub fn labmate() -> Robot {
        Robot {
            name: "TRC LabMate".into(),
            drive: DifferentialDrive::new(0.340, 0.150, 0.150).expect("constants are positive").into(),
            encoder: Encoder::new(2000.0, None, None).expect("constants are positive"),
        }
    }

    /// The numbers of robots that flags and sweeps can change.
    pub const NUMBERS: [Parameter; 4] =
        [DifferentialDrive::WHEELBASE, DifferentialDrive::WHEEL_DIAMETER, Encoder::TICKS, Encoder::RATE];

    /// A number of the drive or the encoder, by its name in files.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.encoder.number(name).unwrap_or_else(|| self.drive.number(name))
    }

    /// The robot with another value of a number of its drive or encoder, by its name in files.
    pub fn with(&self, name: &'static str, value: f64) -> Result<Robot, DriveError> {
        let (drive, encoder) = match self.encoder.with(name, value)? {
            Some(encoder) => (self.drive, encoder),
            None => (self.drive.with(name, value)?, self.encoder),
        };
        Ok(Robot { name: self.name.clone(), drive, encoder })
    }

    /// What the counters do while the axle's centre advances `forward` \[m\] and the robot turns by `rotation` \[rad\], at a
    /// constant ratio of the two; `None` for a turn that the drive cannot make.
    pub fn counting(&self, forward: f64, rotation: f64) -> Option<Counting> {
        self.drive.counting(&self.encoder, forward, rotation)
    }

    /// Ticks of the axle's wheels since START, as logs hold them, for readings of the drive's own counters.
    pub fn axle_ticks(&self, counters: [Vec<f64>; 2]) -> [Vec<f64>; 2] {
        self.axle_ticks_by(counters, |before, _| before)
    }

    /// The same where the angle of a row is that of all that was driven since the row before.
    pub fn axle_ticks_by_rows(&self, counters: [Vec<f64>; 2]) -> [Vec<f64>; 2] {
        self.axle_ticks_by(counters, |before, now| [before[0], now[1]])
    }

    /// The same, with the reading before as it is seen from the one after it.
    fn axle_ticks_by(&self, counters: [Vec<f64>; 2], seen: impl Fn([f64; 2], [f64; 2]) -> [f64; 2]) -> [Vec<f64>; 2] {
        if self.drive.kind().counters() == DriveKind::Differential.counters() {
            return counters;
        }
        let per_tick = self.metres_per_tick();
        let mut ticks = [Vec::new(), Vec::new()];
        let (mut left, mut right, mut before) = (0.0, 0.0, None);
        for (first, second) in counters[0].iter().zip(&counters[1]) {
            let now = [*first, *second];
            let rolled = self.drive.travel(&self.encoder, seen(before.unwrap_or(now), now), now);
            (left, right, before) =
                (left + rolled.left / per_tick.left, right + rolled.right / per_tick.right, Some(now));
            ticks[0].push(left);
            ticks[1].push(right);
        }
        ticks
    }

    /// Whole readings of the drive's own counters from which [`Robot::axle_ticks`] makes these ticks of the axle's wheels.
    pub fn counters(&self, ticks: [&[f64]; 2]) -> [Vec<f64>; 2] {
        if self.drive.kind().counters() == DriveKind::Differential.counters() || ticks[0].is_empty() {
            return ticks.map(<[f64]>::to_vec);
        }
        let per_tick = self.metres_per_tick();
        let travels: Vec<WheelTravel> = (1..ticks[0].len())
            .map(|i| WheelTravel {
                left: (ticks[0][i] - ticks[0][i - 1]) * per_tick.left,
                right: (ticks[1][i] - ticks[1][i - 1]) * per_tick.right,
            })
            .collect();
        let mut now = self.drive.standing(&self.encoder, [0.0; 2], &travels);
        let mut counters = now.map(|count| vec![count]);
        for (i, travel) in travels.iter().enumerate() {
            now = if *travel == WheelTravel::default() {
                self.drive.standing(&self.encoder, now, &travels[i + 1..])
            } else {
                self.drive.reading(&self.encoder, now, travel)
            }
            .map(f64::round);
            counters[0].push(now[0]);
            counters[1].push(now[1]);
        }
        counters
    }

    /// Ticks of the axle's wheels since START for readings of wheels with rollers, one column a wheel; `None` for a drive without such.
    pub fn axle_ticks_of_rollers(&self, counters: &[Vec<f64>]) -> Option<[Vec<f64>; 2]> {
        let rollers = self.drive.rollers()?;
        let (per_tick, per_count) =
            (self.metres_per_tick(), rollers.metres_per_count(self.encoder.ticks_per_revolution()));
        let samples = counters.iter().map(Vec::len).min().unwrap_or(0);
        let mut ticks = [Vec::with_capacity(samples), Vec::with_capacity(samples)];
        for sample in 0..samples {
            let ways: Vec<f64> =
                counters.iter().zip(&per_count).map(|(counts, per_count)| counts[sample] * per_count).collect();
            let motion = rollers.motion(&ways);
            let travel = self.drive.wheel_travel(motion.forward, motion.rotation);
            ticks[0].push(travel.left / per_tick.left);
            ticks[1].push(travel.right / per_tick.right);
        }
        Some(ticks)
    }

    /// Readings of wheels with rollers from which [`Robot::axle_ticks_of_rollers`] makes these ticks of the axle's wheels, where the robot does
    /// not move sideways; none for a drive without such.
    pub fn counters_of_rollers(&self, ticks: [&[f64]; 2]) -> Vec<Vec<f64>> {
        let Some(rollers) = self.drive.rollers() else { return Vec::new() };
        let (per_tick, per_count) =
            (self.metres_per_tick(), rollers.metres_per_count(self.encoder.ticks_per_revolution()));
        let mut counters = vec![Vec::with_capacity(ticks[0].len()); per_count.len()];
        for (left, right) in ticks[0].iter().zip(ticks[1]) {
            let travel = WheelTravel { left: left * per_tick.left, right: right * per_tick.right };
            let ways = rollers.ways_of(&self.drive.displacement(&travel));
            counters
                .iter_mut()
                .zip(ways)
                .zip(&per_count)
                .for_each(|((counts, way), per_count)| counts.push((way / per_count).round()));
        }
        counters
    }

    /// What its two counters mean.
    pub fn gearing(&self) -> Gearing {
        self.drive.gearing(&self.encoder)
    }

    /// The numbers that the variables of effects are computed with.
    pub fn nominal(&self) -> Nominal {
        Nominal {
            wheelbase: self.drive.wheelbase(),
            wheel_radius: [0.5 * self.drive.wheel_diameter_left(), 0.5 * self.drive.wheel_diameter_right()],
            metres_per_tick: self.metres_per_tick(),
            axle_distance: self.drive.axle_distance(),
            wheel_layout: self.drive.wheel_layout(),
        }
    }

    /// Travel of each wheel of the axle per encoder tick \[m\]: π D / (ticks per revolution).
    pub fn metres_per_tick(&self) -> WheelTravel {
        self.drive.metres_per_tick(&self.encoder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_counts_of_every_drive_mean_the_motion_that_made_them() {
        let encoder = Robot::labmate().encoder;
        for drive in DriveKind::ALL.iter().map(|kind| kind.usual()) {
            for (forward, rotation) in [(4.0, 0.0), (-0.3, 0.0), (0.0, 1.5), (0.0, -1.5), (3.0, 1.0), (3.0, -1.0)] {
                let Some(Counting { per_count: [first, second], gain, held }) =
                    drive.counting(&encoder, forward, rotation)
                else {
                    continue;
                };
                let before = [7.0, held as f64];
                let after = [before[0] + gain[0], before[1] + gain[1]];
                let travel = drive.travel(&encoder, before, after);
                let left = first.left * gain[0] + second.left * gain[1];
                let right = first.right * gain[0] + second.right * gain[1];
                let (what, moved) = (drive.kind().name(), drive.displacement(&travel));
                assert!((travel.left - left).abs() + (travel.right - right).abs() < 1e-12, "{what} {travel:?}");
                // An angle that is held stands at a whole count.
                assert!((moved.forward - forward).abs() + (moved.rotation - rotation).abs() < 1e-3, "{what} {moved:?}");
                let read = drive.reading(&encoder, before, &travel);
                assert!((read[0] - after[0]).abs() + (read[1] - after[1]).abs() < 1e-6, "{what} {read:?}");
            }
        }
    }

    #[test]
    fn every_drive_is_made_of_its_values() {
        for kind in DriveKind::ALL {
            let drive = kind.usual();
            assert_eq!((drive.kind(), Drive::from_values(*kind, &drive.values())), (*kind, Ok(drive)));
        }
    }
}
