//! Poses that were not measured but filled in, on straight lines between those that were.
//!
//! A reference of 5 Hz that was interpolated to the rows of a log at 50 Hz cuts every curve short, and nine of ten poses say nothing new. The
//! distance of a pose from the line between its neighbours tells: that of filled-in poses is rounding, and at regular intervals one, or the
//! two around a measured pose that lies between two rows, are far from it.

use umbmark_core::dataset::{ReferencePose, TickLog};
use umbmark_core::stats::median;

/// The least number of measured poses by which the pattern is recognised.
const FEWEST: usize = 20;
/// Filled-in poses lie within rounding of the line \[m\]; less than the second is never seen.
const ROUNDING: (f64, f64) = (5e-5, 1e-7);
/// Beyond so many times the usual distance, a pose breaks the line; measured ones do so by more, on average.
const BREAKS: f64 = 3.0;
const FAR: f64 = 5.0;
/// Shares of the measured poses that stand alone or in pairs, and in the usual interval.
const ALONE: f64 = 0.95;
const REGULAR: f64 = 0.8;

/// Leaves out the poses that were filled in; says how many.
pub(super) fn drop_filled_in(file: &str, log: &mut TickLog, warnings: &mut Vec<String>) {
    let Some((measured, interval)) = measured(log) else { return };
    let last = log.reference.len() - 1;
    let kept = |place: &usize| *place == 0 || *place == last || measured.binary_search(place).is_ok();
    let kept: Vec<ReferencePose> = (0..=last).filter(kept).map(|place| log.reference[place]).collect();
    log.mended.filled_in = log.reference.len() - kept.len();
    log.reference = kept;
    warnings.push(format!(
        "{file}: {} poses were filled in on straight lines between measured ones, {interval} poses apart, and were left out",
        log.mended.filled_in
    ));
}

/// The places of the measured poses between the first and the last, and the usual number of poses from one to the next; `None` where the
/// pattern is not there.
fn measured(log: &TickLog) -> Option<(Vec<usize>, usize)> {
    let away: Vec<f64> = log.reference.windows(3).map(|three| from_line([&three[0], &three[1], &three[2]])).collect();
    if away.len() < FEWEST {
        return None;
    }
    let usual = median(away.clone())?.max(ROUNDING.1);
    let breaks: Vec<usize> = (0..away.len()).filter(|place| away[*place] > BREAKS * usual).collect();
    let far = median(breaks.iter().map(|place| away[*place]).collect())?;
    let groups: Vec<&[usize]> = breaks.chunk_by(|a, b| a + 1 == *b).collect();
    if usual > ROUNDING.0 || groups.len() < FEWEST || far < FAR * usual {
        return None;
    }
    // Of the two around a measured pose, the one that is nearer to it breaks the line more.
    let farthest = |group: &&[usize]| group.iter().copied().max_by(|a, b| away[*a].total_cmp(&away[*b]));
    let measured: Vec<usize> = groups.iter().filter_map(farthest).map(|place| place + 1).collect();
    let steps = || measured.windows(2).map(|pair| pair[1] - pair[0]);
    let interval = median(steps().map(|step| step as f64).collect())? as usize;
    let alone = groups.iter().filter(|group| group.len() <= 2).count() as f64 / groups.len() as f64;
    let regular = steps().filter(|step| step.abs_diff(interval) <= 1).count() as f64 / steps().count() as f64;
    (alone >= ALONE && regular >= REGULAR).then_some((measured, interval))
}

/// Distance of the second of three poses from the line through the others \[m\]. Where along it the pose lies does not count, because a pose may
/// stand in the row that is nearest to it in time.
fn from_line([before, pose, after]: [&ReferencePose; 3]) -> f64 {
    let to = |to: &ReferencePose| [to.x - before.x, to.y - before.y];
    let (own, line) = (to(pose), to(after));
    let length = libm::hypot(line[0], line[1]);
    if length > 0.0 { (own[0] * line[1] - own[1] * line[0]).abs() / length } else { libm::hypot(own[0], own[1]) }
}
