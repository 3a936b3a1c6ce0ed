//! Residuals and Jacobian columns of a run, made independent by a Kalman filter along it.

mod disturbances;

pub use disturbances::Disturbance;

use super::noise::Noise;
use super::observed::{Block, ObservedRun};
use crate::geometry::{Eight, Scalar};
use crate::geometry::{Instructions, by_width};
use std::ops::Range;

/// Standard deviation of a START that is not trusted \[m, rad\]: larger than any misplacement, so it uses up one pose.
const FREE_START: f64 = 1.0;

/// Standard deviation of a position or heading that was not measured \[m, rad\].
const NOT_MEASURED: f64 = 1e6;

/// Columns of a run in which noise is independent with unit variance: two or three rows a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Whitened {
    /// Number of columns.
    pub columns: usize,
    /// Values row by row.
    pub values: Vec<f64>,
    /// The block of each row.
    pub block: Vec<usize>,
    /// Σ log of the standard deviations that were divided by.
    pub log_scale: f64,
}

impl Whitened {
    /// The rows, one after the other.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.columns.max(1))
    }

    /// Treats the last column z as the response to a random number of standard deviation `sd` that the whole run shares, and whitens the
    /// others for it: x ← (1 + sd² z zᵀ)^(-1/2) x.
    #[inline(always)]
    fn less_a_common(&mut self, sd: f64) {
        let width = self.columns;
        let mut products = vec![0.0; width];
        for row in self.values.chunks_exact(width) {
            products.iter_mut().zip(row).for_each(|(sum, value)| *sum += value * row[width - 1]);
        }
        let length = products[width - 1];
        let grown = 1.0 + sd * sd * length;
        let share = if length > 0.0 { (1.0 / grown.sqrt() - 1.0) / length } else { 0.0 };
        let mut less = vec![0.0; self.values.len() / width * (width - 1)];
        if width > 1 {
            for (to, row) in less.chunks_exact_mut(width - 1).zip(self.values.chunks_exact(width)) {
                let common = share * row[width - 1];
                to.iter_mut().zip(row).zip(&products).for_each(|((to, value), p)| *to = value + common * p);
            }
        }
        self.values = less;
        self.columns = width - 1;
        self.log_scale += 0.5 * libm::log(grown);
    }
}

impl Noise {
    /// Whitens `columns`, each with one (x, y, heading) a block, by the innovations of the filter
    ///
    /// S = H (P + Q_m) Hᵀ + R = L Lᵀ,  v = L⁻¹ (y - H s),  W = L⁻¹ H (P + Q_s),  s ← s + Wᵀ v,  P ← P + Q - Wᵀ W,
    ///
    /// in the error coordinates of [`Growth`](super::Growth). A block is observed by the mean of its observations, which has only part of
    /// what is added until its last one: Q is the covariance of the whole, Q_m that of the part, Q_s that of both. The same gains serve all columns, so linear relations between
    /// columns are kept.
    pub fn whiten(&self, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> Whitened {
        let noise = self;
        by_width!(Instructions::best(), |noise: &Noise, run: &ObservedRun, columns: &[&[[f64; 3]]]| -> Whitened {
            noise.whiten_plainly(run, columns)
        })
    }

    #[inline(always)]
    fn whiten_plainly(&self, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> Whitened {
        let mut out = Whitened {
            columns: columns.len() + 1 + run.drifts().len(),
            values: Vec::with_capacity(3 * (columns.len() + 1 + run.drifts().len()) * run.blocks.len()),
            block: Vec::with_capacity(3 * run.blocks.len()),
            log_scale: 0.0,
        };
        let mut filter = Filter::new(self, run, columns);
        for index in 0..run.blocks.len() {
            let rows = filter.take_in(index);
            for row in &filter.states.new[rows.clone()] {
                out.values.extend_from_slice(row);
            }
            out.block.extend(std::iter::repeat_n(index, rows.len()));
        }
        out.log_scale = filter.log_scale();
        for sd in run.drifts().iter().rev() {
            out.less_a_common(*sd);
        }
        out.less_a_common(self.reference_delay);
        out
    }
}

impl Noise<Eight> {
    /// Products of the whitened columns, row by row, and the logarithm of the scales.
    pub(super) fn products(&self, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> (Vec<Eight>, Eight) {
        let noise = self;
        by_width!(Instructions::best(), |noise: &Noise<Eight>,
                                         run: &ObservedRun,
                                         columns: &[&[[f64; 3]]]|
         -> (Vec<Eight>, Eight) { noise.products_plainly(run, columns) })
    }

    #[inline(always)]
    fn products_plainly(&self, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> (Vec<Eight>, Eight) {
        let width = columns.len() + 1 + run.drifts().len();
        let pairs: Vec<(usize, usize)> = (0..width).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
        let mut sums = vec![Eight::from(0.0); pairs.len()];
        let mut filter = Filter::new(self, run, columns);
        for index in 0..run.blocks.len() {
            let rows = filter.take_in(index);
            if rows.is_empty() {
                continue;
            }
            let [first, second, third] = filter.states.new.each_ref().map(|row| &row[..width]);
            for (sum, (i, j)) in sums.iter_mut().zip(&pairs) {
                let plane = || first[*i] * first[*j] + second[*i] * second[*j];
                *sum += match (rows.start, rows.end) {
                    (0, 3) => plane() + third[*i] * third[*j],
                    (0, _) => plane(),
                    _ => third[*i] * third[*j],
                };
            }
        }
        let mut log_scale = filter.log_scale();
        // Whitening for what the whole run shares, the last column first; the delay remains.
        for (k, sd) in run.drifts().iter().enumerate().rev() {
            let (last, variance) = (columns.len() + 1 + k, sd * sd);
            let at = |i: usize, j: usize| i.max(j) * (i.max(j) + 1) / 2 + i.min(j);
            let grown = Eight::from(1.0) + Eight::from(variance) * sums[at(last, last)];
            let share = Eight::from(variance) / grown;
            for i in 0..last {
                for j in 0..=i {
                    let less = share * sums[at(i, last)] * sums[at(j, last)];
                    sums[at(i, j)] = sums[at(i, j)] - less;
                }
            }
            log_scale += Eight::from(0.5) * grown.logarithm();
        }
        let width = columns.len() + 1;
        let sum = |i: usize, j: usize| sums[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        let variance = self.reference_delay * self.reference_delay;
        let grown = Eight::from(1.0) + variance * sum(width - 1, width - 1);
        let share = variance / grown;
        let less = |i: usize, j: usize| sum(i, j) - share * sum(i, width - 1) * sum(j, width - 1);
        let products = (0..width - 1).flat_map(|i| (0..width - 1).map(move |j| (i, j))).map(|(i, j)| less(i, j));
        (products.collect(), log_scale + Eight::from(0.5) * grown.logarithm())
    }
}

/// State of the filter along a run.
struct Filter<'a, T> {
    noise: &'a Noise<T>,
    run: &'a ObservedRun,
    columns: &'a [&'a [[f64; 3]]],
    states: States<T>,
    /// P.
    p: [[T; 3]; 3],
    /// Product of the last standard deviations that were divided by, and Σ log of those before.
    scale: T,
    log_scale: T,
}

impl<'a, T: Scalar> Filter<'a, T> {
    /// At START. Behind the columns there are the velocities of the blocks and, of a gyro, how it drifts.
    #[inline(always)]
    fn new(noise: &'a Noise<T>, run: &'a ObservedRun, columns: &'a [&'a [[f64; 3]]]) -> Filter<'a, T> {
        let (states, p) = (States::new(columns.len() + 1 + run.drifts().len()), noise.start(run.start_seen));
        Filter { noise, run, columns, states, p, scale: T::from(1.0), log_scale: T::from(0.0) }
    }

    /// Processes the next block; returns which rows are new.
    #[inline(always)]
    fn take_in(&mut self, index: usize) -> Range<usize> {
        let (block, noise) = (&self.run.blocks[index], self.noise);
        if self.run.relative {
            if !self.run.has_step(index) {
                return 0..0;
            }
            // A step begins where the last one ended, exactly.
            self.p = diagonal([T::from(0.0); 3]);
            self.states.forget();
        }
        if block.afresh {
            add(&mut self.p, &noise.start(true));
        }
        let Some(stage) = Stage::new(block, &mut self.p, noise) else { return 0..0 };
        let rows = block.rows();
        let shared = [&block.velocity].into_iter().chain(&block.drifts[..self.run.drifts().len()]);
        self.states.take_in(&stage, self.columns.iter().map(|column| &column[index]).chain(shared));
        for diagonal in &stage.diagonal[rows.clone()] {
            self.scale *= *diagonal;
        }
        // One logarithm of many factors.
        if !self.scale.lies_in(1e-200..1e200) {
            self.log_scale += self.scale.logarithm();
            self.scale = T::from(1.0);
        }
        rows
    }

    /// Σ log of the standard deviations that were divided by.
    fn log_scale(&self) -> T {
        self.log_scale + self.scale.logarithm()
    }
}

impl<T: Scalar> Noise<T> {
    /// Covariance of the error at START.
    #[inline(always)]
    fn start(&self, seen: bool) -> [[T; 3]; 3] {
        let (position, heading) =
            if seen { (T::from(FREE_START), T::from(FREE_START)) } else { (self.start_position, self.start_heading) };
        diagonal([position * position, position * position, heading * heading])
    }

    /// Variance of a block's mean.
    #[inline(always)]
    fn measurement(&self, block: &Block) -> [[T; 3]; 3] {
        let (shared, within) = (self.reference_position, self.within_position);
        let steps = T::from(block.steps);
        let [in_position, in_heading] = block.resolution.map(T::from);
        let position = match block.positions {
            0 => T::from(NOT_MEASURED * NOT_MEASURED),
            count => shared * shared * steps + within * within / T::from(count as f64) + in_position,
        };
        let (shared, within) = (self.reference_heading, self.within_heading);
        let heading = match block.headings {
            0 => T::from(NOT_MEASURED * NOT_MEASURED),
            count => shared * shared * steps + within * within / T::from(count as f64) + in_heading,
        };
        let [x, y, turn] = block.velocity;
        let (x, y, turn) =
            (self.reference_time * T::from(x), self.reference_time * T::from(y), self.reference_time * T::from(turn));
        [
            [position + x * x, x * y, x * turn],
            [y * x, position + y * y, y * turn],
            [turn * x, turn * y, heading + turn * turn],
        ]
    }
}

impl Block {
    /// Which of x, y and heading were measured.
    #[inline(always)]
    fn rows(&self) -> Range<usize> {
        let begin = if self.positions > 0 { 0 } else { 2 };
        begin..if self.headings > 0 { 3 } else { 2 }
    }
}

#[inline(always)]
fn diagonal<T: Scalar>(values: [T; 3]) -> [[T; 3]; 3] {
    let ([x, y, heading], none) = (values, T::from(0.0));
    [[x, none, none], [none, y, none], [none, none, heading]]
}

#[inline(always)]
fn add<T: Scalar>(sum: &mut [[T; 3]; 3], more: &[[T; 3]; 3]) {
    for i in 0..3 {
        for j in 0..3 {
            sum[i][j] += more[i][j];
        }
    }
}

/// One step of the filter, by hand: H is three ones and a place.
struct Stage<T> {
    /// The block's place.
    x: T,
    y: T,
    /// The diagonal of L, its inverse, and what is below it.
    diagonal: [T; 3],
    inverse: [T; 3],
    below: [T; 3],
    /// W, row by row.
    w: [[T; 3]; 3],
}

impl<T: Scalar> Stage<T> {
    /// Takes the mean of a block's observations into the covariance P before it, which becomes that of its end; `None` where S is no covariance.
    #[inline(always)]
    fn new(block: &Block, p: &mut [[T; 3]; 3], noise: &Noise<T>) -> Option<Stage<T>> {
        let measurement = noise.measurement(block);
        let whole = noise.growth(&block.growth);
        let stage = if block.count > 1 {
            let (mut of_mean, mut seen) = (*p, *p);
            add(&mut of_mean, &noise.growth(&block.growth_of_mean));
            add(&mut seen, &noise.growth(&block.growth_seen));
            add(p, &whole);
            Stage::of(block, &of_mean, &seen, &measurement)?
        } else {
            add(p, &whole);
            Stage::of(block, p, p, &measurement)?
        };
        stage.take(p);
        Some(stage)
    }

    /// By the covariance of the mean of the block's observations, and that of its end with it.
    #[inline(always)]
    fn of(block: &Block, of_mean: &[[T; 3]; 3], seen: &[[T; 3]; 3], measurement: &[[T; 3]; 3]) -> Option<Stage<T>> {
        let (x, y) = (T::from(block.place.x), T::from(block.place.y));
        // H P, and of H P Hᵀ the lower triangle.
        let observed = |p: &[[T; 3]; 3]| {
            let mut hp = [[T::from(0.0); 3]; 3];
            for k in 0..3 {
                hp[0][k] = p[0][k] - y * p[2][k];
                hp[1][k] = p[1][k] + x * p[2][k];
                hp[2][k] = p[2][k];
            }
            hp
        };
        let hp = observed(of_mean);
        let [first, second, third] = hp;
        let (s00, s10, s20) = (first[0] - y * first[2], second[0] - y * second[2], third[0] - y * third[2]);
        let (s11, s21, s22) = (second[1] + x * second[2], third[1] + x * third[2], third[2]);
        let one = T::from(1.0);
        let d0 = (s00 + measurement[0][0]).root()?;
        let i0 = one / d0;
        let (l10, l20) = ((s10 + measurement[1][0]) * i0, (s20 + measurement[2][0]) * i0);
        let d1 = (s11 + measurement[1][1] - l10 * l10).root()?;
        let i1 = one / d1;
        let l21 = (s21 + measurement[2][1] - l20 * l10) * i1;
        let d2 = (s22 + measurement[2][2] - l20 * l20 - l21 * l21).root()?;
        let (diagonal, inverse) = ([d0, d1, d2], [i0, i1, one / d2]);
        let mut stage = Stage { x, y, diagonal, inverse, below: [l10, l20, l21], w: observed(seen) };
        let [first, second, third] = stage.w;
        for k in 0..3 {
            [stage.w[0][k], stage.w[1][k], stage.w[2][k]] = stage.solved([first[k], second[k], third[k]]);
        }
        Some(stage)
    }

    /// L⁻¹ v.
    #[inline(always)]
    fn solved(&self, v: [T; 3]) -> [T; 3] {
        let a = v[0] * self.inverse[0];
        let b = (v[1] - self.below[0] * a) * self.inverse[1];
        [a, b, (v[2] - self.below[1] * a - self.below[2] * b) * self.inverse[2]]
    }

    /// P - Wᵀ W.
    #[inline(always)]
    fn take(&self, p: &mut [[T; 3]; 3]) {
        let [a, b, c] = &self.w;
        for i in 0..3 {
            for j in 0..3 {
                p[i][j] -= a[i] * a[j] + b[i] * b[j] + c[i] * c[j];
            }
        }
    }
}

/// The states s of all columns, side by side so that a step is the same arithmetic on neighbours.
struct States<T> {
    states: [Vec<T>; 3],
    /// L⁻¹ (y - H s) of the last block.
    new: [Vec<T>; 3],
}

impl<T: Scalar> States<T> {
    fn new(columns: usize) -> States<T> {
        let zeros = || std::array::from_fn(|_| vec![T::from(0.0); columns]);
        States { states: zeros(), new: zeros() }
    }

    /// Sets all states to zero.
    fn forget(&mut self) {
        self.states.iter_mut().for_each(|state| state.fill(T::from(0.0)));
    }

    /// Innovation of a block in every column; updates the states.
    #[inline(always)]
    fn take_in<'b>(&mut self, stage: &Stage<T>, block: impl Iterator<Item = &'b [f64; 3]>) {
        let [v0, v1, v2] = self.new.each_mut().map(Vec::as_mut_slice);
        for (((v0, v1), v2), y) in v0.iter_mut().zip(&mut *v1).zip(&mut *v2).zip(block) {
            (*v0, *v1, *v2) = (T::from(y[0]), T::from(y[1]), T::from(y[2]));
        }
        let [s0, s1, s2] = self.states.each_mut().map(Vec::as_mut_slice);
        let new = v0.iter_mut().zip(v1).zip(v2);
        for (((v0, v1), v2), ((s0, s1), s2)) in new.zip(s0.iter_mut().zip(s1).zip(s2)) {
            let white = stage.solved([*v0 - *s0 + stage.y * *s2, *v1 - *s1 - stage.x * *s2, *v2 - *s2]);
            for (k, state) in [s0, s1, s2].into_iter().enumerate() {
                *state += stage.w[0][k] * white[0] + stage.w[1][k] * white[1] + stage.w[2][k] * white[2];
            }
            [*v0, *v1, *v2] = white;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::geometry::Pose2;
    use crate::likelihood::{Growth, gram};
    use crate::path::{Direction, Path};
    use crate::random::Stream;
    use crate::replay::Track;
    use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

    fn shared(growth: &Growth, share: f64) -> Growth {
        Growth {
            heading_per_metre: growth.heading_per_metre.map(|sum| share * sum),
            heading_per_radian: growth.heading_per_radian.map(|sum| share * sum),
            heading_by_gyro: [0.0; 6],
            forward: growth.forward.map(|sum| share * sum),
            way: share * growth.way,
            rolled: share * growth.rolled,
        }
    }

    /// A run of a few scattered blocks, one of them without headings.
    pub(super) fn run(start_seen: bool) -> ObservedRun {
        let track = Track::from_path(&Path::umbmark(), Direction::Ccw, &Robot::labmate());
        let places = [(0.0, 0.0), (1.0, 0.1), (2.0, -0.3), (2.5, 1.0), (2.4, 2.0)];
        let blocks: Vec<Block> = places
            .iter()
            .enumerate()
            .map(|(i, (x, y))| {
                let mut growth =
                    Growth { way: i as f64, rolled: i as f64, forward: [0.5 * i as f64; 3], ..Growth::default() };
                for (sum, at) in
                    [(&mut growth.heading_per_metre, [*x - 0.5, *y]), (&mut growth.heading_per_radian, [*x, *y - 0.2])]
                {
                    let g = [at[1], -at[0], 1.0];
                    *sum = [g[0] * g[0], g[1] * g[0], g[1] * g[1], g[0], g[1], 1.0].map(|v| i as f64 * v);
                }
                let headings = if i == 2 { 0 } else { 2 };
                Block {
                    first: 2 * i,
                    count: 2,
                    positions: 2,
                    headings,
                    place: Pose2::new(*x, *y, 0.0),
                    velocity: [0.3 * i as f64, 0.1, 0.5],
                    drifts: [[0.0; 3]; 2],
                    wander: 0.0,
                    growth,
                    growth_seen: shared(&growth, 0.6),
                    growth_of_mean: shared(&growth, 0.45),
                    unit: 0,
                    afresh: false,
                    jumped: false,
                    steps: 1.0,
                    resolution: [1e-6, 4e-6],
                    beside: [0.0; 3],
                }
            })
            .collect();
        ObservedRun {
            name: "a few".into(),
            log: "a few".into(),
            direction: None,
            track: track.into(),
            measured: [].into(),
            seen: [].into(),
            moments: [].into(),
            places: [].into(),
            blocks,
            linear: false,
            start_seen,
            relative: false,
            headings_only: false,
            gyro: None,
            counts: [0.0; 2],
            wheelbase: 0.34,
            readings: [].into(),
        }
    }

    pub(super) fn noise() -> Noise {
        Noise {
            heading_per_metre: 0.02,
            heading_per_radian: 0.01,
            forward_per_metre: 0.005,
            reference_time: 0.003,
            reference_delay: 0.02,
            ..Noise::default()
        }
    }

    /// From error coordinates to the error of the pose at a block: δp = q + θ J p.
    fn observation(block: &Block) -> Matrix3<f64> {
        Matrix3::new(1.0, 0.0, -block.place.y, 0.0, 1.0, block.place.x, 0.0, 0.0, 1.0)
    }

    /// The covariance of all residuals by its definition.
    fn dense(noise: &Noise, run: &ObservedRun) -> DMatrix<f64> {
        let matrix = |rows: [[f64; 3]; 3]| Matrix3::from_fn(|i, j| rows[i][j]);
        let mut grown = vec![matrix(noise.start(run.start_seen))];
        for block in &run.blocks {
            grown.push(grown[grown.len() - 1] + matrix(noise.growth(&block.growth)));
        }
        let n = run.blocks.len();
        let mut whole = DMatrix::zeros(3 * n, 3 * n);
        for i in 0..n {
            for j in 0..n {
                let (first, block) = (i.min(j), &run.blocks[i.min(j)]);
                let own = if i == j { &block.growth_of_mean } else { &block.growth_seen };
                let common = grown[first] + matrix(noise.growth(own));
                let mut shared = observation(&run.blocks[i]) * common * observation(&run.blocks[j]).transpose();
                if i == j {
                    shared += matrix(noise.measurement(&run.blocks[i]));
                }
                let late = [i, j].map(|k| Vector3::from(run.blocks[k].velocity) * noise.reference_delay);
                shared += late[0] * late[1].transpose();
                whole.view_mut((3 * i, 3 * j), (3, 3)).copy_from(&shared);
            }
        }
        let kept: Vec<usize> = (0..3 * n).filter(|r| r % 3 < 2 || run.blocks[r / 3].headings > 0).collect();
        DMatrix::from_fn(kept.len(), kept.len(), |i, j| whole[(kept[i], kept[j])])
    }

    #[test]
    fn products_of_whitened_columns_and_the_scale_are_those_of_the_full_covariance() {
        let mut stream = Stream::new(3, 0, 0);
        for start_seen in [true, false] {
            let (run, noise) = (run(start_seen), noise());
            let columns: [Vec<[f64; 3]>; 2] =
                std::array::from_fn(|_| run.blocks.iter().map(|_| std::array::from_fn(|_| stream.normal())).collect());
            let white = noise.whiten(&run, &[&columns[0], &columns[1]]);
            assert_eq!(white, noise.whiten_plainly(&run, &[&columns[0], &columns[1]]));
            let noises = std::array::from_fn(|lane| Noise { heading_per_metre: 0.01 * (lane + 1) as f64, ..noise });
            let (products, log_scale) = Noise::side_by_side(&noises).products(&run, &[&columns[0], &columns[1]]);
            for (lane, noise) in noises.iter().enumerate() {
                let white = noise.whiten(&run, &[&columns[0], &columns[1]]);
                for (product, expected) in products.iter().zip(&gram(&white.values, 2)) {
                    assert!((product.0[lane] / expected - 1.0).abs() < 1e-9, "{lane}: {product:?} {expected}");
                }
                assert!((log_scale.0[lane] - white.log_scale).abs() < 1e-9);
            }
            let sigma = dense(&noise, &run);
            let flat = |c: usize| {
                let kept = run.blocks.iter().zip(&columns[c]);
                let values: Vec<f64> =
                    kept.flat_map(|(b, v)| v[..if b.headings > 0 { 3 } else { 2 }].to_vec()).collect();
                DVector::from_vec(values)
            };
            let factor = sigma.cholesky().unwrap();
            for (a, b) in [(0, 0), (0, 1), (1, 1)] {
                let expected = flat(a).dot(&factor.solve(&flat(b)));
                let got: f64 = white.rows().map(|row| row[a] * row[b]).sum();
                assert!(
                    (got - expected).abs() < 1e-6 * expected.abs().max(1.0),
                    "{start_seen} {a} {b}: {got} {expected}"
                );
            }
            let log_scale: f64 = (0..factor.l().nrows()).map(|i| libm::log(factor.l()[(i, i)])).sum();
            assert!((white.log_scale - log_scale).abs() < 1e-6, "{} {log_scale}", white.log_scale);
        }
    }
}
