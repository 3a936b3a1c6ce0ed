//! Where a run stands in its session, and the moment of a measurement.

use crate::drive::Robot;
use crate::geometry::Pose2;
use crate::path::Direction;

use umbmark_odometry::context::Place;
pub use umbmark_odometry::context::{Aside, Context, Here, Progress};

/// The place of a run in its session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunContext {
    /// Its number in the session, from 0.
    pub run: usize,
    /// Path length driven in the session before it \[m\].
    pub session_distance: f64,
    /// Its sense, where it has one.
    pub direction: Option<Direction>,
}

impl RunContext {
    /// As numbers that laws may depend on.
    pub(crate) fn place(&self) -> Place {
        Place {
            run: self.run as f64,
            session_distance: self.session_distance,
            direction: self.direction.map_or(0.0, Direction::sign),
        }
    }

    /// Follows this run of a robot from START; `recorded` says whether encoders record it.
    pub fn progress(&self, robot: &Robot, recorded: bool) -> Progress {
        Progress::new(&robot.nominal(), &self.place(), recorded)
    }
}

/// The low-pass filter that absolute measurements go through: the share of them that does, and its time constant \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter<T = f64> {
    /// 0 without a filter, 1 where the whole measurement is filtered.
    pub share: T,
    /// Time after which all but 1/e of a step is followed.
    pub time_constant: T,
}

impl Filter {
    /// No filter.
    pub const NONE: Filter = Filter { share: 0.0, time_constant: 1.0 };
}

/// The moment of an absolute measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// Time since the run began by its stamp \[s\].
    pub time: f64,
    /// Delay of the stamp after the moment of the pose \[s\].
    pub late: f64,
    /// Speed of the axle's centre at the moment of that pose \[m/s\].
    pub speed: f64,
    /// Its speed to the left there \[m/s\], of a drive that also moves sideways.
    pub speed_aside: f64,
    /// The same \[rad/s\].
    pub turn_rate: f64,
    /// The frame of the predicted pose, in the frame of the poses that the reference measures; `None` of a measurement by tape at the end
    /// of a drive.
    pub room: Option<Pose2>,
}
