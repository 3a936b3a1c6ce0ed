//! Normal draws in bulk: the plain case of the ziggurat, without a branch, several words at once.
//!
//! The sampler of `rand_distr` stays the one that defines every draw. 99 of 100 words lie in the part of its layer where a
//! product with a number of its table is the draw; these are taken here, all others are left to it. The table is read off the
//! sampler itself.

use rand::rand_core::{Infallible, TryRng};
use rand_distr::{Distribution, StandardNormal};
use std::sync::LazyLock;

/// Layers of the ziggurat.
const LAYERS: usize = 256;

/// Half widths of the layers, widest first, and 0 for the top.
pub(super) type Table = [f64; LAYERS + 1];

/// Draws at once.
const WIDTH: usize = 8;

/// The sampler's table.
pub(super) fn table() -> &'static Table {
    static TABLE: LazyLock<Table> = LazyLock::new(|| {
        // A word of this mantissa and layer i is taken for u = 2^-20 of the width, whatever the layer: a draw by which the
        // width is known to the last bit.
        const SMALL: u64 = (1 << 51) + (1 << 31);
        let width = |layer: usize| {
            if layer == LAYERS {
                return 0.0;
            }
            let draw: f64 = StandardNormal.sample(&mut Given([SMALL << 12 | layer as u64, u64::MAX].into_iter()));
            draw * 1_048_576.0
        };
        std::array::from_fn(width)
    });
    &TABLE
}

/// A source of the words that it is given.
struct Given<I>(I);

impl<I: Iterator<Item = u64>> TryRng for Given<I> {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.try_next_u64().map(|word| word as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.0.next().unwrap_or(0))
    }

    fn try_fill_bytes(&mut self, destination: &mut [u8]) -> Result<(), Infallible> {
        destination.fill(0);
        Ok(())
    }
}

/// The draw of a word, and whether it is a plain one: half of the sign and the share of the width from the upper 52 bits, the layer from the
/// lowest eight.
#[inline(always)]
fn draw(table: &Table, word: u64) -> (f64, bool) {
    let layer = (word & 0xff) as usize;
    let share = f64::from_bits(word >> 12 | 2.0_f64.to_bits()) - 3.0;
    let draw = share * table[layer];
    (draw, draw.abs() < table[layer + 1])
}

/// Takes draws from words until one of them is not plain, or there are no more words or places, and returns how many.
#[inline]
pub(super) fn take_plain(table: &Table, words: &[u64], draws: &mut [f64]) -> usize {
    let count = words.len().min(draws.len());
    let (words, draws) = (&words[..count], &mut draws[..count]);
    let mut taken = 0;
    let (groups, _) = words.as_chunks::<WIDTH>();
    for (group, draws) in groups.iter().zip(draws.as_chunks_mut::<WIDTH>().0) {
        let mut all_plain = true;
        for (place, word) in draws.iter_mut().zip(group) {
            let plain;
            (*place, plain) = draw(table, *word);
            all_plain &= plain;
        }
        if !all_plain {
            break;
        }
        taken += WIDTH;
    }
    for (place, word) in draws[taken..].iter_mut().zip(&words[taken..]) {
        let plain;
        (*place, plain) = draw(table, *word);
        if !plain {
            break;
        }
        taken += 1;
    }
    taken
}
