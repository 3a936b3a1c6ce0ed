//! What a viewer shows of a whole run: both paths and the error between them.
//!
//! `/scene/computed_path` and `/scene/true_path` are nav_msgs/Path, `/scene/errors` is a visualization_msgs/MarkerArray of lines from
//! where the robot computed to be to where it was measured; `/scene/bumps` holds a ball where a simulated wheel met a bump. All are in the
//! frame odom, which stands on START as the measured poses do, and stand at the begin of the log, so that a viewer has them at any time.

use super::parts::{Cdr, header, numbers, orientation};
use umbmark_core::dataset::{ReferencePose, TickLog};
use umbmark_core::geometry::Pose2;

/// Poses of a path, at most.
const POSES: usize = 2000;
/// Error vectors, at most.
const VECTORS: usize = 200;
/// What a marker is, as visualization_msgs numbers it.
const LINE_LIST: i32 = 5;
const SPHERE_LIST: i32 = 7;
/// Width of a line \[m\].
const WIDTH: f64 = 0.004;
/// Diameter of a bump, so that it is seen \[m\].
const BUMP: f64 = 0.04;
/// Red, green, blue and opacity.
const RED: [f32; 4] = [0.84, 0.2, 0.15, 1.0];
const BROWN: [f32; 4] = [0.55, 0.35, 0.15, 1.0];

/// About evenly chosen places, the last among them.
fn chosen(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let kept = count.min(most);
    (1..=kept).map(move |i| i * count / kept - 1)
}

/// The path that the robot computed.
pub(super) fn computed_path(cdr: &mut Cdr, time: u64, poses: &[Pose2]) {
    let places = chosen(poses.len(), POSES).map(|i| (poses[i].x, poses[i].y, Some(poses[i].heading)));
    path(cdr, time, places.collect());
}

/// The path that was measured.
pub(super) fn true_path(cdr: &mut Cdr, time: u64, reference: &[ReferencePose]) {
    let places = chosen(reference.len(), POSES).map(|i| (reference[i].x, reference[i].y, reference[i].heading));
    path(cdr, time, places.collect());
}

fn path(cdr: &mut Cdr, time: u64, poses: Vec<(f64, f64, Option<f64>)>) {
    header(cdr, time, "odom");
    cdr.write_sequence_length(poses.len());
    for (x, y, heading) in poses {
        header(cdr, time, "odom");
        numbers(cdr, [x, y, 0.0]);
        numbers(cdr, orientation(heading.unwrap_or(0.0)));
    }
}

/// Lines from computed to measured places.
pub(super) fn errors(cdr: &mut Cdr, time: u64, log: &TickLog, computed: &[Pose2]) {
    let ends = chosen(log.reference.len(), VECTORS)
        .filter_map(|i| Some((computed.get(log.reference[i].sample)?, &log.reference[i])))
        .flat_map(|(computed, measured)| [[computed.x, computed.y], [measured.x, measured.y]]);
    marker(cdr, time, "errors", LINE_LIST, [WIDTH, 0.0, 0.0], RED, &ends.collect::<Vec<_>>());
}

/// Where wheels met bumps.
pub(super) fn bumps(cdr: &mut Cdr, time: u64, places: &[[f64; 2]]) {
    marker(cdr, time, "bumps", SPHERE_LIST, [BUMP; 3], BROWN, places);
}

/// One marker of many points on the floor, which stays for good.
fn marker(cdr: &mut Cdr, time: u64, name: &str, kind: i32, scale: [f64; 3], colour: [f32; 4], places: &[[f64; 2]]) {
    cdr.write_sequence_length(1);
    header(cdr, time, "odom");
    cdr.write_string(name);
    for number in [0, kind, 0] {
        cdr.write_i32(number);
    }
    numbers(cdr, [0.0; 3]);
    numbers(cdr, orientation(0.0));
    numbers(cdr, scale);
    colour.into_iter().for_each(|part| cdr.write_f32(part));
    // It stays for good, and stands in its frame as that was at its time.
    cdr.write_i32(0);
    cdr.write_u32(0);
    cdr.write_bool(false);
    cdr.write_sequence_length(places.len());
    places.iter().for_each(|[x, y]| numbers(cdr, [*x, *y, 0.0]));
    nothing_more(cdr, time);
}

/// Colours of points, texture, text and mesh of a marker: none.
fn nothing_more(cdr: &mut Cdr, time: u64) {
    cdr.write_sequence_length(0);
    cdr.write_string("");
    header(cdr, time, "");
    cdr.write_string("");
    cdr.write_sequence_length(0);
    cdr.write_sequence_length(0);
    cdr.write_string("");
    cdr.write_string("");
    cdr.write_string("");
    cdr.write_sequence_length(0);
    cdr.write_bool(false);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_places_end_with_the_last_and_few_all_stay() {
        assert_eq!(chosen(3, 10).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(chosen(10, 4).collect::<Vec<_>>(), [1, 4, 6, 9]);
        assert_eq!(chosen(0, 4).count(), 0);
    }
}
