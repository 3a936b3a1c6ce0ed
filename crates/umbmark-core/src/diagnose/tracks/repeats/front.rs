//! The most significant laws, fitted together with the model, and the choice among them.

use super::law::UnlistedLaw;
use super::laws::Laws;
use super::pick::Pick;
use super::steps::TrackStep;
use crate::diagnose::tracks::smooth::Motion;
use crate::evidence::tracks::{Errors, Projected, System};
use crate::likelihood::{Column, Noise, Observed, ObservedRun};

/// A law is not taken where its gain in held-out runs is below this share of the best gain.
const WORSE: f64 = 0.5;
/// Two laws are equally good where their drops of the sum of squares differ by less than this.
const AS_LIKELY: f64 = 40.0;

/// A law that was fitted together with the model's own columns.
struct Tried {
    law: UnlistedLaw,
    /// Squared errors of each fold when it is left out: of positions, headings, innovations.
    squares: Vec<[f64; 3]>,
    /// Its columns.
    columns: Vec<usize>,
}

/// Laws fitted together with the model's own columns: first the shortest of those that predict held-out runs as well as the best, within one
/// standard error, then the others from the best to the worst.
pub fn front(
    observed: &Observed,
    noise: &Noise,
    own: &[Vec<Column>],
    laws: &Laws,
    steps: &[Vec<TrackStep>],
    picks: &[Pick],
) -> Vec<UnlistedLaw> {
    let of_run = |((run, own), steps): ((&ObservedRun, &Vec<Column>), &Vec<TrackStep>)| {
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
    let mut tried = Vec::new();
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
            acts_on: laws.acts_on(pick.term, motion),
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
        tried.push(Tried { law, squares, columns: own });
    }
    chosen_first(tried, &projected)
}

/// The law that is chosen, and the others by their errors in held-out runs, each with its likeness to the chosen one.
fn chosen_first(tried: Vec<Tried>, projected: &Projected) -> Vec<UnlistedLaw> {
    let gain = tried.iter().map(|tried| tried.law.gain).fold(0.0, f64::max);
    let (mut tried, worse): (Vec<_>, Vec<_>) = tried.into_iter().partition(|tried| tried.law.gain >= WORSE * gain);
    let total = |tried: &Tried| tried.squares.iter().map(|fold| fold[2]).sum::<f64>();
    tried.sort_by(|a, b| total(a).total_cmp(&total(b)));
    let most = tried.iter().map(|tried| tried.law.drop).fold(0.0, f64::max);
    let as_good = |(_, other): &(usize, &Tried)| {
        is_as_good(&other.squares, &tried[0].squares) && other.law.drop >= most - AS_LIKELY
    };
    let shortest = tried.iter().enumerate().filter(as_good).min_by_key(|(_, tried)| tried.law.length);
    let first = shortest.map_or(0, |(index, _)| index);
    if tried.is_empty() {
        return Vec::new();
    }
    let chosen = tried.remove(first);
    tried.extend(worse);
    let values = projected.drop(&chosen.columns).map(|(_, values, _)| values);
    let others = tried.into_iter().map(|Tried { law, columns, .. }| {
        let likeness = values.as_ref().map_or(0.0, |values| projected.likeness(&chosen.columns, values, &columns));
        UnlistedLaw { likeness, ..law }
    });
    std::iter::once(chosen.law).chain(others).collect()
}

/// Whether the squared innovations, fold by fold, are no greater than the smallest ones, within one standard error of the sum of
/// their differences.
fn is_as_good(squares: &[[f64; 3]], least: &[[f64; 3]]) -> bool {
    let off: Vec<f64> = squares.iter().zip(least).map(|(own, least)| own[2] - least[2]).collect();
    let count = off.len() as f64;
    let mean = off.iter().sum::<f64>() / count;
    let scatter = off.iter().map(|off| (off - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    count * mean <= (count * scatter).sqrt()
}
