//! The ratios by one method, and how sure they are.

use super::closed_form::ClosedForm;
use super::correction::{Correction, Ratio};
use super::outcome::Replayed;
use crate::fit::Termination;
use crate::stats::{Interval, student_t_quantile};
use nalgebra::Matrix3;

/// How an estimate was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// A published closed form.
    ClosedForm(ClosedForm),
    /// The non-linear fit of the full kinematics.
    Exact,
    /// The model that was learnt: E_d, E_b and E_s beside all other effects that the runs show.
    Model,
}

impl Method {
    /// All, in the order in which they are listed.
    pub const ALL: [Method; 6] = [
        Method::ClosedForm(ClosedForm::X),
        Method::ClosedForm(ClosedForm::Y),
        Method::ClosedForm(ClosedForm::Mean),
        Method::ClosedForm(ClosedForm::Heading),
        Method::Exact,
        Method::Model,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Method::ClosedForm(ClosedForm::X) => "closed_form_x",
            Method::ClosedForm(ClosedForm::Y) => "closed_form_y",
            Method::ClosedForm(ClosedForm::Mean) => "closed_form_mean",
            Method::ClosedForm(ClosedForm::Heading) => "heading",
            Method::Exact => "exact",
            Method::Model => "model",
        }
    }
}

/// The ratios by one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The method.
    pub method: Method,
    /// The ratios; 1 where the data does not show one.
    pub correction: Correction,
    /// Which of E_d, E_b, E_s the data shows.
    pub shown: [bool; 3],
    /// Covariance of E_d, E_b, E_s, zero where not shown; `None` for single runs.
    pub covariance: Option<Matrix3<f64>>,
    /// ν of Student's t for intervals.
    pub degrees_of_freedom: f64,
    /// E_max,sys of the test as driven \[m\].
    pub e_max_sys_before: Option<f64>,
    /// E_max,sys predicted for the same test, driven with the correction \[m\].
    pub e_max_sys_after: Option<f64>,
    /// The recorded ticks computed with the nominal lengths; `None` without ticks.
    pub replayed_before: Option<Replayed>,
    /// The recorded ticks computed with the correction; `None` without ticks.
    pub replayed_after: Option<Replayed>,
    /// Why the fit stopped; `None` for closed forms.
    pub termination: Option<Termination>,
}

impl Estimate {
    /// E_d and E_b alone, without their uncertainty and consequences.
    pub(crate) fn new(method: Method, correction: Correction, degrees_of_freedom: f64) -> Estimate {
        Estimate {
            method,
            correction,
            shown: [true, true, false],
            covariance: None,
            degrees_of_freedom,
            e_max_sys_before: None,
            e_max_sys_after: None,
            replayed_before: None,
            replayed_after: None,
            termination: None,
        }
    }

    /// A ratio, where the data shows it.
    pub fn ratio(&self, ratio: Ratio) -> Option<f64> {
        self.shown[ratio as usize].then(|| self.correction.values()[ratio as usize])
    }

    /// Its standard error.
    pub fn std_error(&self, ratio: Ratio) -> Option<f64> {
        let i = ratio as usize;
        self.covariance.filter(|_| self.shown[i]).map(|c| c[(i, i)].max(0.0).sqrt())
    }

    /// Its interval with probability `level`: Student's t.
    pub fn interval(&self, ratio: Ratio, level: f64) -> Option<Interval> {
        let t = student_t_quantile(0.5 + 0.5 * level, self.degrees_of_freedom);
        Some(Interval::around(self.ratio(ratio)?, t * self.std_error(ratio)?))
    }
}
