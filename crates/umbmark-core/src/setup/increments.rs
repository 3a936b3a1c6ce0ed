//! Counts since the row before, in columns of counts since the beginning.

use super::agreement::Agreement;
use super::{Fault, Seen, clock, faults};
use crate::drive::Robot;
use crate::run::TickLog;

/// The fault that counts are increments: as they are they do not agree with the reference, and their running sums do.
pub(super) fn found(seen: &[Seen], robot: &Robot) -> Option<Fault> {
    let sums: Vec<TickLog> = seen.iter().map(|seen| added_up(seen.log)).collect();
    let beside = clock::reread(seen, &sums, robot);
    let (faults, reading) = faults::look(&beside, robot);
    let agreement = Agreement::without_drift(&beside, reading, robot.drive.wheelbase());
    let agrees = agreement.is_credible() && agreement.misfit < faults::DOUBTFUL;
    (agrees && !faults.iter().any(|fault| matches!(fault, Fault::OtherMotion { .. }))).then_some(Fault::Increments)
}

/// The same log with the running sums of its counts.
fn added_up(log: &TickLog) -> TickLog {
    let sums = |counts: &[f64]| {
        let mut sum = 0.0;
        let add = |count: &f64| {
            sum += count;
            sum
        };
        counts.iter().map(add).collect::<Vec<f64>>()
    };
    let rollers = log.rollers.iter().map(|counts| sums(counts)).collect();
    TickLog { left: sums(&log.left), right: sums(&log.right), rollers, ..log.clone() }
}
