//! Whether the numbers that were fitted are the same all along the runs.
//!
//! A dependence that is not added, because it lowers the error of held-out runs too little, can still bend the numbers: wheels that shrink by
//! 0.4 % in the course of each run leave less than chance does in turns, and E_d, E_b and E_s are 7 to 11 standard errors off. So a
//! smooth is a reason for doubt where it is certain and as large as a share of the way that matters.

use super::curve::curve;
use super::examination::Examination;
use super::responses::Question;
use super::significance;
use super::smooth::{Exposure, Motion};
use crate::diagnose::options::Options;
use crate::diagnose::reason::Reason;

/// Maximum p of such a smooth among all smooths: by F or the scatter of runs, and by flips.
const SIZE: (f64, f64) = (1e-6, 0.01);
/// Standard deviation over the range of what it depends on, as a share of the way.
const LEAST: f64 = 5e-4;

/// The reason that the largest of such smooths gives.
pub(super) fn of_smooths(exam: &Examination, options: &Options) -> Option<Reason> {
    let arm = 0.5 * exam.fitted.observed.robot.drive.wheelbase();
    let certain = significance::smooths(exam, options).iter();
    let shares = certain.filter_map(|finding| {
        let Question::Smooth(covariate, motion) = &exam.asked[finding.answer.asked].question else { return None };
        let scale = match (covariate.exposure, motion) {
            (Exposure::Way | Exposure::AnyWay, Motion::Forward) => 1.0,
            (Exposure::Way | Exposure::AnyWay, Motion::Yaw) => arm,
            _ => return None,
        };
        let values: Vec<f64> =
            curve(exam, finding, covariate, *motion).points.iter().map(|point| scale * point.value).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let spread = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        (finding.p_f <= SIZE.0 && finding.p_flips <= SIZE.1 && spread > LEAST).then_some((
            spread,
            motion.name(),
            covariate.title,
        ))
    });
    let (share, motion, on) = shares.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Reason::Varies { share, motion, on })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{complete, fitted_to};
    use super::*;
    use crate::diagnose::tests::robot_with;
    use crate::effect::{Formula, Target};

    /// Wheels that grow by 0.3 permille with each metre, which the fitted model lacks.
    #[test]
    fn a_share_that_changes_along_the_way_is_told_and_of_a_complete_model_none_is() {
        assert_eq!(of_smooths(complete(), &Options::default()), None);
        let mut growing = robot_with(&[]);
        let law = Formula::new("growing", Target::ForwardScale, "k * distance", &["k"]).unwrap();
        growing.add_formula(law, &[3e-4]).unwrap();
        let exam = Examination::new(fitted_to(&growing)).unwrap();
        let Some(Reason::Varies { share, motion, on }) = of_smooths(&exam, &Options::default()) else {
            panic!("nothing is told");
        };
        // A straight line over 16 m has 3e-4 times 16 m over root 12, 1.4e-3.
        assert!((8e-4..2e-3).contains(&share), "{share}");
        assert_eq!(motion, "forward");
        assert!(["the time in the run", "the place in the run and its sense"].contains(&on), "{on}");
    }
}
