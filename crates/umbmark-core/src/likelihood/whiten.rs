//! Residuals and Jacobian columns of a run, made independent by a Kalman filter along it.

#[cfg(target_arch = "x86_64")]
mod x86;

use super::fitting::Column;
use super::noise::Noise;
use super::observed::{Block, ObservedRun};
use crate::engine::Instructions;
use nalgebra::{Matrix3, Vector3};

/// Standard deviation of a START that is not taken on trust \[m, rad\]: beyond all misplacement, so that it costs one pose.
const FREE_START: f64 = 1.0;

/// Standard deviation of a heading that was not measured \[rad\].
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

    /// Takes the last column z for the response to a number that the whole run shares, of standard deviation `sd`, and makes the
    /// others independent of it: x ← (1 + sd² z zᵀ)^(-1/2) x.
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
    /// P ← P + Q_b,  S = H P Hᵀ + R = L Lᵀ,  v = L⁻¹ (y - H s),  W = L⁻¹ H P,  s ← s + Wᵀ v,  P ← P - Wᵀ W,
    ///
    /// in the error coordinates of [`Growth`](super::Growth). The same gains serve all columns, so linear relations between
    /// columns are kept.
    pub fn whiten(&self, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> Whitened {
        #[cfg(target_arch = "x86_64")]
        match Instructions::best() {
            // SAFETY: the machine was found to have them.
            Instructions::Avx512 => return unsafe { x86::whiten_by_eight(self, run, columns) },
            // SAFETY: as above.
            Instructions::Avx2 => return unsafe { x86::whiten_by_four(self, run, columns) },
            Instructions::Portable => {}
        }
        self.whiten_plainly(run, columns)
    }

    #[inline(always)]
    fn whiten_plainly(&self, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> Whitened {
        let late: Column = run.blocks.iter().map(|block| block.velocity).collect();
        let columns = &[columns, &[&late]].concat();
        let mut out = Whitened {
            columns: columns.len(),
            values: Vec::with_capacity(3 * columns.len() * run.blocks.len()),
            block: Vec::with_capacity(3 * run.blocks.len()),
            log_scale: 0.0,
        };
        let mut states = States::new(columns.len());
        let (mut p, mut scale) = (self.start(run.start_seen), 1.0);
        for (index, block) in run.blocks.iter().enumerate() {
            p += self.growth(&block.growth);
            if block.afresh {
                p += self.start(true);
            }
            let Some(stage) = Stage::new(block, &p, &self.measurement(block)) else { continue };
            let rows = if block.headings > 0 { 3 } else { 2 };
            let first = out.values.len();
            out.values.resize(first + rows * columns.len(), 0.0);
            states.take_in(&stage, columns.iter().map(|column| column[index]));
            for (row, new) in out.values[first..].chunks_exact_mut(columns.len()).zip(&states.new) {
                row.copy_from_slice(new);
            }
            out.block.extend(std::iter::repeat_n(index, rows));
            scale *= stage.diagonal[..rows].iter().product::<f64>();
            // One logarithm of many factors.
            if !(1e-200..1e200).contains(&scale) {
                out.log_scale += libm::log(scale);
                scale = 1.0;
            }
            p -= stage.taken();
        }
        out.log_scale += libm::log(scale);
        out.less_a_common(self.reference_delay);
        out
    }

    /// Covariance of the error at START.
    fn start(&self, seen: bool) -> Matrix3<f64> {
        let sd = if seen { [FREE_START; 3] } else { [self.start_position, self.start_position, self.start_heading] };
        Matrix3::from_diagonal(&Vector3::from(sd.map(|s| s * s)))
    }

    /// Variance of a block's mean.
    fn measurement(&self, block: &Block) -> Matrix3<f64> {
        let position = self.reference_position.powi(2) + self.within_position.powi(2) / block.count as f64;
        let heading = match block.headings {
            0 => NOT_MEASURED * NOT_MEASURED,
            count => self.reference_heading.powi(2) + self.within_heading.powi(2) / count as f64,
        };
        let late = Vector3::from(block.velocity) * self.reference_time;
        Matrix3::from_diagonal(&Vector3::new(position, position, heading)) + late * late.transpose()
    }
}

/// One step of the filter, by hand: H is three ones and a place.
struct Stage {
    /// The block's place.
    x: f64,
    y: f64,
    /// The diagonal of L, and what is below it.
    diagonal: [f64; 3],
    below: [f64; 3],
    /// W, row by row.
    w: [[f64; 3]; 3],
}

impl Stage {
    /// `None` where S is no covariance.
    fn new(block: &Block, p: &Matrix3<f64>, measurement: &Matrix3<f64>) -> Option<Stage> {
        let (x, y) = (block.place.x, block.place.y);
        let row = |k: usize| [p[(k, 0)], p[(k, 1)], p[(k, 2)]];
        let with = |a: [f64; 3], t: f64, b: [f64; 3]| [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
        let hp = [with(row(0), -y, row(2)), with(row(1), x, row(2)), row(2)];
        let s = |i: usize| [hp[i][0] - y * hp[i][2], hp[i][1] + x * hp[i][2], hp[i][2]];
        let (first, second, third) = (s(0), s(1), s(2));
        let root = |square: f64| (square > 0.0).then(|| square.sqrt());
        let d0 = root(first[0] + measurement[(0, 0)])?;
        let (l10, l20) = ((second[0] + measurement[(1, 0)]) / d0, (third[0] + measurement[(2, 0)]) / d0);
        let d1 = root(second[1] + measurement[(1, 1)] - l10 * l10)?;
        let l21 = (third[1] + measurement[(2, 1)] - l20 * l10) / d1;
        let d2 = root(third[2] + measurement[(2, 2)] - l20 * l20 - l21 * l21)?;
        let mut stage = Stage { x, y, diagonal: [d0, d1, d2], below: [l10, l20, l21], w: [[0.0; 3]; 3] };
        let columns: [[f64; 3]; 3] = std::array::from_fn(|k| stage.solved(hp.map(|row| row[k])));
        stage.w = std::array::from_fn(|row| columns.map(|column| column[row]));
        Some(stage)
    }

    /// L⁻¹ v.
    #[inline(always)]
    fn solved(&self, v: [f64; 3]) -> [f64; 3] {
        let a = v[0] / self.diagonal[0];
        let b = (v[1] - self.below[0] * a) / self.diagonal[1];
        [a, b, (v[2] - self.below[1] * a - self.below[2] * b) / self.diagonal[2]]
    }

    /// Wᵀ W.
    fn taken(&self) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| self.w.iter().map(|row| row[i] * row[j]).sum())
    }
}

/// The states s of all columns, side by side so that a step is the same arithmetic on neighbours.
struct States {
    states: [Vec<f64>; 3],
    /// L⁻¹ (y - H s) of the last block.
    new: [Vec<f64>; 3],
}

impl States {
    fn new(columns: usize) -> States {
        let zeros = || std::array::from_fn(|_| vec![0.0; columns]);
        States { states: zeros(), new: zeros() }
    }

    /// What is new in a block of every column; the states take it in.
    #[inline(always)]
    fn take_in(&mut self, stage: &Stage, block: impl Iterator<Item = [f64; 3]>) {
        let [v0, v1, v2] = self.new.each_mut().map(Vec::as_mut_slice);
        for (((v0, v1), v2), y) in v0.iter_mut().zip(&mut *v1).zip(&mut *v2).zip(block) {
            [*v0, *v1, *v2] = y;
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
    use crate::likelihood::Growth;
    use crate::path::{Direction, Path};
    use crate::random::Stream;
    use crate::replay::Track;
    use nalgebra::{DMatrix, DVector};

    /// A run of a few blocks here and there; one of them without headings.
    fn run(start_seen: bool) -> ObservedRun {
        let track = Track::from_path(&Path::umbmark(), Direction::Ccw, &Robot::labmate());
        let places = [(0.0, 0.0), (1.0, 0.1), (2.0, -0.3), (2.5, 1.0), (2.4, 2.0)];
        let blocks: Vec<Block> = places
            .iter()
            .enumerate()
            .map(|(i, (x, y))| {
                let mut growth = Growth { way: i as f64, forward: [0.5 * i as f64; 3], ..Growth::default() };
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
                    headings,
                    place: Pose2::new(*x, *y, 0.0),
                    velocity: [0.3 * i as f64, 0.1, 0.5],
                    growth,
                    unit: 0,
                    afresh: false,
                }
            })
            .collect();
        ObservedRun {
            name: "a few".into(),
            direction: None,
            track: track.into(),
            measured: [].into(),
            seen: [].into(),
            blocks,
            start_seen,
        }
    }

    fn noise() -> Noise {
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
        let mut grown = vec![noise.start(run.start_seen)];
        for block in &run.blocks {
            grown.push(grown[grown.len() - 1] + noise.growth(&block.growth));
        }
        let n = run.blocks.len();
        let mut whole = DMatrix::zeros(3 * n, 3 * n);
        for i in 0..n {
            for j in 0..n {
                let mut shared =
                    observation(&run.blocks[i]) * grown[1 + i.min(j)] * observation(&run.blocks[j]).transpose();
                if i == j {
                    shared += noise.measurement(&run.blocks[i]);
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
