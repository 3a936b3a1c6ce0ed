//! Pieces of true motion: first listed, then computed side by side, then chained run by run.
//!
//! The true motion of a stretch is a list of pieces with constant twist: a single piece if nothing interrupts the stretch, more if bumps or
//! a law that varies along the path cut it. The relative motion of a piece does not depend on the others. So the pieces of all runs of a
//! test are computed in one loop without a branch; only the products along each run are sequential.

use super::diffusion::Diffusion;
use crate::effect::WheelVariance;
use crate::engine::{Instructions, Motion};
use crate::geometry::{Displacement2, Pose2, by_width, sinc_cos_near_zero};

/// A motion with constant twist, whose end is then moved in the frame of its start and turned about itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Twist times time.
    pub motion: Displacement2,
    /// The noise at its end.
    pub noise: Noise,
}

/// How noise moves the end of a piece, seen from its start: (x, y) \[m\] and heading \[rad\].
#[derive(Clone, Copy, Debug)]
pub(super) enum Noise {
    /// Not at all.
    None,
    /// By a known displacement.
    Moves([f64; 3]),
    /// By wheel noise of this variance, with these draws from the standard normal distribution.
    Draws { variance: WheelVariance, normals: [f64; 3] },
}

/// Pieces side by side.
const WIDTH: usize = 8;

/// Some pieces as a structure of arrays, so that one instruction processes several of them.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
struct Block {
    forward: [f64; WIDTH],
    sideways: [f64; WIDTH],
    rotation: [f64; WIDTH],
    scatter: [[f64; WIDTH]; 3],
    /// Variances of the left and the right wheel, for pieces whose scatter is not yet computed.
    variance: [[f64; WIDTH]; 2],
    normals: [[f64; WIDTH]; 3],
    /// Whether any scatter is.
    draws: bool,
}

/// (sinc h, sin h, cos h) from q = h/2 within the polynomials' range, |q| <= π/4: no quarter or half turn is past it.
#[inline(always)]
fn from_half(q: f64) -> (f64, f64, f64) {
    let (sinc, cosine) = sinc_cos_near_zero(q);
    let sine = sinc * q;
    (sinc * cosine, 2.0 * sine * cosine, 1.0 - 2.0 * (sine * sine))
}

impl Block {
    fn set(&mut self, place: usize, piece: &Piece) {
        self.forward[place] = piece.motion.forward;
        self.sideways[place] = piece.motion.sideways;
        self.rotation[place] = piece.motion.rotation;
        let put = |rows: &mut [[f64; WIDTH]; 3], values: [f64; 3]| {
            rows.iter_mut().zip(values).for_each(|(row, value)| row[place] = value);
        };
        match piece.noise {
            Noise::None => {}
            Noise::Moves(scatter) => put(&mut self.scatter, scatter),
            Noise::Draws { variance, normals } => {
                self.draws = true;
                (self.variance[0][place], self.variance[1][place]) = (variance.left, variance.right);
                put(&mut self.normals, normals);
            }
        }
    }

    #[inline(always)]
    fn motion(&self, place: usize) -> Displacement2 {
        Displacement2 { forward: self.forward[place], sideways: self.sideways[place], rotation: self.rotation[place] }
    }

    #[inline(always)]
    fn variance(&self, place: usize) -> WheelVariance {
        WheelVariance { left: self.variance[0][place], right: self.variance[1][place] }
    }

    /// Computes the scatter of the pieces that have draws.
    #[inline(always)]
    fn spread(&mut self, rotation_per_metre: f64) {
        let mut any_large = false;
        for i in 0..WIDTH {
            let variance = self.variance(i);
            let draws = variance.left + variance.right > 0.0;
            let small = self.rotation[i].abs() <= std::f64::consts::FRAC_PI_2;
            any_large |= draws & !small;
            let diffusion = Diffusion::of_small_turn(&self.motion(i), &variance, rotation_per_metre);
            let scatter = diffusion.scatter([self.normals[0][i], self.normals[1][i], self.normals[2][i]]);
            for (row, value) in self.scatter.iter_mut().zip(scatter) {
                row[i] = if draws & small { value } else { row[i] };
            }
        }
        if any_large {
            self.spread_large(rotation_per_metre);
        }
    }

    /// The same for turns past a quarter, one by one.
    #[cold]
    fn spread_large(&mut self, rotation_per_metre: f64) {
        for i in 0..WIDTH {
            let variance = self.variance(i);
            if variance.left + variance.right > 0.0 && !(self.rotation[i].abs() <= std::f64::consts::FRAC_PI_2) {
                let diffusion = Diffusion::new(&self.motion(i), &variance, rotation_per_metre);
                let scatter = diffusion.scatter(self.normals.map(|row| row[i]));
                self.scatter.iter_mut().zip(scatter).for_each(|(row, value)| row[i] = value);
            }
        }
    }

    /// Rotation with scatter.
    #[inline(always)]
    fn turned(&self, place: usize) -> f64 {
        self.rotation[place] + self.scatter[2][place]
    }

    #[inline(always)]
    fn is_large(&self, place: usize) -> bool {
        !(self.rotation[place].abs() <= std::f64::consts::PI && self.turned(place).abs() <= std::f64::consts::PI)
    }

    /// Relative end poses of the pieces, including scatter.
    #[inline(always)]
    fn ends(&self, ends: &mut [Motion; WIDTH]) {
        let mut x = [0.0; WIDTH];
        let (mut y, mut cosines, mut sines) = (x, x, x);
        let mut any_large = false;
        for i in 0..WIDTH {
            any_large |= self.is_large(i);
            let (sinc, sine, cosine) = from_half(0.25 * self.rotation[i]);
            let (ahead, aside) = (sinc * self.forward[i], sinc * self.sideways[i]);
            x[i] = (cosine * ahead - sine * aside) + self.scatter[0][i];
            y[i] = (sine * ahead + cosine * aside) + self.scatter[1][i];
            let (_, sine, cosine) = from_half(0.25 * self.turned(i));
            cosines[i] = 1.0 - 2.0 * (sine * sine);
            sines[i] = 2.0 * sine * cosine;
        }
        for (i, end) in ends.iter_mut().enumerate() {
            // Number by number: a struct put together first is written and read again in different widths.
            (end.pose.x, end.pose.y, end.pose.heading) = (x[i], y[i], self.turned(i));
            (end.cosine, end.sine) = (cosines[i], sines[i]);
        }
        if any_large {
            self.replace_large(ends);
        }
    }

    /// Rotations past half a turn, one by one.
    #[cold]
    fn replace_large(&self, ends: &mut [Motion; WIDTH]) {
        for (i, motion) in ends.iter_mut().enumerate().filter(|(i, _)| self.is_large(*i)) {
            let end = Pose2::exp(&self.motion(i));
            *motion = Motion::from(Pose2 {
                x: end.x + self.scatter[0][i],
                y: end.y + self.scatter[1][i],
                heading: self.turned(i),
            });
        }
    }
}

/// The ends of all pieces of `blocks`, one block after the other.
#[inline(always)]
fn all_ends(blocks: &mut [Block], ends: &mut [[Motion; WIDTH]], rotation_per_metre: f64) {
    for (block, ends) in blocks.iter_mut().zip(ends) {
        if block.draws {
            block.spread(rotation_per_metre);
        }
        block.ends(ends);
    }
}

fn work_out(instructions: Instructions, blocks: &mut [Block], ends: &mut [[Motion; WIDTH]], rotation_per_metre: f64) {
    by_width!(instructions, |blocks: &mut [Block], ends: &mut [[Motion; WIDTH]], rotation_per_metre: f64| -> () {
        all_ends(blocks, ends, rotation_per_metre)
    })
}

/// A run under way.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Its pose after the pieces computed so far.
    reached: Motion,
    /// Its first piece that is not yet computed.
    first: usize,
}

/// The present runs and their pending pieces.
#[derive(Clone, Debug)]
pub(super) struct Pieces {
    instructions: Instructions,
    runs: Vec<Run>,
    blocks: Vec<Block>,
    count: usize,
    ends: Vec<[Motion; WIDTH]>,
}

impl Pieces {
    /// No runs yet; uses registers no wider than these, with the same bits on all.
    pub(super) fn new(instructions: Instructions) -> Pieces {
        Pieces {
            instructions: instructions.min(Instructions::best()),
            runs: Vec::new(),
            blocks: Vec::new(),
            count: 0,
            ends: Vec::new(),
        }
    }

    /// Forgets all runs.
    pub(super) fn clear(&mut self) {
        self.runs.clear();
        self.blocks.clear();
        self.count = 0;
    }

    /// Begins one more run at `start`; the pieces that follow are its own.
    pub(super) fn start(&mut self, start: Pose2) {
        self.runs.push(Run { reached: Motion::from(start), first: self.count });
    }

    /// Adds a piece to the run begun last.
    #[inline]
    pub(super) fn push(&mut self, piece: &Piece) {
        let place = self.count % WIDTH;
        if place == 0 {
            self.blocks.push(Block::default());
        }
        if let Some(block) = self.blocks.last_mut() {
            block.set(place, piece);
        }
        self.count += 1;
    }

    /// Moves every run to the end of its pieces; `rotation_per_metre` as of [`Diffusion::new`].
    pub(super) fn settle(&mut self, rotation_per_metre: f64) {
        self.ends.resize(self.blocks.len(), [Motion::IDENTITY; WIDTH]);
        work_out(self.instructions, &mut self.blocks, &mut self.ends, rotation_per_metre);
        let ends = self.ends.as_flattened();
        let mut end = self.count;
        for run in self.runs.iter_mut().rev() {
            run.reached = ends[run.first..end].iter().fold(run.reached, |pose, piece| pose.then(piece));
            (end, run.first) = (run.first, 0);
        }
        self.blocks.clear();
        self.count = 0;
    }

    /// The poses of the runs, in the order in which they were begun.
    pub(super) fn reached(&self) -> impl Iterator<Item = Pose2> + '_ {
        self.runs.iter().map(|run| run.reached.pose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROTATION_PER_METRE: f64 = 1.0 / 0.34;

    fn pieces_of(run: usize) -> impl Iterator<Item = Piece> {
        let rotations = [0.0, 1e-9, -1.57, 1.572, 3.13, -3.145, 3.2, -7.0, 20.0, 0.3, -0.02];
        rotations.into_iter().cycle().skip(run).take(5 + 7 * run).enumerate().map(|(i, rotation)| Piece {
            motion: Displacement2 { forward: 4.0 - i as f64, sideways: 0.1 * i as f64, rotation },
            noise: match i % 3 {
                0 => Noise::None,
                1 => Noise::Moves([1e-2, -2e-2, 1e-3 * (i as f64 - 5.0)]),
                _ => Noise::Draws {
                    variance: WheelVariance { left: 1e-6 * i as f64, right: 2e-6 },
                    normals: [0.5, -1.0, 0.1 * i as f64],
                },
            },
        })
    }

    /// The piece by its definition, pose by pose.
    fn driven(pose: Pose2, piece: &Piece) -> Pose2 {
        let [x, y, turned] = match piece.noise {
            Noise::None => [0.0; 3],
            Noise::Moves(by) => by,
            Noise::Draws { variance, normals } => {
                Diffusion::new(&piece.motion, &variance, ROTATION_PER_METRE).scatter(normals)
            }
        };
        let end = Pose2::exp(&piece.motion);
        pose.compose(&Pose2::new(end.x + x, end.y + y, end.heading + turned))
    }

    #[test]
    fn runs_end_where_their_pieces_lead_one_by_one_past_half_and_whole_turns_too() {
        for instructions in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            let mut pieces = Pieces::new(instructions);
            // Settled in the middle of the last run, as a recording does, and at the end.
            let mut expected = Vec::new();
            for run in 0..4 {
                let start = Pose2::new(0.1 * run as f64, -0.2, 0.3 * run as f64);
                pieces.start(start);
                pieces_of(run).for_each(|piece| pieces.push(&piece));
                expected.push(pieces_of(run).fold(start, |pose, piece| driven(pose, &piece)));
            }
            pieces.settle(ROTATION_PER_METRE);
            let last =
                Piece { motion: Displacement2 { forward: 1.0, sideways: 0.0, rotation: -0.5 }, noise: Noise::None };
            pieces.push(&last);
            expected[3] = driven(expected[3], &last);
            pieces.settle(ROTATION_PER_METRE);
            let reached: Vec<Pose2> = pieces.reached().collect();
            assert_eq!(reached.len(), 4);
            for (reached, expected) in reached.iter().zip(&expected) {
                let gap = [reached.x - expected.x, reached.y - expected.y, reached.heading - expected.heading];
                assert!(gap.iter().all(|gap| gap.abs() < 1e-12), "{instructions:?}: {reached:?} {expected:?}");
            }
        }
    }

    #[test]
    fn the_bits_of_a_piece_do_not_depend_on_its_neighbours_or_the_instruction_set() {
        let alone = |piece: &Piece| {
            let mut pieces = Pieces::new(Instructions::Portable);
            pieces.start(Pose2::IDENTITY);
            pieces.push(piece);
            pieces.settle(ROTATION_PER_METRE);
            pieces.reached().next().unwrap()
        };
        for instructions in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            let mut pieces = Pieces::new(instructions);
            for piece in pieces_of(3) {
                pieces.start(Pose2::IDENTITY);
                pieces.push(&piece);
            }
            pieces.settle(ROTATION_PER_METRE);
            for (piece, reached) in pieces_of(3).zip(pieces.reached()) {
                assert_eq!(reached, alone(&piece), "{instructions:?} {piece:?}");
            }
        }
    }
}
