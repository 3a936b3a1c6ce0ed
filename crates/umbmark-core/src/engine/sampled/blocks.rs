//! Eight readings at a time.
//!
//! At a constant rate a wheel's count changes by one of two neighbouring numbers, and which of them is a carry of its
//! phase. Eight carries are a word of eight bits, and only 76 such words can occur: the factors of length eight of all
//! mechanical words, the same digital lines as in the word of ticks. So the eight readings of both wheels are one of
//! 76 x 76 rigid motions, and these are worked out once for each pair of rates.
//!
//! With equal tick lengths every heading is a whole multiple of δ/b. Its cosine and sine come from a second table, and
//! what remains for eight readings is one complex product and an integer sum: no rounding is carried along.

use super::carries::{WORD, carry_words};
use super::constant_rate::{EqualPieces, Step};
use super::directions::{Directions, sum, turned};
use super::{TickGeometry, Update};
use crate::engine::Instructions;

/// Words of eight carries at a constant rate.
const WORDS: usize = 76;

/// Tables of rates kept at the same time; 92 KB each.
const KEPT: usize = 16;

/// Segments with fewer readings are not worth a table.
const FEWEST_READINGS: u32 = 64;

/// What a carry word means: its place among the possible ones, and by how many ticks it turns the robot.
#[derive(Clone, Copy)]
struct Rank {
    column: u16,
    row: u16,
    turn: i32,
}

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

/// The ranks of the words of a wheel whose ticks turn the robot counter-clockwise: a right one forward or a left one
/// backward. Words that cannot occur have none.
static COUNTER_CLOCKWISE: [Rank; 256] = ranks(1);
static CLOCKWISE: [Rank; 256] = ranks(-1);

const fn ranks(sign: i32) -> [Rank; 256] {
    let mut ranks = [Rank { column: 0, row: 0, turn: 0 }; 256];
    let mut place = 0;
    while place < WORDS {
        let word = POSSIBLE[place];
        ranks[word as usize] =
            Rank { column: place as u16, row: (WORDS * place) as u16, turn: sign * word.count_ones() as i32 };
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

/// What a table of motions depends on, beside the geometry: whole ticks per reading and direction of each wheel.
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
    single: [Step; 4],
    /// Translation \[m\] by place of the left word + 76 times place of the right one.
    eight: Vec<[f64; 2]>,
}

impl Motions {
    fn new(geometry: &TickGeometry, update: Update, pieces: &EqualPieces) -> Motions {
        let single = pieces.steps(geometry, update);
        // Four readings first, for all pairs of half words.
        let half_words: Vec<Step> = (0..256_usize)
            .map(|pair| {
                (0..4)
                    .fold(Step::IDENTITY, |motion, i| motion.then(&single[(pair >> i & 1) + 2 * (pair >> (4 + i) & 1)]))
            })
            .collect();
        let eight = POSSIBLE
            .map(usize::from)
            .iter()
            .flat_map(|right| POSSIBLE.map(usize::from).map(|left| (left, *right)))
            .map(|(left, right)| {
                let motion =
                    half_words[(left & 15) + 16 * (right & 15)].then(&half_words[(left >> 4) + 16 * (right >> 4)]);
                [motion.x, motion.y]
            })
            .collect();
        Motions { rates: Rates { whole: pieces.whole, sign: pieces.sign }, single, eight }
    }
}

/// Scratch memory for segments at constant rates. What is in it changes the time a segment takes, never its result.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    motions: Vec<Motions>,
    next_replaced: usize,
    words: [Vec<u8>; 2],
}

impl Blocks {
    /// Whether these pieces can be done eight at a time: headings must be multiples of one angle, and not too many.
    pub fn suit(geometry: &TickGeometry, pieces: &EqualPieces, counts: [i64; 2]) -> bool {
        pieces.readings >= FEWEST_READINGS && Directions::suit(geometry, counts)
    }

    /// Where the pieces lead: x, y \[m\]. `directions` reach to where they end.
    pub fn end(
        &mut self,
        geometry: &TickGeometry,
        update: Update,
        instructions: Instructions,
        directions: &Directions,
        pieces: &EqualPieces,
    ) -> (f64, f64) {
        let words = (pieces.readings / WORD) as usize;
        for wheel in 0..2 {
            self.words[wheel].resize(words, 0);
            carry_words(instructions, pieces.phase[wheel], pieces.rest[wheel], &mut self.words[wheel]);
        }
        let motions = self.find_motions(geometry, update, pieces);
        let motions = &self.motions[motions];

        let [left_sign, right_sign] = pieces.sign;
        let whole = right_sign * pieces.whole[1] - left_sign * pieces.whole[0];
        let (directions, mut heading) = directions.table();
        let ranks = |sign: i64| if sign > 0 { &COUNTER_CLOCKWISE } else { &CLOCKWISE };
        let (left_ranks, right_ranks) = (ranks(-left_sign), ranks(right_sign));
        let mut eight = |left: u8, right: u8| {
            let (left, right) = (left_ranks[usize::from(left)], right_ranks[usize::from(right)]);
            let motion = motions.eight[usize::from(left.column) + usize::from(right.row)];
            let turned = turned(directions[heading as usize], motion);
            heading += 8 * whole + i64::from(left.turn + right.turn);
            turned
        };
        // Two sums, so that one addition need not wait for the other.
        let (mut even, mut odd) = ([0.0; 2], [0.0; 2]);
        let (left_pairs, left_last) = self.words[0].as_chunks::<2>();
        let (right_pairs, right_last) = self.words[1].as_chunks::<2>();
        for (left, right) in left_pairs.iter().zip(right_pairs) {
            even = sum(even, eight(left[0], right[0]));
            odd = sum(odd, eight(left[1], right[1]));
        }
        for (left, right) in left_last.iter().zip(right_last) {
            even = sum(even, eight(*left, *right));
        }

        let done = u64::from(pieces.readings / WORD * WORD);
        let mut phase = [0, 1].map(|i| pieces.phase[i].wrapping_add(pieces.rest[i].wrapping_mul(done)));
        for _ in done..u64::from(pieces.readings) {
            let mut carries = [false; 2];
            for wheel in 0..2 {
                (phase[wheel], carries[wheel]) = phase[wheel].overflowing_add(pieces.rest[wheel]);
            }
            let [left, right] = carries;
            let step = &motions.single[usize::from(left) + 2 * usize::from(right)];
            odd = sum(odd, turned(directions[heading as usize], [step.x, step.y]));
            heading += whole + right_sign * i64::from(right) - left_sign * i64::from(left);
        }
        let [x, y] = sum(even, odd);
        (x, y)
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
