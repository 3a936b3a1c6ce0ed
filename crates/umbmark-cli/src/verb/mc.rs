//! `umbmark mc`: Monte Carlo of whole UMBmark tests.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context;
use serde_json::{Map, Value, json};
use umbmark_core::calibrate::{Angles, Correction};
use umbmark_core::engine::Update;
use umbmark_core::monte_carlo::{Distribution, Draw, Ensemble, Metric, Row, Statistics, Study};
use umbmark_core::path::{Direction, SQUARE};
use umbmark_core::score::summarise;
use umbmark_core::simulate::{Odometry, Phase};

use crate::setup::{Setup, SetupFlags};
use crate::table::{table, with_precision_of};
use crate::terminal::histogram;
use crate::{Session, files};

/// The quantiles that are printed.
const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// How the robot computes its pose.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum OdometryKind {
    /// At the encoder rate where there is one, else at every tick
    Robot,
    /// At every tick
    Ticks,
    /// At every tick, one by one: the slow reference
    TickByTick,
    /// From the wheel angles themselves, without quantisation
    Continuous,
}

/// The update of sampled odometry.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum UpdateKind {
    /// Exact circular arc
    Arc,
    /// Straight step at the mean heading
    Midpoint,
    /// Straight step at the old heading
    Euler,
}

/// Where the wheels rest within a tick.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum PhaseKind {
    /// Anywhere
    Random,
    /// On the edge of a tick
    Edge,
}

/// Arguments of `mc`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Trials: whole tests, each with all its runs
    #[arg(short = 'n', long, default_value_t = 1000, value_name = "N")]
    trials: u64,

    /// Runs in each direction
    #[arg(long, default_value_t = 5, value_name = "N")]
    runs: usize,

    /// How the robot computes its pose
    #[arg(long, value_enum, default_value_t = OdometryKind::Robot, value_name = "KIND")]
    odometry: OdometryKind,

    /// How sampled odometry follows the counts
    #[arg(long, value_enum, default_value_t = UpdateKind::Arc, value_name = "RULE")]
    update: UpdateKind,

    /// Where within a tick the wheels come to rest
    #[arg(long, value_enum, default_value_t = PhaseKind::Random, value_name = "WHERE")]
    phase: PhaseKind,

    /// Write the metrics of every trial to a CSV file
    #[arg(long, value_name = "trials.csv")]
    out: Option<PathBuf>,

    /// Replace files that exist
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    setup: SetupFlags,
}

impl Arguments {
    fn study(&self, seed: u64) -> anyhow::Result<(Study, Vec<String>)> {
        let Setup { path, model, draws, assumed } = self.setup.resolve()?;
        let robot = model.robot();
        let update = match self.update {
            UpdateKind::Arc => Update::Arc,
            UpdateKind::Midpoint => Update::Midpoint,
            UpdateKind::Euler => Update::Euler,
        };
        let odometry = match (self.odometry, robot.encoder.rate()) {
            (OdometryKind::Robot, Some(rate)) => Odometry::Sampled { rate, update },
            (OdometryKind::Robot, None) | (OdometryKind::Ticks, _) => Odometry::EveryTick,
            (OdometryKind::TickByTick, _) => Odometry::EveryTickOneByOne,
            (OdometryKind::Continuous, _) => Odometry::Continuous,
        };
        let phase = match self.phase {
            PhaseKind::Random => Phase::Random,
            PhaseKind::Edge => Phase::Edge,
        };
        let runs = [self.runs; 2];
        let study = Study { draws, odometry, path, phase, runs, ..Study::new(model, self.trials, seed) };
        Ok((study, assumed))
    }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let (study, assumed) = arguments.study(session.seed())?;
    let metrics = study.metrics();
    let mut out =
        arguments.out.as_deref().map(|file| TrialsFile::create(file, &metrics, arguments.force)).transpose()?;
    let interrupt = session.catch_interrupt()?;
    let mut progress = session.progress(study.trials, "trials");
    let began = Instant::now();
    let mut failure = None;
    let ensemble = session.on_threads(|| {
        study.run(|first, rows| {
            progress.at(first + rows.len() as u64);
            if let Some(file) = &mut out
                && let Err(error) = file.write(first, rows)
            {
                failure = Some(error);
            }
            if failure.is_some() || interrupt.requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    })??;
    let seconds = began.elapsed().as_secs_f64();
    drop(progress);
    if let Some(error) = failure {
        return Err(error);
    }
    if let Some(file) = out {
        file.finish()?;
    }
    let partial = ensemble.trials < study.trials;
    if partial {
        session.message("partial", &format!("stopped after {} of {} trials", ensemble.trials, study.trials));
    }
    let theory = Theory::of(&study)?;
    let report = Report { study: &study, ensemble: &ensemble, theory, assumed: &assumed, partial, seconds };
    if session.json() {
        session.print_json(&report.json())?;
    } else {
        write!(session.out(), "{}", report.text())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The file of `--out`: one row a trial.
struct TrialsFile {
    file: files::Pending,
    columns: Vec<usize>,
}

impl TrialsFile {
    fn create(path: &std::path::Path, metrics: &[Metric], force: bool) -> anyhow::Result<TrialsFile> {
        let mut file = files::Pending::create(path, force)?;
        let names: Vec<&str> = metrics.iter().map(|metric| metric.name()).collect();
        writeln!(file, "trial,{}", names.join(",")).with_context(|| file.failed())?;
        let columns = (0..Metric::COUNT).filter(|i| metrics.contains(&Metric::ALL[*i])).collect();
        Ok(TrialsFile { file, columns })
    }

    fn write(&mut self, first: u64, rows: &[Row]) -> anyhow::Result<()> {
        let mut text = String::new();
        for (trial, row) in (first..).zip(rows) {
            text.push_str(&trial.to_string());
            for column in &self.columns {
                text.push(',');
                text.push_str(&row[*column].to_string());
            }
            text.push('\n');
        }
        self.file.write_all(text.as_bytes()).with_context(|| self.file.failed())
    }

    fn finish(self) -> anyhow::Result<()> {
        self.file.finish()
    }
}

/// E_max,sys \[m\] of the same test without noise.
struct Theory {
    exact: Option<f64>,
    /// By the formulas of the paper's companion, for a square.
    first_order: Option<f64>,
}

impl Theory {
    fn of(study: &Study) -> anyhow::Result<Theory> {
        let [cw, ccw] = study.noise_free()?;
        let middle = |effect: &str, parameter: &str| {
            let drawn = study.draws.iter().find(|d| d.effect() == effect && d.parameter().name == parameter);
            drawn.map(Draw::centre).or(study.model.get(effect, parameter)).unwrap_or(1.0)
        };
        let e_d = middle("wheel_diameter_ratio", "e_d");
        // A square sees the ratio of the two only.
        let e_b = middle("wheelbase", "e_b") / middle("scale", "e_s");
        let side = study.path.values().first().filter(|_| std::ptr::eq(study.path.shape(), &SQUARE));
        let first_order = side.and_then(|side| {
            let angles = Angles::of(&Correction { e_d, e_b, e_s: 1.0 }, *side, &study.robot.drive);
            let [cw, ccw] = Direction::BOTH.map(|direction| angles.first_order_return(direction, *side));
            summarise(&[cw], &[ccw]).e_max_sys()
        });
        Ok(Theory { exact: summarise(&[cw], &[ccw]).e_max_sys(), first_order })
    }

    fn text(&self) -> String {
        let mm = |value: Option<f64>| value.map(|v| format!("{:.1} mm", v * 1e3));
        match (mm(self.exact), mm(self.first_order)) {
            (Some(exact), Some(first)) => {
                format!("E_max,sys without noise: {exact} by exact kinematics, {first} to first order\n\n")
            }
            (Some(exact), None) => format!("E_max,sys without noise: {exact} by exact kinematics\n\n"),
            _ => String::new(),
        }
    }
}

/// Everything that is said of a finished study.
struct Report<'a> {
    study: &'a Study,
    ensemble: &'a Ensemble,
    theory: Theory,
    assumed: &'a [String],
    partial: bool,
    seconds: f64,
}

impl Report<'_> {
    fn trials_per_s(&self) -> f64 {
        self.ensemble.trials as f64 / self.seconds.max(1e-9)
    }

    fn json(&self) -> Value {
        let metrics: Map<String, Value> = self
            .ensemble
            .statistics
            .iter()
            .map(|(metric, s)| {
                let quantiles: Map<String, Value> =
                    QUANTILES.iter().map(|q| (q.to_string(), json!(s.quantile(*q)))).collect();
                let value = json!({
                    "mean": s.mean(), "std_dev": s.std_dev(), "std_error": s.std_error(),
                    "min": s.min(), "max": s.max(), "quantiles": quantiles,
                });
                (metric.name().to_owned(), value)
            })
            .collect();
        let effects = self.study.model.parts().iter().map(|part| {
            let mut entry = Map::from_iter([("name".to_owned(), json!(part.effect.about.name))]);
            for (parameter, value) in part.effect.about.parameters.iter().zip(&part.values) {
                let drawn = self
                    .study
                    .draws
                    .iter()
                    .find(|d| d.effect() == part.effect.about.name && d.parameter().name == parameter.name);
                entry.insert(parameter.name.to_owned(), drawn.map_or(json!(value), distribution_json));
            }
            Value::Object(entry)
        });
        let path = &self.study.path;
        let sizes: Map<String, Value> =
            path.shape().parameters.iter().zip(path.values()).map(|(p, v)| (p.name.to_owned(), json!(v))).collect();
        json!({
            "n": self.ensemble.trials,
            "seed": self.study.seed,
            "partial": self.partial,
            "metrics": metrics,
            "trials_per_s": self.trials_per_s(),
            "noise_free": {
                "e_max_sys_m": self.theory.exact, "first_order_e_max_sys_m": self.theory.first_order,
            },
            "runs_per_direction": self.study.runs[0],
            "robot": self.study.robot.name,
            "path": { "shape": path.shape().name, "sizes": sizes },
            "effects": effects.collect::<Vec<Value>>(),
            "assumed": self.assumed,
            "version": umbmark_core::VERSION,
        })
    }

    fn text(&self) -> String {
        let study = self.study;
        let sizes: Vec<String> = study
            .path
            .shape()
            .parameters
            .iter()
            .zip(study.path.values())
            .map(|(p, v)| format!("{} {v}", p.name))
            .collect();
        let mut text = format!(
            "Monte Carlo of UMBmark: {} trials of {} cw + {} ccw runs\n{}, {} ({})\n",
            self.ensemble.trials,
            study.runs[0],
            study.runs[1],
            study.robot.name,
            study.path.shape().name.replace('_', "-"),
            sizes.join(", "),
        );
        for part in study.model.parts() {
            let values: Vec<String> = part
                .effect
                .about
                .parameters
                .iter()
                .zip(&part.values)
                .map(|(p, v)| self.value_text(part.effect.about.name, p, *v))
                .collect();
            text += &format!("  {}: {}\n", part.effect.about.name, values.join(", "));
        }
        for assumption in self.assumed {
            text += &format!("  assumed: {assumption}\n");
        }
        text += "\n";
        text += &self.table();
        text += "\n\n";
        text += &self.theory.text();
        if let Some(e_max) = self.ensemble.get(Metric::EMaxSys) {
            text += "E_max,sys over the trials\n";
            text += &distribution_of(e_max);
        }
        text += &format!(
            "\nseed {}, {:.0} trials/s, umbmark {}{}\n",
            study.seed,
            self.trials_per_s(),
            umbmark_core::VERSION,
            if self.partial { ", PARTIAL: stopped before the end" } else { "" },
        );
        text
    }

    fn value_text(&self, effect: &str, parameter: &umbmark_core::parameter::Parameter, value: f64) -> String {
        if let Some(word) = parameter.choices.get(value as usize) {
            return format!("{} {word}", parameter.name);
        }
        let drawn = self.study.draws.iter().find(|d| d.effect() == effect && d.parameter().name == parameter.name);
        match drawn.map(Draw::distribution) {
            Some(Distribution::Normal { mean, sd }) => format!("{} {mean} ± {sd}", parameter.name),
            Some(Distribution::Uniform { min, max }) => format!("{} {min} .. {max}", parameter.name),
            None => format!("{} {value}", parameter.name),
        }
    }

    fn table(&self) -> String {
        let rows = self.ensemble.statistics.iter().map(|(metric, s)| {
            let (unit, factor) = if metric.is_angle() { ("deg", 180.0 / std::f64::consts::PI) } else { ("mm", 1e3) };
            let cell = |value: f64| with_precision_of(value * factor, s.std_error() * factor);
            let mut row = vec![format!("{} [{unit}]", title(*metric)), cell(s.mean())];
            row.push(with_precision_of(s.std_error() * factor, s.std_error() * factor));
            row.push(cell(s.std_dev()));
            row.extend([0.05, 0.5, 0.95].map(|q| cell(s.quantile(q))));
            row
        });
        table(&["metric", "mean", "std error", "std dev", "5 %", "50 %", "95 %"], rows)
    }
}

fn distribution_json(draw: &Draw) -> Value {
    match draw.distribution() {
        Distribution::Normal { mean, sd } => json!({ "mean": mean, "sd": sd }),
        Distribution::Uniform { min, max } => json!({ "min": min, "max": max }),
    }
}

/// What people call a metric.
fn title(metric: Metric) -> &'static str {
    match metric {
        Metric::EMaxSys => "E_max,sys",
        Metric::Sigma => "sigma (per axis)",
        Metric::CentroidCwX => "centroid cw, x",
        Metric::CentroidCwY => "centroid cw, y",
        Metric::CentroidCcwX => "centroid ccw, x",
        Metric::CentroidCcwY => "centroid ccw, y",
        Metric::ReturnHeadingCw => "return heading cw",
        Metric::ReturnHeadingCcw => "return heading ccw",
        Metric::NonsysOrientation => "orientation, bumps",
    }
}

/// A histogram of lengths in mm, in classes of a round width between the extremes.
fn distribution_of(s: &Statistics) -> String {
    let (low, high) = (1e3 * s.quantile(0.001), 1e3 * s.quantile(0.999));
    let width = round_width((high - low) / 16.0);
    let first = (low / width).floor();
    let classes = ((high / width).ceil() - first).max(1.0) as usize;
    let mut below = 0.0;
    let shares: Vec<(f64, f64)> = (0..classes)
        .map(|i| {
            let edge = (first + i as f64) * width;
            let up_to = if i + 1 == classes { 1.0 } else { s.share_below((edge + width) * 1e-3) };
            let share = (up_to - below).max(0.0);
            below = up_to.max(below);
            (edge, share)
        })
        .collect();
    histogram(&shares, "mm", 40)
}

/// The next 1, 2 or 5 times a power of ten.
fn round_width(width: f64) -> f64 {
    if !(width > 1e-6) {
        return 1e-3;
    }
    let power = 10f64.powf(width.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|w| *w >= width * 0.999).unwrap_or(width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn class_widths_are_round() {
        assert_eq!([0.7, 1.0, 1.2, 3.0, 60.0].map(round_width), [1.0, 1.0, 2.0, 5.0, 100.0]);
        assert_eq!(round_width(0.0), 1e-3);
    }
}
