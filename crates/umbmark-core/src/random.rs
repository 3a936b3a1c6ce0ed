//! Random streams that depend on nothing but the seed, the purpose and the trial.

mod ziggurat;

use rand::rand_core::{Infallible, TryRng};
use rand::{Rng, RngExt};
use rand_distr::{ChiSquared, Distribution, StandardNormal};

/// A counter-based random stream: Philox4x64-10.
///
/// The key is (seed, purpose), the last counter word is the trial. So the draws of one trial depend on no other trial,
/// no thread and no chunk, and drawing more for one purpose (bumps, say) moves no draw of another. The raw words equal
/// those of `numpy.random.Philox(key=[seed, purpose], counter=[0, 0, 0, trial])`.
///
/// Source: Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11.
#[derive(Clone, Debug)]
pub struct Stream {
    key: [u64; 2],
    counter: [u64; 4],
    /// Words worked out ahead, those from `next` to `end` not yet taken.
    words: [u64; AHEAD],
    next: usize,
    end: usize,
}

/// Words worked out ahead at most.
const AHEAD: usize = 32;

/// Words of a block of Philox.
const BLOCK: usize = 4;

/// Blocks worked out together: their rounds, each a chain of multiplications, overlap.
const TOGETHER: usize = 2;

impl Stream {
    /// The stream of a trial for one purpose.
    #[inline]
    pub fn new(seed: u64, purpose: u64, trial: u64) -> Stream {
        Stream { key: [seed, purpose], counter: [0, 0, 0, trial], words: [0; AHEAD], next: 0, end: 0 }
    }

    /// A draw from the standard normal distribution (ziggurat).
    ///
    /// Not inlined, so that it comes back in a register: draws that go through memory one by one and are read in pairs make
    /// the reader wait.
    #[inline(never)]
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(self)
    }

    /// A draw from the χ² distribution with this many degrees of freedom, which must be positive; NaN otherwise.
    pub fn chi_squared(&mut self, freedom: f64) -> f64 {
        ChiSquared::new(freedom).map_or(f64::NAN, |distribution| distribution.sample(self))
    }

    /// As many draws of [`Stream::normal`] as there are places, the same bits as one by one.
    pub fn normals(&mut self, draws: &mut [f64]) {
        let table = ziggurat::table();
        let mut rest = draws;
        while !rest.is_empty() {
            if self.next == self.end {
                self.refill(rest.len());
            }
            let taken = ziggurat::take_plain(table, &self.words[self.next..self.end], rest);
            self.next += taken;
            rest = &mut rest[taken..];
            if self.next < self.end
                && let Some(draw) = rest.first_mut()
            {
                *draw = self.normal();
                rest = &mut rest[1..];
            }
        }
    }

    /// A draw from the uniform distribution on [0, 1).
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        self.random()
    }

    /// Works out so many words, or as many as there is room for. Not inlined, so that taking a word is.
    #[inline(never)]
    fn refill(&mut self, wanted: usize) {
        let [mut first, rest @ ..] = self.counter;
        self.next = 0;
        self.end = wanted.next_multiple_of(TOGETHER * BLOCK).min(AHEAD);
        for words in self.words[..self.end].chunks_exact_mut(TOGETHER * BLOCK) {
            let counter = |i: usize| first.wrapping_add(1 + i as u64);
            let blocks = philox::<TOGETHER>(std::array::from_fn(|i| [counter(i), rest[0], rest[1], rest[2]]), self.key);
            words.copy_from_slice(blocks.as_flattened());
            first = counter(TOGETHER - 1);
        }
        self.counter[0] = first;
    }
}

/// Ten rounds of Philox on blocks of four 64-bit words.
#[inline(always)]
fn philox<const N: usize>(mut blocks: [[u64; BLOCK]; N], [mut k0, mut k1]: [u64; 2]) -> [[u64; BLOCK]; N] {
    const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
    const WEYL: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];
    for _ in 0..10 {
        for block in &mut blocks {
            let [c0, c1, c2, c3] = *block;
            let p0 = u128::from(MULTIPLIERS[0]) * u128::from(c0);
            let p1 = u128::from(MULTIPLIERS[1]) * u128::from(c2);
            *block = [(p1 >> 64) as u64 ^ c1 ^ k0, p1 as u64, (p0 >> 64) as u64 ^ c3 ^ k1, p0 as u64];
        }
        (k0, k1) = (k0.wrapping_add(WEYL[0]), k1.wrapping_add(WEYL[1]));
    }
    blocks
}

impl TryRng for Stream {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.next_u64() as u32)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        if self.next == self.end {
            self.refill(1);
        }
        let word = self.words[self.next % AHEAD];
        self.next += 1;
        Ok(word)
    }

    fn try_fill_bytes(&mut self, destination: &mut [u8]) -> Result<(), Infallible> {
        for chunk in destination.chunks_mut(8) {
            let bytes = self.next_u64().to_le_bytes();
            chunk.copy_from_slice(&bytes[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raw_words_are_those_of_numpy_philox() {
        // np.random.Philox(key=[42, 0], counter=[0, 0, 0, 7]).random_raw(14)
        let expected: [u64; 14] = [
            11_119_611_033_881_747_937,
            5_872_490_000_409_827_705,
            9_076_633_787_134_743_578,
            1_991_237_858_349_935_211,
            18_153_647_140_768_459_483,
            16_539_072_371_841_872_151,
            3_968_078_018_016_975_680,
            1_429_073_118_286_788_233,
            11_639_969_361_856_473_151,
            14_304_417_508_335_185_442,
            10_503_572_497_895_252_717,
            10_778_017_486_778_164_243,
            16_880_464_031_188_650_337,
            17_283_046_439_037_632_326,
        ];
        let mut stream = Stream::new(42, 0, 7);
        assert_eq!(std::array::from_fn(|_| stream.next_u64()), expected);
    }

    #[test]
    fn draws_in_bulk_are_those_one_by_one_and_leave_the_stream_where_they_do() {
        let (mut bulk, mut single) = (Stream::new(9, 2, 5), Stream::new(9, 2, 5));
        let mut draws = [0.0; 70];
        // Long enough for the tail of the distribution, which comes once in 4000 draws, to be met a hundred times.
        for round in 0..10_000 {
            let draws = &mut draws[..round % 71];
            bulk.normals(draws);
            for draw in draws {
                assert_eq!(draw.to_bits(), single.normal().to_bits(), "round {round}");
            }
            if round % 3 == 0 {
                assert_eq!(bulk.next_u64(), single.next_u64(), "round {round}");
            }
        }
    }

    #[test]
    fn seed_purpose_and_trial_each_make_another_stream() {
        let first = |seed, purpose, trial| Stream::new(seed, purpose, trial).next_u64();
        let all = [first(0, 0, 0), first(1, 0, 0), first(0, 1, 0), first(0, 0, 1)];
        for i in 0..4 {
            assert!(all[i + 1..].iter().all(|w| *w != all[i]));
        }
    }

    /// Kolmogorov-Smirnov against the normal distribution: n = 20 000, seed 3; D below 1.63/sqrt(n) is passed with
    /// probability 0.99 by a correct sampler.
    #[test]
    fn normal_draws_are_normal() {
        use statrs::distribution::{ContinuousCDF, Normal};
        let n = 20_000;
        let mut stream = Stream::new(3, 0, 0);
        let mut draws: Vec<f64> = (0..n).map(|_| stream.normal()).collect();
        draws.sort_by(f64::total_cmp);
        let normal = Normal::new(0.0, 1.0).unwrap();
        let d = draws.iter().enumerate().fold(0.0_f64, |d, (i, x)| {
            let p = normal.cdf(*x);
            d.max((p - i as f64 / n as f64).abs()).max(((i + 1) as f64 / n as f64 - p).abs())
        });
        assert!(d < 1.63 / (n as f64).sqrt(), "{d}");
        // The sampler is pinned: another value here is a value-breaking change.
        assert_eq!(Stream::new(42, 0, 7).normal().to_bits(), 4_595_199_739_288_332_353);
    }
}
