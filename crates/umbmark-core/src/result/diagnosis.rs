//! `diagnose`.

use schemars::JsonSchema;
use serde::Serialize;

use super::fitted::{Estimate, estimates};
use super::law::Nearest;
use super::{Closure, Findings, Keyed, Leaves, Model, finite};
use crate::diagnose::{self, Options, Why};
use crate::drive::Robot;
use crate::effect::effects_text;
use crate::evidence;

/// A test of the whole model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct GoodnessOfFit {
    /// Its name.
    pub name: &'static str,
    /// Its statistic.
    pub statistic: f64,
    /// Degrees of freedom; null where its p is from simulated tests.
    pub degrees_of_freedom: Option<[f64; 2]>,
    /// Probability of a statistic this large if nothing is missing.
    pub p: f64,
}

impl From<&diagnose::GoodnessOfFit> for GoodnessOfFit {
    fn from(g: &diagnose::GoodnessOfFit) -> Self {
        GoodnessOfFit { name: g.name, statistic: g.statistic, degrees_of_freedom: g.degrees_of_freedom, p: g.p }
    }
}

/// A class of effects that may be missing and that this data cannot separate.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Suspect {
    /// Names of its effects.
    pub class: Vec<&'static str>,
    /// The one that fits best.
    pub best: &'static str,
    /// F of adding it.
    pub f: f64,
    /// Degrees of freedom of F.
    pub degrees_of_freedom: [f64; 2],
    /// Probability of an F this large if the effect is absent.
    pub p: f64,
    /// The same, corrected for all classes that were tested.
    pub p_adjusted: f64,
    /// The same by sign flips of runs; null if these were not tested.
    pub p_flips: Option<f64>,
    /// Values of the parameters of the best.
    pub estimate: Keyed<Option<f64>>,
    /// Their standard errors.
    pub standard_error: Keyed<Option<f64>>,
    /// Expected decrease of the sum of squares if it is added.
    pub expected_drop: f64,
    /// Meaning of the values for the robot; null if it has none.
    pub meaning: Option<String>,
}

impl Suspect {
    fn new(suspect: &diagnose::Suspect, robot: &Robot) -> Suspect {
        let of = |value: fn(&evidence::Estimate) -> f64| {
            suspect.estimate.iter().map(|e| (e.parameter, finite(value(e)))).collect()
        };
        Suspect {
            class: suspect.class.clone(),
            best: suspect.best,
            f: suspect.f,
            degrees_of_freedom: suspect.degrees_of_freedom,
            p: suspect.p,
            p_adjusted: suspect.p_adjusted,
            p_flips: suspect.p_flips,
            estimate: of(|e| e.value),
            standard_error: of(|e| e.standard_error),
            expected_drop: suspect.expected_drop,
            meaning: suspect.meaning(robot),
        }
    }
}

/// Minimum detectable size of an effect: detected with a probability of 80 %.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DetectableSize {
    /// The effect.
    pub effect: &'static str,
    /// The parameter that has the size.
    pub parameter: &'static str,
    /// The size, in the unit of the parameter; null if no size would be detected.
    pub size: Option<f64>,
}

/// An effect that the model lacks, of a size that these runs allow, that would bias what is fitted.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Confounder {
    /// The effect.
    pub effect: &'static str,
    /// The parameter that has the size.
    pub parameter: &'static str,
    /// The size, in the unit of the parameter: as these runs show it, else the usual one, or the minimum detectable one where that is smaller.
    pub size: f64,
    /// The fitted numbers that it would move out of their intervals, by more than a tenth of their usual size.
    pub biases: Vec<Bias>,
}

/// By how much an effect that is left out biases a fitted number.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Bias {
    /// The effect that the number belongs to.
    pub effect: &'static str,
    /// The number.
    pub parameter: &'static str,
    /// The bias, without its sign, in the unit of the number.
    pub bias: f64,
    /// Half the width of the number's interval, in the same unit.
    pub half_width: f64,
}

impl From<&diagnose::Confounder> for Confounder {
    fn from(own: &diagnose::Confounder) -> Confounder {
        let of = |b: &diagnose::Bias| Bias {
            effect: b.effect,
            parameter: b.parameter,
            bias: b.bias,
            half_width: b.half_width,
        };
        let biases = own.biases.iter().map(of).collect();
        Confounder { effect: own.effect, parameter: own.parameter, size: own.size, biases }
    }
}

/// A further experiment that separates two effects.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Experiment {
    /// The two effects.
    pub separates: (&'static str, &'static str),
    /// What to drive.
    pub experiment: String,
    /// Its duration, in min.
    pub minutes: f64,
    /// Separation of the two, in standard deviations.
    pub sd: f64,
}

pub(super) fn experiments(experiments: &[diagnose::Experiment]) -> Vec<Experiment> {
    let one = |e: &diagnose::Experiment| Experiment {
        separates: e.separates.into(),
        experiment: e.experiment.clone(),
        minutes: e.minutes,
        sd: e.sd,
    };
    experiments.iter().map(one).collect()
}

/// Change of an end pose per unit of a parameter.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Share {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// Shift of the position per unit of the parameter, in m.
    pub position_m_per_unit: f64,
    /// Change of the heading per unit of the parameter, in rad.
    pub heading_rad_per_unit: f64,
}

/// A combination of parameters that the experiment does not determine.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Hidden {
    /// The weight of each parameter.
    pub weights: Keyed<f64>,
    /// Units of the second parameter that have the effect of one unit of the first, for two parameters; otherwise null.
    pub ratio: Option<f64>,
}

/// What this experiment determines of the model.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Identifiability {
    /// Each free parameter, with its influence on end poses.
    pub parameters: Vec<Share>,
    /// Number of combinations that are determined.
    pub rank: usize,
    /// Combinations that are not determined.
    pub hidden: Vec<Hidden>,
}

impl From<&diagnose::Identifiability> for Identifiability {
    fn from(identifiability: &diagnose::Identifiability) -> Self {
        let share = |s: &diagnose::Share| Share {
            effect: s.effect,
            parameter: s.parameter,
            position_m_per_unit: s.position,
            heading_rad_per_unit: s.heading,
        };
        let hidden = identifiability.hidden.iter();
        let hidden = hidden.map(|h| Hidden { weights: h.weights.iter().copied().collect(), ratio: h.ratio });
        Identifiability {
            parameters: identifiability.shares.iter().map(share).collect(),
            rank: identifiability.rank,
            hidden: hidden.collect(),
        }
    }
}

/// A point of a curve, with its 95 % band.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CurvePoint {
    /// Value of the covariate, in the curve's `at_unit`.
    pub at: f64,
    /// Value of the curve, in its `unit`.
    pub value: f64,
    /// Lower end of its band.
    pub low: f64,
    /// Upper end of its band.
    pub high: f64,
}

/// The missing motion as a function of what it depends on.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Curve {
    /// Unit of the covariate.
    pub at_unit: &'static str,
    /// Unit of the missing motion.
    pub unit: String,
    /// Its points, in order.
    pub points: Vec<CurvePoint>,
}

/// A formula to try, and the share of the curve that it explains.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Suggestion {
    /// The formula as an effect of a model.
    #[serde(flatten)]
    pub model: Model,
    /// The share of the curve that it explains.
    pub share: f64,
    /// The same as text of a model file.
    pub toml: String,
}

/// A missing effect that is not in the catalogue.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Unlisted {
    /// What it acts on.
    pub acts_on: &'static str,
    /// What it depends on.
    pub depends_on: &'static str,
    /// Probability of a dependence this strong by chance, corrected for all tests.
    pub p_adjusted: f64,
    /// How it depends on it.
    pub curve: Curve,
    /// The effect of the catalogue that explains the largest share of it; null if no effect explains any.
    pub nearest: Option<Nearest>,
    /// A formula to try; null if none fits.
    pub suggestion: Option<Suggestion>,
}

impl From<&diagnose::Dependence> for Unlisted {
    fn from(told: &diagnose::Dependence) -> Self {
        let point = |p: &diagnose::CurvePoint| CurvePoint {
            at: p.at,
            value: p.value,
            low: p.value - p.half_width,
            high: p.value + p.half_width,
        };
        let suggestion = |suggestion: &diagnose::Suggestion| Suggestion {
            model: (&suggestion.model).into(),
            share: suggestion.share,
            toml: effects_text(&suggestion.model),
        };
        Unlisted {
            acts_on: told.acts_on,
            depends_on: told.depends_on,
            p_adjusted: told.p_adjusted,
            curve: Curve {
                at_unit: told.curve.at_unit,
                unit: told.curve.unit.clone(),
                points: told.curve.points.iter().map(point).collect(),
            },
            nearest: told.nearest.map(Nearest::new),
            suggestion: told.suggestion.as_ref().map(suggestion),
        }
    }
}

/// What a model is missing, how certain that is, and what this data cannot show.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Diagnosis {
    /// "explained"; "missing_effect" or "several_missing"; "unlisted_effect", which is not in the catalogue; "not_explained" if the model
    /// does not suffice although no single effect is certified (`reasons` say why); or "not_enough_data".
    pub verdict: &'static str,
    /// "end_poses" or "tracks".
    pub observed: &'static str,
    /// The free parameters of the model.
    pub fitted: Vec<Estimate>,
    /// Their correlations, a row each; empty where the data does not determine them.
    pub correlations: Vec<Vec<f64>>,
    /// Tests of the whole model.
    pub goodness_of_fit: Vec<GoodnessOfFit>,
    /// Classes of effects that were tested; the first `certified` of them are missing.
    pub ranking: Vec<Suspect>,
    /// Number of missing classes at the head of the ranking.
    pub certified: usize,
    /// Effects that this data cannot show; `absorbed` names the effects that mask them.
    pub invisible: Vec<&'static str>,
    /// Effects that other effects of the model absorb, with the names of these.
    pub absorbed: Keyed<Vec<&'static str>>,
    /// Minimum detectable size of each effect.
    pub minimum_detectable: Keyed<Option<f64>>,
    /// The same for each parameter.
    pub minimum_detectable_sizes: Vec<DetectableSize>,
    /// Effects that the model lacks, of sizes that these runs allow, that would bias its first numbers, the worst first.
    pub confounders: Vec<Confounder>,
    /// What to measure next, the most informative per minute first.
    pub next_experiments: Vec<Experiment>,
    /// What this experiment determines of the model.
    pub identifiability: Identifiability,
    /// A missing effect that is not in the catalogue; null if there is none.
    pub unlisted: Option<Unlisted>,
    /// The model with its fitted parameters.
    pub model: Model,
    /// Findings about the model and the data.
    #[serde(flatten)]
    pub findings: Findings,
    /// Further remarks, a sentence each.
    pub remarks: Vec<String>,
    /// False-alarm rate: probability that a complete model is rejected.
    pub size: f64,
    /// Simulated tests for p-values that have no closed form.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Version of umbmark.
    pub version: &'static str,
    /// The closure of a square: contrasts, and end points on a circle.
    #[serde(flatten)]
    pub closure: Closure,
    /// The remaining error of the model.
    #[serde(flatten)]
    pub leaves: Leaves,
}

impl Diagnosis {
    /// A diagnosis, asked with `options`.
    pub fn new(diagnosis: &diagnose::Diagnosis, options: &Options) -> Diagnosis {
        let size = |d: &diagnose::Detectable| DetectableSize {
            effect: d.effect,
            parameter: d.parameter,
            size: finite(d.size),
        };
        Diagnosis {
            verdict: diagnosis.verdict.name(),
            observed: diagnosis.level.name(),
            fitted: estimates(&diagnosis.fitted, 1.0 - options.size),
            correlations: diagnosis.correlations.clone(),
            goodness_of_fit: diagnosis.goodness_of_fit.iter().map(GoodnessOfFit::from).collect(),
            ranking: diagnosis.ranking.iter().map(|s| Suspect::new(s, diagnosis.model.robot())).collect(),
            certified: diagnosis.certified,
            invisible: diagnosis.invisible.iter().map(|u| u.effect).collect(),
            absorbed: diagnosis.invisible.iter().filter_map(absorbed).collect(),
            minimum_detectable: largest(&diagnosis.minimum_detectable),
            minimum_detectable_sizes: diagnosis.minimum_detectable.iter().map(size).collect(),
            confounders: diagnosis.confounders.iter().map(Confounder::from).collect(),
            next_experiments: experiments(&diagnosis.next_experiments),
            identifiability: (&diagnosis.identifiability).into(),
            unlisted: diagnosis.dependence.as_ref().map(Unlisted::from),
            model: (&diagnosis.model).into(),
            findings: diagnosis.into(),
            remarks: diagnosis.remarks.clone(),
            size: options.size,
            draws: options.draws,
            seed: options.seed,
            version: crate::VERSION,
            closure: Closure::new(&diagnosis.contrasts, &diagnosis.circle),
            leaves: diagnosis.remains.as_ref().into(),
        }
    }
}

fn absorbed(unseen: &diagnose::Unseen) -> Option<(&'static str, Vec<&'static str>)> {
    match &unseen.why {
        Why::Absorbed(by) => Some((unseen.effect, by.clone())),
        Why::BelowNoise => None,
    }
}

/// For each effect, the largest of its sizes' least; none where one of them cannot be seen at any size.
fn largest(detectable: &[diagnose::Detectable]) -> Keyed<Option<f64>> {
    let mut sizes: Vec<(&str, f64)> = Vec::new();
    for d in detectable {
        match sizes.iter_mut().find(|(effect, _)| *effect == d.effect) {
            Some((_, size)) => *size = size.max(d.size),
            None => sizes.push((d.effect, d.size)),
        }
    }
    sizes.into_iter().map(|(effect, size)| (effect, finite(size))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_with_a_size_that_is_never_seen_has_no_least_size_in_whichever_order_they_stand() {
        let sizes = [("x_m", f64::INFINITY), ("y_m", 0.01)];
        let of = |order: [usize; 2]| {
            let detectable =
                order.map(|i| diagnose::Detectable { effect: "start_pose", parameter: sizes[i].0, size: sizes[i].1 });
            serde_json::to_value(largest(&detectable)).unwrap()
        };
        let never = serde_json::json!({ "start_pose": null });
        assert_eq!((of([0, 1]), of([1, 0])), (never.clone(), never));
    }
}
