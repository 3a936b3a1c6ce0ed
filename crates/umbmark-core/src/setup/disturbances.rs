//! Poses that are wrong, and places where a track jumps: found together, in all runs at once.
//!
//! Between two poses the reference moves and the wheels roll. Their difference, in standard deviations, is the cost of the edge that joins
//! the poses (`edges`). Skipping a pose has a cost, and so has a jump. The cheapest way from the first pose of a run to its last
//! (`cheapest`) shows which poses are wrong and where the track jumps, all at once, so that no jump hides another. Slower disturbances are
//! searched afterwards (`stretches`). The standard deviations come from medians over all runs, which wild poses do not change.

use super::cheapest::{LONGEST, Way};
use super::edges::{Edge, JUMP, Sighting, Spread, difference};
use super::shared::Shared;
use super::{PoseNoise, stretches};

/// Poses that deviate for no longer than this share of a run's poses and this time \[s\], after which the track continues as before, are
/// wrong.
const APART: (f64, f64) = (0.05, 3.0);

/// What was found in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// Poses that are wrong, by their place in the run.
    pub wrong: Vec<Wrong>,
    /// Places where the track jumps.
    pub jumps: Vec<Leap>,
}

/// A wrong pose, and its distance from the place that its neighbours imply \[m, rad\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrong {
    pub pose: usize,
    pub moved: f64,
    pub turned: Option<f64>,
}

/// A jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leap {
    /// The last pose before it.
    pub from: usize,
    /// The first behind it.
    pub pose: usize,
    /// Motion of the tracked point that the wheels did not make \[m\], and its rotation \[rad\].
    pub moved: f64,
    pub turned: Option<f64>,
    /// In standard deviations.
    pub deviations: f64,
}

/// Searches all runs; returns the findings of each, and the noise of a single pose. What is wrong with single `steps` of a reference that tells
/// motion only is an accident at whatever place, also where another run has one. `counted`: variances of a pose \[m², rad²\] that whole counts
/// make.
pub(super) fn search(runs: &[Vec<Sighting>], steps_only: bool, counted: [f64; 2]) -> (Vec<Found>, PoseNoise) {
    let (spread, noise) = Spread::of(runs, counted);
    let ways: Vec<Way> = runs.iter().map(|run| Way::cheapest(run, &spread)).collect();
    let steps: Vec<Vec<Edge>> = runs.iter().zip(&ways).map(|(run, way)| way.large_steps(run, &spread)).collect();
    let large = |(run, steps): (&Vec<Sighting>, &Vec<Edge>)| steps.iter().map(|step| run[step.to].rolled).collect();
    let shared = Shared::new(runs, runs.iter().zip(&steps).map(large).collect());
    let left = |(index, run): (usize, &Vec<Sighting>)| {
        let is_shared = |step: &Edge| !steps_only && shared.stands_elsewhere(index, run[step.to].rolled);
        let own = |step: &&Edge| step.deviations > JUMP && !is_shared(step);
        let jumps = steps[index].iter().filter(own).copied().collect::<Vec<Edge>>();
        sorted_out(run, &ways[index].kept, jumps, &spread)
    };
    let (kept, jumps): (Vec<_>, Vec<_>) = runs.iter().enumerate().map(left).unzip();
    let stretches = stretches::search(runs, &kept, jumps, &spread);
    let found = runs.iter().zip(&kept).zip(stretches).map(|((run, kept), mut stretches)| {
        behind_gaps(run, kept, &mut stretches, &spread);
        Found::of(run, kept, stretches)
    });
    (found.collect(), noise)
}

/// Turns jumps that soon reverse into wrong poses: returns the poses that are then kept, and the remaining jumps.
fn sorted_out(run: &[Sighting], kept: &[usize], jumps: Vec<Edge>, spread: &Spread) -> (Vec<usize>, Vec<Edge>) {
    let mut jumps = jumps;
    let mut kept = kept.to_vec();
    let longest = ((APART.0 * run.len() as f64) as usize).max(LONGEST);
    let mut k = 0;
    while k + 1 < jumps.len() {
        let (out, back) = (jumps[k], jumps[k + 1]);
        let short = back.from - out.to < longest && run[back.from].time - run[out.to].time < APART.1;
        let across = spread.deviations(&run[out.from], &run[back.to]);
        if short && across < 0.5 * JUMP {
            kept.retain(|pose| *pose <= out.from || *pose >= back.to);
            jumps.drain(k..=k + 1);
            k = k.saturating_sub(1);
        } else {
            k += 1;
        }
    }
    (kept, jumps)
}

/// Adds the places where rows are missing, however small the difference.
fn behind_gaps(run: &[Sighting], kept: &[usize], jumps: &mut Vec<Edge>, spread: &Spread) {
    for pair in kept.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let known = jumps.iter().any(|jump| jump.from <= from && to <= jump.to);
        if !known && run[from + 1..=to].iter().any(|pose| pose.after_gap) {
            jumps.push(Edge::between(run, from, to, spread));
        }
    }
    jumps.sort_by_key(|jump| jump.from);
}

impl Found {
    /// Poses that are not kept are wrong, except those within a jump.
    fn of(run: &[Sighting], kept: &[usize], jumps: Vec<Edge>) -> Found {
        let mut wrong = Vec::new();
        let mut next = 0;
        for pose in 0..run.len() {
            if kept.get(next) == Some(&pose) {
                next += 1;
                continue;
            }
            let before = next.checked_sub(1).map(|k| kept[k]);
            let Some(from) = before.or_else(|| kept.get(next).copied()) else { continue };
            let ([x, y], turned) = difference(&run[from], &run[pose]);
            wrong.push(Wrong { pose, moved: libm::hypot(x, y), turned });
        }
        // What lies within a jump is the way that the wheels did not make.
        wrong.retain(|wrong| !jumps.iter().any(|jump| jump.from < wrong.pose && wrong.pose < jump.to));
        let jumps = jumps.into_iter().map(|Edge { from, to, deviations }| {
            let ([x, y], turned) = difference(&run[from], &run[to]);
            Leap { from, pose: to, moved: libm::hypot(x, y), turned, deviations }
        });
        Found { wrong, jumps: jumps.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Displacement2, Pose2};
    use crate::random::Stream;

    /// Runs of 600 poses at 20 Hz of a robot that drives and turns at random, seen to 2 mm and 3 mrad.
    fn runs(count: u64) -> Vec<Vec<Sighting>> {
        (0..count)
            .map(|run| {
                let mut stream = Stream::new(17, 0, run);
                let (mut pose, mut rolled) = (Pose2::IDENTITY, [0.0; 2]);
                (0..600)
                    .map(|k| {
                        let (way, turn) = (0.01 * (1.0 + stream.normal()), 0.03 * stream.normal());
                        pose = pose.moved(&Displacement2 { forward: way, sideways: 0.0, rotation: turn });
                        rolled = [rolled[0] + way.abs(), rolled[1] + turn.abs()];
                        let noisy = |value: f64, sd: f64, stream: &mut Stream| value + sd * stream.normal();
                        let measured = (
                            noisy(pose.x, 2e-3, &mut stream),
                            noisy(pose.y, 2e-3, &mut stream),
                            Some(noisy(pose.heading, 3e-3, &mut stream)),
                        );
                        let [way, turned] = rolled;
                        Sighting {
                            time: 0.05 * f64::from(k),
                            way,
                            turned,
                            rolled: way + 0.15 * turned,
                            after_gap: false,
                            expected: pose,
                            measured,
                        }
                    })
                    .collect()
            })
            .collect()
    }

    /// Moves everything from a pose on and rotates it about that pose.
    fn jump(run: &mut [Sighting], at: usize, moved: f64, turned: f64) {
        let (pivot_x, pivot_y, _) = run[at].measured;
        let (sine, cosine) = libm::sincos(turned);
        for Sighting { measured: (x, y, heading), .. } in &mut run[at..] {
            let (dx, dy) = (*x - pivot_x, *y - pivot_y);
            (*x, *y) = (pivot_x + cosine * dx - sine * dy + moved, pivot_y + sine * dx + cosine * dy);
            *heading = heading.map(|heading| heading + turned);
        }
    }

    #[test]
    fn nothing_is_found_where_nothing_is() {
        assert!(search(&runs(6), false, [0.0; 2]).0.iter().all(|found| *found == Found::default()));
    }

    #[test]
    fn a_jump_in_every_run_and_two_in_one_are_found_where_they_are_and_as_large() {
        let mut runs = runs(4);
        for (index, run) in runs.iter_mut().enumerate() {
            jump(run, 100 + 77 * index, 0.1, -0.2);
        }
        jump(&mut runs[2], 400, 0.0, 0.5);
        let (found, noise) = search(&runs, false, [0.0; 2]);
        assert!((noise.position / 2e-3 - 1.0).abs() < 0.2 && (noise.heading / 3e-3 - 1.0).abs() < 0.2, "{noise:?}");
        for (index, found) in found.iter().enumerate() {
            let expected: &[usize] = if index == 2 { &[254, 400] } else { &[100 + 77 * index] };
            assert_eq!(found.jumps.iter().map(|jump| jump.pose).collect::<Vec<_>>(), expected);
            assert!(found.wrong.is_empty());
            let first = found.jumps[0];
            assert!((first.moved - 0.1).abs() < 0.02 && (first.turned.unwrap() + 0.2).abs() < 0.02, "{first:?}");
        }
    }

    #[test]
    fn wrong_poses_alone_and_in_bursts_are_found_and_no_others_and_are_no_jumps() {
        let mut runs = runs(3);
        let wrong = [vec![0, 50, 51, 52, 200, 599], (300..320).collect(), (0..600).step_by(20).collect::<Vec<usize>>()];
        for (run, wrong) in runs.iter_mut().zip(&wrong) {
            for pose in wrong {
                let shift = if wrong.len() == 20 { 1.0 } else { 0.3 + 0.01 * (*pose % 7) as f64 };
                run[*pose].measured.0 += shift;
            }
        }
        for (found, expected) in search(&runs, false, [0.0; 2]).0.iter().zip(&wrong) {
            assert_eq!(found.jumps, []);
            assert_eq!(found.wrong.iter().map(|wrong| wrong.pose).collect::<Vec<_>>(), *expected);
            assert!(found.wrong.iter().all(|wrong| (0.25..1.1).contains(&wrong.moved)), "{:?}", found.wrong);
        }
    }

    /// From 300 on, so many poses slip by so much each.
    fn slip(run: &mut [Sighting], poses: usize, turned: f64) {
        for at in 300..300 + poses {
            jump(run, at, 0.0, turned);
        }
    }

    #[test]
    fn a_slip_of_a_second_is_found_as_one_jump_and_no_pose_is_wrong() {
        let mut runs = runs(4);
        slip(&mut runs[1], 16, 0.012);
        let (found, _) = search(&runs, false, [0.0; 2]);
        for (index, found) in found.iter().enumerate() {
            assert_eq!((found.wrong.len(), found.jumps.len()), (0, usize::from(index == 1)), "{found:?}");
        }
        let jump = found[1].jumps[0];
        assert!((285..=300).contains(&jump.from) && (315..=331).contains(&jump.pose), "{jump:?}");
        assert!((jump.turned.unwrap() - 0.19).abs() < 0.03, "{jump:?}");
    }

    #[test]
    fn a_robot_that_is_carried_for_two_seconds_jumps_once() {
        let mut runs = runs(4);
        slip(&mut runs[2], 40, 0.1);
        let (found, _) = search(&runs, false, [0.0; 2]);
        assert_eq!(found.iter().map(|found| found.jumps.len()).collect::<Vec<_>>(), [0, 0, 1, 0]);
        assert!(found.iter().all(|found| found.wrong.is_empty()), "{found:?}");
        let jump = found[2].jumps[0];
        assert!(jump.from.abs_diff(299) <= 2 && jump.pose.abs_diff(339) <= 2, "{jump:?}");
    }

    #[test]
    fn what_slips_in_many_places_or_at_the_same_of_all_runs_is_no_accident() {
        let mut runs = runs(4);
        for run in &mut runs {
            for at in (0..6).map(|k| 40 + 90 * k) {
                for pose in at..at + 16 {
                    jump(run, pose, 0.0, 0.012);
                }
            }
        }
        assert!(search(&runs, false, [0.0; 2]).0.iter().all(|found| found.jumps.is_empty()));
        let mut runs = self::runs(6);
        for run in &mut runs {
            let at = run.iter().position(|pose| pose.rolled > 3.0).unwrap();
            for pose in at..at + 16 {
                jump(run, pose, 0.0, 0.012);
            }
        }
        assert!(search(&runs, false, [0.0; 2]).0.iter().all(|found| found.jumps.is_empty()));
    }

    #[test]
    fn what_all_runs_have_at_the_same_place_is_no_jump() {
        let mut runs = runs(6);
        for run in &mut runs {
            let at = run.iter().position(|pose| pose.rolled > 3.0).unwrap();
            jump(run, at, 0.0, 0.1);
        }
        assert!(search(&runs, false, [0.0; 2]).0.iter().all(|found| found.jumps.is_empty()));
    }
}
