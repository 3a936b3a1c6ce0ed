//! `fit`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Keyed, Model, Setup, Taken, ends, finite, taken};
use crate::{effect, evidence, likelihood};

/// A parameter that was fitted.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Estimate {
    /// The effect that has it.
    pub effect: &'static str,
    /// Its name.
    pub parameter: &'static str,
    /// Its value, in the unit that the catalogue states.
    pub value: f64,
    /// Its standard error; null if the data does not determine it.
    pub standard_error: Option<f64>,
    /// Its interval; null if the data does not determine it.
    pub interval: Option<[f64; 2]>,
}

/// What was fitted, with intervals that hold with probability `level`.
pub(super) fn estimates(estimates: &[evidence::Estimate], level: f64) -> Vec<Estimate> {
    let one = |e: &evidence::Estimate| Estimate {
        effect: e.effect,
        parameter: e.parameter,
        value: e.value,
        standard_error: finite(e.standard_error),
        interval: e.interval(level).and_then(ends),
    };
    estimates.iter().map(one).collect()
}

/// A jump of a track that exceeds the noise.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Outlier {
    /// Name of the run.
    pub run: String,
    /// Time since START, in s.
    pub time_s: f64,
    /// Length of the jump, in m.
    pub moved_m: f64,
    /// Rotation in the jump, in rad; null without headings.
    pub turned_rad: Option<f64>,
    /// Size of the jump, in standard deviations of the noise; null if that is not known.
    pub standard_deviations: Option<f64>,
}

impl From<&likelihood::Outlier> for Outlier {
    fn from(o: &likelihood::Outlier) -> Self {
        Outlier {
            run: o.run.clone(),
            time_s: o.time,
            moved_m: o.moved,
            turned_rad: o.turned,
            standard_deviations: finite(o.deviations),
        }
    }
}

/// How a fit ended.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Ended {
    /// Whether at a minimum.
    pub converged: bool,
    /// How.
    pub how: &'static str,
    /// Steps tried.
    pub steps: usize,
}

/// What was known of a number before a fit, and what became of it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct KnownBefore {
    /// The effect that has it.
    pub effect: String,
    /// Its name.
    pub parameter: String,
    /// Its least value; null without one.
    pub low: Option<f64>,
    /// Its greatest value; null without one.
    pub high: Option<f64>,
    /// Its value by an earlier measurement; null without one.
    pub mean: Option<f64>,
    /// Standard deviation of that measurement.
    pub sd: Option<f64>,
    /// Its value by the fit.
    pub value: f64,
    /// Whether it is held at a bound beyond which the fit would be better; it has no interval then.
    pub held: bool,
    /// How far the runs alone are from the earlier measurement, in standard deviations of the difference.
    pub contradiction: Option<f64>,
}

impl From<evidence::KnownBefore<'_>> for KnownBefore {
    fn from(k: evidence::KnownBefore<'_>) -> Self {
        let likelihood::KnownNumber { effect, parameter, known } = k.number;
        KnownBefore {
            effect: effect.clone(),
            parameter: parameter.clone(),
            low: finite(known.low),
            high: finite(known.high),
            mean: known.prior.map(|prior| prior.mean),
            sd: known.prior.map(|prior| prior.sd),
            value: k.value,
            held: k.held,
            contradiction: k.contradiction,
        }
    }
}

/// A fit of a model: its numbers, and the model with them.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Fitted {
    /// The free parameters.
    pub fitted: Vec<Estimate>,
    /// Their correlations, a row each; empty where the data does not determine them.
    pub correlations: Vec<Vec<f64>>,
    /// Free effects that this data cannot separate from the rest; they keep their values.
    pub not_shown: Vec<&'static str>,
    /// Meaning of each fitted effect for the robot, a sentence each.
    pub meaning: Keyed<String>,
    /// Jumps of tracks that exceed the noise.
    pub outliers: Vec<Outlier>,
    /// Whether the values were fitted with noise of the usual sizes: only from tracks, if these values predict held-out runs better by a
    /// tenth than those of maximum likelihood.
    pub usual_noise: bool,
    /// Findings about the data before any fit: faults, clock and mounting of the reference, jumps, wrong poses, outlying runs.
    pub setup: Setup,
    /// Effects of the reference whose values were estimated from the motion.
    pub taken: Vec<Taken>,
    /// How the fit ended.
    pub ended: Ended,
    /// Root mean square distance of observed from predicted positions, in m.
    pub rmse_m: Option<f64>,
    /// The same of headings, in rad; null where none were measured.
    pub heading_rmse_rad: Option<f64>,
    /// Sum of the squared residuals in units of their standard deviations, those of earlier measurements included; from tracks only.
    pub chi2: Option<f64>,
    /// Number of these residuals, those of the runs; from tracks only.
    pub residual_count: Option<usize>,
    /// Akaike's information criterion, corrected for few runs; null where these are too few.
    pub aicc: Option<f64>,
    /// Schwarz's information criterion; null where the runs are too few.
    pub bic: Option<f64>,
    /// Bounds and earlier measurements of numbers.
    pub known: Vec<KnownBefore>,
    /// The model with the fitted values.
    pub model: Model,
    /// Probability with which the intervals hold.
    pub level: f64,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Fitted {
    /// A fit, with intervals that hold with probability `level`.
    pub fn new(fit: &evidence::Fit, level: f64) -> Fitted {
        Fitted {
            fitted: estimates(&fit.estimates, level),
            correlations: fit.correlations.clone(),
            not_shown: not_shown(fit),
            meaning: meaning(&fit.estimates, &fit.model),
            outliers: fit.outliers.iter().map(Outlier::from).collect(),
            usual_noise: fit.usual_noise,
            setup: fit.setup.as_ref().into(),
            taken: taken(&fit.taken),
            ended: Ended {
                converged: fit.ended.termination.converged(),
                how: fit.ended.termination.name(),
                steps: fit.ended.steps,
            },
            rmse_m: finite(fit.leaves.position),
            heading_rmse_rad: fit.leaves.heading,
            chi2: fit.leaves.chi2,
            residual_count: fit.leaves.residuals,
            aicc: fit.leaves.aicc,
            bic: fit.leaves.bic,
            known: fit.known().map(KnownBefore::from).collect(),
            model: Model::with_noise(&fit.model, fit.noise.as_ref()),
            level,
            version: crate::VERSION,
        }
    }
}

/// Said of an effect whose sizes may be nothing by their intervals, which hold with this probability.
const UNCERTAIN: (f64, &str) = (0.95, " That is within its uncertainty.");

/// Each fitted effect with its meaning for the robot.
pub fn meaning(estimates: &[evidence::Estimate], model: &effect::Model) -> Keyed<String> {
    let (level, uncertain) = UNCERTAIN;
    let may_be_nothing = |e: &evidence::Estimate| {
        let nothing = model.place_of(e.effect, e.parameter).and_then(|place| model.nothing(place))?;
        Some(e.interval(level).is_none_or(|i| (i.low..=i.high).contains(&nothing)))
    };
    let mut said: Vec<(&str, String)> = Vec::new();
    for e in estimates {
        if said.iter().all(|(name, _)| *name != e.effect) {
            let sizes = estimates.iter().filter(|other| other.effect == e.effect).filter_map(may_be_nothing);
            let doubt = if sizes.reduce(|all, one| all && one) == Some(true) { uncertain } else { "" };
            said.extend(model.meaning(e.effect).map(|sentence| (e.effect, sentence + doubt)));
        }
    }
    said.into_iter().collect()
}

/// The free effects that were not fitted, because this data cannot separate them from the rest of the model.
pub fn not_shown(fit: &evidence::Fit) -> Vec<&'static str> {
    let is_free = |part: &&effect::Part| part.free && part.fixed.len() < part.values.len();
    let free = fit.model.parts().iter().filter(is_free).map(|part| part.effect.name());
    let is_held = |name: &str| fit.known().any(|known| known.held && known.number.effect == name);
    free.filter(|name| fit.estimates.iter().all(|e| e.effect != *name) && !is_held(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;

    #[test]
    fn an_effect_that_may_be_nothing_by_its_interval_is_said_to_be_within_its_uncertainty() {
        let robot = Robot::labmate();
        let mut model = effect::Model::new(&robot);
        model.set("scale", "e_s", 1.001).unwrap();
        model.set("marker_offset", "forward_m", 0.02).unwrap();
        let said = |e_s: f64, aside: f64| {
            let of = |effect, parameter, value, standard_error| evidence::Estimate {
                effect,
                parameter,
                value,
                standard_error,
                degrees_of_freedom: 1e4,
            };
            let estimates = [
                of("scale", "e_s", 1.001, e_s),
                of("marker_offset", "forward_m", 0.02, 0.1),
                of("marker_offset", "left_m", 0.01, aside),
            ];
            let all = meaning(&estimates, &model);
            ["scale", "marker_offset"].map(|name| all.get(name).unwrap().ends_with(UNCERTAIN.1))
        };
        // 1.96 standard errors; two sizes, of which one is enough.
        assert_eq!(said(0.0006, 0.1), [true, true]);
        assert_eq!(said(0.0005, 0.1), [false, true]);
        assert_eq!(said(0.0006, 0.005), [true, false]);
        assert_eq!(said(f64::NAN, 0.005), [true, false]);
    }
}
