//! Headings without positions.

use super::{Kind, Told};

pub(super) static KIND: Kind = Kind {
    name: "heading",
    about: "a compass, or an inertial unit that gives its heading in the room: how the robot is turned, and not where it is",
    position: Told::Nothing,
    heading: Told::InRoom,
    shows: "headings show E_d and E_b as far as E_s = 1, and what turns the robot; they do not show E_s, nor what only moves it. Positions in \
            the tables are those of the counted way along the measured headings",
};
