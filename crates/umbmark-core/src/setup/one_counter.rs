//! One of two counters whose counts are a factor off: a decoder that counts one edge of each line where the other counts two or four.

use super::agreement::{Agreement, Reading};
use super::{Fault, Seen, clock, faults};
use crate::drive::Robot;
use crate::run::TickLog;

/// What the counts of one wheel may have to be multiplied by.
const FACTORS: [f64; 4] = [0.25, 0.5, 2.0, 4.0];
/// Corrected ways may differ from those of the reference by this factor: less than the counts of a decoder are off.
const OTHER_WAY: f64 = 1.4;

/// The counter and the factor with which distances and rotations agree with the reference: of all that make them agree, the best.
pub(super) fn found(seen: &[Seen], robot: &Robot) -> Option<Fault> {
    if !robot.drive.kind().has_axle_wheels() {
        return None;
    }
    let wheelbase = robot.drive.wheelbase();
    let tried = FACTORS.into_iter().flat_map(|factor| [(0, factor), (1, factor)]).map(|(wheel, factor)| {
        let logs: Vec<TickLog> = seen.iter().map(|seen| multiplied(seen.log, wheel, factor)).collect();
        let agreement = Agreement::without_drift(&clock::reread(seen, &logs, robot), Reading::default(), wheelbase);
        (agreement, Fault::OneCounter { name: robot.drive.kind().counters()[wheel], factor })
    });
    let agrees = |(found, _): &(Agreement, Fault)| {
        let is_way = (1.0 / OTHER_WAY..OTHER_WAY).contains(&found.scale());
        found.shown == [true; 2] && is_way && found.misfits.iter().all(|misfit| *misfit < faults::DOUBTFUL)
    };
    let best = tried.filter(agrees).min_by(|a, b| a.0.misfit.total_cmp(&b.0.misfit));
    best.map(|(_, fault)| fault)
}

/// The same log with the counts of one wheel multiplied.
fn multiplied(log: &TickLog, wheel: usize, factor: f64) -> TickLog {
    let of = |own: usize, counts: &[f64]| {
        let factor = if own == wheel { factor } else { 1.0 };
        counts.iter().map(|count| factor * count).collect::<Vec<f64>>()
    };
    TickLog { left: of(0, &log.left), right: of(1, &log.right), ..log.clone() }
}
