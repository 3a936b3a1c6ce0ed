//! Recordings that stand twice in a dataset.
//!
//! A copy under another name says nothing new, and yet every interval would be narrower by it. No drive repeats another to the last digit of
//! every measured pose.

use super::Fault;
use crate::run::{ReferencePose, Run, TickLog};

/// A recording with fewer measured poses is not compared: few numbers may agree by chance.
const FEWEST: usize = 20;
/// The wheels stand over so many poses in a row; the first and the last of them are not compared, as a slow wheel makes no count for a
/// while.
const RESTING: usize = 10;
const EDGE: usize = 3;
/// Poses closer than this are the same \[m, rad\].
const ROUNDING: f64 = 1e-9;

/// The faults of recordings that are the same as another one, a group each.
pub(super) fn found(runs: &[Run]) -> impl Iterator<Item = Fault> {
    let mut groups: Vec<(&TickLog, Vec<String>)> = Vec::new();
    let measured = runs.iter().filter_map(|run| Some((run, run.log.as_ref()?)));
    for (run, log) in measured.filter(|(_, log)| log.reference.len() >= FEWEST && is_noisy(log)) {
        match groups.iter_mut().find(|(first, _)| is_same(first, log)) {
            Some((_, names)) => names.push(run.name.clone()),
            None => groups.push((log, vec![run.name.clone()])),
        }
    }
    groups.into_iter().filter(|(_, names)| names.len() > 1).map(|(_, runs)| Fault::Copies { runs })
}

/// Whether poses differ while the wheels stand, as measured ones do; simulated ones without noise repeat each other rightly.
fn is_noisy(log: &TickLog) -> bool {
    log.reference.windows(RESTING).any(|poses| {
        let samples = poses[0].sample..=poses[RESTING - 1].sample;
        let stands = |counts: &[f64]| counts[samples.clone()].iter().all(|count| *count == counts[*samples.start()]);
        let apart = |a: &ReferencePose, b: &ReferencePose| {
            let turned = a.heading.zip(b.heading).map_or(0.0, |(a, b)| (a - b).abs());
            (a.x - b.x).abs().max((a.y - b.y).abs()).max(turned) > ROUNDING
        };
        stands(&log.left)
            && stands(&log.right)
            && log.rollers.iter().all(|counts| stands(counts))
            && poses[EDGE..RESTING - EDGE].iter().any(|pose| apart(pose, &poses[EDGE]))
    })
}

/// Whether two recordings have the same counts and the same poses, whenever they began.
fn is_same(one: &TickLog, other: &TickLog) -> bool {
    let counts = |log: &TickLog| {
        let since = |counts: &[f64]| counts.iter().map(|count| count - counts[0]).collect::<Vec<_>>();
        [&log.left, &log.right].into_iter().chain(&log.rollers).map(|counts| since(counts)).collect::<Vec<_>>()
    };
    one.reference == other.reference && one.time.len() == other.time.len() && counts(one) == counts(other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::robot_with;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::likelihood::watched::watched;

    #[test]
    fn a_recording_under_a_second_name_is_named_and_a_drive_like_another_is_not() {
        let noisy =
            robot_with(&[("reference_noise", "position_sd_m", 1e-3), ("reference_noise", "heading_sd_rad", 2e-3)]);
        let mut runs = watched(&noisy, 2, 5).runs;
        assert_eq!(found(&runs).count(), 0);
        let mut copy = runs[1].clone();
        copy.name = "again".into();
        // Begun a minute later, on counters that went on.
        let log = copy.log.as_mut().unwrap();
        log.time.iter_mut().for_each(|time| *time += 60.0);
        log.left.iter_mut().for_each(|count| *count += 1000.0);
        runs.push(copy);
        let names = vec![runs[1].name.clone(), "again".to_owned()];
        assert_eq!(found(&runs).collect::<Vec<_>>(), [Fault::Copies { runs: names }]);
        runs.last_mut().unwrap().log.as_mut().unwrap().reference[30].x += 1e-4;
        assert_eq!(found(&runs).count(), 0);
    }

    #[test]
    fn drives_without_noise_may_be_the_same() {
        let mut runs = watched(&Model::new(&Robot::labmate()), 1, 5).runs;
        runs.push(Run { name: "again".into(), ..runs[0].clone() });
        assert_eq!(found(&runs).count(), 0);
    }
}
