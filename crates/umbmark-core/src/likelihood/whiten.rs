//! Residuals and Jacobian columns of a run, made independent by a Kalman filter along it.

use super::noise::Noise;
use super::observed::{Block, ObservedRun};
use nalgebra::{Matrix3, RowVector3, SMatrix, Vector3};

/// Standard deviation of a START that is not taken on trust \[m, rad\]: beyond all misplacement, so that it costs one pose.
const FREE_START: f64 = 1.0;

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
}

impl Noise {
    /// Whitens `columns`, each with one (x, y, heading) a block, by the innovations of the filter
    ///
    /// P ← P + Q_b,  S = H P Hᵀ + R,  v = L⁻¹ (y - H s) with L Lᵀ = S,  s ← s + P Hᵀ S⁻¹ (y - H s),
    ///
    /// in the error coordinates of [`Growth`](super::Growth). The same gains serve all columns, so linear relations between
    /// columns are kept.
    pub fn whiten(&self, run: &ObservedRun, columns: &[&[[f64; 3]]]) -> Whitened {
        let mut out = Whitened {
            columns: columns.len(),
            values: Vec::with_capacity(3 * columns.len() * run.blocks.len()),
            block: Vec::with_capacity(3 * run.blocks.len()),
            log_scale: 0.0,
        };
        let mut states = vec![Vector3::zeros(); columns.len()];
        let mut innovations = vec![Vector3::zeros(); columns.len()];
        let mut p = self.start(run.start_seen);
        for (index, block) in run.blocks.iter().enumerate() {
            p += self.growth(&block.growth);
            let h = observation(block);
            let rows = if block.headings > 0 { 3 } else { 2 };
            for (column, (state, innovation)) in columns.iter().zip(states.iter().zip(&mut innovations)) {
                *innovation = Vector3::from(column[index]) - h * state;
            }
            if rows == 3 {
                let s = h * p * h.transpose() + self.measurement(block);
                let Some(factor) = s.cholesky() else { continue };
                let gain = factor.solve(&(h * p)).transpose();
                let lower = factor.l();
                self.emit(&mut out, &lower, &innovations, 3, index);
                update(&mut states, &innovations, &gain);
                p -= gain * h * p;
            } else {
                let h = h.fixed_view::<2, 3>(0, 0).into_owned();
                let noise = self.measurement(block).fixed_view::<2, 2>(0, 0).into_owned();
                let s = h * p * h.transpose() + noise;
                let Some(factor) = s.cholesky() else { continue };
                let gain: SMatrix<f64, 3, 2> = factor.solve(&(h * p)).transpose();
                let lower = Matrix3::identity();
                let mut lower = lower;
                lower.fixed_view_mut::<2, 2>(0, 0).copy_from(&factor.l());
                self.emit(&mut out, &lower, &innovations, 2, index);
                let mut wide = Matrix3::zeros();
                wide.fixed_view_mut::<3, 2>(0, 0).copy_from(&gain);
                update(&mut states, &innovations, &wide);
                p -= gain * h * p;
            }
            p = 0.5 * (p + p.transpose());
        }
        out
    }

    fn emit(&self, out: &mut Whitened, lower: &Matrix3<f64>, innovations: &[Vector3<f64>], rows: usize, block: usize) {
        let first = out.values.len();
        out.values.resize(first + rows * out.columns, 0.0);
        for (c, v) in innovations.iter().enumerate() {
            let a = v[0] / lower[(0, 0)];
            let b = (v[1] - lower[(1, 0)] * a) / lower[(1, 1)];
            let white = [a, b, (v[2] - lower[(2, 0)] * a - lower[(2, 1)] * b) / lower[(2, 2)]];
            for (r, value) in white.into_iter().take(rows).enumerate() {
                out.values[first + r * out.columns + c] = value;
            }
        }
        for r in 0..rows {
            out.block.push(block);
            out.log_scale += libm::log(lower[(r, r)]);
        }
    }

    /// Covariance of the error at START.
    fn start(&self, seen: bool) -> Matrix3<f64> {
        let sd = if seen { [FREE_START; 3] } else { [self.start_position, self.start_position, self.start_heading] };
        Matrix3::from_diagonal(&Vector3::from(sd.map(|s| s * s)))
    }

    /// Variance of a block's mean.
    fn measurement(&self, block: &Block) -> Matrix3<f64> {
        let position = self.reference_position.powi(2) + self.within_position.powi(2) / block.count as f64;
        let heading = self.reference_heading.powi(2) + self.within_heading.powi(2) / block.headings.max(1) as f64;
        Matrix3::from_diagonal(&Vector3::new(position, position, heading))
    }
}

/// From error coordinates to the error of the pose at a block: δp = q + θ J p.
fn observation(block: &Block) -> Matrix3<f64> {
    Matrix3::from_rows(&[
        RowVector3::new(1.0, 0.0, -block.place.y),
        RowVector3::new(0.0, 1.0, block.place.x),
        RowVector3::new(0.0, 0.0, 1.0),
    ])
}

fn update(states: &mut [Vector3<f64>], innovations: &[Vector3<f64>], gain: &Matrix3<f64>) {
    for (state, innovation) in states.iter_mut().zip(innovations) {
        *state += gain * innovation;
    }
}
