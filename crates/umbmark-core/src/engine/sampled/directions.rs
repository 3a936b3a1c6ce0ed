//! Headings in whole ticks.
//!
//! With equal tick lengths every heading is a whole multiple of δ/b. Taken from a table, its cosine and sine need no heading
//! before it: no rounding is carried along, and no reading waits for the last.

use crate::engine::TickGeometry;
use crate::geometry::Real;

/// Headings up to so many ticks \[δ/b\] are tabulated: 1 MB for each direction.
const LIMIT: i64 = 1 << 16;

/// Cosine and sine of the multiples of δ/b from `-reach` to `reach`.
#[derive(Clone, Debug, Default)]
pub(super) struct Directions {
    reach: i64,
    table: Vec<[f64; 2]>,
}

impl Directions {
    /// Whether headings on the way to these counts can be tabulated: they must be multiples of one angle, and not too many.
    pub fn suit(geometry: &TickGeometry, counts: [i64; 2]) -> bool {
        geometry.left() == geometry.right() && (counts[1] - counts[0]).abs() < LIMIT
    }

    /// Makes room for all headings along a straight line of the wheels to these counts.
    pub fn reach_to(&mut self, counts: [i64; 2], geometry: &TickGeometry) {
        // Between readings both counters round down, so on the way the heading strays from the line by less than 2.
        let reach = (counts[1] - counts[0]).abs() + 2;
        if self.table.is_empty() || self.reach < reach {
            self.reach = (reach as u64).next_power_of_two() as i64;
            self.table = (-self.reach..=self.reach)
                .map(|ticks| {
                    let (sine, cosine) = geometry.heading([0, ticks]).sine_cosine();
                    [cosine, sine]
                })
                .collect();
        }
    }

    /// \[cosine, sine\] of all of them, and the place of heading 0.
    #[inline(always)]
    pub fn table(&self) -> (&[[f64; 2]], i64) {
        (&self.table, self.reach)
    }
}

/// A translation turned into a direction.
#[inline(always)]
pub(super) fn turned([cosine, sine]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [cosine * x - sine * y, sine * x + cosine * y]
}

#[inline(always)]
pub(super) fn sum(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
