//! What one effect of usual size does along a path, ccw and cw.

use serde_json::{Value, json};
use umbmark_core::drive::{DriveKind, Robot};
use umbmark_core::effect::{Entry, Model};
use umbmark_core::parameter::Parameter;
use umbmark_core::path::{CIRCLE, Direction, FIXED_SQUARE, Path, SpeedProfile};
use umbmark_core::preset::Preset;
use umbmark_core::replay::Track;

use crate::prose::hanging;
use umbmark_plot::render::strip::strip;

/// Errors below this are rounding \[m, rad\].
const NOTHING: f64 = 1e-9;
/// Characters of the picture of one run, across, and of one of its strips, down.
const WIDTH: usize = 30;
const HEIGHT: usize = 3;
/// How many moments of a run a document holds.
const SAMPLES: usize = 21;

/// The error that an effect makes along a path.
#[derive(Clone, Debug)]
pub struct Signature {
    /// The parameter that has its usual size; the others keep their defaults.
    pub parameter: &'static Parameter,
    /// Its value.
    pub value: f64,
    /// The path in words.
    pub path: &'static str,
    /// The runs, ccw and cw.
    pub runs: [Vec<Moment>; 2],
}

/// A moment of a run: the true pose relative to that of the odometry.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// How far the wheels have rolled, on average and whatever way \[m\].
    pub way: f64,
    /// Whether the robot turns on the spot.
    pub turning: bool,
    /// \[m\]
    pub forward: f64,
    /// \[m\]
    pub sideways: f64,
    /// \[rad\]
    pub heading: f64,
}

impl Signature {
    /// The signature of an effect's first number that has one, on the paper's square, or on a circle or a square at a fixed heading where the
    /// square shows nothing; `None` where it acts by chance only. The robot is the LabMate; where only the CLAPPER or bases on rollers may have
    /// the effect, it is that, or the first of those.
    pub fn of(entry: &'static Entry) -> anyhow::Result<Option<Signature>> {
        let trucks = entry.drives().each().all(DriveKind::has_trucks);
        let rollers = entry.drives().each().next().filter(|_| entry.drives().each().all(DriveKind::moves_sideways));
        let robot = match (Preset::find("clapper"), rollers) {
            (Ok(preset), _) if trucks => preset.robot(),
            (_, Some(kind)) => Robot { drive: kind.usual(), ..Robot::labmate() },
            _ => Robot::labmate(),
        };
        let circle = Path::new(&CIRCLE, &[1.0, 1.0], SpeedProfile::default())?;
        let fixed = Path::new(&FIXED_SQUARE, &[4.0], SpeedProfile::default())?;
        let mut paths = vec![
            ("4 m square", Path::umbmark()),
            ("circle of radius 1 m", circle),
            ("4 m square at a fixed heading", fixed),
        ];
        paths.retain(|(_, path)| path.suits(&robot));
        for parameter in entry.about.parameters {
            let value = parameter.usual(&robot);
            let mut model = Model::new(&robot);
            model.set(entry.about.name, parameter.name, value)?;
            for (words, path) in &paths {
                let runs = [Direction::Ccw, Direction::Cw].map(|direction| run(&model, path, direction));
                let shown = |m: &Moment| m.forward.abs().max(m.sideways.abs()).max(m.heading.abs()) > NOTHING;
                if runs.iter().flatten().any(shown) {
                    return Ok(Some(Signature { parameter, value, path: words, runs }));
                }
            }
        }
        Ok(None)
    }

    /// The error along the path, a strip for each of its components, ccw beside cw; labels stand in the first `indent`
    /// columns.
    pub fn picture(&self, indent: usize) -> String {
        let head = format!("{} = {} on a {}", self.parameter.name, self.value, self.path);
        let mut text =
            hanging("picture", indent, &format!("{head}: true position and heading relative to the odometry"));
        text += &format!("{:indent$}{:WIDTH$}  {}\n", "", "driven ccw", "driven cw");
        for (name, value, written) in QUANTITIES {
            let most = self.runs.iter().flatten().map(|m| value(m).abs()).fold(0.0, f64::max);
            if most < NOTHING {
                text += &format!("{:<indent$}none\n", format!("  {name}"));
                continue;
            }
            let [ccw, cw] = self.runs.each_ref().map(|run| {
                let points: Vec<(f64, f64)> = run.iter().map(|m| (m.way, value(m))).collect();
                strip(&points, way(run), most, WIDTH, HEIGHT)
            });
            for (line, label) in [name, &written(most), ""].iter().enumerate() {
                text += &format!("{:<indent$}{}  {}", format!("  {label}"), ccw[line], cw[line]);
                text.truncate(text.trim_end().len());
                text += "\n";
            }
        }
        let [ccw, cw] = self.runs.each_ref().map(|run| turns(run));
        text + &format!("{:indent$}{ccw}  {cw}\n", "")
    }

    /// The same as numbers, at moments evenly spread over the way.
    pub fn json(&self) -> Value {
        let [ccw, cw] = self.runs.each_ref().map(|run| {
            let whole = way(run);
            let samples: Vec<&Moment> = (0..SAMPLES)
                .filter_map(|i| run.get(run.partition_point(|m| m.way < whole * i as f64 / (SAMPLES - 1) as f64)))
                .collect();
            let column = |of: fn(&Moment) -> f64| samples.iter().map(|m| rounded(of(m))).collect::<Vec<f64>>();
            json!({
                "way_m": column(|m| m.way),
                "forward_m": column(|m| m.forward),
                "sideways_m": column(|m| m.sideways),
                "heading_rad": column(|m| m.heading),
            })
        });
        let (parameter, value) = (self.parameter.name, self.value);
        json!({ "path": self.path, "parameter": parameter, "value": value, "ccw": ccw, "cw": cw })
    }
}

/// What a strip shows: its name, its value, and how that is written.
type Quantity = (&'static str, fn(&Moment) -> f64, fn(f64) -> String);

const QUANTITIES: [Quantity; 3] = [
    ("forward", |m| m.forward, |metres| format!("±{} mm", three_digits(1e3 * metres))),
    ("sideways", |m| m.sideways, |metres| format!("±{} mm", three_digits(1e3 * metres))),
    ("heading", |m| m.heading, |radians| format!("±{} deg", three_digits(radians.to_degrees()))),
];

/// A positive number with three digits.
pub fn three_digits(value: f64) -> String {
    let decimals = (2.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

/// How far the wheels roll in all \[m\].
fn way(run: &[Moment]) -> f64 {
    run.last().map_or(0.0, |moment| moment.way)
}

/// A line below a strip, with a mark where the robot turns on the spot.
fn turns(run: &[Moment]) -> String {
    let mut line = vec!['─'; WIDTH];
    for moment in run.iter().filter(|moment| moment.turning) {
        line[((moment.way / way(run) * WIDTH as f64) as usize).min(WIDTH - 1)] = '┴';
    }
    line.into_iter().collect()
}

/// To a nanometre or nanoradian.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}

fn run(model: &Model, path: &Path, direction: Direction) -> Vec<Moment> {
    let robot = model.robot();
    let track = Track::watched(path, direction, robot);
    let believed = track.poses(&Model::new(robot).chain());
    let seen = track.poses(&model.chain());
    let mut way = 0.0;
    let pieces = track.travel().iter().zip(track.contexts()).zip(believed.iter().zip(&seen));
    pieces
        .map(|((travel, at), (believed, seen))| {
            way += travel.rolled().max(at.aside.way.abs());
            let error = believed.between(seen);
            let turning = travel.left * travel.right < 0.0;
            Moment { way, turning, forward: error.x, sideways: error.y, heading: error.heading }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::effect::find;

    fn signature(name: &str) -> Option<Signature> {
        Signature::of(find(name).unwrap()).unwrap()
    }

    #[test]
    fn the_wheelbase_turns_ccw_and_cw_apart_by_its_share_of_a_full_turn() {
        let signature = signature("wheelbase").unwrap();
        assert_eq!((signature.path, signature.value), ("4 m square", 1.008));
        let error = std::f64::consts::TAU * (1.0 / 1.008 - 1.0);
        for (run, sign) in signature.runs.iter().zip([1.0, -1.0]) {
            let end = run[run.len() - 1];
            assert!((end.heading - sign * error).abs() < 1e-12 && end.turning, "{end:?}");
            // Four legs of 4 m and four quarter turns of wheels 0.17 m from the middle.
            assert!((end.way - 16.0 - 0.34 * std::f64::consts::PI).abs() < 1e-9);
        }
    }

    #[test]
    fn what_needs_arcs_is_shown_on_a_circle_and_chance_not_at_all() {
        assert_eq!(signature("centripetal_load").unwrap().path, "circle of radius 1 m");
        assert!(signature("wheel_noise").is_none());
    }
}
