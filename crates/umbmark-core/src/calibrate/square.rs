//! The closed forms on a square that was driven in both directions.

use super::closed_form::{ClosedForm, RadiusWheelbase};
use super::estimate::{Estimate, Method};
use super::{Correction, drive_again};
use crate::dataset::ReturnError;
use crate::drive::Robot;
use crate::path::{Direction, Path, SQUARE};
use crate::prose::listed;
use crate::score::{Cluster, Scatter, Summary, summarise};
use nalgebra::{Matrix2, Matrix3, Vector2};

/// A square driven both ways, for the closed forms.
pub(super) struct Square<'a> {
    robot: &'a Robot,
    path: &'a Path,
    side: f64,
    summary: Summary,
    scatter: Option<Scatter>,
}

impl<'a> Square<'a> {
    pub fn new(
        path: Option<&'a Path>,
        robot: &'a Robot,
        cw: &[ReturnError],
        ccw: &[ReturnError],
        warnings: &mut Vec<String>,
    ) -> Option<Square<'a>> {
        let refused = match path {
            None => "the path is not known; they need the side of the square".to_owned(),
            Some(path) if !std::ptr::eq(path.shape(), &SQUARE) => {
                format!("they are made for a square, and the path is a {}", path.shape().name.replace('_', " "))
            }
            Some(_) if cw.is_empty() || ccw.is_empty() => {
                "they need runs in both directions: in one alone, E_d and E_b cannot be separated".to_owned()
            }
            Some(path) => {
                let summary = summarise(cw, ccw);
                return Some(Square {
                    robot,
                    path,
                    side: path.values()[0],
                    summary,
                    scatter: Scatter::pooled(cw, ccw),
                });
            }
        };
        warnings.push(format!("No closed forms: {refused}."));
        None
    }

    pub fn estimates(&self, wheelbase: RadiusWheelbase, warnings: &mut Vec<String>) -> Vec<Estimate> {
        let (Some(cw), Some(ccw)) = (self.summary.cw, self.summary.ccw) else { return Vec::new() };
        let mut coarse = Vec::new();
        let mut estimate = |form: ClosedForm| {
            let name = Method::ClosedForm(form).name();
            let Some(angles) = form.angles(&cw, &ccw, self.side) else {
                warnings.push(format!("No {name}: return headings were not measured in both directions."));
                return None;
            };
            let Some(correction) = angles.correction(self.side, &self.robot.drive, wheelbase) else {
                warnings.push(format!(
                    "No {name}: its angles, {:.1} deg a turn and {:.1} deg a leg, belong to no robot. Are signs and units right?",
                    angles.alpha.to_degrees(),
                    angles.beta.to_degrees()
                ));
                return None;
            };
            let scatter = self.scatter.filter(|s| form != ClosedForm::Heading || s.with_heading);
            let covariance = scatter.map(|scatter| {
                let by_angles = angles.correction_jacobian(self.side, &self.robot.drive, wheelbase);
                let of_angles = form.covariance(&scatter, cw.n, ccw.n, self.side);
                by_angles * of_angles * by_angles.transpose()
            });
            if let Some((covariance, bias)) = covariance.zip(self.bias(form, &correction, wheelbase))
                && bias.iter().zip(covariance.diagonal().iter()).any(|(bias, variance)| bias * bias > *variance)
            {
                coarse.push(name);
            }
            let covariance = covariance.map(widen);
            let freedom = scatter.map_or(0.0, |s| s.degrees_of_freedom as f64);
            Some(Estimate { covariance, ..Estimate::new(Method::ClosedForm(form), correction, freedom) })
        };
        let estimates = ClosedForm::ALL.into_iter().filter_map(&mut estimate).collect();
        if !coarse.is_empty() {
            warnings.push(format!(
                "Of first order in the errors, {} would be off by more than a standard error on exact returns of the robot that is told: the \
                 interval leaves that out. Use the exact fit.",
                listed(&coarse)
            ));
        }
        estimates
    }

    /// What a closed form makes of the exact return errors of a robot with its own E_d and E_b, less these: its equations are of first order.
    fn bias(&self, form: ClosedForm, own: &Correction, wheelbase: RadiusWheelbase) -> Option<Vector2<f64>> {
        let exact = |direction| {
            let error = drive_again(self.robot, self.path, direction, own, &Correction::NONE)?;
            Cluster::of(&[error])
        };
        let angles = form.angles(&exact(Direction::Cw)?, &exact(Direction::Ccw)?, self.side)?;
        let told = angles.correction(self.side, &self.robot.drive, wheelbase)?;
        Some(Vector2::new(told.e_d - own.e_d, told.e_b - own.e_b))
    }
}

fn widen(covariance: Matrix2<f64>) -> Matrix3<f64> {
    let mut wide = Matrix3::zeros();
    wide.fixed_view_mut::<2, 2>(0, 0).copy_from(&covariance);
    wide
}
