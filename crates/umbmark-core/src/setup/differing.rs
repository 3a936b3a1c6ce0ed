//! Runs that were recorded otherwise than the rest.

use super::agreement::{Agreement, Beside, Reading};
use super::counts_factor::CountsFactor;
use super::faults::{DOUBTFUL, Fault, NOTHING, VAGUE, look, scaled};
use crate::drive::Robot;

/// Minimum number of windows for a run to be examined by itself.
const FEWEST: usize = 20;

/// The faults of runs that were recorded with other columns or headings than the rest, or whose wheels and reference do not belong together;
/// `None` where all were recorded alike.
///
/// A run is examined by itself only if it disagrees with the agreement of all runs.
pub(super) fn faults(
    runs: &[(&str, Vec<Beside>)],
    (together, reading): (&[Fault], Reading),
    robot: &Robot,
) -> Option<Vec<Fault>> {
    if runs.len() < 2 || Fault::heading_factor(together) != 1.0 {
        return None;
    }
    let wheelbase = robot.drive.wheelbase();
    let pooled: Vec<Beside> = runs.iter().flat_map(|(_, own)| own.iter().copied()).collect();
    let agreed = Agreement::without_drift(&pooled, reading, wheelbase);
    let doubtful = |own: &[Beside]| agreed.misfits_of(own, reading, wheelbase).iter().any(|misfit| *misfit > VAGUE);
    if !runs.iter().any(|(_, own)| own.len() >= FEWEST && doubtful(own)) {
        return None;
    }
    // Each run by itself, if its motion then agrees and determines distance and rotation; and those that agree in no reading.
    let mut alone: Vec<(&str, Vec<Fault>, Option<CountsFactor>)> = Vec::new();
    let (mut strange, mut least): (Vec<String>, f64) = (Vec::new(), f64::INFINITY);
    for (name, own) in runs.iter().filter(|(_, own)| own.len() >= FEWEST) {
        let (faults, own_reading) = look(own, robot);
        let read = scaled(own, Fault::heading_factor(&faults));
        let found = Agreement::without_drift(&read, own_reading, wheelbase);
        if found.shown != [true; 2] || found.misfits.iter().any(|misfit| *misfit > DOUBTFUL) {
            // Courses of single positions turn by chance where the robot is slow: then the way says more than the turns.
            let misfit = match own.iter().all(|(window, _)| window.with_heading) {
                true => agreed.misfit_of_turns(own, reading, wheelbase),
                false => agreed.misfits_of(own, reading, wheelbase)[0],
            };
            if misfit > NOTHING && !agreed.only_wheels_turn(own, reading, wheelbase) {
                strange.push((*name).to_owned());
                least = least.min(misfit);
            }
            continue;
        }
        alone.push((*name, faults, CountsFactor::of(&found, robot)));
    }
    let usual = CountsFactor::of_most(&alone.iter().filter_map(|(_, _, counts)| *counts).collect::<Vec<_>>());
    let mut kinds: Vec<(Vec<Fault>, Vec<String>)> = Vec::new();
    for (name, mut faults, counts) in alone {
        if faults.is_empty() {
            faults.extend(counts.zip(usual).and_then(|(own, others)| own.beside(&others)).map(Fault::Counts));
        }
        match kinds.iter_mut().find(|(own, _)| *own == faults) {
            Some((_, same)) => same.push(name.to_owned()),
            None => kinds.push((faults, vec![name.to_owned()])),
        }
    }
    // Others must agree: if none do, nothing is known of any.
    let others = !kinds.is_empty() && !together.iter().any(|fault| matches!(fault, Fault::OtherMotion { .. }));
    let each = |(faults, runs): (Vec<Fault>, Vec<String>)| {
        faults.into_iter().map(move |fault| Fault::InRuns { fault: Box::new(fault), runs: runs.clone() })
    };
    let mut faults: Vec<Fault> = if kinds.len() > 1 { kinds.into_iter().flat_map(each).collect() } else { Vec::new() };
    if !strange.is_empty() && others {
        faults.push(Fault::InRuns { fault: Box::new(Fault::OtherMotion { misfit: least }), runs: strange });
    }
    (!faults.is_empty()).then_some(faults)
}
