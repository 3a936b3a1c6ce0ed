//! One test for whatever repeats: thousands of laws that no catalogue lists, and one p-value for all of them.
//!
//! The whitened residuals of a fitted model are held against the whitened columns of every law of [`Laws`], each less what the
//! model's own columns make of it. The statistic is the greatest of all quotients of a score and its standard deviation. Where nothing
//! repeats, the signs of whole runs may be flipped, and the same columns give its distribution: no law is asked by itself, so none costs
//! anything. Where few runs carry a column, quarters of runs are flipped.
//!
//! Of the laws that stand out most, each is then fitted along with the model and runs are left out. The shortest of those that predict
//! them as well as the best, within one standard error, is the law.
//!
//! Source: as [`flips`](super::flips); the choice by one standard error, Breiman, Friedman, Olshen & Stone (1984).

mod laws;
mod lengths;
mod shaping;
mod signs;

use super::examination::{ALIKE, Examination};
use super::look;
use super::smooth::Motion;
use crate::diagnose::Suspect;
use crate::effect::Model;
use crate::evidence::tracks::Errors;
use crate::evidence::tracks::estimates;
use crate::evidence::tracks::{Projected, System};
use crate::likelihood::{Column, Noise, Observed, ObservedRun};
use crate::stats::chi_squared_upper_tail;
use laws::{Laws, Step, steps};
use rayon::prelude::*;
use signs::{Asked, Sums, of_run, p_of_all};

/// So many laws are fitted, and so many of one shape at most.
const TRIED: usize = 16;
const OF_A_SHAPE: usize = 2;
/// A law by which errors of runs left out fall by less than this share of what the best of them does is none to take.
const WORSE: f64 = 0.5;
/// A law that is as good as another takes off the sum of squares as much as that, but for so much.
const AS_LIKELY: f64 = 40.0;
/// p at which something repeats: the other certificates together take the rest of one in twenty. Where it stands out as far as the second says
/// and runs left out are predicted so much better, p need only be the third: the flips of ten runs, of which the fast ones carry most, are few.
const SIZE: f64 = 0.01;
const LOUD: (f64, f64) = (1e-6, 0.1);
const SIZE_IF_LOUD: f64 = 0.05;
/// The names of the sizes of a law.
const SIZES: [&str; 2] = ["a", "b"];
/// The name of the number that shapes a law: a period, a scale, a threshold.
pub(super) const SHAPE: &str = "c";
/// Fewer runs do not show whether it is the same in all.
const ENOUGH_RUNS: usize = 4;
/// Where runs left out are predicted so much better, noise as wide as it was fitted may be what repeats, and is not taken as wider still. p need
/// only be this then: it is of the flips alone, and of few runs, of which some carry most, these are few.
const PLAIN: f64 = 0.4;
const SIZE_IF_PLAIN: f64 = 0.2;
/// The same by the noise model, and how many times as wide as that has it noise that remembers makes a drift of the heading.
const SIZE_BY_NOISE: f64 = 0.05;
const REMEMBERS: f64 = 2.6;

/// What repeats most.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeated {
    /// p of all laws together.
    pub p: f64,
    /// The score of the one that stands out most in standard deviations, as the noise model has them.
    pub deviations: f64,
    /// How many laws there are that the data could show.
    pub laws: usize,
    /// In how many runs it was looked for.
    pub runs: usize,
    /// The law that it is taken for.
    pub law: UnlistedLaw,
    /// Others that stand out, the one that predicts runs left out best first.
    pub others: Vec<UnlistedLaw>,
}

/// A law that no catalogue lists.
#[derive(Clone, Debug, PartialEq)]
pub struct UnlistedLaw {
    /// Its number in the table of laws, from 1.
    pub number: usize,
    /// A model that holds it alone, with start values, where it can be written as a formula.
    pub model: Option<Model>,
    /// What it acts on: "forward", "sideways" or "yaw".
    pub acts_on: &'static str,
    /// What it is in proportion to: "second", "metre" or "radian turned".
    pub per: &'static str,
    /// Whether it turns over with the sense of the run.
    pub with_sense: bool,
    /// By what, in words, with {c} for the value of its parameter c.
    pub(super) follows: String,
    /// What the length that shapes it is of the robot or of its path: "the circumference of a wheel".
    pub means: Option<String>,
    /// The effect of the catalogue that comes nearest to it once it is fitted, and the share of its response that this makes, as a cosine.
    pub nearest: Option<(&'static str, f64)>,
    /// How long its formula is: operations, variables and numbers.
    pub length: usize,
    /// Root mean square error of runs left out \[m\], and with the law.
    pub left_out: [f64; 2],
    /// By what share errors of runs left out fall, of positions, of headings, or from pose to pose, whichever falls most; less what positions
    /// rise by.
    pub gain: f64,
    /// What it takes off the sum of squares, in units of the noise variance.
    pub drop: f64,
    /// Share of its response that the law which is taken makes as well, as a cosine.
    pub likeness: f64,
}

impl UnlistedLaw {
    /// Whether these runs cannot tell it from the law that is taken.
    pub fn is_alike(&self) -> bool {
        self.likeness > ALIKE
    }

    /// The numbers that shape it, each with its name and three digits: a period, a scale, a threshold, a place.
    pub fn shapes(&self) -> Vec<(&'static str, String)> {
        let part = self.model.as_ref().and_then(|model| model.parts().first());
        let numbers = part.into_iter().flat_map(|part| part.effect.parameters().iter().zip(&part.values));
        let shapes = numbers.filter(|(parameter, _)| !SIZES.contains(&parameter.name));
        shapes.map(|(parameter, value)| (parameter.name, three_digits(*value))).collect()
    }

    /// What it follows, in words: "a wave of the time with a period of 18.9 s".
    pub fn by(&self) -> String {
        let part = self.model.as_ref().and_then(|model| model.parts().first());
        let numbers = part.into_iter().flat_map(|part| part.effect.parameters().iter().zip(&part.values));
        numbers.fold(self.follows.clone(), |words, (parameter, value)| {
            words.replace(&format!("{{{}}}", parameter.name), &three_digits(*value))
        })
    }

    /// In words: "the yaw motion for each metre follows the speed".
    pub fn words(&self) -> String {
        let sense = if self.with_sense { ", with the sense of the run" } else { "" };
        let means = self.means.as_ref().map(|means| format!(" ({means})")).unwrap_or_default();
        format!("the {} motion for each {} follows {}{means}{sense}", self.acts_on, self.per, self.by())
    }
}

fn three_digits(value: f64) -> String {
    let decimals = (2.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

impl Repeated {
    /// Whether it is no chance, and makes errors of runs left out fall by this share.
    pub(super) fn counts(&self, least: f64) -> bool {
        let (by_noise, gain) = (self.p_by_noise(REMEMBERS), self.law.gain);
        let is_plain = gain >= PLAIN && self.p_by_noise(1.0) <= LOUD.0;
        let is_loud = by_noise <= LOUD.0 && gain >= LOUD.1;
        let is_clear = (is_loud && self.p <= SIZE_IF_LOUD) || (is_plain && self.p <= SIZE_IF_PLAIN);
        let is_certain = self.p <= SIZE && by_noise <= SIZE_BY_NOISE;
        gain >= least && (is_certain || (is_clear && self.runs >= ENOUGH_RUNS))
    }

    /// Whether a model beside which it is left is not to be called explained: it counts, or it stands out of the noise as far as chance does
    /// once in a million and predicts runs left out 10 % better, though the flips of so few runs do not confirm it. A doubt needs less than an
    /// addition.
    pub(super) fn is_doubt(&self, least: f64) -> bool {
        let stands_out = self.p_by_noise(1.0) <= LOUD.0 && self.law.gain >= LOUD.1.max(least);
        self.counts(least) || (stands_out && self.runs >= ENOUGH_RUNS)
    }

    /// p of all laws together by the noise model (Bonferroni), with scores so many times as wide as that has them: flips of few runs are few, and
    /// one of them is as far out once in a while.
    fn p_by_noise(&self, wider: f64) -> f64 {
        let square = (self.deviations / wider).powi(2);
        (self.laws as f64 * chi_squared_upper_tail(square, 1.0)).min(1.0)
    }

    /// In a sentence, without a full stop.
    pub(crate) fn sentence(&self) -> String {
        let [before, after] = self.law.left_out;
        let p = if self.p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {:.3}", self.p) };
        let told = match self.counts(0.0) {
            true => format!("what is left repeats ({p} among {} laws)", self.laws),
            false => format!(
                "what is left may repeat ({:.1} standard deviations, the largest of {} laws; sign flips of these runs do not confirm it, {p})",
                self.deviations, self.laws
            ),
        };
        format!(
            "{told}: {}; with that, runs left out would be predicted to {:.1} mm instead of {:.1} mm",
            self.law.words(),
            1e3 * after,
            1e3 * before
        )
    }

    /// The same with the law of a number taken, 1 for the one that is, or the first behind it that is not `refused`; `None` where there is none.
    pub(super) fn taking(&self, number: usize, refused: impl Fn(&UnlistedLaw) -> bool) -> Option<Repeated> {
        let mut laws: Vec<UnlistedLaw> = std::iter::once(&self.law).chain(&self.others).cloned().collect();
        let which = (number.saturating_sub(1)..laws.len()).find(|which| !refused(&laws[*which]))?;
        let law = laws.remove(which);
        Some(Repeated { law, others: laws, ..self.clone() })
    }
}

impl UnlistedLaw {
    /// The law of this name as it was fitted in a model, and what its length means there.
    pub(super) fn fitted(self, name: &'static str, exam: &Examination) -> UnlistedLaw {
        let model = exam.fitted.model.only(name);
        let c = estimates(&exam.fitted).into_iter().find(|e| e.effect == name && e.parameter == SHAPE);
        let nearest = look::nearest(exam, name);
        let is_way = self.follows.contains("period of {c} m");
        let means = c.filter(|_| is_way).and_then(|c| lengths::meaning(&exam.fitted.observed, &c));
        UnlistedLaw { model: Some(model), means, nearest, ..self }
    }
}

/// What repeats as a suspect: the law of this name in a model that it was added to.
pub(super) fn suspect(repeated: &Repeated, name: &'static str, exam: &Examination) -> Suspect {
    let estimate: Vec<_> = estimates(&exam.fitted).into_iter().filter(|e| e.effect == name).collect();
    let freedom = [estimate.len() as f64, exam.system.rows as f64];
    let square = repeated.deviations * repeated.deviations;
    Suspect {
        class: vec![name],
        best: name,
        f: square / freedom[0].max(1.0),
        degrees_of_freedom: freedom,
        p: repeated.p_by_noise(REMEMBERS),
        p_adjusted: repeated.p,
        p_flips: Some(repeated.p),
        estimate,
        expected_drop: square,
    }
}

/// A law that is tried: its term, which motion it acts on, and whether it turns over with the sense of the run.
#[derive(Clone)]
struct Pick {
    term: usize,
    /// The numbers that shape it.
    shapes: Vec<f64>,
    motion: usize,
    with_sense: bool,
}

impl Pick {
    /// The columns of its term, and of its twin, in a run: for each of some numbers that shape it.
    fn columns(&self, shapes: &[&[f64]], run: &ObservedRun, laws: &Laws, steps: &[Step]) -> Vec<Column> {
        let sense = if self.with_sense { sense_of(run) } else { 1.0 };
        let shaped = shapes.iter().flat_map(|by| laws.both(self.term).map(move |term| (term, *by)));
        let columns = laws.shaped_columns(&shaped.collect::<Vec<_>>(), run, steps);
        let own = columns.into_iter().skip(self.motion).step_by(Motion::ALL.len());
        own.map(|column| column.into_iter().map(|c| c.map(|value| sense * value)).collect()).collect()
    }
}

/// Looks for what repeats beside a model under a noise: the law that stands out most, whether it counts or not; `None` where the runs could
/// show no law. `own` holds, run by run, the columns that are fitted along, one (x, y, heading) \[m, m, rad\] a block each, and last the residual.
pub fn what_repeats(
    observed: &Observed,
    model: &Model,
    noise: &Noise,
    own: &[Vec<Column>],
    seed: u64,
) -> Option<Repeated> {
    let chain = model.chain();
    let steps: Vec<Vec<Step>> = observed.runs.par_iter().map(|run| steps(run, &chain)).collect();
    let laws = Laws::of(&steps);
    let runs = observed.runs.par_iter().zip(own).zip(&steps).enumerate();
    let sums = runs.flat_map_iter(|(index, ((run, own), steps))| of_run(index, run, own, &laws, steps, noise));
    let sums: Vec<Sums> = sums.collect();
    let senses: Vec<f64> = sums.iter().map(|unit| sense_of(&observed.runs[unit.run])).collect();
    let plain = Asked::new(&sums, &vec![1.0; sums.len()])?;
    let both = [-1.0, 1.0].iter().all(|sense| senses.contains(sense));
    let turned = both.then(|| Asked::new(&sums, &senses)).flatten();
    drop(sums);
    let asked: Vec<&Asked> = std::iter::once(&plain).chain(&turned).collect();
    let p = p_of_all(&asked, seed)?;
    let (mut picks, square) = picks(&asked, &laws);
    shaping::shape(&mut picks, (observed, noise, own), &laws, &steps);
    let mut front = front(observed, noise, own, &laws, &steps, &picks);
    if front.is_empty() {
        return None;
    }
    front.iter_mut().zip(1..).for_each(|(law, number)| law.number = number);
    let law = front.remove(0);
    Some(Repeated {
        p,
        deviations: square.sqrt(),
        laws: asked.iter().map(|asked| asked.shown()).sum(),
        runs: observed.runs.len(),
        law,
        others: front,
    })
}

/// The same beside the model of an examination and the effects of the reference.
pub(super) fn beside(exam: &Examination, seed: u64) -> Option<Repeated> {
    let own = exam.some_columns(&[&exam.base(None)[..], &[exam.system.residual()]].concat());
    what_repeats(&exam.fitted.observed, &exam.fitted.model, &exam.fitted.noise, &own, seed)
}

fn sense_of(run: &ObservedRun) -> f64 {
    run.track.contexts().first().map_or(0.0, |at| at.direction)
}

/// The laws that stand out most, and the square of the greatest score of a column in standard deviations.
fn picks(asked: &[&Asked], laws: &Laws) -> (Vec<Pick>, f64) {
    let each = Motion::ALL.len();
    let mut all: Vec<(f64, Pick)> = Vec::new();
    let mut greatest: f64 = 0.0;
    for (group, asked) in asked.iter().enumerate() {
        for (term, about) in laws.terms.iter().enumerate() {
            for motion in 0..each {
                let of = |term: usize| asked.square(each * term + motion);
                let twin = about.twin.map_or(0.0, of);
                greatest = greatest.max(of(term)).max(twin);
                if about.twin.is_none_or(|twin| twin > term) {
                    let worth = of(term) + twin - 3.0 * laws.numbers(term) as f64;
                    all.push((worth, Pick { term, shapes: Vec::new(), motion, with_sense: group > 0 }));
                }
            }
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut shapes = Vec::new();
    let mut picks = Vec::new();
    for (worth, pick) in all {
        let shape = (laws.shape(pick.term), pick.motion, laws.terms[pick.term].per.name(), pick.with_sense);
        let known = shapes.iter().filter(|known| **known == shape).count();
        if picks.len() < TRIED && known < OF_A_SHAPE && (worth > 0.0 || picks.is_empty()) {
            shapes.push(shape);
            picks.push(Pick { shapes: laws.shapes(pick.term), ..pick });
        }
    }
    (picks, greatest)
}

/// Laws fitted along with the model's own columns: first the shortest of those that predict runs left out as well as the best, within one
/// standard error, then the others from the best to the worst.
fn front(
    observed: &Observed,
    noise: &Noise,
    own: &[Vec<Column>],
    laws: &Laws,
    steps: &[Vec<Step>],
    picks: &[Pick],
) -> Vec<UnlistedLaw> {
    let of_run = |((run, own), steps): ((&ObservedRun, &Vec<Column>), &Vec<Step>)| {
        let (residual, base) = own.split_last().map_or((Column::new(), own.as_slice()), |(r, b)| (r.clone(), b));
        let laws = picks.iter().flat_map(|pick| pick.columns(&[&pick.shapes], run, laws, steps));
        base.iter().cloned().chain(laws).chain([residual]).collect()
    };
    let columns: Vec<Vec<Column>> = observed.runs.iter().zip(own).zip(steps).map(of_run).collect();
    let system = System::new(observed, noise, &columns);
    let errors = Errors::new(observed, &system, &columns, (0..system.width).collect());
    let base: Vec<usize> = (0..own.first().map_or(0, |own| own.len() - 1)).collect();
    let left_out = |extra: &[usize]| {
        let columns = [&base[..], extra].concat();
        errors.squares(|fold| (columns.clone(), Projected::fit(&system.without(fold), &columns)))
    };
    let plain = left_out(&[]);
    let before = errors.misses_of(&plain);
    let projected = Projected::new(&system.whole, &base);
    let mut next = base.len();
    let mut tried: Vec<(UnlistedLaw, Vec<[f64; 3]>, Vec<usize>)> = Vec::new();
    for pick in picks {
        let own: Vec<usize> = (next..next + laws.both(pick.term).count()).collect();
        next += own.len();
        let Some((drop, sizes, _)) = projected.drop(&own) else { continue };
        let squares = left_out(&own);
        let after = errors.misses_of(&squares);
        let motion = Motion::ALL[pick.motion];
        let (numbers, how) = ((sizes.as_slice(), &pick.shapes[..]), (motion, pick.with_sense));
        let model = laws.model(pick.term, numbers, how, &observed.robot);
        let formula = model.as_ref().and_then(|model| model.parts().first()?.effect.formula());
        let law = UnlistedLaw {
            number: 0,
            length: formula.map_or(usize::MAX, |formula| formula.length()),
            model,
            acts_on: motion.name(),
            per: laws.terms[pick.term].per.name(),
            with_sense: pick.with_sense,
            follows: laws.words(pick.term).to_owned(),
            means: None,
            nearest: None,
            left_out: [before.position, after.position],
            gain: (after.gain(&before) - (after.position / before.position - 1.0).max(0.0)).max(0.0),
            drop,
            likeness: 1.0,
        };
        tried.push((law, squares, own));
    }
    let gain = tried.iter().map(|(law, ..)| law.gain).fold(0.0, f64::max);
    let (mut tried, worse): (Vec<_>, Vec<_>) = tried.into_iter().partition(|(law, ..)| law.gain >= WORSE * gain);
    let total = |squares: &[[f64; 3]]| squares.iter().map(|fold| fold[2]).sum::<f64>();
    tried.sort_by(|a, b| total(&a.1).total_cmp(&total(&b.1)));
    let most = tried.iter().map(|(law, ..)| law.drop).fold(0.0, f64::max);
    let as_good = |other: &&(UnlistedLaw, Vec<[f64; 3]>, Vec<usize>)| {
        is_as_good(&other.1, &tried[0].1) && other.0.drop >= most - AS_LIKELY
    };
    let written = tried.iter().filter(as_good).min_by_key(|(law, ..)| law.length);
    let Some(first) = written.or(tried.first()).and_then(|written| tried.iter().position(|other| other.2 == written.2))
    else {
        return Vec::new();
    };
    let chosen = tried.remove(first);
    tried.extend(worse);
    let values = projected.drop(&chosen.2).map(|(_, values, _)| values);
    let others = tried.into_iter().map(|(law, _, own)| {
        let likeness = values.as_ref().map_or(0.0, |values| projected.likeness(&chosen.2, values, &own));
        UnlistedLaw { likeness, ..law }
    });
    std::iter::once(chosen.0).chain(others).collect()
}

/// Whether squares of what is new from pose to pose, fold by fold, are no greater than the least ones, within one standard error of the sum of
/// their differences.
fn is_as_good(squares: &[[f64; 3]], least: &[[f64; 3]]) -> bool {
    let off: Vec<f64> = squares.iter().zip(least).map(|(own, least)| own[2] - least[2]).collect();
    let count = off.len() as f64;
    let mean = off.iter().sum::<f64>() / count;
    let scatter = off.iter().map(|off| (off - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    count * mean <= (count * scatter).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{complete, fitted, on_grain};
    use super::*;
    use crate::drive::Robot;
    use crate::effect::effects_text;
    use crate::effect::{Formula, Target};
    use crate::likelihood::watched::watched;

    #[test]
    fn nothing_counts_beside_a_complete_model() {
        let repeated = beside(complete(), 1).unwrap();
        assert!(!repeated.counts(0.02) && repeated.laws > 1000, "{repeated:?}");
    }

    /// What counts by certainty, by loudness, and by a gain that is plain; each just misses by one number.
    #[test]
    fn a_law_counts_by_its_p_its_score_and_what_it_predicts() {
        let repeated = beside(complete(), 1).unwrap();
        let counts = |p: f64, deviations: f64, gain: f64, runs: usize| {
            let law = UnlistedLaw { gain, ..repeated.law.clone() };
            Repeated { p, deviations, laws: 4000, runs, law, ..repeated.clone() }.counts(0.02)
        };
        assert!(counts(0.01, 12.0, 0.03, 10));
        assert!(!counts(0.02, 12.0, 0.03, 10) && !counts(0.01, 10.0, 0.03, 10) && !counts(0.01, 12.0, 0.01, 10));
        assert!(counts(0.05, 20.0, 0.11, 10));
        assert!(!counts(0.06, 20.0, 0.11, 10) && !counts(0.05, 12.0, 0.11, 10) && !counts(0.05, 20.0, 0.09, 10));
        assert!(counts(0.2, 8.0, 0.4, 4));
        assert!(!counts(0.21, 8.0, 0.4, 4) && !counts(0.2, 4.4, 0.43, 4) && !counts(0.2, 8.0, 0.39, 4));
        assert!(!counts(0.2, 8.0, 0.4, 3));
        let doubt = |deviations: f64, gain: f64, runs: usize| {
            let law = UnlistedLaw { gain, ..repeated.law.clone() };
            let doubted = Repeated { p: 0.3, deviations, laws: 4000, runs, law, ..repeated.clone() };
            assert!(!doubted.counts(0.0) && doubted.sentence().starts_with("what is left may repeat ("));
            doubted.is_doubt(0.02)
        };
        assert!(doubt(8.0, 0.1, 4));
        assert!(!doubt(6.0, 0.1, 4) && !doubt(8.0, 0.09, 4) && !doubt(8.0, 0.1, 3));
    }

    #[test]
    fn a_law_that_no_catalogue_lists_is_named_with_what_it_follows() {
        let exam = Examination::new(super::super::tests::fitted_to(&on_grain())).unwrap();
        let repeated = beside(&exam, 1).unwrap();
        assert!(repeated.counts(0.1) && repeated.p < 0.01, "{repeated:?}");
        assert_eq!((repeated.law.acts_on, repeated.law.per), ("yaw", "metre"));
        assert_eq!(repeated.law.by(), "a wave of 2 times the heading");
        assert!(repeated.law.left_out[1] < 0.5 * repeated.law.left_out[0], "{repeated:?}");
        let law = repeated.law.model.as_ref().unwrap();
        assert!(
            effects_text(law).contains(
                "acts_on = \"heading_per_metre\"\nformula = \"a * cos(2 * heading) + b * sin(2 * heading)\"\n"
            ),
            "{}",
            effects_text(law)
        );
        let sizes = ["a", "b"].map(|name| law.get("yaw_by_heading", name).unwrap());
        assert!((sizes[0] - 0.02).abs() < 1e-3, "{sizes:?}");
        assert_eq!(beside(&exam, 1), Some(repeated));
    }

    /// Oracle: exact derivatives of replays with a formula that does the same, on squares driven both ways.
    #[test]
    fn a_law_moves_the_robot_as_a_formula_does_that_adds_the_same() {
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        let chain = model.chain();
        let steps: Vec<Vec<Step>> = observed.runs.iter().map(|run| steps(run, &chain)).collect();
        let laws = Laws::of(&steps);
        for (words, per, motion, target, formula) in [
            ("a wave of 2 times the heading", "metre", 2, Target::HeadingPerMetre, "cos(2 * heading)"),
            ("the square of the speed", "metre", 1, Target::SidewaysPerMetre, "speed^2"),
            ("the speed", "metre", 0, Target::ForwardScale, "abs(speed)"),
            ("the size of the turn rate", "radian turned", 0, Target::ForwardPerRadian, "abs(turn_rate)"),
            ("the time in the run", "metre", 2, Target::HeadingPerMetre, "time"),
        ] {
            let mut with = Model::new(&observed.robot);
            let text = format!("k * {formula}");
            with.add_formula(Formula::new("own", target, &text, &["k"]).unwrap(), &[0.0]).unwrap();
            let expected = observed.columns(&with, &[0]);
            let is_it = |term: &usize| laws.words(*term) == words && laws.terms[*term].per.name() == per;
            let term = (0..laws.terms.len()).find(is_it).unwrap();
            for ((run, expected), steps) in observed.runs.iter().zip(&expected).zip(&steps) {
                let own = &laws.columns(&[term], run, steps)[motion];
                for k in 0..3 {
                    let most = expected[0].iter().map(|error| error[k].abs()).fold(0.0, f64::max);
                    let near = |(a, b): (&[f64; 3], &[f64; 3])| (a[k] - b[k]).abs() <= 0.1 * most + 1e-9;
                    assert!(own.iter().zip(&expected[0]).all(near), "{words}, {k}");
                }
            }
        }
    }

    /// Oracle: the columns of the law itself, and exact derivatives of replays of the formula that it is written as.
    #[test]
    fn every_law_moves_the_robot_as_the_formula_does_that_it_is_written_as() {
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        let chain = model.chain();
        let steps: Vec<Vec<Step>> = observed.runs.iter().map(|run| steps(run, &chain)).collect();
        let laws = Laws::of(&steps);
        let (mut written, mut lost) = (0, Vec::new());
        for term in 0..laws.terms.len() {
            let terms: Vec<usize> =
                std::iter::once(term).chain(laws.terms[term].twin.filter(|twin| *twin > term)).collect();
            if laws.terms[term].twin.is_some_and(|twin| twin < term) {
                continue;
            }
            for (which, motion) in Motion::ALL.into_iter().enumerate() {
                let sizes = vec![0.0; terms.len()];
                let Some(formula) = laws.model(term, (&sizes, &laws.shapes(term)), (motion, false), &observed.robot)
                else {
                    continue;
                };
                written += 1;
                assert!(observed.tracks().all(|track| track.check(&formula).is_ok()), "{}", laws.words(term));
                let numbers: Vec<usize> = (0..sizes.len()).collect();
                let derivatives = observed.columns(&formula, &numbers);
                for ((run, exact), steps) in observed.runs.iter().zip(&derivatives).zip(&steps) {
                    let own: Vec<Column> =
                        laws.columns(&terms, run, steps).into_iter().skip(which).step_by(Motion::ALL.len()).collect();
                    for (own, exact) in own.iter().zip(exact) {
                        let size = |column: &Column| column.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
                        let off: Column =
                            own.iter().zip(exact).map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]]).collect();
                        let words = laws.words(term);
                        // Blocks hold some decimetres and seconds: what turns over within them is its mean in one, and its middle in the other.
                        let is_quick = ["wave", "more than"].iter().any(|quick| words.contains(quick));
                        if size(&off) > if is_quick { 0.6 } else { 0.15 } * size(exact) + 1e-6 {
                            lost.push((
                                laws.words(term).to_owned(),
                                laws.terms[term].per,
                                motion,
                                size(&off),
                                size(exact),
                            ));
                        }
                    }
                }
            }
        }
        assert!(written > 500, "{written}");
        assert!(lost.len() < written / 10, "{} of {written}: {:#?}", lost.len(), &lost);
    }

    #[test]
    fn an_effect_that_the_model_lacks_counts_and_is_said_in_a_sentence() {
        let exam = Examination::new(fitted(&[("floor_slope", "drift_x", 6e-3)])).unwrap();
        let repeated = beside(&exam, 1).unwrap();
        assert!(repeated.counts(0.02), "{repeated:?}");
        let said = repeated.sentence();
        assert!(said.starts_with("what is left repeats (p = ") && said.contains(&repeated.law.by()), "{said}");
    }
}
