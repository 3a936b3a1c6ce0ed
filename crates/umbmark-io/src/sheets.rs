//! Returns and tick logs as text, in the shortest form that reads back to the last bit.

use super::csv_text::CsvText;
use umbmark_core::dataset::{Run, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;

/// The columns of the absolute poses.
const REFERENCE: [&str; 3] = ["x_ref_m", "y_ref_m", "theta_ref_rad"];

/// `returns.csv` of the runs whose return error is known; nothing where there is none.
pub(super) fn returns_text(runs: &[Run]) -> Option<Vec<u8>> {
    let known: Vec<_> = runs.iter().filter_map(|run| Some((run, run.returned?))).collect();
    if known.is_empty() {
        return None;
    }
    let tests = known.iter().any(|(run, _)| run.test != TestKind::Systematic);
    let headings = known.iter().any(|(_, error)| error.heading.is_some());
    let mut text = CsvText::behind("# Return errors: absolute minus computed end pose, in the frame of START.\n");
    let optional = |is: bool, column: &'static str| is.then_some(column);
    let columns = ["direction", "run"].into_iter().chain(optional(tests, "test")).chain(["ex_m", "ey_m"]);
    text.row(columns.chain(optional(headings, "etheta_rad")));
    for (run, error) in known {
        text.cell(run.direction.map_or("none", Direction::name));
        text.cell(run.number);
        if tests {
            text.cell(run.test.name());
        }
        text.decimal(error.x);
        text.decimal(error.y);
        if headings {
            text.decimal(error.heading);
        }
        text.end();
    }
    Some(text.finish())
}

/// `runs/*.csv` of a log whose references belong to different samples, in their order; counts as the encoder's counter
/// shows them, rolled over where it does.
pub(super) fn tick_log_text(log: &TickLog, robot: &Robot) -> Vec<u8> {
    let (encoder, kind) = (&robot.encoder, robot.drive.kind());
    let [first, second] = encoder.wiring().columns(robot.counters([&log.left, &log.right]));
    let shown = |ticks: f64| encoder.reading(ticks.floor() as i64) as f64 + (ticks - ticks.floor());
    let referenced = !log.reference.is_empty();
    let counters = kind.counters().map(|counter| format!("ticks_{counter}"));
    let mut text = CsvText::behind("");
    let columns = ["t_s"].into_iter().chain(counters.iter().map(String::as_str));
    text.row(columns.chain(REFERENCE.into_iter().filter(|_| referenced)));
    let mut references = log.reference.iter().peekable();
    for (sample, time) in log.time.iter().enumerate() {
        text.decimal(*time);
        text.cell(shown(first[sample]));
        text.cell(shown(second[sample]));
        if referenced {
            let pose = references.next_if(|pose| pose.sample == sample);
            text.decimal(pose.map(|pose| pose.x));
            text.decimal(pose.map(|pose| pose.y));
            text.decimal(pose.and_then(|pose| pose.heading));
        }
        text.end();
    }
    text.finish()
}
