//! How often a test of n + n runs shows an effect of some size, by the very tests that will judge the runs.
//!
//! * E_d and E_b are seen where the interval of `calibrate` leaves 1 out: Student's t of the estimate, its standard error from
//!   the pooled scatter. The power is non-central t with ν = 2n - 2, exact to first order.
//! * Every other effect is seen where `diagnose` certifies it: where its own F is beyond what the greatest of all that are
//!   asked reaches by chance. The F of a single pattern is Rao's, adjusted for covariates: given the share B of the pattern
//!   that the covariates take by chance, non-central F(1, 2n - q) with λ = (size · shift)² (1 - B), and B is
//!   Beta((q - 1)/2, (2n - q + 1)/2); q is the number of coordinates that the model leaves alone. Where no exact test applies,
//!   tests are simulated.

use super::expected::expected_dataset;
use super::{Options, PlanError, Setting};
use crate::diagnose::ends::{Asked, Family, Moments, Unit, statistics};
use crate::diagnose::{Unseen, Why, base_model};
use crate::drive::Robot;
use crate::effect::{CATALOGUE, Entry, ModelError};
use crate::evidence::Estimate;
use crate::evidence::ends::{Ends, Fitted};
use crate::parameter::{Parameter, nearest};
use crate::random::Stream;
use crate::score::FEWEST_RUNS;
use crate::stats::{noncentral_f_upper_tail, student_t_quantile};
use nalgebra::Matrix3;
use rayon::prelude::*;
use std::cell::OnceCell;

/// The most runs a direction that are planned.
pub const MOST_RUNS: usize = 1000;

/// Purpose of the stream of simulated tests.
const POWER_TESTS: u64 = 14;

/// A size of an effect that is to be seen.
#[derive(Clone, Copy, Debug)]
pub struct Sought {
    /// The effect.
    pub effect: &'static Entry,
    /// Its parameter.
    pub parameter: &'static Parameter,
    /// Its value less the value at which it does nothing.
    pub departure: f64,
}

impl Sought {
    /// A size by its flag ("eb", "slope-x") or its name ("e_b", "drift_x", "floor_slope.drift_x").
    ///
    /// Where several effects have a size of that name, the first of the catalogue.
    pub fn named(name: &str, value: f64, robot: &Robot) -> Result<Sought, PlanError> {
        let mut all = CATALOGUE.iter().copied().flat_map(|e| e.about.parameters.iter().map(move |p| (e, p)));
        let is_meant = |(effect, parameter): &(&'static Entry, &'static Parameter)| {
            let whole = name.split_once('.').is_some_and(|(e, p)| e == effect.about.name && p == parameter.name);
            whole || name == parameter.flag || name == parameter.name
        };
        let Some((effect, parameter)) = all.find(is_meant) else {
            let flags = CATALOGUE.iter().flat_map(|e| e.about.parameters.iter().map(|p| p.flag));
            return Err(PlanError::UnknownSize { name: name.to_owned(), nearest: nearest(name, flags) });
        };
        let checked =
            parameter.check(value).map_err(|problem| ModelError::Value { effect: effect.about.name, problem })?;
        let departure = checked - parameter.default.resolve(robot);
        if departure == 0.0 {
            return Err(PlanError::NoSize { name: parameter.flag, value });
        }
        Ok(Sought { effect, parameter, departure })
    }

    fn usual(effect: &'static Entry, parameter: &'static Parameter) -> Sought {
        Sought { effect, parameter, departure: parameter.typical }
    }
}

/// By what a size shows, if at all.
#[derive(Clone, Debug, PartialEq)]
pub enum Shown {
    /// `calibrate` fits it, with this standard error.
    Fitted(f64),
    /// `diagnose` asks for it, beside all else.
    Asked,
    /// Never: these effects of the model do what it does.
    Absorbed(Vec<&'static str>),
    /// `diagnose` does not ask for it: at its usual size it moves the means by less than half a standard deviation, or it is no
    /// size but a shape, a threshold or a scatter.
    BelowNoise,
}

/// A planned test of n + n runs.
#[derive(Clone, Debug)]
pub struct Planned {
    /// n.
    pub runs: usize,
    options: Options,
    fitted: Vec<Estimate>,
    asked: Asked,
    family: Family,
}

impl Planned {
    /// What n + n runs would be asked.
    ///
    /// ```
    /// use umbmark_core::{drive::Robot, effect::Model, path::Path};
    /// use umbmark_core::plan::{Options, Planned, Setting, Sought};
    /// let robot = Robot::labmate();
    /// let mut truth = Model::new(&robot);
    /// truth.set("wheel_noise", "k_sqrt_m", 1e-3)?;
    /// let setting = Setting::new(&Path::umbmark(), &truth, 1)?.with_sigma(0.050);
    /// let planned = Planned::new(&setting, 5, &Options::default())?;
    /// let half_a_percent = Sought::named("eb", 1.005, &robot)?;
    /// let (power, least) = (planned.power(&half_a_percent), planned.least(&half_a_percent, 0.9).unwrap());
    /// assert!(power > 0.9 && least < 0.005);
    /// // The scale shows in no return pose.
    /// assert_eq!(planned.power(&Sought::named("es", 1.003, &robot)?), 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(setting: &Setting, runs: usize, options: &Options) -> Result<Planned, PlanError> {
        if !(FEWEST_RUNS..=MOST_RUNS).contains(&runs) {
            return Err(PlanError::Runs { value: runs });
        }
        let ends = Ends::new(&expected_dataset(setting, runs))?;
        let fitted = Fitted::new(&ends, &base_model(setting.robot())?)?;
        let asked = Asked::new(&ends, &fitted)?.ok_or(PlanError::NoScatter)?;
        let family = Family::new(&asked, options).ok_or(PlanError::NoScatter)?;
        Ok(Planned { runs, options: *options, fitted: fitted.estimates, asked, family })
    }

    /// By what a size would show.
    pub fn shown(&self, sought: &Sought) -> Shown {
        if let Some(estimate) = self.estimate(sought) {
            return Shown::Fitted(estimate.standard_error);
        }
        if self.unit(sought).is_some() {
            return Shown::Asked;
        }
        let unseen = self.asked.unseen.iter().find(|unseen| unseen.effect == sought.effect.about.name);
        match unseen.map(|unseen| &unseen.why) {
            Some(Why::Absorbed(by)) => Shown::Absorbed(by.clone()),
            _ => Shown::BelowNoise,
        }
    }

    /// The probability that it is seen.
    pub fn power(&self, sought: &Sought) -> f64 {
        if let Some(estimate) = self.estimate(sought) {
            let noncentrality = (sought.departure / estimate.standard_error).powi(2);
            return self.of_estimate(estimate).power(noncentrality);
        }
        let Some(unit) = self.unit(sought) else { return 0.0 };
        match self.exact(unit) {
            Some(test) => test.power((sought.departure * self.asked.units[unit].shift.norm()).powi(2)),
            None => self.simulated(unit, sought.departure),
        }
    }

    /// The least departure that is seen with this probability; `None` where none ever is.
    pub fn least(&self, sought: &Sought, power: f64) -> Option<f64> {
        self.least_of(std::slice::from_ref(sought), power).pop().flatten()
    }

    /// The same of several sizes at once.
    pub fn least_of(&self, sought: &[Sought], power: f64) -> Vec<Option<f64>> {
        // All tests of a kind need the same non-centrality.
        let (of_fit, exact) = (OnceCell::new(), OnceCell::new());
        let least = |sought: &Sought| {
            if let Some(estimate) = self.estimate(sought) {
                let needed = of_fit.get_or_init(|| self.of_estimate(estimate).needed(power));
                return Some((*needed)? * estimate.standard_error);
            }
            let unit = self.unit(sought)?;
            let shift = self.asked.units[unit].shift.norm();
            let root = match self.exact(unit) {
                Some(test) => *exact.get_or_init(|| test.needed(power)),
                None => rising(|root| self.simulated(unit, root / shift), power),
            };
            Some(root? / shift)
        };
        sought.iter().map(least).collect()
    }

    /// Every size that the test would show, at its usual value: E_d and E_b first.
    pub fn sizes(&self) -> Vec<Sought> {
        let entry = |name: &str| CATALOGUE.iter().find(|entry| entry.about.name == name);
        let of_fit = self.fitted.iter().filter_map(|estimate| {
            let effect = entry(estimate.effect)?;
            let parameter = effect.about.parameters.iter().find(|p| p.name == estimate.parameter)?;
            Some(Sought::usual(effect, parameter))
        });
        of_fit.chain(self.asked.units.iter().map(|unit| Sought::usual(unit.effect, unit.parameter))).collect()
    }

    /// Effects that the test cannot show, and why.
    pub fn unseen(&self) -> &[Unseen] {
        &self.asked.unseen
    }

    fn estimate(&self, sought: &Sought) -> Option<&Estimate> {
        let (effect, parameter) = (sought.effect.about.name, sought.parameter.name);
        self.fitted.iter().find(|estimate| estimate.effect == effect && estimate.parameter == parameter)
    }

    fn unit(&self, sought: &Sought) -> Option<usize> {
        let is_meant =
            |unit: &Unit| std::ptr::eq(unit.effect, sought.effect) && unit.parameter.name == sought.parameter.name;
        self.asked.units.iter().position(is_meant)
    }

    /// The test that a fitted value is not the one that does nothing.
    fn of_estimate(&self, estimate: &Estimate) -> AdjustedTest {
        let t = student_t_quantile(1.0 - 0.5 * self.options.size, estimate.degrees_of_freedom);
        AdjustedTest { critical: t * t, freedom: estimate.degrees_of_freedom, covariates: 0 }
    }

    /// The exact test of a unit among all; `None` where it has none.
    fn exact(&self, unit: usize) -> Option<AdjustedTest> {
        self.asked.units[unit].pattern.as_ref()?;
        let q = self.asked.moments.size;
        let critical = self.family.critical(unit, self.options.size);
        Some(AdjustedTest { critical, freedom: (2 * self.runs - q) as f64, covariates: q - 1 })
    }

    /// The share of simulated tests that certify a unit of some size.
    fn simulated(&self, unit: usize, departure: f64) -> f64 {
        let critical = self.family.critical(unit, self.options.size);
        let mut one = self.asked.clone();
        one.units = vec![self.asked.units[unit].clone()];
        let moments = &self.asked.moments;
        let Some(root) = (moments.scatter / moments.freedom()).cholesky().map(|c| c.l()) else { return 0.0 };
        let seen = |draw: u64| self.certifies(&one, departure, critical, &root, draw);
        let found = (0..self.options.draws as u64).into_par_iter().filter(|draw| seen(*draw)).count();
        found as f64 / self.options.draws as f64
    }

    fn certifies(&self, one: &Asked, departure: f64, critical: f64, root: &Matrix3<f64>, draw: u64) -> bool {
        let mut stream = Stream::new(self.options.seed, POWER_TESTS, draw);
        let means = one.units[0].columns.map(|column| column * departure);
        let drawn = Moments::about(self.asked.moments.counts, means, (root, self.asked.moments.size), &mut stream);
        statistics(one, &drawn).is_some_and(|statistics| statistics.units[0] > critical)
    }
}

/// A test of one number, adjusted for covariates of mean zero: F(1, freedom) under chance alone.
struct AdjustedTest {
    critical: f64,
    freedom: f64,
    covariates: usize,
}

impl AdjustedTest {
    /// The probability of an F beyond the critical one, for the non-centrality that the pattern would have without covariates.
    ///
    /// With B = sin²φ, the density of φ is proportional to sin^(c - 1) φ cos^freedom φ for c covariates: Simpson's rule, as
    /// far as that is not negligible.
    fn power(&self, noncentrality: f64) -> f64 {
        const INTERVALS: usize = 32;
        let beyond = |noncentrality: f64| noncentral_f_upper_tail(self.critical, [1.0, self.freedom], noncentrality);
        if !self.critical.is_finite() {
            return 0.0;
        }
        if self.covariates == 0 {
            return beyond(noncentrality);
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        let last = std::f64::consts::FRAC_PI_2.min(8.0 / self.freedom.sqrt());
        for i in 0..INTERVALS {
            let (sine, cosine) = libm::sincos(last * i as f64 / INTERVALS as f64);
            let simpson = if i == 0 { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
            let weight = simpson * libm::pow(sine, (self.covariates - 1) as f64) * libm::pow(cosine, self.freedom);
            sum += weight * beyond(noncentrality * cosine * cosine);
            weights += weight;
        }
        sum / weights
    }

    /// The root of the non-centrality at which it has this power.
    fn needed(&self, power: f64) -> Option<f64> {
        rising(|root| self.power(root * root), power)
    }
}

/// Where a function that rises from about 0 to 1 reaches a value; `None` where it does not below a million.
fn rising(function: impl Fn(f64) -> f64, value: f64) -> Option<f64> {
    let mut high = 1.0;
    while function(high) < value {
        high *= 2.0;
        if high > 1e6 {
            return None;
        }
    }
    let mut low = if high > 1.0 { 0.5 * high } else { 0.0 };
    while high - low > 1e-6 * high {
        let middle = 0.5 * (low + high);
        if function(middle) < value { low = middle } else { high = middle }
    }
    Some(high)
}

/// The fewest runs a direction that show a size with this probability; `None` where [`MOST_RUNS`] do not.
pub fn runs_needed(
    setting: &Setting,
    sought: &Sought,
    power: f64,
    options: &Options,
) -> Result<Option<usize>, PlanError> {
    let enough =
        |runs: usize| -> Result<bool, PlanError> { Ok(Planned::new(setting, runs, options)?.power(sought) >= power) };
    if enough(FEWEST_RUNS)? {
        return Ok(Some(FEWEST_RUNS));
    }
    let (mut low, mut high) = (FEWEST_RUNS, 2 * FEWEST_RUNS);
    while !enough(high)? {
        if high == MOST_RUNS {
            return Ok(None);
        }
        (low, high) = (high, (2 * high).min(MOST_RUNS));
    }
    while high - low > 1 {
        let middle = (low + high) / 2;
        if enough(middle)? { high = middle } else { low = middle }
    }
    Ok(Some(high))
}
