//! A diagnosis from return poses, put together.

use super::asked::{Asked, Unit};
use super::family::Family;
use super::flips::certificate;
use super::moments::Whitened;
use super::{Contrast, circle, contrasts};
use crate::diagnose::diagnosis::{Diagnosis, GoodnessOfFit, Verdict};
use crate::diagnose::ends::contrasts::OnCircle;
use crate::diagnose::experiments::next_experiments;
use crate::diagnose::identifiability::of_ends;
use crate::diagnose::likeness::Likeness;
use crate::diagnose::options::Options;
use crate::diagnose::reason::Reason;
use crate::diagnose::remains::{Remains, Trail};
use crate::diagnose::suspect::Suspect;
use crate::diagnose::unseen::Detectable;
use crate::effect::Model;
use crate::evidence::ends::{End, Ends, FEWEST_RUNS, Fitted};
use crate::evidence::{Estimate, FitError, Level, correlations};
use crate::stats::{normal_quantile, student_t_quantile};
use nalgebra::Vector3;
use std::sync::Arc;

/// Probability with which an effect of the minimum detectable size is seen.
const POWER: f64 = 0.8;

/// Fits the model and tests every effect that it lacks.
pub(crate) fn diagnose(ends: &Ends, model: &Model, options: &Options) -> Result<Diagnosis, FitError> {
    let fitted = Fitted::new(ends, model)?;
    let mut diagnosis = Diagnosis {
        level: Level::Ends,
        verdict: Verdict::NotEnoughData,
        model: fitted.model.clone(),
        fitted: fitted.estimates.clone(),
        correlations: correlations(fitted.covariance.as_ref()),
        likeness: Likeness::default(),
        goodness_of_fit: Vec::new(),
        ranking: Vec::new(),
        certified: 0,
        invisible: Vec::new(),
        minimum_detectable: Vec::new(),
        confounders: Vec::new(),
        next_experiments: Vec::new(),
        contrasts: contrasts(ends, &fitted, 1.0 - options.size),
        circle: circle(ends, &fitted, 1.0 - options.size),
        identifiability: of_ends(ends, &fitted.model)?,
        dependence: None,
        outliers: Vec::new(),
        setup: Arc::clone(&ends.setup),
        taken: Vec::new(),
        reasons: ends.doubts.iter().cloned().map(Reason::Data).collect(),
        repeats: None,
        remains: Some(remains(ends, &fitted.residuals, options)),
        remarks: Vec::new(),
    };
    diagnosis.remarks.extend(remarks_on_data(ends, &fitted));
    if Asked::wilks_p(ends, &fitted).is_some_and(|p| p < options.size) {
        diagnosis.remarks.extend(diagnosis.circle.iter().filter_map(contradiction));
    }
    if !ends.enough() {
        return Ok(diagnosis);
    }
    let Some(asked) = Asked::new(ends, &fitted)? else {
        diagnosis.remarks.push(
            "The runs have too little scatter to judge by, or repeat one another: no test. Enter every run as it was measured."
                .into(),
        );
        return Ok(diagnosis);
    };
    let Some(family) = Family::new(&asked, options) else { return Ok(diagnosis) };
    diagnosis.goodness_of_fit = vec![goodness_of_fit(&family)];
    diagnosis.ranking = ranking(&asked, &family, &certificate(&asked, options.seed), options.size);
    diagnosis.minimum_detectable = detectable(&asked, options.size);
    diagnosis.invisible = asked.unseen.clone();
    diagnosis.likeness = asked.likeness();
    judge(&mut diagnosis, &asked, &family, options);
    if diagnosis.verdict == Verdict::Explained {
        let repeats = diagnosis.remains.as_ref().and_then(|remains| Reason::of_remains(remains, [0.0; 2]));
        diagnosis.reasons.extend(repeats);
        if !diagnosis.reasons.is_empty() {
            diagnosis.verdict = Verdict::NotExplained;
        }
    }
    if !options.experiments {
        return Ok(diagnosis);
    }
    diagnosis.next_experiments = next_experiments(ends, &fitted, &asked, &diagnosis.ranking)?;
    Ok(diagnosis)
}

/// The residuals of a model on return poses, and the part that is the same in every run of a direction.
pub(crate) fn remains(ends: &Ends, residuals: &[Vector3<f64>], options: &Options) -> Remains {
    let trail = |(run, left): (&End, &Vector3<f64>)| Trail {
        sense: run.direction.sign(),
        rolled: vec![0.0],
        places: vec![[0.0; 2]],
        left: vec![[left.x, left.y, left.z]],
        with_heading: ends.with_heading,
    };
    let trails: Vec<Trail> = ends.runs.iter().zip(residuals).map(trail).collect();
    Remains::of(&trails, 1.0 - options.size)
}

/// What the return poses alone show about a model, for runs that were also observed on the way.
pub(crate) struct Beside {
    pub contrasts: Vec<Contrast>,
    pub circle: Vec<OnCircle>,
    pub goodness_of_fit: Option<GoodnessOfFit>,
}

impl Beside {
    /// Of a model that is fitted to them.
    pub fn new(ends: &Ends, model: &Model, options: &Options) -> Result<Beside, FitError> {
        let fitted = Fitted::new(ends, model)?;
        let asked = if ends.enough() { Asked::nothing(ends, &fitted) } else { None };
        let family = asked.and_then(|asked| Family::new(&asked, options));
        Ok(Beside {
            contrasts: contrasts(ends, &fitted, 1.0 - options.size),
            circle: circle(ends, &fitted, 1.0 - options.size),
            goodness_of_fit: family.as_ref().map(goodness_of_fit),
        })
    }
}

/// The effect that lowers the misfit most, without any test of significance.
pub(crate) fn likeliest(ends: &Ends, model: &Model) -> Result<Option<&'static str>, FitError> {
    let fitted = Fitted::new(ends, model)?;
    let Some(asked) = Asked::new(ends, &fitted)? else { return Ok(None) };
    let possible = asked.units.iter().zip(asked.drops()).filter(|(unit, _)| possible(&asked, unit));
    let best = possible.max_by(|a, b| a.1.total_cmp(&b.1));
    Ok(best.map(|(unit, _)| unit.effect.about.name))
}

/// Whether an effect can physically have its estimated size: a bump cannot return travel.
fn possible(asked: &Asked, unit: &Unit) -> bool {
    unit.parameter.check(one_step(asked, unit).0.value).is_ok()
}

fn goodness_of_fit(family: &Family) -> GoodnessOfFit {
    let (name, degrees_of_freedom) = match family.exact_whole {
        Some(freedom) => ("Wilks' lambda, exact F", Some(freedom)),
        None => ("generalised least squares, simulated", None),
    };
    GoodnessOfFit { name, statistic: family.observed.whole, degrees_of_freedom, p: family.p_whole }
}

/// Classes that may be certified come first, then all others, each ordered by the decrease of the misfit with its best member: the member
/// of possible size that lowers the misfit most.
fn ranking(asked: &Asked, family: &Family, flips: &[f64], size: f64) -> Vec<Suspect> {
    let mut suspects: Vec<Suspect> = Vec::new();
    let drops = asked.drops();
    for class in asked.classes() {
        let strength = |i: &usize| (family.p_adjusted[*i] < size, drops[*i]);
        let mut members = class.clone();
        members.sort_by(|a, b| stronger(strength(a), strength(b)));
        members.sort_by_key(|i| !possible(asked, &asked.units[*i]));
        let Some(best) = members.first().copied() else { continue };
        let mut names: Vec<&'static str> = Vec::new();
        for unit in members.iter().map(|i| &asked.units[*i]) {
            if !names.contains(&unit.effect.about.name) {
                names.push(unit.effect.about.name);
            }
        }
        let unit = &asked.units[best];
        let (estimate, degrees_of_freedom) = one_step(asked, unit);
        suspects.push(Suspect {
            class: names,
            best: unit.effect.about.name,
            f: family.observed.units[best],
            degrees_of_freedom,
            p: family.p[best],
            p_adjusted: family.p_adjusted[best],
            p_flips: Some(flips[best]),
            estimate: vec![estimate],
            expected_drop: drops[best],
        });
    }
    let strength = |s: &Suspect| (s.p_adjusted < size, s.expected_drop);
    suspects.sort_by(|a, b| stronger(strength(a), strength(b)));
    suspects
}

/// The order of (may be certified, fall of the misfit): the strongest first.
fn stronger(a: (bool, f64), b: (bool, f64)) -> std::cmp::Ordering {
    b.0.cmp(&a.0).then(b.1.total_cmp(&a.1))
}

/// Size of an effect after one step from zero, and the degrees of freedom of its F.
fn one_step(asked: &Asked, unit: &Unit) -> (Estimate, [f64; 2]) {
    let (mut size, mut error, mut freedom) = (0.0, f64::INFINITY, asked.moments.freedom());
    if let Some(whitened) = Whitened::new(&asked.moments, &asked.base) {
        let along = unit.shift.dot(&whitened.means);
        (size, error) = (along / unit.shift.norm_squared(), 1.0 / unit.shift.norm());
    }
    if let Some(rao) = unit.pattern.as_ref().and_then(|pattern| pattern.test(&asked.moments)) {
        freedom = rao.freedom;
        if rao.f > 0.0 {
            (size, error) = (rao.size, rao.size.abs() / rao.f.sqrt());
        }
    }
    let (effect, parameter) = (unit.effect.about.name, unit.parameter.name);
    let estimate = Estimate { effect, parameter, value: size, standard_error: error, degrees_of_freedom: freedom };
    (estimate, [1.0, freedom])
}

/// (t_{1 - α/2, ν} + z_{0.8})/‖Q a‖ for each size.
fn detectable(asked: &Asked, size: f64) -> Vec<Detectable> {
    let needed = student_t_quantile(1.0 - 0.5 * size, asked.moments.freedom()) + normal_quantile(POWER);
    let of = |unit: &Unit| Detectable {
        effect: unit.effect.about.name,
        parameter: unit.parameter.name,
        size: needed / unit.shift.norm(),
    };
    asked.units.iter().map(of).collect()
}

/// Verdict and certified classes: the best class is added to the model, and the rest tested again.
fn judge(diagnosis: &mut Diagnosis, asked: &Asked, family: &Family, options: &Options) {
    let certified = diagnosis.ranking.first().is_some_and(|s| s.p_adjusted < options.size);
    if !certified {
        let accused = family.p_whole_adjusted < options.size;
        diagnosis.verdict = if accused { Verdict::UnlistedEffect } else { Verdict::Explained };
        return;
    }
    (diagnosis.verdict, diagnosis.certified) = (Verdict::MissingEffect, 1);
    let best = &diagnosis.ranking[0];
    if best.p_flips.is_some_and(|p| p >= options.size) {
        diagnosis.remarks.push(format!(
            "The signs of the runs do not confirm {} on their own (p = {:.3}): it rests on normally distributed scatter.",
            best.best,
            best.p_flips.unwrap_or(1.0)
        ));
    }
    let parameter = best.estimate[0].parameter;
    let unit = asked.units.iter().find(|u| u.effect.about.name == best.best && u.parameter.name == parameter);
    let Some(unit) = unit else { return };
    let rest = asked.explaining(unit);
    let Some(further) = Family::new(&rest, options) else { return };
    let beside = ranking(&rest, &further, &certificate(&rest, options.seed), options.size);
    match beside.into_iter().next().filter(|second| second.p_adjusted < options.size) {
        Some(second) => {
            (diagnosis.verdict, diagnosis.certified) = (Verdict::SeveralMissing, 2);
            // The whole class is added as one suspect; its members are not listed again.
            let first = diagnosis.ranking.remove(0);
            diagnosis.ranking.retain(|other| !second.class.contains(&other.best));
            diagnosis.ranking.splice(0..0, [first, second]);
        }
        None if further.p_whole_adjusted < options.size => diagnosis.verdict = Verdict::SeveralMissing,
        None => {}
    }
}

fn remarks_on_data(ends: &Ends, fitted: &Fitted) -> Vec<String> {
    let [cw, ccw] = ends.counts();
    let mut remarks = Vec::new();
    if cw == 0 || ccw == 0 {
        let driven = if cw == 0 { "counter-clockwise" } else { "clockwise" };
        remarks.push(format!(
            "All runs are {driven}: E_d and E_b act alike there, so neither they nor other effects can be separated. \
             Drive the path the other way round as well."
        ));
    } else if !ends.enough() {
        remarks.push(format!(
            "No test: {FEWEST_RUNS} or more runs a direction are needed, got {cw} cw and {ccw} ccw. The paper drives 5."
        ));
    }
    if !ends.with_heading {
        remarks.push(
            "Return headings were not measured in every run: one contrast of two is lost, and with it START heading, caster \
             kick and backlash. A protractor is enough."
                .into(),
        );
    }
    let names = crate::evidence::ends::names(&fitted.model);
    if cw > 0 && ccw > 0 && !fitted.open.is_empty() {
        let open: Vec<String> = fitted.open.iter().map(|i| format!("{} of {}", names[*i].1, names[*i].0)).collect();
        remarks.push(format!("Not fitted, since this data does not show it apart from the rest: {}.", open.join(", ")));
    }
    remarks
}

/// The evidence of the circle against all effects that are the same on each side. It is used only if a test rejects all of them, because
/// each interval of the circle alone has its own false-alarm rate.
pub(crate) fn contradiction(circle: &OnCircle) -> Option<String> {
    let implied = circle.implied.filter(|_| !circle.explained())?;
    let degrees = circle.turned_less_heading?.to_degrees();
    Some(format!(
        "{} runs: the return heading alone, by E_d and E_b, would put the end {:.0} mm from START; it lies {:.0} mm away, and \
         angle and heading differ by {:.2} deg. E_d and E_b contradict these poses.",
        circle.direction.name(),
        1e3 * implied,
        1e3 * circle.distance,
        degrees.abs(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::base_model;
    use crate::diagnose::tests::{robot_with, simulated};
    use crate::drive::Robot;
    use crate::path::Path;

    /// Ten runs about two means: t of 97.5 % with 8 degrees of freedom is 2.3060, z of 80 % is 0.8416.
    #[test]
    fn the_least_size_that_is_seen_stands_out_by_what_the_test_needs_and_its_power() {
        let data = simulated(&robot_with(&[]), &Path::umbmark(), 5, 7, 0..1).remove(0);
        let ends = Ends::new(&data).unwrap();
        let fitted = Fitted::new(&ends, &base_model(&Robot::labmate()).unwrap()).unwrap();
        let asked = Asked::new(&ends, &fitted).unwrap().unwrap();
        for (told, unit) in detectable(&asked, 0.05).iter().zip(&asked.units) {
            assert_eq!((told.effect, told.parameter), (unit.effect.about.name, unit.parameter.name));
            assert!((told.size * unit.shift.norm() - 3.1476).abs() < 1e-4, "{told:?}");
        }
    }
}
