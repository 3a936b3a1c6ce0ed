//! Models compared with return poses.

use super::replicas::{NoiseSource, Replicas};
use super::statistics::Statistic;
use crate::dataset::Dataset;
use crate::diagnose::ends::{self, Asked};
use crate::diagnose::{Contrast, OnCircle, Options, Remains, base_model};
use crate::effect::Model;
use crate::evidence::ends::Fitted;
use crate::evidence::{Ends, Evidence, FitError, Level};
use crate::path::Direction;
use crate::setup::Setup;
use std::sync::Arc;

/// Result of one model.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Its name.
    pub name: String,
    /// Source of the scatter of the simulated tests.
    pub noise: NoiseSource,
    /// Of both directions.
    pub statistics: Vec<Statistic>,
    /// p of the smallest of them.
    pub p: f64,
    /// Root mean square distance of observed from predicted ends \[m\].
    pub rmse: f64,
    /// The same of headings \[rad\].
    pub heading_rmse: Option<f64>,
    /// The remaining error, and how much of it is the same in every run of a direction.
    pub remains: Remains,
    /// What is explained and what not, a sentence each.
    pub sentences: Vec<String>,
    /// Whether faults, outlying runs or jumps put the return errors in doubt: then no model explains them.
    pub in_doubt: bool,
}

/// Models side by side, on return poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Number of runs clockwise and counter-clockwise.
    pub runs: [usize; 2],
    /// In the order in which they were given.
    pub models: Vec<Judged>,
    /// Closure contrasts of a square driven both ways, after a fit of E_d and E_b.
    pub contrasts: Vec<Contrast>,
    /// End points beside the circle through START.
    pub circle: Vec<OnCircle>,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
    /// What was found of the return errors before anything was compared.
    pub setup: Arc<Setup>,
}

impl Judged {
    /// Whether no test rejects the model at this size of the whole test.
    pub fn explains(&self, size: f64) -> bool {
        self.p >= size && !self.in_doubt
    }
}

/// [`compare`](super::compare) with the return poses alone, even where the runs were observed on the way.
pub fn compare_returns(data: &Dataset, models: &[(String, Model)], options: &Options) -> Result<Comparison, FitError> {
    compare(Ends::examined(data)?, data, models, options)
}

/// Compares models with return poses.
pub(super) fn compare(
    ends: Ends,
    data: &Dataset,
    models: &[(String, Model)],
    options: &Options,
) -> Result<Comparison, FitError> {
    models.iter().try_for_each(|(_, model)| model.check_robot(&ends.robot))?;
    models.iter().try_for_each(|(_, model)| ends.check(model))?;
    let fitted = Fitted::new(&ends, &base_model(&ends.robot)?)?;
    let confidence = 1.0 - options.size;
    let circle = ends::circle(&ends, &fitted, confidence);
    let mut remarks = Vec::new();
    if Asked::wilks_p(&ends, &fitted).is_some_and(|p| p < options.size) {
        remarks.extend(circle.iter().filter_map(ends::contradiction));
    }
    if !ends.enough() {
        let [cw, ccw] = ends.counts();
        remarks.push(format!("Few runs, {cw} cw and {ccw} ccw: p-values are unreliable below 3 + 3."));
    }
    if Level::of(data) == Level::Tracks {
        remarks.push("The runs were observed on the way; their return poses alone are compared here.".into());
    }
    let models = models.iter().map(|(name, model)| judge(name, model, &ends, &fitted, options)).collect();
    let contrasts = ends::contrasts(&ends, &fitted, confidence);
    Ok(Comparison { runs: ends.counts(), models, contrasts, circle, remarks, setup: ends.setup })
}

fn judge(name: &str, model: &Model, ends: &Ends, fitted: &Fitted, options: &Options) -> Judged {
    let residuals = ends.residuals(model);
    let replicas = Replicas::new(model, ends, fitted, options);
    let (statistics, p) = replicas.judge(ends, model);
    let n = residuals.len().max(1) as f64;
    let in_doubt = !ends.is_sound() || !ends.doubts.is_empty();
    let rms = |sum: f64| (sum / n).sqrt();
    Judged {
        name: name.to_owned(),
        noise: replicas.source,
        sentences: sentences(&statistics, options.size, in_doubt),
        in_doubt,
        statistics,
        p,
        remains: ends::remains(ends, &residuals, options),
        rmse: rms(residuals.iter().map(|r| r.xy().norm_squared()).sum()),
        heading_rmse: ends.with_heading.then(|| rms(residuals.iter().map(|r| r.z * r.z).sum())),
    }
}

/// For each direction, what is explained and what is not. Single statistics are Bonferroni-corrected.
fn sentences(statistics: &[Statistic], size: f64, in_doubt: bool) -> Vec<String> {
    let least = size / statistics.len().max(1) as f64;
    let of = |direction: Direction| {
        let all: Vec<&Statistic> = statistics.iter().filter(|s| s.direction == direction).collect();
        let failing: Vec<String> = all.iter().filter(|s| s.p < least).map(|s| phrase(s)).collect();
        let verdict = match (all.is_empty(), failing.is_empty()) {
            (true, _) => return None,
            (false, true) if in_doubt => "no statement while the return errors are in doubt".to_owned(),
            (false, true) => "explained: means, spread and correlation agree with simulated tests".to_owned(),
            (false, false) => format!("not explained: {}", failing.join("; ")),
        };
        Some(format!("{} runs: {verdict}.", direction.name()))
    };
    Direction::BOTH.into_iter().filter_map(of).collect()
}

fn phrase(statistic: &Statistic) -> String {
    let quantity = statistic.quantity;
    let (scale, unit) = quantity.display();
    format!(
        "{} is {:.2}{unit}, predicted {:.2}{unit} (p = {:.3})",
        quantity.name(),
        scale * statistic.measured,
        scale * statistic.predicted,
        statistic.p
    )
}
