//! Learning from return poses.

use super::{Evidence, Squares};
use crate::diagnose::ends::{self, Ends, Fitted, Moments};
use crate::diagnose::{self, DiagnoseError, Diagnosis, Estimate};
use crate::effect::Model;
use nalgebra::DVector;

impl Evidence for Ends {
    fn nominal(&self) -> Model {
        Model::new(&self.robot)
    }

    fn runs(&self) -> usize {
        self.runs.len()
    }

    fn without(&self, run: usize) -> Ends {
        let mut rest = self.clone();
        rest.runs.remove(run);
        rest
    }

    fn both_ways(&self) -> bool {
        self.counts().iter().all(|n| *n > 1)
    }

    fn fit(&self, model: &Model) -> Result<(Model, Vec<Estimate>), DiagnoseError> {
        Fitted::new(self, model).map(|fitted| (fitted.model, fitted.estimates))
    }

    fn diagnose(&self, model: &Model, options: &diagnose::Options) -> Result<Diagnosis, DiagnoseError> {
        ends::diagnose(self, model, options)
    }

    fn likeliest(&self, model: &Model) -> Result<Option<&'static str>, DiagnoseError> {
        ends::likeliest(self, model)
    }

    fn squares(&self, model: &Model, run: usize) -> Squares {
        let residual = self.residuals(model)[run];
        let weighted = self.runs[run].weight * residual;
        Squares {
            positions: 1,
            position: residual.xy().norm_squared(),
            headings: usize::from(self.with_heading),
            heading: residual.z * residual.z,
            weighted: weighted.rows(0, self.coordinates()).norm_squared(),
            weights: self.coordinates(),
        }
    }

    /// From the normal likelihood of N runs with one unknown covariance: N ln |Σ̂| and 2k or k ln N for k parameters.
    fn criteria(&self, model: &Model) -> Option<[f64; 2]> {
        let d = self.coordinates();
        let fitted = Fitted::new(self, model).ok()?;
        let of_run = |r: &nalgebra::Vector3<f64>| DVector::from_column_slice(&r.as_slice()[..d]);
        let runs: Vec<_> =
            self.runs.iter().zip(&fitted.residuals).map(|(run, r)| (run.direction as usize, of_run(r))).collect();
        let moments = Moments::of(&runs);
        let n = runs.len() as f64;
        let mut covariance = moments.scatter.clone();
        for group in 0..2 {
            covariance.ger(moments.count(group), &moments.means[group], &moments.means[group], 1.0);
        }
        let determinant = (covariance / n).cholesky()?.determinant();
        let (values, parameters) = (n * d as f64, (fitted.free.len() + d * (d + 1) / 2) as f64);
        let spare = values - parameters - 1.0;
        if !(determinant > 0.0) || spare <= 0.0 {
            return None;
        }
        let deviance = n * libm::log(determinant);
        let aicc = deviance + 2.0 * parameters * values / spare;
        Some([aicc, deviance + parameters * libm::log(n)])
    }
}
