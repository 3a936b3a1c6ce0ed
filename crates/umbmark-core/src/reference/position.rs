//! Positions without headings.

use super::{Kind, Told};

pub(super) static KIND: Kind = Kind {
    name: "position",
    about: "GPS or RTK, UWB, a total station, a single marker: where a point of the robot is, and not how it is turned",
    position: Told::InRoom,
    heading: Told::Nothing,
    shows: "positions show E_d, E_b and E_s; the heading at START, the clock and, where the robot turns, the lever arm are fitted; turns on \
            the spot show only by the leg behind them, and the yaw of the tracked body does not show",
};
