//! The published closed forms: two angles from the centres of gravity, two ratios from the angles.
//!
//! On a square of side L, driven both ways, errors that repeat on every side act through the heading error of one side alone: φ_ccw = β - α
//! and φ_cw = β + α. α is the error of each quarter turn by a wrong wheelbase, β the rotation of each leg by unequal wheels. To first order
//! in them
//!
//! ```text
//! return error, ccw  (2L, -2L, 4) φ_ccw        cw  (-2L, -2L, 4) φ_cw
//!
//!            from x (Borenstein & Feng)   from y (the same)           from heading (Jung & Chung)
//! α =        (x_cw + x_ccw)/(-4L)         (y_cw - y_ccw)/(-4L)        (θ_cw - θ_ccw)/8
//! β =        (x_cw - x_ccw)/(-4L)         (y_cw + y_ccw)/(-4L)        (θ_cw + θ_ccw)/8
//!
//! E_b = 90°/(90° - α)          b = E_b b_nominal
//! R = (L/2)/sin(β/2)           E_d = (R + b/2)/(R - b/2)
//! ```
//!
//! with x, y, θ the mean return errors. Sources: Borenstein & Feng, "Correction of systematic odometry errors in mobile robots", IROS 1995,
//! and IEEE Trans. Robotics and Automation 12(6), 1996; heading: Jung & Chung, Int. J. Advanced Robotic Systems 8(5), 2011. Which wheelbase
//! b is meant in E_d is a choice: see [`RadiusWheelbase`]. Jung & Chung's term that couples β into E_b is omitted: it applies if the error
//! is attributed to one wheel, and here the mean diameter is kept.

use super::correction::Correction;
use crate::dataset::ReturnError;
use crate::drive::DifferentialDrive;
use crate::path::Direction;
use crate::score::{Cluster, Scatter};
use nalgebra::{Matrix2, Matrix2x3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Which of the mean return errors a closed form uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClosedForm {
    /// x.
    X,
    /// y.
    Y,
    /// The mean of the angles from x and from y.
    Mean,
    /// The heading.
    Heading,
}

impl ClosedForm {
    /// All.
    pub const ALL: [ClosedForm; 4] = [ClosedForm::X, ClosedForm::Y, ClosedForm::Mean, ClosedForm::Heading];

    /// (α, β) as linear functions of the mean return error (x, y, θ) of one direction; those of both directions add up.
    fn weights(self, direction: Direction, side: f64) -> Matrix2x3<f64> {
        let (length, turn) = (1.0 / (4.0 * side), 0.125);
        let s = direction.sign();
        match self {
            ClosedForm::X => Matrix2x3::new(-length, 0.0, 0.0, s * length, 0.0, 0.0),
            ClosedForm::Y => Matrix2x3::new(0.0, s * length, 0.0, 0.0, -length, 0.0),
            ClosedForm::Mean => 0.5 * (ClosedForm::X.weights(direction, side) + ClosedForm::Y.weights(direction, side)),
            ClosedForm::Heading => Matrix2x3::new(0.0, 0.0, -s * turn, 0.0, 0.0, turn),
        }
    }

    /// The angles from the mean return errors; `None` where the form needs headings and there are none.
    pub fn angles(self, cw: &Cluster, ccw: &Cluster, side: f64) -> Option<Angles> {
        let part = |cluster: &Cluster, direction| {
            let heading = match self {
                ClosedForm::Heading => cluster.heading?,
                _ => 0.0,
            };
            Some(self.weights(direction, side) * Vector3::new(cluster.x, cluster.y, heading))
        };
        let sum = part(cw, Direction::Cw)? + part(ccw, Direction::Ccw)?;
        Some(Angles { alpha: sum[0], beta: sum[1] })
    }

    /// Covariance of (α, β) from the scatter of the runs.
    pub fn covariance(self, scatter: &Scatter, n_cw: usize, n_ccw: usize, side: f64) -> Matrix2<f64> {
        let part = |direction, n: usize| {
            let weights = self.weights(direction, side);
            weights * scatter.of(direction) * weights.transpose() / n as f64
        };
        part(Direction::Cw, n_cw) + part(Direction::Ccw, n_ccw)
    }
}

/// The wheelbase b in E_d = (R + b/2)/(R - b/2).
///
/// E_d - 1 differs by the relative difference of the wheelbases. One round on a noise-free LabMate of the paper's Table I (306 and 417 mm)
/// leaves, in mm:
///
/// | | x | y | mean | heading |
/// |---|---|---|---|---|
/// | corrected | 10.0, 19.1 | 19.2, 37.1 | 4.6, 9.0 | 0.0, 0.0 |
/// | nominal | 11.4, 21.7 | 18.1, 35.2 | 3.3, 6.8 | 1.3, 2.3 |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RadiusWheelbase {
    /// b_nominal, as the paper's companion writes it: the only b that is known beforehand.
    #[default]
    Nominal,
    /// E_b b_nominal: the true distance of the wheels when they roll along R. With it, the published remaining errors of real robots
    /// (OptiOdom, 2022) are reproduced to the last printed digit; the published corrections are reproduced with either.
    Corrected,
}

impl RadiusWheelbase {
    /// "corrected" or "nominal".
    pub fn name(self) -> &'static str {
        match self {
            RadiusWheelbase::Corrected => "corrected",
            RadiusWheelbase::Nominal => "nominal",
        }
    }

    fn of(self, drive: &DifferentialDrive, e_b: f64) -> f64 {
        match self {
            RadiusWheelbase::Corrected => e_b * drive.wheelbase(),
            RadiusWheelbase::Nominal => drive.wheelbase(),
        }
    }
}

/// The two angles per side of the square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// α \[rad\]: shortfall of each quarter turn.
    pub alpha: f64,
    /// β \[rad\]: rotation to the left on each leg.
    pub beta: f64,
}

impl Angles {
    /// The angles that a correction causes on a square of `side` \[m\]: the closed form read backward.
    pub fn of(correction: &Correction, side: f64, drive: &DifferentialDrive) -> Angles {
        let wheelbase = correction.e_b * drive.wheelbase();
        let curvature = 2.0 / wheelbase * (correction.e_d - 1.0) / (correction.e_d + 1.0);
        Angles {
            alpha: FRAC_PI_2 * (1.0 - 1.0 / correction.e_b),
            beta: 2.0 * libm::asin((0.5 * side * curvature).clamp(-1.0, 1.0)),
        }
    }

    /// E_d and E_b; `None` for impossible angles: a quarter turn or more lost in each turn, or a leg curved about a point between the
    /// wheels.
    ///
    /// ```
    /// use umbmark_core::{calibrate::{Angles, Correction, RadiusWheelbase}, drive::Robot};
    /// let drive = Robot::labmate().drive;
    /// let correction = Correction { e_d: 1.002, e_b: 0.99, e_s: 1.0 };
    /// let back = Angles::of(&correction, 4.0, &drive).correction(4.0, &drive, RadiusWheelbase::Corrected).unwrap();
    /// assert!((back.e_d - 1.002).abs() < 1e-12 && (back.e_b - 0.99).abs() < 1e-12);
    /// ```
    pub fn correction(&self, side: f64, drive: &DifferentialDrive, wheelbase: RadiusWheelbase) -> Option<Correction> {
        let e_b = FRAC_PI_2 / (FRAC_PI_2 - self.alpha);
        // (b/2)/R
        let half = wheelbase.of(drive, e_b) / side * libm::sin(0.5 * self.beta);
        let possible = self.alpha < FRAC_PI_2 && half.abs() < 1.0;
        possible.then(|| Correction { e_d: (1.0 + half) / (1.0 - half), e_b, e_s: 1.0 })
    }

    /// ∂(E_d, E_b)/∂(α, β).
    pub fn correction_jacobian(
        &self,
        side: f64,
        drive: &DifferentialDrive,
        wheelbase: RadiusWheelbase,
    ) -> Matrix2<f64> {
        let e_b = FRAC_PI_2 / (FRAC_PI_2 - self.alpha);
        let per_side = wheelbase.of(drive, e_b) / side;
        let half = per_side * libm::sin(0.5 * self.beta);
        let by_half = 2.0 / ((1.0 - half) * (1.0 - half));
        let half_by_alpha = match wheelbase {
            RadiusWheelbase::Corrected => half * e_b / FRAC_PI_2,
            RadiusWheelbase::Nominal => 0.0,
        };
        let half_by_beta = 0.5 * per_side * libm::cos(0.5 * self.beta);
        Matrix2::new(by_half * half_by_alpha, by_half * half_by_beta, e_b * e_b / FRAC_PI_2, 0.0)
    }

    /// The return error to first order: (2L, ∓2L, 4) φ as in the module's text.
    ///
    /// Any effect that repeats on every side of the square obeys it. E_max,sys to first order is 2√2 L max|φ|.
    ///
    /// ```
    /// use umbmark_core::{calibrate::{Angles, Correction}, drive::Robot, path::Direction};
    /// let labmate = Correction { e_d: 1.00121, e_b: 337.2 / 340.0, e_s: 1.0 };
    /// let angles = Angles::of(&labmate, 4.0, &Robot::labmate().drive);
    /// let error = angles.first_order_return(Direction::Ccw, 4.0);
    /// assert!((error.x.hypot(error.y) - 0.310).abs() < 5e-4); // Table I of the paper: 310 mm
    /// ```
    pub fn first_order_return(&self, direction: Direction, side: f64) -> ReturnError {
        let s = direction.sign();
        let phi = self.beta - s * self.alpha;
        ReturnError { x: s * 2.0 * side * phi, y: -2.0 * side * phi, heading: Some(4.0 * phi) }
    }
}
