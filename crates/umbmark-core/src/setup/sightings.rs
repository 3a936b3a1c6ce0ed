//! The poses of a run beside those by the wheels.

use super::Seen;
use super::agreement::Agreement;
use super::clock::Late;
use super::edges::Sighting;
use super::low_pass::LowPass;
use super::windows::usual_step;
use crate::drive::Robot;
use crate::geometry::{Displacement2, Pose2};

/// Rows are missing where there is none for this many times the usual time between two.
const GAP: f64 = 5.0;
/// Without rows for this long \[s\] while the wheels roll this far \[m\], the way of the wheels is not known.
const BLIND: (f64, f64) = (0.5, 0.05);

/// Every pose of a run with the corresponding pose by the wheels, scaled and mounted as all runs agree, late, and behind a low-pass filter if
/// `time_constant` is given \[s\].
pub(super) fn of(
    seen: &Seen,
    late: &Late,
    (robot, agreement): (&Robot, &Agreement),
    time_constant: Option<f64>,
) -> Vec<Sighting> {
    let wheelbase = robot.drive.wheelbase();
    let (scale, [gain, drift]) = (agreement.scale(), agreement.turn);
    let [ahead, left] = agreement.lever_on_robot();
    let with_heading = seen.log.reference.iter().all(|pose| pose.heading.is_some());
    let body = if with_heading { Pose2::new(ahead, left, agreement.yaw()) } else { Pose2::IDENTITY };
    let (mut pose, mut rolled, mut now) = (Pose2::IDENTITY, [0.0; 2], None);
    let mut filter = time_constant.map(LowPass::new);
    let mut heading = 0.0;
    // Where positions and headings are measured, their own differences show whether the way is lost.
    let asked = !with_heading || seen.log.headings_only && seen.log.relative;
    let usual = usual_step(&seen.log.time);
    let mut before: Option<(usize, f64)> = None;
    let mut samples = seen.log.time.iter().copied().peekable();
    let mut drive_to = |time: f64| {
        let from: f64 = *now.get_or_insert(time);
        let rolling = seen.rolled.between(from, time);
        let [l, r] = rolling.travel;
        let (way, turn) = (0.5 * (l + r), (r - l) / wheelbase);
        let rotation = gain * turn + drift * way;
        pose = pose.moved(&Displacement2 { forward: scale * way, sideways: scale * rolling.aside, rotation });
        let gone = if rolling.aside == 0.0 { way.abs() } else { libm::hypot(way, rolling.aside) };
        rolled = [rolled[0] + gone, rolled[1] + turn.abs()];
        now = Some(time);
        let mut expected = pose.compose(&body);
        heading += rotation;
        if let Some(filter) = &mut filter {
            let [x, y, heading] = filter.follow(time, [expected.x, expected.y, heading]);
            expected = Pose2::new(x, y, body.heading + heading);
        }
        (expected, rolled)
    };
    let of = |reference: &crate::run::ReferencePose| {
        let stamp = seen.log.time[reference.sample];
        let taken = late.taken(stamp);
        // Sample by sample, so that each piece is an arc; poses are ordered by time, up to rounding.
        while let Some(sample) = samples.next_if(|sample| *sample < taken) {
            drive_to(sample);
        }
        let (expected, [way, turned]) = drive_to(taken);
        let rolled = way + 0.5 * wheelbase * turned;
        let blind = |(sample, rolled_then): (usize, f64)| {
            let missing = unrecorded(&seen.log.time[sample..=reference.sample], usual);
            missing.is_some_and(|seconds| seconds > BLIND.0) && rolled - rolled_then > BLIND.1
        };
        let after_gap = asked && before.is_some_and(blind);
        before = Some((reference.sample, rolled));
        Sighting {
            time: stamp,
            way,
            turned,
            rolled,
            after_gap,
            expected,
            measured: if seen.log.headings_only {
                (expected.x, expected.y, reference.heading)
            } else {
                (reference.x, reference.y, reference.heading)
            },
        }
    };
    seen.log.reference.iter().map(of).collect()
}

/// The longest time between two rows that follow each other \[s\], if it is much longer than usual.
pub(super) fn unrecorded(time: &[f64], usual: f64) -> Option<f64> {
    let longest = time.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    (longest > GAP * usual).then_some(longest)
}
