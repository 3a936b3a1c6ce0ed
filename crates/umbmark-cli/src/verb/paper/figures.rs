//! The paper's figures and remarks, by exact kinematics.

use serde_json::{Value, json};
use umbmark_core::drive::{Robot, Wheel};
use umbmark_core::effect::{Bump, Model, Stretch, TestKind, extra_travel};
use umbmark_core::geometry::Pose2;
use umbmark_core::path::{Direction, FIGURE_EIGHT, Path, RECTANGLE, SpeedProfile};
use umbmark_core::preset::Preset;
use umbmark_core::replay::Track;
use umbmark_core::simulate::{Course, Odometry, Phase, Simulator, Truth};

use super::{Bench, Found};
use crate::table::table;

/// The heading error of each corner or leg in the paper's Fig. 2 \[deg\].
const PER_SIDE: f64 = 3.0;

fn labmate(e_d: f64, e_b: f64) -> anyhow::Result<Model> {
    let mut model = Model::new(&Robot::labmate());
    model.set("wheel_diameter_ratio", "e_d", e_d)?;
    model.set("wheelbase", "e_b", e_b)?;
    Ok(model)
}

/// Return error without noise: x, y \[m\] and heading \[rad\].
fn returned(model: &Model, path: &Path, direction: Direction) -> [f64; 3] {
    let end = Track::from_path(path, direction, model.robot()).end(&model.chain());
    let told = path.end(direction);
    [end.x - told.x, end.y - told.y, end.heading - told.heading]
}

fn distance(error: &[f64; 3]) -> f64 {
    error[0].hypot(error[1])
}

/// A row of distances and headings, ccw and cw.
fn both_ways(name: &str, model: &Model, path: &Path) -> (Vec<String>, Value) {
    let errors = [Direction::Ccw, Direction::Cw].map(|direction| returned(model, path, direction));
    let mut row = vec![name.to_owned()];
    for error in &errors {
        row.push(format!("{:.1}", distance(error) * 1e3));
        row.push(format!("{:.2}", error[2].to_degrees()));
    }
    (row, json!({ "what": name, "ccw": errors[0], "cw": errors[1] }))
}

const BOTH_WAYS: [&str; 5] = ["", "ccw [mm]", "heading [deg]", "cw [mm]", "heading [deg]"];

/// Figs. 2 to 4.
pub(super) fn masking(_: &Bench) -> anyhow::Result<Found> {
    let path = Path::umbmark();
    let e_b = 90.0 / (90.0 - PER_SIDE);
    // A leg of 4 m turns to the left by 3 degrees on the true wheelbase.
    let turn = PER_SIDE.to_radians() * 0.340 * e_b / 4.0;
    let e_d = (1.0 + 0.5 * turn) / (1.0 - 0.5 * turn);
    let mut found = Vec::new();
    for (name, d, b) in [
        ("E_b alone: corners of 87 deg", 1.0, e_b),
        ("E_d alone: legs bent by 3.1 deg", e_d, 1.0),
        ("both: hidden in ccw, plain in cw", e_d, e_b),
    ] {
        found.push(both_ways(name, &labmate(d, b)?, &path));
    }
    let (rows, document): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let text = format!(
        "Figures 2 to 4: errors that compensate for each other in one direction\n\n{}\n\nE_d = {e_d:.5}, E_b = {e_b:.5}, LabMate, 4 x 4 m, \
         exact kinematics without noise",
        table(&BOTH_WAYS, rows)
    );
    Ok(Found { key: "figure_2", text, document: json!({ "e_d": e_d, "e_b": e_b, "rows": document }) })
}

/// Fig. 5: one test of the uncalibrated LabMate.
pub(super) fn clusters(bench: &Bench) -> anyhow::Result<Found> {
    let preset = Preset::find("trc-labmate-nocal").map_err(|_| anyhow::anyhow!("no robot"))?;
    let model = preset.model()?;
    let mut simulator = Simulator::new(model.robot(), &preset.path(), Odometry::EveryTick, Phase::Random)?;
    let mut truth = Truth::new(&model);
    simulator.open(&mut truth, bench.session.seed(), 0);
    let (mut rows, mut document) = (Vec::new(), Vec::new());
    for direction in Direction::BOTH {
        let runs: Vec<[f64; 2]> = (0..5)
            .map(|_| simulator.run(&mut truth, direction, TestKind::Systematic))
            .map(|error| [error.x, error.y])
            .collect();
        let mean = [0, 1].map(|i| runs.iter().map(|run| run[i]).sum::<f64>() / 5.0);
        for (name, [x, y]) in runs.iter().enumerate().map(|(i, run)| (format!("{} {}", direction.name(), i + 1), *run))
        {
            rows.push(vec![name, format!("{:.0}", x * 1e3), format!("{:.0}", y * 1e3), String::new()]);
        }
        let radius = mean[0].hypot(mean[1]);
        let cells = [mean[0], mean[1], radius].map(|v| format!("{:.0}", v * 1e3));
        rows.push(std::iter::once(format!("{} centre of gravity", direction.name())).chain(cells).collect());
        document.push(json!({ "direction": direction.name(), "returns_m": runs, "centre_m": mean, "r_m": radius }));
    }
    let text = format!(
        "Figure 5: return positions of one test, {}, seed {}\n\n{}",
        preset.name,
        bench.session.seed(),
        table(&["", "ex [mm]", "ey [mm]", "r [mm]"], rows)
    );
    Ok(Found { key: "figure_5", text, document: json!(document) })
}

/// Fig. 6: ten bumps at the beginning of the first leg, all along it, and at its end.
pub(super) fn bump_places(_: &Bench) -> anyhow::Result<Found> {
    let model = Model::new(&Robot::labmate());
    let lost = extra_travel(0.010, 0.075, true);
    let (mut rows, mut document) = (Vec::new(), Vec::new());
    for (name, from, to) in [
        ("path A: in the first tenth", 0.0, 0.1),
        ("evenly, as the test prescribes", 0.0, 1.0),
        ("path B: in the last tenth", 0.9, 1.0),
    ] {
        let end = with_bumps(&model, |i| from + (to - from) * (i as f64 + 0.5) / 10.0, lost)?;
        let (shift, turn) = (end.x.hypot(end.y), end.heading - std::f64::consts::TAU);
        rows.push(vec![name.to_owned(), format!("{:.0}", shift * 1e3), format!("{:.2}", turn.to_degrees())]);
        document.push(json!({ "bumps": name, "return_position_m": shift, "return_heading_rad": turn }));
    }
    let text = format!(
        "Figure 6: ten 10 mm bumps on the first leg, ccw, LabMate, exact kinematics without noise\n\n{}",
        table(&["", "return position [mm]", "return heading [deg]"], rows)
    );
    Ok(Found { key: "figure_6", text, document: json!(document) })
}

/// The end of a ccw run with ten bumps under the left wheel at places of the first leg.
fn with_bumps(model: &Model, place: impl Fn(usize) -> f64, lost: f64) -> anyhow::Result<Pose2> {
    let mut truth = Truth::new(model);
    truth.start(Direction::Ccw);
    let course = Course::new(model.robot(), &Path::umbmark(), Direction::Ccw)?;
    for (index, leg) in course.legs.iter().enumerate() {
        let stretch = Stretch { index, direction: Direction::Ccw, test: TestKind::Systematic, travel: leg.travel };
        truth.begin(stretch, leg);
        for bump in (0..10).filter(|_| index == 0) {
            truth.place(Bump { at: place(bump), wheel: Wheel::Left, lost });
        }
        truth.advance(1.0);
    }
    Ok(truth.pose())
}

/// What a figure-eight shows of E_d and E_b.
pub(super) fn figure_eight(_: &Bench) -> anyhow::Result<Found> {
    let path = Path::new(&FIGURE_EIGHT, &[2.0], SpeedProfile::default())?;
    let mut found = Vec::new();
    for (name, d, b) in [("E_d = 1.001", 1.001, 1.0), ("E_b = 1.001", 1.0, 1.001)] {
        found.push(both_ways(name, &labmate(d, b)?, &path));
    }
    let (rows, document): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let text = format!(
        "Section 3.1: the figure-eight (two circles of 2 m) hides E_d from a tape measure and E_b from a compass,\n\
         whichever way it is driven: with positions alone it has the shortcoming that the paper says, with headings it has not\n\n{}",
        table(&BOTH_WAYS, rows)
    );
    Ok(Found { key: "figure_eight", text, document: json!(document) })
}

/// The 7 x 4 m rectangle beside the square.
pub(super) fn rectangle(_: &Bench) -> anyhow::Result<Found> {
    let preset = Preset::find("trc-labmate-nocal").map_err(|_| anyhow::anyhow!("no robot"))?;
    let model = preset.model()?;
    let rectangle = Path::new(&RECTANGLE, &[7.0, 4.0], SpeedProfile::default())?;
    let (rows, document): (Vec<_>, Vec<_>) = [("4 x 4 m", &Path::umbmark()), ("7 x 4 m", &rectangle)]
        .map(|(name, path)| both_ways(name, &model, path))
        .into_iter()
        .unzip();
    let text = format!(
        "Section 4.5: the rectangle instead of the square, {}, exact kinematics without noise\n\n{}",
        preset.name,
        table(&BOTH_WAYS, rows)
    );
    Ok(Found { key: "rectangle", text, document: json!(document) })
}
