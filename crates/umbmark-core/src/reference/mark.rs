//! Marks on the floor.

use super::{Kind, Told};

pub(super) static KIND: Kind = Kind {
    name: "mark",
    about: "a mark on the floor, or a corner of two walls, that the robot is driven onto: where a drive began and ended",
    position: Told::AtEnds,
    heading: Told::AtEnds,
    shows: "ends show E_d and E_b/E_s; on a closed path they do not separate E_b from E_s, and what happens on the way shows only by what it \
            leaves at the end",
};
