//! Sobol's sequence, scrambled.

mod joe_kuo;

use crate::random::Stream;
use joe_kuo::JOE_KUO;
use rand::Rng;

/// Purpose of the streams that scrambles are drawn from.
const SCRAMBLE: u64 = 20;

const BITS: usize = 32;

/// Points that fill the unit cube evenly: Sobol's sequence with the direction numbers of Joe & Kuo (2008), in the order of its
/// Gray code, under Owen's nested uniform scrambling.
///
/// Each bit of a coordinate is flipped or not by a hash of the bits before it, so that every scrambled point is uniform in
/// the cube, and any 2^m of them keep the evenness of the sequence. Bits beyond the 32nd come from the hash of all others.
///
/// Source: Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences" (1995); hashing as in Burley, "Practical hash-based
/// Owen scrambling" (2020), though here bit by bit and so exactly nested.
///
/// ```
/// use umbmark_core::sensitivity::SobolPoints;
/// let points = SobolPoints::scrambled(2, 7, 0);
/// let mut point = [0.0; 2];
/// points.point(0, &mut point);
/// assert!(point.iter().all(|u| (0.0..1.0).contains(u)));
/// ```
#[derive(Clone, Debug)]
pub struct SobolPoints {
    directions: Vec<[u32; BITS]>,
    /// The key of each dimension's scramble; none for the plain sequence.
    keys: Option<Vec<u64>>,
}

impl SobolPoints {
    /// The most dimensions that direction numbers are there for.
    pub const MOST_DIMENSIONS: usize = JOE_KUO.len() + 1;

    /// How many points a sequence has.
    pub const COUNT: u64 = 1 << BITS;

    /// The sequence itself, whose first point is the origin.
    ///
    /// # Panics
    /// For more than [`SobolPoints::MOST_DIMENSIONS`] dimensions.
    pub fn plain(dimensions: usize) -> SobolPoints {
        assert!(dimensions <= Self::MOST_DIMENSIONS, "{dimensions} dimensions");
        SobolPoints { directions: (0..dimensions).map(directions).collect(), keys: None }
    }

    /// The sequence under one of the independent scrambles of a seed.
    ///
    /// # Panics
    /// For more than [`SobolPoints::MOST_DIMENSIONS`] dimensions.
    pub fn scrambled(dimensions: usize, seed: u64, scramble: u64) -> SobolPoints {
        let mut stream = Stream::new(seed, SCRAMBLE, scramble);
        let keys = (0..dimensions).map(|_| stream.next_u64()).collect();
        SobolPoints { keys: Some(keys), ..SobolPoints::plain(dimensions) }
    }

    /// Point number `index`, below [`SobolPoints::COUNT`], into the coordinates of `point`: in [0, 1), and within the open
    /// interval where scrambled.
    pub fn point(&self, index: u64, point: &mut [f64]) {
        let gray = (index ^ (index >> 1)) as u32;
        for (dimension, (coordinate, directions)) in point.iter_mut().zip(&self.directions).enumerate() {
            let (mut bits, mut rest) = (0, gray);
            while rest != 0 {
                bits ^= directions[rest.trailing_zeros() as usize];
                rest &= rest - 1;
            }
            *coordinate = match &self.keys {
                None => f64::from(bits) / Self::COUNT as f64,
                Some(keys) => scrambled(bits, keys[dimension]),
            };
        }
    }
}

/// The direction numbers of a dimension, from 0, as binary fractions.
fn directions(dimension: usize) -> [u32; BITS] {
    let mut numbers = [0; BITS];
    let Some((inner, first)) = dimension.checked_sub(1).map(|place| JOE_KUO[place]) else {
        return std::array::from_fn(|k| 1 << (BITS - 1 - k));
    };
    let degree = first.len();
    for k in 0..BITS {
        numbers[k] = if k < degree {
            first[k] << (BITS - 1 - k)
        } else {
            let carried = |l: &usize| inner >> (degree - 1 - l) & 1 == 1;
            let old = numbers[k - degree];
            (1..degree).filter(carried).fold(old ^ (old >> degree), |sum, l| sum ^ numbers[k - l])
        };
    }
    numbers
}

/// A coordinate's bits after its scramble, as a number in (0, 1).
fn scrambled(bits: u32, key: u64) -> f64 {
    let mut flips = 0;
    for depth in 0..BITS {
        // The node of the binary tree at which this bit decides: the bits before it, with a 1 in front.
        let node = (1 << depth) | (u64::from(bits) >> (BITS - depth));
        flips |= ((mix(key ^ mix(node)) >> 63) as u32) << (BITS - 1 - depth);
    }
    let beyond = mix(key ^ mix((1 << BITS) | u64::from(bits))) >> 44;
    let word = u64::from(bits ^ flips) << 20 | beyond;
    (word as f64 + 0.5) / (1_u64 << 52) as f64
}

/// The finaliser of SplitMix64: a bijection that leaves no bit recognisable.
fn mix(mut word: u64) -> u64 {
    word = word.wrapping_add(0x9E37_79B9_7F4A_7C15);
    word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(points: &SobolPoints, dimensions: usize, count: u64) -> Vec<Vec<f64>> {
        let point = |index| {
            let mut point = vec![0.0; dimensions];
            points.point(index, &mut point);
            point
        };
        (0..count).map(point).collect()
    }

    /// `scipy.stats.qmc.Sobol(128, scramble=False, bits=32).random(1024)`, SciPy 1.17.1: row 1000 at some dimensions, and
    /// all 131 072 numbers, each added to 6364136223846793005 times the sum so far, modulo 2^64.
    #[test]
    fn the_plain_sequence_is_that_of_scipy() {
        let rows = points(&SobolPoints::plain(128), 128, 1024);
        let word = |u: f64| (u * SobolPoints::COUNT as f64) as u64;
        let some = [0, 1, 2, 5, 20, 63, 100, 127].map(|dimension| word(rows[1000][dimension]));
        let expected = [943718400, 415236096, 2227175424, 3896508416, 2243952640, 1916796928, 3300917248, 2336227328];
        assert_eq!(some, expected);
        let numbers = rows.iter().flatten().map(|u| word(*u));
        let digest = numbers.fold(0_u64, |sum, n| sum.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(n));
        assert_eq!(digest, 13_418_375_309_070_172_160);
    }

    /// Nested scrambling moves dyadic intervals as wholes: 2^m points that had one in each, still have, and two points that
    /// shared one still do.
    #[test]
    fn a_scramble_keeps_every_dyadic_box_as_full_as_it_was() {
        let (plain, scrambled) = (SobolPoints::plain(6), SobolPoints::scrambled(6, 3, 1));
        let (before, after) = (points(&plain, 6, 256), points(&scrambled, 6, 256));
        for (one, two) in [(0, 1), (2, 5), (3, 4)] {
            for bits in 0..=8 {
                let counts = |rows: &[Vec<f64>]| {
                    let (wide, high) = ((1 << bits) as f64, (1 << (8 - bits)) as f64);
                    let mut counts = vec![0; 256];
                    for row in rows {
                        counts[(row[one] * wide) as usize + (row[two] * high) as usize * (1 << bits)] += 1;
                    }
                    counts.sort_unstable();
                    counts
                };
                assert_eq!(counts(&before), counts(&after), "{one} {two} {bits}");
            }
        }
        assert_ne!(before, after);
    }

    /// Over 4000 scrambles, seed 5, each point is uniform and two of them are nearly uncorrelated: mean and correlation
    /// within 4 standard errors (p < 1e-4 each by chance).
    #[test]
    fn each_scrambled_point_is_uniform_over_scrambles() {
        let n = 4000;
        let mut sums = [0.0; 4];
        for scramble in 0..n {
            let rows = points(&SobolPoints::scrambled(2, 5, scramble), 2, 3);
            let [a, b] = [rows[2][0] - 0.5, rows[2][1] - 0.5];
            sums = [sums[0] + a, sums[1] + b, sums[2] + a * b, sums[3] + a * a];
        }
        let [a, b, ab, aa] = sums.map(|sum| sum / n as f64);
        let of_mean = 1.0 / (12.0 * n as f64).sqrt();
        assert!(a.abs() < 4.0 * of_mean && b.abs() < 4.0 * of_mean, "{a} {b}");
        assert!(ab.abs() < 4.0 / 12.0 / (n as f64).sqrt(), "{ab}");
        assert!((aa * 12.0 - 1.0).abs() < 4.0 * 0.9 / (n as f64).sqrt(), "{aa}");
    }

    /// A smooth product over ten dimensions: 1024 scrambled points err a tenth of what as many random ones do, or less.
    #[test]
    fn scrambled_points_integrate_far_better_than_random_ones() {
        let product = |point: &[f64]| point.iter().map(|u| 1.0 + 0.3 * (u - 0.5)).product::<f64>() - 1.0;
        let error = |estimate: &dyn Fn(u64) -> f64| ((0..20).map(|i| estimate(i).powi(2)).sum::<f64>() / 20.0).sqrt();
        let of = |rows: Vec<Vec<f64>>| rows.iter().map(|row| product(row)).sum::<f64>() / rows.len() as f64;
        let even = error(&|i| of(points(&SobolPoints::scrambled(10, 2, i), 10, 1024)));
        let random = error(&|i| {
            let mut stream = Stream::new(2, 0, i);
            of((0..1024).map(|_| (0..10).map(|_| stream.uniform()).collect()).collect())
        });
        assert!(even < 0.1 * random, "{even} {random}");
    }
}
