//! Eight readings at a time.
//!
//! At a constant rate a wheel's count changes by one of two neighbouring numbers, and which of them is a carry of its
//! phase. Eight carries are a word of eight bits, and only 76 such words can occur: the factors of length eight of all
//! mechanical words, the same digital lines as in the word of ticks. So the eight readings of both wheels are one of
//! 76 x 76 rigid motions, and these are worked out once for each pair of rates.
//!
//! With equal tick lengths every heading is a whole multiple of δ/b. Its cosine and sine come from a second table, and
//! what remains for eight readings is one complex product and an integer sum: no rounding is carried along. The four products
//! of real numbers in it are summed each for itself and put together at the end.

use super::carries::{Carries, OneByOne, WORD};
use super::constant_rate::{EqualPieces, PoseIncrement};
use super::directions::Directions;
use super::{TickGeometry, Update};
use crate::engine::Instructions;

#[cfg(target_arch = "x86_64")]
mod x86;

/// Words of eight carries at a constant rate.
const WORDS: usize = 76;

/// Tables of rates kept at the same time; 92 KB each.
const KEPT: usize = 16;

/// Segments with fewer readings are not worth a table.
const FEWEST_READINGS: u32 = 64;

/// What a carry word of one wheel means: in the lower half what it adds to the place of a pair of words among the possible ones,
/// in the upper half by how many ticks it turns the robot. So one addition adds both.
type Rank = i64;

/// The words that can occur, in numerical order.
const POSSIBLE: [u8; WORDS] = {
    let mut possible = [0; WORDS];
    let (mut word, mut place) = (0, 0);
    while word < 256 {
        if balanced(word as u8) {
            possible[place] = word as u8;
            place += 1;
        }
        word += 1;
    }
    assert!(place == WORDS);
    possible
};

/// The ranks of the words of each wheel as it turns. Words that cannot occur have none.
static LEFT_FORWARD: [Rank; 256] = ranks(1, -1);
static LEFT_BACKWARD: [Rank; 256] = ranks(1, 1);
static RIGHT_FORWARD: [Rank; 256] = ranks(WORDS, 1);
static RIGHT_BACKWARD: [Rank; 256] = ranks(WORDS, -1);

const fn ranks(stride: usize, sign: i64) -> [Rank; 256] {
    let mut ranks = [0; 256];
    let mut place = 0;
    while place < WORDS {
        let word = POSSIBLE[place];
        ranks[word as usize] = (sign * word.count_ones() as i64) << 32 | (stride * place) as i64;
        place += 1;
    }
    ranks
}

/// Whether any two stretches of equal length have as many ones as each other, give or take one: the mark of mechanical
/// words (Morse & Hedlund 1940).
const fn balanced(word: u8) -> bool {
    let mut length = 1;
    while length < 8 {
        let mask = (1_u32 << length) - 1;
        let (mut least, mut most) = (8, 0);
        let mut start = 0;
        while start + length <= 8 {
            let ones = (word as u32 >> start & mask).count_ones();
            least = if ones < least { ones } else { least };
            most = if ones > most { ones } else { most };
            start += 1;
        }
        if most > least + 1 {
            return false;
        }
        length += 1;
    }
    true
}

/// The key of a table of motions, for a given geometry: whole ticks per reading and direction of each wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rates {
    whole: [i64; 2],
    sign: [i64; 2],
}

/// The motions of one and of eight readings at a pair of rates.
#[derive(Clone, Debug)]
struct Motions {
    rates: Rates,
    /// By left carry + 2 right carry.
    single: [PoseIncrement; 4],
    /// By place of the left word + 76 times place of the right one.
    eight: Vec<Factors>,
}

/// What the cosine, sine, cosine and sine of a heading are multiplied by to turn a translation \[m\]: x, -y, y, x.
type Factors = [f64; 4];

/// Sums of these products \[m\].
type Products = [f64; 4];

#[inline(always)]
fn factors(x: f64, y: f64) -> Factors {
    [x, -y, y, x]
}

/// The sums and one more translation, turned into a direction.
#[inline(always)]
fn and_turned(sums: Products, [cosine, sine]: [f64; 2], [a, b, c, d]: Factors) -> Products {
    [sums[0] + cosine * a, sums[1] + sine * b, sums[2] + cosine * c, sums[3] + sine * d]
}

impl Motions {
    fn new(geometry: &TickGeometry, update: Update, pieces: &EqualPieces) -> Motions {
        let single = pieces.steps(geometry, update);
        // Four readings first, for all pairs of half words.
        let half_words: Vec<PoseIncrement> = (0..256_usize)
            .map(|pair| {
                (0..4).fold(PoseIncrement::IDENTITY, |motion, i| {
                    motion.then(&single[(pair >> i & 1) + 2 * (pair >> (4 + i) & 1)])
                })
            })
            .collect();
        let eight = POSSIBLE
            .map(usize::from)
            .iter()
            .flat_map(|right| POSSIBLE.map(usize::from).map(|left| (left, *right)))
            .map(|(left, right)| {
                let motion =
                    half_words[(left & 15) + 16 * (right & 15)].then(&half_words[(left >> 4) + 16 * (right >> 4)]);
                factors(motion.x, motion.y)
            })
            .collect();
        Motions { rates: Rates { whole: pieces.whole, sign: pieces.sign }, single, eight }
    }
}

/// A walk in words of eight readings, one pair of words after the other.
struct Walk<'a> {
    left: &'a [Rank; 256],
    right: &'a [Rank; 256],
    /// As of [`Motions::eight`].
    motions: &'a [Factors],
    directions: &'a [[f64; 2]],
    /// Place of heading 0 among the directions.
    origin: i64,
    /// Ticks that the robot turns in eight readings without a carry.
    whole: i64,
}

/// The end of a walk.
struct Reached {
    /// By the words in even and in odd places: two sums, so that additions do not wait for each other.
    ends: [Products; 2],
    /// Place of the heading among the directions.
    heading: i64,
}

impl Walk<'_> {
    #[inline(always)]
    fn take(&self, sums: Products, heading: &mut i64, left: u8, right: u8) -> Products {
        let rank = self.left[usize::from(left)] + self.right[usize::from(right)];
        let sums = and_turned(sums, self.directions[*heading as usize], self.motions[rank as u32 as usize]);
        *heading += self.whole + (rank >> 32);
        sums
    }

    /// Takes so many words of each wheel.
    #[inline(always)]
    fn along<C: Carries>(&self, [mut left, mut right]: [C; 2], words: u32) -> Reached {
        let (mut even, mut odd, mut heading) = ([0.0; 4], [0.0; 4], self.origin);
        for _ in 0..words / 2 {
            even = self.take(even, &mut heading, left.word(), right.word());
            odd = self.take(odd, &mut heading, left.word(), right.word());
        }
        if words % 2 == 1 {
            even = self.take(even, &mut heading, left.word(), right.word());
        }
        Reached { ends: [even, odd], heading }
    }

    fn along_by(&self, instructions: Instructions, pieces: &EqualPieces, words: u32) -> Reached {
        #[cfg(target_arch = "x86_64")]
        match instructions {
            // SAFETY: `instructions` is never more than what the machine was found to have.
            Instructions::Avx512 => return unsafe { x86::walk_by_eight(self, pieces, words) },
            // SAFETY: as above.
            Instructions::Avx2 => return unsafe { x86::walk_by_four(self, pieces, words) },
            Instructions::Portable => {}
        }
        let _ = instructions;
        self.along([0, 1].map(|i| OneByOne::new(pieces.phase[i], pieces.rest[i])), words)
    }
}

/// Scratch memory for segments at constant rates. Its content changes the time for a segment, never its result.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    motions: Vec<Motions>,
    next_replaced: usize,
}

impl Blocks {
    /// Whether these pieces can be done eight at a time: headings must be multiples of one angle, and not too many.
    pub fn suit(geometry: &TickGeometry, pieces: &EqualPieces, counts: [i64; 2]) -> bool {
        pieces.readings >= FEWEST_READINGS && Directions::suit(geometry, counts)
    }

    /// End of the pieces: x, y \[m\]. `directions` must cover their headings.
    pub fn end(
        &mut self,
        geometry: &TickGeometry,
        update: Update,
        instructions: Instructions,
        directions: &Directions,
        pieces: &EqualPieces,
    ) -> (f64, f64) {
        let motions = self.find_motions(geometry, update, pieces);
        let motions = &self.motions[motions];

        let [left_sign, right_sign] = pieces.sign;
        let whole = right_sign * pieces.whole[1] - left_sign * pieces.whole[0];
        let (directions, origin) = directions.table();
        let walk = Walk {
            left: if left_sign > 0 { &LEFT_FORWARD } else { &LEFT_BACKWARD },
            right: if right_sign > 0 { &RIGHT_FORWARD } else { &RIGHT_BACKWARD },
            motions: &motions.eight,
            directions,
            origin,
            whole: 8 * whole,
        };
        let Reached { ends: [even, mut odd], mut heading } =
            walk.along_by(instructions, pieces, pieces.readings / WORD);

        let done = u64::from(pieces.readings / WORD * WORD);
        let mut phase = [0, 1].map(|i| pieces.phase[i].wrapping_add(pieces.rest[i].wrapping_mul(done)));
        for _ in done..u64::from(pieces.readings) {
            let mut carries = [false; 2];
            for wheel in 0..2 {
                (phase[wheel], carries[wheel]) = phase[wheel].overflowing_add(pieces.rest[wheel]);
            }
            let [left, right] = carries;
            let step = &motions.single[usize::from(left) + 2 * usize::from(right)];
            odd = and_turned(odd, directions[heading as usize], factors(step.x, step.y));
            heading += whole + right_sign * i64::from(right) - left_sign * i64::from(left);
        }
        ((even[0] + odd[0]) + (even[1] + odd[1]), (even[2] + odd[2]) + (even[3] + odd[3]))
    }

    /// The place of the motions at these rates among those kept.
    fn find_motions(&mut self, geometry: &TickGeometry, update: Update, pieces: &EqualPieces) -> usize {
        let rates = Rates { whole: pieces.whole, sign: pieces.sign };
        if let Some(found) = self.motions.iter().position(|motions| motions.rates == rates) {
            return found;
        }
        let motions = Motions::new(geometry, update, pieces);
        if self.motions.len() < KEPT {
            self.motions.push(motions);
            return self.motions.len() - 1;
        }
        let replaced = self.next_replaced;
        self.next_replaced = (replaced + 1) % KEPT;
        self.motions[replaced] = motions;
        replaced
    }
}
