//! Turns from each measurement to the next.

use super::{Kind, Told};

pub(super) static KIND: Kind = Kind {
    name: "gyro",
    about: "a gyro: how fast the robot turns, with a rate of its own that drifts",
    position: Told::Nothing,
    heading: Told::Steps,
    shows: "turns show E_d and E_b as far as E_s = 1 and the gyro's scale is right, and what turns the robot; they do not show E_s, nor what \
            only moves it. The gyro's own rate is fitted in each run, and is known best where the robot also rests. Positions in the tables are \
            those of the counted way along the measured headings",
};
