//! What to drive next: the run that would separate effects that these tracks cannot, or show effects that they hide.
//!
//! The worth of a drive is judged as for return poses ([`next_experiments`](super::super::experiments)): the distance, in standard
//! deviations, between the prediction of j and the closest prediction of the model with k in its place, for old and new data together.
//! Planned tracks are whitened with this robot's fitted noise, so their products are simply added to the present ones.

use super::class::rivals;
use super::examination::Examination;
use super::finding::{Answer, Finding};
use super::repeats::{Repeated, UnlistedLaw};
use super::responses::{Asked, Question};
use crate::diagnose::experiments::design::{MINUTES_A_RUN, minutes};
use crate::diagnose::experiments::{Experiment, best, worth};
use crate::diagnose::unseen::{Unseen, Why};
use crate::effect::{Law, Model, ModelError, Number, Part};
use crate::evidence::FitError;
use crate::evidence::tracks::Projected;
use crate::likelihood::{Noise, ObservedRun, gram};
use crate::parameter::{Parameter, Role};
use crate::path::{
    CIRCLE, DIAGONAL_SQUARE, Direction, FIGURE_EIGHT, FIXED_SQUARE, Path, SIDEWAYS_SQUARE, SLIDE, SPIN, SQUARE,
    STRAIGHT, Shape, SpeedProfile, WAYPOINTS,
};
use crate::replay::Track;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Runs of a new drive, each way.
const RUNS: usize = 3;
/// Names of laws that are indistinguishable from the one taken, as in their table.
const LAWS: [&str; 8] = ["law_1", "law_2", "law_3", "law_4", "law_5", "law_6", "law_7", "law_8"];
/// Name of the alternative for a size below the noise.
const NOISE: &str = "noise";

/// An available drive.
struct Drive {
    what: String,
    path: Path,
    /// Heading at START in the room \[rad\], relative to that of the data.
    turned: f64,
    directions: &'static [Direction],
}

/// A hypothesis, and what it must be separated from.
#[derive(Clone)]
struct Doubt {
    separates: [&'static str; 2],
    truth: Vec<usize>,
    values: DVector<f64>,
    /// Columns of the model and of the rival; all of them those of an examination, or of a [`Basis`].
    against: Vec<usize>,
}

/// Drives that would separate the members of certified classes, and drives that would show hidden effects; the most informative per minute
/// first.
pub fn next(exam: &Examination, certified: &[&Finding], unseen: &[Unseen]) -> Result<Vec<Experiment>, FitError> {
    let mut doubts: Vec<Doubt> = certified.iter().flat_map(|finding| of_class(exam, finding)).collect();
    doubts.extend(unseen.iter().flat_map(|unseen| of_unseen(exam, unseen)));
    let mut experiments: Vec<Experiment> = offers_of(exam, &doubts)?.into_iter().filter_map(best).collect();
    experiments.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    Ok(experiments)
}

/// Every available drive that separates two effects, together with these tracks, at the usual size that is hardest to separate; the most
/// informative per minute first.
pub fn separating(exam: &Examination, pair: [&'static str; 2]) -> Result<Vec<Experiment>, FitError> {
    let asked = pair.map(|name| exam.asked.iter().position(|a| a.effect().is_some_and(|e| e.about.name == name)));
    let of = |truth: Option<usize>, rival: Option<usize>| {
        let Some(Asked { question: Question::Effect(_, parameters), columns, .. }) = truth.map(|i| &exam.asked[i])
        else {
            return Vec::new();
        };
        let rivals = rival.map_or(&[][..], |i| &exam.asked[i].columns);
        let against: Vec<usize> = exam.base(truth).iter().chain(rivals).copied().collect();
        let doubt = |(column, parameter): (&usize, &&'static Parameter)| Doubt {
            separates: pair,
            truth: vec![*column],
            values: DVector::from_element(1, parameter.typical),
            against: against.iter().filter(|other| *other != column).copied().collect(),
        };
        columns.iter().zip(parameters).map(doubt).collect::<Vec<Doubt>>()
    };
    let doubts = [of(asked[0], asked[1]), of(asked[1], asked[0])].concat();
    let mut experiments = offers_of(exam, &doubts)?.pop().unwrap_or_default();
    experiments.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    Ok(experiments)
}

/// Drives that would separate a law from its rivals in these tracks, the most informative per minute for each: `exam` is of the model that
/// had none of them yet.
pub fn of_laws(exam: &Examination, repeated: &Repeated) -> Result<Vec<Experiment>, FitError> {
    let mut model = exam.fitted.model.clone();
    let own_numbers: Vec<Number> = exam.base(None).iter().filter_map(|column| exam.number(*column)).collect();
    let mut numbers = own_numbers.clone();
    // Indices and values of the numbers of a law, without those that only change its shape.
    let mut adopt = |law: &UnlistedLaw, name: Option<&'static str>| -> Option<(Vec<usize>, Vec<f64>, &'static str)> {
        let part = law.model.as_ref()?.parts().first()?.clone();
        let Law::Formula(formula) = &part.effect else { return None };
        let effect = name.map_or_else(|| Arc::clone(formula), |name| Arc::new(formula.named(name)));
        let part = Part { effect: Law::Formula(effect), ..part };
        model.adopt(&part);
        let sizes =
            part.effect.parameters().iter().zip(&part.values).filter(|(parameter, _)| parameter.role != Role::Shape);
        let (mut places, mut values) = (Vec::new(), Vec::new());
        for (parameter, value) in sizes {
            places.push(numbers.len());
            values.push(*value);
            numbers.push(Number::of(part.effect.name(), parameter.name));
        }
        Some((places, values, part.effect.name()))
    };
    let Some((truth, values, own)) = adopt(&repeated.law, None) else { return Ok(Vec::new()) };
    let alike = repeated.others.iter().filter(|other| other.is_alike());
    let named = alike.filter_map(|other| Some((LAWS.get(other.number.checked_sub(1)?)?, other)));
    let doubt = |(name, other): (&&'static str, &UnlistedLaw)| {
        let (rival, ..) = adopt(other, Some(name))?;
        let against = (0..own_numbers.len()).chain(rival).collect();
        let values = DVector::from_column_slice(&values);
        Some(Doubt { separates: [own, name], truth: truth.clone(), values, against })
    };
    let doubts: Vec<Doubt> = named.filter_map(doubt).collect();
    if doubts.is_empty() {
        return Ok(Vec::new());
    }
    let derived = model.derived(&numbers)?;
    let of_run = |run: &ObservedRun| {
        let made = run.columns_of(&derived, numbers.len());
        let white = exam.fitted.noise.whiten(run, &made.iter().map(Vec::as_slice).collect::<Vec<_>>());
        gram(&white.values, white.columns)
    };
    let parts: Vec<DMatrix<f64>> = exam.fitted.observed.runs.par_iter().map(of_run).collect();
    let today = parts.iter().fold(DMatrix::zeros(numbers.len(), numbers.len()), |sum, part| sum + part);
    let basis = Basis { model: &model, numbers, today };
    Ok(offers(exam, &basis, &doubts)?.into_iter().filter_map(best).collect())
}

/// The linear system for predictions of the available drives.
struct Basis<'a> {
    model: &'a Model,
    /// What its columns are derivatives by.
    numbers: Vec<Number>,
    /// Products of these columns over today's runs.
    today: DMatrix<f64>,
}

/// Every available drive, for each pair of rivals given by columns of an examination.
fn offers_of(exam: &Examination, doubts: &[Doubt]) -> Result<Vec<Vec<Experiment>>, FitError> {
    let mut columns: Vec<usize> = doubts.iter().flat_map(|d| d.truth.iter().chain(&d.against)).copied().collect();
    columns.sort_unstable();
    columns.dedup();
    let today = DMatrix::from_fn(columns.len(), columns.len(), |i, j| exam.system.whole[(columns[i], columns[j])]);
    let numbers = columns.iter().filter_map(|column| exam.number(*column)).collect();
    let basis = Basis { model: &exam.fitted.model, numbers, today };
    let place = |own: &[usize]| own.iter().filter_map(|column| columns.binary_search(column).ok()).collect();
    let placed = |doubt: &Doubt| Doubt { truth: place(&doubt.truth), against: place(&doubt.against), ..doubt.clone() };
    offers(exam, &basis, &doubts.iter().map(placed).collect::<Vec<_>>())
}

/// Every available drive, for each pair of rivals given by columns of a basis.
fn offers(exam: &Examination, basis: &Basis, doubts: &[Doubt]) -> Result<Vec<Vec<Experiment>>, FitError> {
    let drives = drives(exam);
    let told: Vec<DMatrix<f64>> = drives
        .par_iter()
        .map(|drive| drive.products(exam, basis).map(|new| &basis.today + new))
        .collect::<Result<_, _>>()?;
    let of_pair = |separates: [&'static str; 2]| {
        let own: Vec<&Doubt> = doubts.iter().filter(|doubt| doubt.separates == separates).collect();
        let offers = drives.iter().zip(&told).map(|(drive, products)| Experiment {
            separates,
            experiment: drive.what.clone(),
            minutes: drive.minutes(exam),
            sd: own.iter().map(|doubt| doubt.distance(products)).fold(f64::INFINITY, f64::min),
        });
        offers.collect()
    };
    Ok(pairs(doubts).into_iter().map(of_pair).collect())
}

fn pairs(doubts: &[Doubt]) -> Vec<[&'static str; 2]> {
    let mut pairs = Vec::new();
    for doubt in doubts.iter().filter(|doubt| !doubt.truth.is_empty()) {
        if !pairs.contains(&doubt.separates) {
            pairs.push(doubt.separates);
        }
    }
    pairs
}

/// A finding against each other member of its class; either may be true.
fn of_class(exam: &Examination, finding: &Finding) -> Vec<Doubt> {
    let name = |answer: &Answer| exam.asked[answer.asked].effect().map_or("", |effect| effect.about.name);
    let own = &finding.answer;
    let either = |rival: &Answer| {
        let separates = [name(own), name(rival)];
        [(own, rival), (rival, own)].map(|(truth, other)| {
            let base = finding.base().iter().filter(|c| !truth.columns.contains(c));
            let against = base.chain(&other.columns).copied().collect();
            Doubt { separates, truth: truth.columns.clone(), values: truth.step.clone(), against }
        })
    };
    rivals(exam, finding).iter().flat_map(either).collect()
}

/// Each size of a hidden effect, at its usual size.
fn of_unseen(exam: &Examination, unseen: &Unseen) -> Vec<Doubt> {
    let from = match &unseen.why {
        Why::Absorbed(by) => by.first().copied().unwrap_or(NOISE),
        Why::BelowNoise => NOISE,
    };
    let named = |asked: &Asked| asked.effect().is_some_and(|effect| effect.about.name == unseen.effect);
    let Some(index) = exam.asked.iter().position(named) else { return Vec::new() };
    let Question::Effect(_, parameters) = &exam.asked[index].question else { return Vec::new() };
    let against = exam.base(Some(index));
    let sizes = exam.asked[index].columns.iter().zip(parameters);
    sizes
        .map(|(column, parameter)| Doubt {
            separates: [unseen.effect, from],
            truth: vec![*column],
            values: DVector::from_element(1, parameter.typical),
            against: against.clone(),
        })
        .collect()
}

impl Doubt {
    /// Distance between the prediction of the truth and the closest prediction of the others, in standard deviations.
    fn distance(&self, products: &DMatrix<f64>) -> f64 {
        let against: Vec<usize> = self.against.iter().copied().filter(|c| products[(*c, *c)] > 0.0).collect();
        let left = Projected::new(products, &against).information(&self.truth);
        (&left * &self.values).dot(&self.values).max(0.0).sqrt()
    }
}

impl Drive {
    fn minutes(&self, exam: &Examination) -> f64 {
        let runs = (RUNS * self.directions.len()) as f64;
        runs * (MINUTES_A_RUN + minutes(&self.path, &exam.fitted.observed.robot))
    }

    /// Products of the columns of a basis over all runs of this drive.
    fn products(&self, exam: &Examination, basis: &Basis) -> Result<DMatrix<f64>, ModelError> {
        let mut sum = DMatrix::zeros(basis.numbers.len(), basis.numbers.len());
        for direction in self.directions {
            let track = Track::watched(&self.path, *direction, &exam.fitted.observed.robot);
            sum += self.of_run(exam, basis, track, *direction)? * RUNS as f64;
        }
        Ok(sum)
    }

    fn of_run(
        &self,
        exam: &Examination,
        basis: &Basis,
        track: Track,
        direction: Direction,
    ) -> Result<DMatrix<f64>, ModelError> {
        let Some(like) = exam.fitted.observed.runs.first() else {
            return Ok(DMatrix::zeros(basis.numbers.len(), basis.numbers.len()));
        };
        let model = self.at_start(basis.model)?;
        let run = ObservedRun::planned(track, direction, like, &model);
        let noise: &Noise = &exam.fitted.noise;
        let made = run.columns_of(&model.derived(&basis.numbers)?, basis.numbers.len());
        let white = noise.whiten(&run, &made.iter().map(Vec::as_slice).collect::<Vec<_>>());
        Ok(gram(&white.values, white.columns))
    }

    /// The model of a robot with the START heading of this drive.
    fn at_start(&self, model: &Model) -> Result<Model, ModelError> {
        let mut model = model.clone();
        if self.turned != 0.0 {
            let heading = model.get("start_pose", "heading_rad").unwrap_or(0.0);
            model.set("start_pose", "heading_rad", heading + self.turned)?;
        }
        Ok(model)
    }
}

/// All drives that are available for this robot.
fn drives(exam: &Examination) -> Vec<Drive> {
    let path = exam.fitted.observed.path.as_ref();
    let speed = path.map_or_else(SpeedProfile::default, |path| path.speed);
    let [top, acceleration, pause] = speed.values();
    let at = |factor: f64| SpeedProfile::new(factor * top, acceleration, pause).unwrap_or(speed);
    let of = |what: &str, shape: &'static Shape, values: &[f64], speed: SpeedProfile, turned: f64| {
        let path = Path::new(shape, values, speed).ok().filter(|path| path.suits(&exam.fitted.observed.robot))?;
        Some(Drive { what: format!("{what}, {RUNS} runs each way"), path, turned, directions: &Direction::BOTH })
    };
    let mut offered = vec![
        of("a straight of 10 m", &STRAIGHT, &[10.0], speed, 0.0).map(one_way),
        of("a straight of 10 m at double speed", &STRAIGHT, &[10.0], at(2.0), 0.0).map(one_way),
        of("5 m out, a half turn, and 5 m back", &WAYPOINTS, &[5.0, 0.0, 0.0, 0.0], speed, 0.0),
        of("5 turns on the spot", &SPIN, &[5.0], speed, 0.0),
        of("5 turns on the spot at double rate", &SPIN, &[5.0], at(2.0), 0.0),
        of("a circle of 1 m radius, twice round", &CIRCLE, &[1.0, 2.0], speed, 0.0),
        of("a circle of 1 m radius, twice round, at double speed", &CIRCLE, &[1.0, 2.0], at(2.0), 0.0),
        of("a figure-eight of 1 m radius", &FIGURE_EIGHT, &[1.0], speed, 0.0),
        of("a way of 5 m to the side", &SLIDE, &[5.0], speed, 0.0),
        of("a square of 2 m at a fixed heading", &FIXED_SQUARE, &[2.0], speed, 0.0),
        of("a square of 2 m on its corner, at a fixed heading", &DIAGONAL_SQUARE, &[2.0], speed, 0.0),
        of("a square of 2 m driven to the side", &SIDEWAYS_SQUARE, &[2.0], speed, 0.0),
    ];
    if let Some(path) = path {
        let again = |what: &str, speed, turned| of(what, path.shape(), path.values(), speed, turned);
        offered.push(again("the same path", speed, 0.0));
        offered.push(again("the same path at half speed", at(0.5), 0.0));
        offered.push(again("the same path at double speed", at(2.0), 0.0));
        offered.push(again("the same path, START turned by 90 deg in the room", speed, FRAC_PI_2));
        if std::ptr::eq(path.shape(), &SQUARE) {
            let side = path.values()[0];
            let half = 0.5 * side;
            let points = [half, 0.0, side, 0.0, side, half, side, side, half, side, 0.0, side, 0.0, half, 0.0, 0.0];
            offered.push(of("the same square with a stop halfway along each side", &WAYPOINTS, &points, speed, 0.0));
            offered.push(of(&format!("a square of {half} m"), &SQUARE, &[half], speed, 0.0));
        }
    }
    offered.into_iter().flatten().collect()
}

/// A straight line is the same in both directions.
fn one_way(drive: Drive) -> Drive {
    let what = drive.what.replace(&format!("{RUNS} runs each way"), &format!("{RUNS} runs"));
    Drive { what, directions: &[Direction::Ccw], ..drive }
}

#[cfg(test)]
mod tests {
    use super::super::tests::complete;
    use super::*;
    use crate::random::Stream;

    /// Oracle: least squares of the truth's response by the columns of the others.
    #[test]
    fn a_truth_is_as_far_from_the_others_as_what_they_leave_of_its_response() {
        let mut stream = Stream::new(6, 0, 0);
        let mut rows = DMatrix::from_fn(20, 5, |_, _| stream.normal());
        rows.column_mut(1).fill(0.0);
        let values = DVector::from_column_slice(&[0.7, -2.0]);
        let doubt = Doubt { separates: ["a", "b"], truth: vec![3, 4], values: values.clone(), against: vec![0, 1, 2] };
        let against = rows.select_columns(&[0, 2]);
        let response = rows.select_columns(&[3, 4]) * values;
        let left = &response - &against * against.clone().svd(true, true).solve(&response, 1e-12).unwrap();
        let distance = doubt.distance(&rows.tr_mul(&rows));
        assert!((distance - left.norm()).abs() < 1e-9, "{distance}");
    }

    #[test]
    fn what_is_unseen_is_doubted_by_its_own_columns() {
        let exam = complete();
        let unseen = Unseen { effect: "turn_slip", why: Why::Absorbed(vec!["wheelbase"]) };
        let doubts = of_unseen(exam, &unseen);
        assert_eq!((doubts.len(), doubts[0].separates), (1, ["turn_slip", "wheelbase"]));
        assert_eq!(exam.name(doubts[0].truth[0]), Some("turn_slip"));
        assert!(!doubts[0].against.contains(&doubts[0].truth[0]));
    }

    #[test]
    fn a_straight_is_offered_one_way() {
        let speed = SpeedProfile::default();
        let path = Path::new(&STRAIGHT, &[10.0], speed).unwrap();
        let what = format!("a straight of 10 m, {RUNS} runs each way");
        let drive = one_way(Drive { what, path, turned: 0.0, directions: &Direction::BOTH });
        assert_eq!((&*drive.what, drive.directions), ("a straight of 10 m, 3 runs", &[Direction::Ccw][..]));
    }
}
