//! Pieces of true motion: first listed, then worked out side by side, then chained run by run.
//!
//! Whatever makes a stretch of driving into true motion does so as a list of pieces with constant twist: one where nothing
//! interrupts the stretch, more where bumps, or a law that changes along the way, cut it. Where a piece ends as seen from
//! where it began does not depend on the others. So the pieces of all runs of a test are worked out in one loop without a
//! branch, and only the products along each run wait for each other.

use crate::engine::Motion;
use crate::geometry::{Displacement2, Pose2, sinc_cos_near_zero};

/// A motion with constant twist, whose end is then moved in the frame of its start and turned about itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Twist times time.
    pub motion: Displacement2,
    /// What noise adds at the end: (x, y) \[m\] and heading \[rad\].
    pub scatter: [f64; 3],
}

/// Pieces side by side.
const WIDTH: usize = 8;

/// Some pieces, number by number, so that one instruction does several of them.
#[derive(Clone, Debug, Default)]
struct Block {
    forward: [f64; WIDTH],
    sideways: [f64; WIDTH],
    rotation: [f64; WIDTH],
    scatter: [[f64; WIDTH]; 3],
}

/// Where the pieces of a block end, scatter included.
#[derive(Clone, Copy, Debug)]
struct Ends {
    x: [f64; WIDTH],
    y: [f64; WIDTH],
    cosine: [f64; WIDTH],
    sine: [f64; WIDTH],
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
        for (row, value) in self.scatter.iter_mut().zip(piece.scatter) {
            row[place] = value;
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

    #[inline(always)]
    fn ends(&self) -> Ends {
        let zero = [0.0; WIDTH];
        let mut ends = Ends { x: zero, y: zero, cosine: zero, sine: zero };
        for i in 0..WIDTH {
            let (sinc, sine, cosine) = from_half(0.25 * self.rotation[i]);
            let (ahead, aside) = (sinc * self.forward[i], sinc * self.sideways[i]);
            ends.x[i] = (cosine * ahead - sine * aside) + self.scatter[0][i];
            ends.y[i] = (sine * ahead + cosine * aside) + self.scatter[1][i];
            let (_, sine, cosine) = from_half(0.25 * self.turned(i));
            ends.cosine[i] = 1.0 - 2.0 * (sine * sine);
            ends.sine[i] = 2.0 * sine * cosine;
        }
        if (0..WIDTH).fold(false, |any, i| any | self.is_large(i)) {
            self.replace_large(&mut ends);
        }
        ends
    }

    /// Rotations past half a turn, one by one.
    #[cold]
    fn replace_large(&self, ends: &mut Ends) {
        for i in (0..WIDTH).filter(|i| self.is_large(*i)) {
            let (forward, sideways, rotation) = (self.forward[i], self.sideways[i], self.rotation[i]);
            let end = Pose2::exp(&Displacement2 { forward, sideways, rotation });
            let Motion { cosine, sine, .. } = Motion::from(Pose2::new(0.0, 0.0, self.turned(i)));
            (ends.x[i], ends.y[i]) = (end.x + self.scatter[0][i], end.y + self.scatter[1][i]);
            (ends.cosine[i], ends.sine[i]) = (cosine, sine);
        }
    }
}

/// A run under way.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Where it has come, as far as its pieces are worked out.
    reached: Motion,
    /// The first of its pieces that are not.
    first: usize,
}

/// The runs under way and the pieces that they have yet to drive.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    runs: Vec<Run>,
    blocks: Vec<Block>,
    count: usize,
    motions: Vec<Motion>,
}

impl Pieces {
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

    /// Moves every run to the end of its pieces.
    pub(super) fn settle(&mut self) {
        self.motions.clear();
        for block in &self.blocks {
            let ends = block.ends();
            self.motions.extend((0..WIDTH).map(|i| Motion {
                pose: Pose2 { x: ends.x[i], y: ends.y[i], heading: block.turned(i) },
                cosine: ends.cosine[i],
                sine: ends.sine[i],
            }));
        }
        let mut end = self.count;
        for run in self.runs.iter_mut().rev() {
            run.reached = self.motions[run.first..end].iter().fold(run.reached, |pose, piece| pose.then(piece));
            (end, run.first) = (run.first, 0);
        }
        self.blocks.clear();
        self.count = 0;
    }

    /// Where the runs have come, in the order in which they were begun.
    pub(super) fn reached(&self) -> impl Iterator<Item = Pose2> + '_ {
        self.runs.iter().map(|run| run.reached.pose)
    }
}
