//! Poses that are wrong, and places where a track jumps: found together, in all runs at once.
//!
//! Between two poses the reference moves and the wheels roll; how far the two differ, in standard deviations, is what an edge costs
//! that joins them. A pose that is passed over costs something, and a jump costs something. The cheapest way from the
//! first pose of a run to its last (Viterbi 1967) therefore says at once which poses are wrong and where the track jumps, and no
//! jump hides another. Slower ones are looked for afterwards (`stretches`). The standard deviations come from medians over all runs, which wild poses do not move.

use super::robust::median;
use super::{PoseNoise, stretches};
use crate::geometry::Pose2;

/// A difference of more standard deviations than this is a jump.
pub(super) const JUMP: f64 = 10.0;
/// What a jump costs, in half squares of standard deviations; what the first pose costs that is passed over, and each after it.
const COSTS: [f64; 3] = [0.5 * JUMP * JUMP, 32.0, 10.0];
/// Maximum number of consecutive wrong poses.
const LONGEST: usize = 12;
/// Where no edge nearby exceeds this many standard deviations, no pose is passed over.
const QUIET: f64 = 5.0;
/// What stands apart for no longer than this share of a run's poses, and this time \[s\], and then goes on as before, is wrong.
const APART: (f64, f64) = (0.05, 3.0);
/// Edges that determine the noise: over these numbers of poses.
const OVER: [usize; 4] = [1, 2, 4, 8];
/// The noise is estimated by the size of the motion, in this many parts of all edges.
const PARTS: usize = 10;
/// Minimum standard deviation \[m, rad\], and minimum in terms of the motion in this time \[s\]: smaller differences are noise, and are
/// judged where the sizes of the noise are known.
const LEAST: [f64; 2] = [1.5e-3, 3e-3];
const JITTER: f64 = 0.01;
/// Sizes of the robot by the motion alone are wrong by up to this share of way and turns.
const SIZES: f64 = 0.005;
/// A jump that other runs have at the same place is not an accident: within this distance \[m\], and more often than by chance at this level.
const SAME_PLACE: (f64, f64) = (0.15, 1e-4);
/// Other runs have it where a difference exceeds this many standard deviations.
pub(super) const LARGE: f64 = 4.0;

/// A pose of a run: as the wheels have it, and as it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sighting {
    /// Its stamp \[s\].
    pub time: f64,
    /// Way of the wheels until then \[m\], and how much they turned \[rad\], whatever way.
    pub way: f64,
    pub turned: f64,
    /// Both together, turning at the arm of a wheel \[m\].
    pub rolled: f64,
    pub expected: Pose2,
    /// Without a heading where none was measured.
    pub measured: (f64, f64, Option<f64>),
}

/// What was found in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// Poses that are wrong, by their place in the run.
    pub wrong: Vec<Wrong>,
    /// Places where the track jumps.
    pub jumps: Vec<Leap>,
}

/// A pose that is wrong, and how far it lies from where the poses around it say \[m, rad\].
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
    /// How far the tracked point went that the wheels did not \[m\], and how far it turned \[rad\].
    pub moved: f64,
    pub turned: Option<f64>,
    /// In standard deviations.
    pub deviations: f64,
}

/// How far the measured motion from one pose to another is from the expected one: along both coordinates of the robot \[m\] and,
/// where headings were measured, its rotation \[rad\].
fn difference(from: &Sighting, to: &Sighting) -> ([f64; 2], Option<f64>) {
    let expected = from.expected.between(&to.expected);
    let (x, y) = (to.measured.0 - from.measured.0, to.measured.1 - from.measured.1);
    let (Some(before), Some(after)) = (from.measured.2, to.measured.2) else {
        // The course is all there is to lay one along the other.
        return ([libm::hypot(x, y) - libm::hypot(expected.x, expected.y), 0.0], None);
    };
    let (sine, cosine) = libm::sincos(before);
    let moved = [cosine * x + sine * y - expected.x, cosine * y - sine * x - expected.y];
    (moved, Some(crate::geometry::wrap(after - before - expected.heading)))
}

/// Variances of a coordinate \[m²\] and of a rotation \[rad²\], by how far the wheels rolled: a + b · rolled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    position: [f64; 2],
    heading: [f64; 2],
}

impl Spread {
    /// Of all runs, and the noise of a single pose: half of what two differ by that are one place.
    fn of(runs: &[Vec<Sighting>]) -> (Spread, PoseNoise) {
        let mut edges: Vec<(f64, f64, Option<f64>)> = Vec::new();
        for run in runs {
            for over in OVER {
                edges.extend(run.windows(over + 1).map(|poses| {
                    let (from, to) = (&poses[0], &poses[over]);
                    let ([x, y], turned) = difference(from, to);
                    // The median of chi-squared with two degrees of freedom, and with one.
                    let square = if turned.is_some() { (x * x + y * y) / 1.386 } else { x * x / 0.455 };
                    (to.rolled - from.rolled, square, turned.map(|t| t * t / 0.455))
                }));
            }
        }
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        let part = edges.len().div_ceil(PARTS).max(1);
        let (mut positions, mut headings) = (Vec::new(), Vec::new());
        for part in edges.chunks(part) {
            let rolled = median(part.iter().map(|edge| edge.0));
            positions.push((rolled, median(part.iter().map(|edge| edge.1))));
            headings.push((rolled, median(part.iter().filter_map(|edge| edge.2))));
        }
        let least = |line: [f64; 2], least: f64| [line[0].max(least * least), line[1]];
        let (position, heading) = (rising(&positions), rising(&headings));
        let noise = PoseNoise { position: (0.5 * position[0]).sqrt(), heading: (0.5 * heading[0]).sqrt() };
        (Spread { position: least(position, LEAST[0]), heading: least(heading, LEAST[1]) }, noise)
    }

    /// How far two poses of a run differ, in standard deviations.
    fn deviations(&self, from: &Sighting, to: &Sighting) -> f64 {
        let ([x, y], turned) = difference(from, to);
        let rolled = to.rolled - from.rolled;
        let seconds = (to.time - from.time).max(JITTER);
        let variance = |line: &[f64; 2], moved: f64| {
            line[0] + line[1] * rolled + (JITTER * moved / seconds).powi(2) + (SIZES * moved).powi(2)
        };
        let turned = turned.map_or(0.0, |turned| turned * turned / variance(&self.heading, to.turned - from.turned));
        ((x * x + y * y) / variance(&self.position, to.way - from.way) + turned).sqrt()
    }
}

/// a + b x through medians, neither of them negative.
fn rising(points: &[(f64, f64)]) -> [f64; 2] {
    let n = points.len().max(1) as f64;
    // Variances are as uncertain as they are large.
    let weight = |y: f64| 1.0 / (y * y).max(1e-30);
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|(x, y)| weight(*y) * of(*x, *y)).sum::<f64>();
    let (w, x, y, xx, xy) = (sum(&|_, _| 1.0), sum(&|x, _| x), sum(&|_, y| y), sum(&|x, _| x * x), sum(&|x, y| x * y));
    let slope = (w * xy - x * y) / (w * xx - x * x);
    let base = (y - slope * x) / w;
    match (slope.is_finite() && slope > 0.0, base >= 0.0) {
        (true, true) => [base, slope],
        (true, false) => [0.0, xy / xx],
        _ => [points.iter().map(|(_, y)| y).sum::<f64>() / n, 0.0],
    }
}

/// Looks through all runs; gives what was found in each, and the noise of a single pose.
pub(super) fn search(runs: &[Vec<Sighting>]) -> (Vec<Found>, PoseNoise) {
    let (spread, noise) = Spread::of(runs);
    let ways: Vec<Way> = runs.iter().map(|run| Way::cheapest(run, &spread)).collect();
    let steps: Vec<Vec<Step>> = runs.iter().zip(&ways).map(|(run, way)| way.steps(run, &spread)).collect();
    let large = |(run, steps): (&Vec<Sighting>, &Vec<Step>)| {
        steps.iter().filter(|step| step.deviations > LARGE).map(|step| run[step.to].rolled).collect()
    };
    let shared = Shared::new(runs, runs.iter().zip(&steps).map(large).collect());
    let left = |(index, run): (usize, &Vec<Sighting>)| {
        let own = |step: &&Step| step.deviations > JUMP && !shared.stands_elsewhere(index, run[step.to].rolled);
        let jumps = steps[index].iter().filter(own).copied().collect::<Vec<Step>>();
        sorted_out(run, &ways[index].kept, jumps, &spread)
    };
    let (kept, jumps): (Vec<_>, Vec<_>) = runs.iter().enumerate().map(left).unzip();
    let stretches = stretches::search(runs, &kept, jumps, &spread);
    let found = runs.iter().zip(&kept).zip(stretches).map(|((run, kept), stretches)| Found::of(run, kept, stretches));
    (found.collect(), noise)
}

/// The poses of a run that are kept, in order.
struct Way {
    kept: Vec<usize>,
}

/// From one kept pose to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub from: usize,
    pub to: usize,
    pub deviations: f64,
}

impl Step {
    pub fn between(run: &[Sighting], from: usize, to: usize, spread: &Spread) -> Step {
        Step { from, to, deviations: spread.deviations(&run[from], &run[to]) }
    }
}

impl Way {
    fn cheapest(run: &[Sighting], spread: &Spread) -> Way {
        let loud: Vec<bool> =
            (0..run.len()).map(|k| k > 0 && spread.deviations(&run[k - 1], &run[k]) > QUIET).collect();
        let passed = |count: usize| if count == 0 { 0.0 } else { COSTS[1] + COSTS[2] * (count - 1) as f64 };
        let mut cost = vec![f64::INFINITY; run.len()];
        let mut before = vec![usize::MAX; run.len()];
        for to in 0..run.len() {
            if to <= LONGEST {
                cost[to] = passed(to);
            }
            let first = to.saturating_sub(LONGEST + 1);
            // Without a leap near, the pose before is the one to come from.
            let near = (first..=(to + 1).min(run.len() - 1)).any(|k| loud[k]);
            let from = if near { first } else { to.saturating_sub(1) };
            for from in from..to {
                let deviations = spread.deviations(&run[from], &run[to]);
                let own = cost[from] + passed(to - from - 1) + (0.5 * deviations * deviations).min(COSTS[0]);
                if own < cost[to] {
                    (cost[to], before[to]) = (own, from);
                }
            }
        }
        let ends = run.len().saturating_sub(LONGEST + 1)..run.len();
        let last = ends.min_by(|a, b| {
            let of = |end: &usize| cost[*end] + passed(run.len() - 1 - end);
            of(a).total_cmp(&of(b))
        });
        let mut kept: Vec<usize> =
            std::iter::successors(last, |at| Some(before[*at]).filter(|b| *b != usize::MAX)).collect();
        kept.reverse();
        Way { kept }
    }

    fn steps(&self, run: &[Sighting], spread: &Spread) -> Vec<Step> {
        self.kept.windows(2).map(|pair| Step::between(run, pair[0], pair[1], spread)).collect()
    }
}

/// Where each run has large differences.
pub(super) struct Shared {
    /// Way of the wheels there, run by run.
    large: Vec<Vec<f64>>,
    /// Chance that a run has one within a place.
    chance: f64,
}

impl Shared {
    /// `large`: what is large in each run, whatever it is.
    pub fn new(runs: &[Vec<Sighting>], large: Vec<Vec<f64>>) -> Shared {
        let way: f64 = runs.iter().filter_map(|run| run.last()).map(|last| last.rolled).sum();
        let all: usize = large.iter().map(Vec::len).sum();
        Shared { large, chance: (all as f64 * 2.0 * SAME_PLACE.0 / way.max(SAME_PLACE.0)).min(1.0) }
    }

    /// Whether more of the other runs have one at this place than chance would have it.
    pub fn stands_elsewhere(&self, run: usize, rolled: f64) -> bool {
        let others = self.large.iter().enumerate().filter(|(other, _)| *other != run);
        let there = others.filter(|(_, own)| own.iter().any(|at| (at - rolled).abs() <= SAME_PLACE.0)).count();
        let n = self.large.len().saturating_sub(1);
        there > 0 && at_least(there, n, self.chance) < SAME_PLACE.1.max(0.5 * self.chance.powi(n as i32))
    }
}

/// Probability of a given number or more of n, each with probability p.
fn at_least(count: usize, n: usize, p: f64) -> f64 {
    if p >= 1.0 {
        return 1.0;
    }
    let mut term = (1.0 - p).powi(n as i32);
    let mut below = 0.0;
    for k in 0..count {
        below += term;
        term *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
    }
    (1.0 - below).max(0.0)
}

/// Jumps that are taken back soon are wrong poses: the poses that are kept then, and the jumps that are left.
fn sorted_out(run: &[Sighting], kept: &[usize], jumps: Vec<Step>, spread: &Spread) -> (Vec<usize>, Vec<Step>) {
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

impl Found {
    /// Poses that are not kept are wrong, but for those within a jump that lasts.
    fn of(run: &[Sighting], kept: &[usize], jumps: Vec<Step>) -> Found {
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
        let lasts = |jump: &Step| kept.iter().any(|pose| jump.from < *pose && *pose < jump.to);
        let lasting: Vec<Step> = jumps.iter().filter(|jump| lasts(jump)).copied().collect();
        wrong.retain(|wrong| !lasting.iter().any(|jump| jump.from < wrong.pose && wrong.pose < jump.to));
        let jumps = jumps.into_iter().map(|Step { from, to, deviations }| {
            let ([x, y], turned) = difference(&run[from], &run[to]);
            Leap { from, pose: to, moved: libm::hypot(x, y), turned, deviations }
        });
        Found { wrong, jumps: jumps.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Displacement2;
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
                            expected: pose,
                            measured,
                        }
                    })
                    .collect()
            })
            .collect()
    }

    /// Everything from a pose on moved and turned about that pose.
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
        assert!(search(&runs(6)).0.iter().all(|found| *found == Found::default()));
    }

    #[test]
    fn a_jump_in_every_run_and_two_in_one_are_found_where_they_are_and_as_large() {
        let mut runs = runs(4);
        for (index, run) in runs.iter_mut().enumerate() {
            jump(run, 100 + 77 * index, 0.1, -0.2);
        }
        jump(&mut runs[2], 400, 0.0, 0.5);
        let (found, noise) = search(&runs);
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
        for (found, expected) in search(&runs).0.iter().zip(&wrong) {
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
        let (found, _) = search(&runs);
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
        let (found, _) = search(&runs);
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
        assert!(search(&runs).0.iter().all(|found| found.jumps.is_empty()));
        let mut runs = self::runs(6);
        for run in &mut runs {
            let at = run.iter().position(|pose| pose.rolled > 3.0).unwrap();
            for pose in at..at + 16 {
                jump(run, pose, 0.0, 0.012);
            }
        }
        assert!(search(&runs).0.iter().all(|found| found.jumps.is_empty()));
    }

    #[test]
    fn what_all_runs_have_at_the_same_place_is_no_jump() {
        let mut runs = runs(6);
        for run in &mut runs {
            let at = run.iter().position(|pose| pose.rolled > 3.0).unwrap();
            jump(run, at, 0.0, 0.1);
        }
        assert!(search(&runs).0.iter().all(|found| found.jumps.is_empty()));
    }
}
