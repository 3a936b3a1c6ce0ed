//! Wheel travel from the counters of a drive, whatever they count.

use super::{Course, Leg};
use crate::drive::WheelTravel;
use crate::engine::{UNITS_PER_TICK, WheelLine};

impl Leg {
    /// Travel of the axle's wheels for so many counts \[m\].
    pub(super) fn of_counts(&self, counts: [f64; 2]) -> WheelTravel {
        let [first, second] = self.counting.per_count;
        WheelTravel {
            left: counts[0] * first.left + counts[1] * second.left,
            right: counts[0] * first.right + counts[1] * second.right,
        }
    }

    /// Travel of the axle's wheels along a line of the counters, fractions of counts included \[m\].
    pub(super) fn rolled(&self, line: &WheelLine) -> WheelTravel {
        self.of_counts(line.travel().map(|units| units as f64 / UNITS_PER_TICK as f64))
    }
}

impl Course {
    /// Travel of the axle's wheels in move `index` by whole counts \[m\].
    ///
    /// If only one counter moves, as on every move of the paper's paths, the odometry gets this result at any sampling rate. If both move,
    /// the order of ticks is neglected, which is at most half a tick of distance.
    pub(super) fn counted(&self, index: usize) -> WheelTravel {
        let before = index.checked_sub(1).map_or([0; 2], |before| self.legs[before].stop);
        let leg = &self.legs[index];
        leg.of_counts([0, 1].map(|counter| (leg.stop[counter] - before[counter]) as f64))
    }
}
