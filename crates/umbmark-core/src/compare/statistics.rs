//! The statistics of a test of return poses.

use crate::path::Direction;
use nalgebra::Vector3;

/// A statistic of the measured test and its prediction by a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistic {
    /// Of the runs.
    pub direction: Direction,
    /// What it is.
    pub quantity: Quantity,
    /// As measured \[m, rad or 1\].
    pub measured: f64,
    /// As predicted: for spreads and correlations, the middle of the simulated tests.
    pub predicted: f64,
    /// Share of simulated tests that are at least as far from the prediction.
    pub p: f64,
}

/// What is compared, for each direction of driving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Mean ε_x \[m\].
    MeanX,
    /// Mean ε_y \[m\].
    MeanY,
    /// Mean ε_θ \[rad\].
    MeanHeading,
    /// Standard deviation of ε_x \[m\], n - 1.
    SpreadX,
    /// Standard deviation of ε_y \[m\].
    SpreadY,
    /// Standard deviation of ε_θ \[rad\].
    SpreadHeading,
    /// Correlation of ε_x and ε_y.
    Correlation,
}

impl Quantity {
    /// All, in the order of tables.
    pub const ALL: [Quantity; 7] = [
        Quantity::MeanX,
        Quantity::MeanY,
        Quantity::MeanHeading,
        Quantity::SpreadX,
        Quantity::SpreadY,
        Quantity::SpreadHeading,
        Quantity::Correlation,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::MeanX => "mean x",
            Quantity::MeanY => "mean y",
            Quantity::MeanHeading => "mean heading",
            Quantity::SpreadX => "spread of x",
            Quantity::SpreadY => "spread of y",
            Quantity::SpreadHeading => "spread of heading",
            Quantity::Correlation => "correlation of x and y",
        }
    }

    /// As a key, with its unit.
    pub fn key(self) -> &'static str {
        match self {
            Quantity::MeanX => "mean_x_m",
            Quantity::MeanY => "mean_y_m",
            Quantity::MeanHeading => "mean_heading_rad",
            Quantity::SpreadX => "spread_x_m",
            Quantity::SpreadY => "spread_y_m",
            Quantity::SpreadHeading => "spread_heading_rad",
            Quantity::Correlation => "correlation_x_y",
        }
    }

    /// Factor and unit of the report: millimetres and degrees.
    pub fn display(self) -> (f64, &'static str) {
        match self {
            Quantity::MeanX | Quantity::MeanY | Quantity::SpreadX | Quantity::SpreadY => (1e3, " mm"),
            Quantity::MeanHeading | Quantity::SpreadHeading => (1f64.to_degrees(), " deg"),
            Quantity::Correlation => (1.0, ""),
        }
    }

    /// Whether it is the mean of a coordinate, and of which.
    pub(super) fn mean_of(self) -> Option<usize> {
        match self {
            Quantity::MeanX => Some(0),
            Quantity::MeanY => Some(1),
            Quantity::MeanHeading => Some(2),
            _ => None,
        }
    }

    pub(super) fn needs_heading(self) -> bool {
        matches!(self, Quantity::MeanHeading | Quantity::SpreadHeading)
    }

    pub(super) fn needs(self) -> usize {
        match self {
            Quantity::MeanX | Quantity::MeanY | Quantity::MeanHeading => 1,
            Quantity::SpreadX | Quantity::SpreadY | Quantity::SpreadHeading => 2,
            Quantity::Correlation => 3,
        }
    }

    /// Of return errors.
    pub(super) fn of(self, errors: &[Vector3<f64>]) -> f64 {
        let n = errors.len() as f64;
        let mean = errors.iter().fold(Vector3::zeros(), |sum, e| sum + e) / n;
        let moment =
            |i: usize, j: usize| errors.iter().map(|e| (e[i] - mean[i]) * (e[j] - mean[j])).sum::<f64>() / (n - 1.0);
        match self {
            Quantity::MeanX => mean.x,
            Quantity::MeanY => mean.y,
            Quantity::MeanHeading => mean.z,
            Quantity::SpreadX => moment(0, 0).sqrt(),
            Quantity::SpreadY => moment(1, 1).sqrt(),
            Quantity::SpreadHeading => moment(2, 2).sqrt(),
            Quantity::Correlation => {
                let product = moment(0, 0) * moment(1, 1);
                if product > 0.0 { moment(0, 1) / product.sqrt() } else { 0.0 }
            }
        }
    }
}
