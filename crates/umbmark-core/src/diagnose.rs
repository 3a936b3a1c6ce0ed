//! Which class of effects a model is missing, how sure that is, and what this data cannot see.
//!
//! Two kinds of evidence, one answer: return poses alone (`ends`), where a square driven both ways shows six numbers and
//! exact small-sample tests exist; and tick logs with absolute poses on the way (`tracks`), where almost every effect leaves
//! a trace of its own. Effects that the data cannot tell apart are named together, as a class.

mod candidates;
pub mod classes;
pub(crate) mod ends;
pub(crate) mod experiments;
mod identifiability;
mod likeness;
mod reason;
mod remains;
pub(crate) mod tracks;

use crate::dataset::Dataset;
use crate::drive::Robot;
use crate::effect::{Model, ModelError, find};
use crate::evidence::{self, AnyEvidence, Ends, Estimate, Evidence, FitError, Level, robot_of};
use crate::likelihood::{Outlier, Taken};
use crate::setup::Setup;
use std::sync::Arc;

pub use candidates::{Candidate, Size, candidates, columns};
pub use ends::{Contrast, OnCircle};
pub use identifiability::{Identifiability, Share, identifiability};
pub use likeness::Likeness;
pub use reason::Reason;
pub(crate) use remains::Trail;
pub use remains::{Chance, Left, Remains, Repeating};
pub use tracks::{Repeated, Suggestion, UnlistedLaw, what_repeats};

/// How to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Probability with which a complete model is accused all the same: the family-wise size of all tests together.
    pub size: f64,
    /// Simulated tests that p-values without a closed form are taken from.
    pub draws: usize,
    /// Seed of those.
    pub seed: u64,
    /// Whether to use return poses alone, even where the runs were observed on the way.
    pub ends_only: bool,
    /// Which of the laws that stand out is added first where no effect of the catalogue explains what repeats: 1 for the one that would be
    /// taken, 2 for the first of its [`Repeated::others`], and so on.
    pub law: usize,
}

impl Default for Options {
    /// 5 %, 999 draws, seed 1, the first law.
    fn default() -> Self {
        Options { size: 0.05, draws: 999, seed: 1, ends_only: false, law: 1 }
    }
}

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No sign of a further effect, as far as this data can see.
    Explained,
    /// One class of effects is missing.
    MissingEffect,
    /// More than one class is missing.
    SeveralMissing,
    /// Something is missing that no effect of the catalogue explains.
    UnlistedEffect,
    /// Too few runs, or of one direction only.
    NotEnoughData,
    /// Nothing further is certified, and yet the model does not explain the data; the reasons say why.
    NotExplained,
}

impl Verdict {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Explained => "explained",
            Verdict::MissingEffect => "missing_effect",
            Verdict::SeveralMissing => "several_missing",
            Verdict::UnlistedEffect => "unlisted_effect",
            Verdict::NotEnoughData => "not_enough_data",
            Verdict::NotExplained => "not_explained",
        }
    }
}

/// A test of the whole model against what it leaves unexplained.
#[derive(Clone, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Which test.
    pub name: &'static str,
    /// Its statistic.
    pub statistic: f64,
    /// Degrees of freedom, where it is an F; none where p comes from simulation.
    pub degrees_of_freedom: Option<[f64; 2]>,
    /// Probability of so large a statistic where the model is complete.
    pub p: f64,
}

/// A class of effects that may be missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// All effects that this data cannot tell apart from the best, the best included.
    pub class: Vec<&'static str>,
    /// The effect of the class that fits best.
    pub best: &'static str,
    /// Its F (t² for one size).
    pub f: f64,
    /// Degrees of freedom of F.
    pub degrees_of_freedom: [f64; 2],
    /// p of this class alone.
    pub p: f64,
    /// p of the greatest among all classes that were asked.
    pub p_adjusted: f64,
    /// p of the greatest when the signs of the runs' scores are flipped, where there are runs enough: it trusts no
    /// noise model.
    pub p_flips: Option<f64>,
    /// Sizes of the best effect after one step from zero.
    pub estimate: Vec<Estimate>,
    /// By how much the misfit would fall, in units of the noise variance: it ranks the classes.
    pub expected_drop: f64,
}

impl Suspect {
    /// What the best effect would mean for the robot at its estimated size, in a sentence; `None` where it says nothing or
    /// cannot have that size.
    pub fn meaning(&self, robot: &Robot) -> Option<String> {
        let mut model = Model::new(robot);
        for e in &self.estimate {
            model.set(e.effect, e.parameter, e.value).ok()?;
        }
        model.meaning(self.best)
    }
}

/// An effect that this data says nothing of.
#[derive(Clone, Debug, PartialEq)]
pub struct Unseen {
    /// The effect.
    pub effect: &'static str,
    /// Why.
    pub why: Why,
}

/// Why an effect cannot be seen.
#[derive(Clone, Debug, PartialEq)]
pub enum Why {
    /// Whatever it does, these parameters of the model do as well.
    Absorbed(Vec<&'static str>),
    /// At its usual size it moves no observation by as much as the noise.
    BelowNoise,
}

/// The least size of an effect that this data would show in four cases of five.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectable {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// \[unit of the parameter\]
    pub size: f64,
}

/// A further experiment that tells two effects apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The two.
    pub separates: [&'static str; 2],
    /// What to do, in words.
    pub experiment: String,
    /// How long it takes.
    pub minutes: f64,
    /// How far apart the two would then be, in standard deviations; 3.3 is seen in nine cases of ten.
    pub sd: f64,
}

/// What a diagnosis found.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// What was observed.
    pub level: Level,
    /// In one word.
    pub verdict: Verdict,
    /// The model, its free parameters fitted to this data.
    pub model: Model,
    /// Those parameters.
    pub fitted: Vec<Estimate>,
    /// Their correlations, a row each; empty where they are not known.
    pub correlations: Vec<Vec<f64>>,
    /// Tests of the model as a whole.
    pub goodness_of_fit: Vec<GoodnessOfFit>,
    /// All classes that were asked: those that may be certified first, and of these the likeliest first.
    pub ranking: Vec<Suspect>,
    /// How many of the first of the ranking are certified as missing.
    pub certified: usize,
    /// What this data cannot see.
    pub invisible: Vec<Unseen>,
    /// How alike the effects that it can see look.
    pub likeness: Likeness,
    /// What it would have seen.
    pub minimum_detectable: Vec<Detectable>,
    /// What to measure next, the most telling per minute first.
    pub next_experiments: Vec<Experiment>,
    /// Closure contrasts of a square driven both ways, after the fit.
    pub contrasts: Vec<Contrast>,
    /// End points beside the circle through START, direction by direction; for squares.
    pub circle: Vec<OnCircle>,
    /// What of the model this experiment determines.
    pub identifiability: Identifiability,
    /// What an effect outside the catalogue acts on and depends on; from tracks only.
    pub dependence: Option<Dependence>,
    /// Where runs were disturbed, and what happened there left out; from tracks only.
    pub outliers: Vec<Outlier>,
    /// What was found of the experiment before anything was fitted.
    pub setup: Arc<Setup>,
    /// What of that was taken into the model.
    pub taken: Vec<Taken>,
    /// Why the model is not called explained, or would not be.
    pub reasons: Vec<Reason>,
    /// What repeats most beside the model, whether it counts or not; from tracks only.
    pub repeats: Option<Repeated>,
    /// What the model leaves; none where the columns are not what they are called.
    pub remains: Option<Remains>,
    /// What else should be said, a sentence each.
    pub remarks: Vec<String>,
}

/// What is missing and not in the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependence {
    /// The motion that it adds to: "forward", "sideways" or "yaw".
    pub acts_on: &'static str,
    /// What it depends on, as formulas of the user's own have it.
    pub depends_on: &'static str,
    /// The same in words.
    pub title: &'static str,
    /// p among all that was asked.
    pub p_adjusted: f64,
    /// By how much the misfit would fall, in units of the noise variance.
    pub drop: f64,
    /// What it adds, over all that the runs show of what it depends on.
    pub curve: Curve,
    /// A formula that does the same, where one of a small family does.
    pub suggestion: Option<Suggestion>,
    /// The effect of the catalogue that comes nearest, and the share of the drop that it explains.
    pub nearest: Option<(&'static str, f64)>,
}

/// A smooth dependence, in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Unit of what it depends on; empty for a pure number.
    pub at_unit: &'static str,
    /// Unit of what it adds.
    pub unit: String,
    /// In increasing order.
    pub points: Vec<CurvePoint>,
}

/// A place on a [`Curve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// What it depends on.
    pub at: f64,
    /// What it adds.
    pub value: f64,
    /// Half the width of its 95 % interval, taken by itself.
    pub half_width: f64,
}

impl Diagnosis {
    /// What is said of an experiment whose columns are not what they are called: nothing of the robot.
    pub(crate) fn of_faults(evidence: &dyn Evidence, model: &Model) -> Diagnosis {
        Diagnosis {
            level: evidence.level(),
            verdict: Verdict::NotExplained,
            model: model.clone(),
            fitted: Vec::new(),
            correlations: Vec::new(),
            goodness_of_fit: Vec::new(),
            ranking: Vec::new(),
            certified: 0,
            invisible: Vec::new(),
            likeness: Likeness::default(),
            minimum_detectable: Vec::new(),
            next_experiments: Vec::new(),
            contrasts: Vec::new(),
            circle: Vec::new(),
            identifiability: Identifiability { shares: Vec::new(), rank: 0, hidden: Vec::new() },
            dependence: None,
            outliers: Vec::new(),
            setup: Arc::clone(evidence.setup()),
            taken: Vec::new(),
            reasons: evidence.faults().into_iter().map(Reason::Fault).collect(),
            repeats: None,
            remains: None,
            remarks: Vec::new(),
        }
    }

    /// The suspects that are certified as missing.
    pub fn certified(&self) -> &[Suspect] {
        &self.ranking[..self.certified]
    }

    /// What this data would have seen, effect by effect: of each parameter the least size, whatever shapes were tried.
    pub fn least_sizes(&self) -> Vec<Vec<&Detectable>> {
        let mut effects: Vec<Vec<&Detectable>> = Vec::new();
        for size in &self.minimum_detectable {
            let Some(own) = effects.iter_mut().find(|own| own[0].effect == size.effect) else {
                effects.push(vec![size]);
                continue;
            };
            match own.iter_mut().find(|known| known.parameter == size.parameter) {
                Some(known) if known.size <= size.size => {}
                Some(known) => *known = size,
                None => own.push(size),
            }
        }
        effects
    }

    /// The effects that this data cannot see because parts of the model do the same, by these parts.
    pub fn absorbed(&self) -> Vec<(&[&'static str], Vec<&'static str>)> {
        let mut parts: Vec<(&[&str], Vec<&str>)> = Vec::new();
        for unseen in &self.invisible {
            let Why::Absorbed(by) = &unseen.why else { continue };
            match parts.iter_mut().find(|(own, _)| own == by) {
                Some((_, names)) => names.push(unseen.effect),
                None => parts.push((by, vec![unseen.effect])),
            }
        }
        parts
    }

    /// The effects that at their usual size move nothing by as much as the noise.
    pub fn below_noise(&self) -> Vec<&'static str> {
        self.invisible.iter().filter(|unseen| unseen.why == Why::BelowNoise).map(|unseen| unseen.effect).collect()
    }
}

/// The model that is asked first: E_d and E_b, and where tracks show it E_s, all free.
pub fn first_model(data: &Dataset) -> Result<Model, FitError> {
    let robot = robot_of(data)?;
    let mut model = base_model(robot)?;
    if Level::of(data) == Level::Tracks {
        model.add(robot.drive.first_effects()[2])?.free = true;
    }
    Ok(model)
}

/// The model of the paper: E_d and E_b, both free; for other drives, the two that do alike on a square.
pub fn base_model(robot: &Robot) -> Result<Model, ModelError> {
    let mut model = Model::new(robot);
    for effect in &robot.drive.first_effects()[..2] {
        model.add(effect)?.free = true;
    }
    Ok(model)
}

/// Fits a model's free parameters and asks every other effect of the catalogue whether it is missing.
///
/// ```
/// use umbmark_core::diagnose::{Options, Verdict, base_model, diagnose};
/// # use umbmark_core::{dataset::{Dataset, Run}, drive::Robot, effect::TestKind, path::{Direction, Path}};
/// # use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};
/// # let (robot, path) = (Robot::labmate(), Path::umbmark());
/// let mut truth = base_model(&robot)?;
/// truth.set("wheel_diameter_ratio", "e_d", 1.00121)?;
/// truth.set("wheel_noise", "k_sqrt_m", 1e-3)?;
/// # let mut simulator = Simulator::new(&robot, &path, Odometry::Continuous, Phase::Edge)?;
/// # let mut truth = Truth::new(&truth);
/// # simulator.open(&mut truth, 2, 0);
/// # let mut runs = Vec::new();
/// # for direction in Direction::BOTH {
/// #     for number in 1..=5 {
/// #         let returned = Some(simulator.run(&mut truth, direction, TestKind::Systematic));
/// #         let name = format!("{}_{number}", direction.name());
/// #         runs.push(Run { name, number, direction: Some(direction), test: TestKind::Systematic, log: None, returned });
/// #     }
/// # }
/// # let data = Dataset { robot: Some(robot.clone()), path: Some(path), runs, ..Dataset::default() };
/// // `data`: five simulated runs each way of the robot above.
/// let diagnosis = diagnose(&data, &base_model(&robot)?, &Options::default())?;
/// assert_eq!(diagnosis.verdict, Verdict::Explained);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diagnose(data: &Dataset, model: &Model, options: &Options) -> Result<Diagnosis, FitError> {
    model.check_robot(robot_of(data)?)?;
    let level = options.level(data);
    let of_evidence = || match AnyEvidence::of(data, level)? {
        evidence if !evidence.is_sound() => Ok(Diagnosis::of_faults(&*evidence, model)),
        AnyEvidence::Ends(ends) => ends::diagnose(&ends, model, options),
        AnyEvidence::Tracks(observed) => tracks::diagnose(evidence::tracks::fit(&observed, model)?, options),
    };
    if level == Level::Ends {
        return of_evidence();
    }
    // Where return poses tell of the same runs, what they alone would have said stands beside it.
    let of_returns = || ends::Beside::new(&Ends::new(data)?, &base_model(model.robot())?, options);
    let (diagnosis, returns) = rayon::join(of_evidence, of_returns);
    let mut diagnosis = diagnosis?;
    if let Ok(returns) = returns {
        diagnosis.contrasts = returns.contrasts;
        diagnosis.circle = returns.circle;
        let renamed = |test| GoodnessOfFit { name: "E_d and E_b for the return poses alone", ..test };
        diagnosis.goodness_of_fit.extend(returns.goodness_of_fit.map(renamed));
    }
    Ok(diagnosis)
}

impl Options {
    /// What is used of a dataset.
    pub fn level(&self, data: &Dataset) -> Level {
        if self.ends_only { Level::Ends } else { Level::of(data) }
    }
}

/// Every experiment on offer for telling two effects apart, together with this data; the most telling per minute first.
///
/// What the model has is fitted to the data: to whole tracks, where the runs were observed on the way, and further drives are then
/// watched as these were. Each effect is taken at its usual size, the hardest of its sizes. None where the runs have no
/// scatter to judge by.
pub fn separating(data: &Dataset, model: &Model, pair: [&str; 2]) -> Result<Vec<Experiment>, FitError> {
    match Level::of(data) {
        Level::Ends => experiments::separating(&Ends::new(data)?, model, pair),
        Level::Tracks => {
            let [first, second] = [find(pair[0])?, find(pair[1])?];
            let model = experiments::with_one_of(model, [first, second])?;
            let fitted = evidence::tracks::fit(&evidence::tracks::of(data)?, &model)?;
            tracks::separating(fitted, [first.about.name, second.about.name])
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
