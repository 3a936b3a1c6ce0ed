//! The reference: one tick after the other.
//!
//! Slow and obvious, sharing no code with the fast paths but the geometry's sine and cosine. It is public so that users can compare any
//! result with it.

use super::{Letter, Motion, TickGeometry, UNITS_PER_TICK, WheelLine};
use crate::geometry::Real;

/// The letters of the word of `line`, in the order in which the counters tick.
///
/// ```
/// use umbmark_core::engine::{Letter::*, WheelLine, oracle};
/// let line = WheelLine::from_ticks([0.0, 0.5], [3.0, 2.0])?;
/// assert_eq!(oracle::letters(&line).collect::<Vec<_>>(), [Right, Left, Left, Right, Left]);
/// # Ok::<(), umbmark_core::engine::EngineError>(())
/// ```
pub fn letters(line: &WheelLine) -> Letters {
    let forward = line.mirrored_forward();
    let (start, travel) = (forward.start().map(i128::from), forward.travel().map(i128::from));
    let unit = i128::from(UNITS_PER_TICK);
    // Wheel w ticks for the i-th time at λ = (i 2^32 - start_w) / travel_w: compare numerators over a common denominator.
    Letters {
        remaining: forward.counts(),
        next: [(unit - start[0]) * travel[1], (unit - start[1]) * travel[0]],
        period: [unit * travel[1], unit * travel[0]],
    }
}

/// Iterator over the letters of a word; see [`letters`].
#[derive(Clone, Debug)]
pub struct Letters {
    remaining: [i64; 2],
    next: [i128; 2],
    period: [i128; 2],
}

impl Iterator for Letters {
    type Item = Letter;

    fn next(&mut self) -> Option<Letter> {
        let letter = match self.remaining {
            [0, 0] => return None,
            [_, 0] => Letter::Left,
            [0, _] => Letter::Right,
            _ => match self.next[0].cmp(&self.next[1]) {
                std::cmp::Ordering::Less => Letter::Left,
                std::cmp::Ordering::Greater => Letter::Right,
                std::cmp::Ordering::Equal => Letter::Joint,
            },
        };
        for (wheel, other) in [(0, Letter::Right), (1, Letter::Left)] {
            if letter != other {
                self.remaining[wheel] -= 1;
                self.next[wheel] += self.period[wheel];
            }
        }
        Some(letter)
    }
}

/// The motion that the ticks along `line` report, tick by tick.
///
/// Each tick is an exact arc at the heading of its own counts; positions are summed with compensation. Nothing builds up:
/// the error stays near 1e-16 of the distance, plus the rounding of the headings.
pub fn motion(geometry: &TickGeometry, line: &WheelLine) -> Motion {
    let step = line.backward().map(|backward| if backward { -1 } else { 1 });
    let (mut counts, mut x, mut y) = ([0; 2], CompensatedSum::default(), CompensatedSum::default());
    for letter in letters(line) {
        let ticks = match letter {
            Letter::Left => [step[0], 0],
            Letter::Right => [0, step[1]],
            Letter::Joint => step,
        };
        let half = 0.5 * geometry.heading(ticks);
        let (sine, cosine) = (geometry.heading(counts) + half).sine_cosine();
        let chord = geometry.distance(ticks) * half.sinc_cos().0;
        x.add(chord * cosine);
        y.add(chord * sine);
        counts = [counts[0] + ticks[0], counts[1] + ticks[1]];
    }
    Motion::with_counts(x.value(), y.value(), counts, geometry)
}

/// Neumaier's summation: the rounding errors are added up beside the sum.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CompensatedSum {
    sum: f64,
    lost: f64,
}

impl CompensatedSum {
    #[inline]
    pub fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        let (large, small) = if self.sum.abs() >= value.abs() { (self.sum, value) } else { (value, self.sum) };
        self.lost += (large - sum) + small;
        self.sum = sum;
    }

    #[inline]
    pub fn value(&self) -> f64 {
        self.sum + self.lost
    }
}
