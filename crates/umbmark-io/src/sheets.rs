//! Returns and tick logs as text, in the shortest form that reads back to the last bit.

use std::fmt::Write;
use umbmark_core::dataset::{Run, TickLog};
use umbmark_core::drive::Robot;
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;

/// The columns of the absolute poses.
const REFERENCE: &str = ",x_ref_m,y_ref_m,theta_ref_rad";

/// `returns.csv` of the runs whose return error is known; nothing where there is none.
pub(super) fn returns_text(runs: &[Run]) -> Option<String> {
    let known: Vec<_> = runs.iter().filter_map(|run| Some((run, run.returned?))).collect();
    if known.is_empty() {
        return None;
    }
    let tests = known.iter().any(|(run, _)| run.test != TestKind::Systematic);
    let headings = known.iter().any(|(_, error)| error.heading.is_some());
    let mut text =
        String::from("# Return errors: absolute minus computed end pose, in the frame of START.\ndirection,run");
    text.push_str(if tests { ",test,ex_m,ey_m" } else { ",ex_m,ey_m" });
    text.push_str(if headings { ",etheta_rad\n" } else { "\n" });
    for (run, error) in known {
        let _ = write!(text, "{},{}", run.direction.map_or("none", Direction::name), run.number);
        if tests {
            let _ = write!(text, ",{}", run.test.name());
        }
        let _ = write!(text, ",{:?},{:?}", error.x, error.y);
        if headings {
            let _ = write!(text, ",{}", cell(error.heading));
        }
        text.push('\n');
    }
    Some(text)
}

/// `runs/*.csv` of a log whose references belong to different samples, in their order; counts as the encoder's counter
/// shows them, rolled over where it does.
pub(super) fn tick_log_text(log: &TickLog, robot: &Robot) -> String {
    let (encoder, kind) = (&robot.encoder, robot.drive.kind());
    let [first, second] = encoder.wiring().columns(robot.counters([&log.left, &log.right]));
    let shown = |ticks: f64| encoder.reading(ticks.floor() as i64) as f64 + (ticks - ticks.floor());
    let mut text = String::with_capacity(40 * log.time.len());
    let referenced = !log.reference.is_empty();
    let [a, b] = kind.counters();
    let _ = writeln!(text, "t_s,ticks_{a},ticks_{b}{}", if referenced { REFERENCE } else { "" });
    let mut references = log.reference.iter().peekable();
    for (sample, time) in log.time.iter().enumerate() {
        let _ = write!(text, "{time:?},{},{}", shown(first[sample]), shown(second[sample]));
        match references.next_if(|pose| pose.sample == sample) {
            Some(pose) => {
                let _ = write!(text, ",{:?},{:?},{}", pose.x, pose.y, cell(pose.heading));
            }
            None if referenced => text.push_str(",,,"),
            None => {}
        }
        text.push('\n');
    }
    text
}

fn cell(value: Option<f64>) -> String {
    value.map(|value| format!("{value:?}")).unwrap_or_default()
}
