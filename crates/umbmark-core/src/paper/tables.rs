//! Tables I and II, simulated.

use std::ops::ControlFlow;

use schemars::JsonSchema;
use serde::Serialize;

use super::{Bench, PaperError, preset};
use crate::drive::Robot;
use crate::effect::Model;
use crate::monte_carlo::{Ensemble, Metric, Shard, Statistics, Study};
use crate::path::Direction;
use crate::preset::{PRESETS, Preset, TABLE_TWO};
use crate::replay::Track;

/// A published number among those that were simulated, in SI.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PublishedNumber {
    /// What the paper says, or what follows from it.
    pub published: f64,
    /// Mean of the simulated tests.
    pub mean: f64,
    /// Where the middle 95 % of them lie.
    pub middle_95: [f64; 2],
    /// Share of them below the published number.
    pub share_below_published: f64,
    /// Whether the published number lies in the middle 95 %.
    pub inside: bool,
}

impl PublishedNumber {
    fn of(published: f64, simulated: &Statistics) -> PublishedNumber {
        let middle_95 = [0.025, 0.975].map(|q| simulated.quantile(q));
        let [low, high] = middle_95;
        let share_below_published = simulated.share_below(published);
        let inside = (low..=high).contains(&published);
        PublishedNumber { published, mean: simulated.mean(), middle_95, share_below_published, inside }
    }
}

/// Table I.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TableOne {
    /// Simulated tests of each robot.
    pub trials: u64,
    /// Its rows.
    pub rows: Vec<RobotOfTableOne>,
    /// What would leave the CLAPPER's published E_max,sys, each alone and to first order.
    pub clapper_would_take: Vec<LinkError>,
}

/// A size of an error of the CLAPPER's link.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LinkError {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// How far from where it does nothing.
    pub size: f64,
}

/// A robot of Table I.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RobotOfTableOne {
    /// Its name there.
    pub row: &'static str,
    /// Its name in flags.
    pub robot: &'static str,
    /// E_max,sys, in m.
    pub e_max_sys_m: PublishedNumber,
    /// Standard deviation of one coordinate, in m.
    pub sigma_m: PublishedNumber,
    /// Where its numbers are from.
    pub from: From,
}

/// Where the numbers of a robot are from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct From {
    /// What is taken from the paper, a phrase each.
    pub sources: &'static [&'static str],
    /// What the paper leaves open, a phrase each.
    pub assumed: &'static [&'static str],
}

/// Table II.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TableTwo {
    /// Simulated tests of each robot.
    pub trials: u64,
    /// Its columns.
    pub columns: Vec<RobotOfTableTwo>,
    /// What ten bumps turn the CLAPPER by without other noise, its correction on, in rad.
    pub clapper_corrected_rad: f64,
    /// The same with its correction off.
    pub clapper_uncorrected_rad: f64,
}

/// A robot of Table II.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RobotOfTableTwo {
    /// Its name there.
    pub robot: &'static str,
    /// Its name in flags.
    pub preset: &'static str,
    /// The average as printed, in rad.
    pub printed_rad: f64,
    /// The average as it follows from the printed headings, in rad.
    pub recomputed: PublishedNumber,
    /// Standard deviation with which headings were measured in the simulated tests, in rad.
    pub heading_noise_rad: f64,
    /// The least and the largest deviation of a single run, in rad.
    pub runs_rad: [f64; 2],
}

impl Bench<'_> {
    /// Part `number` of `all` of an experiment.
    fn ensemble(&self, preset: &Preset, model: Model, number: usize, all: usize) -> Result<Ensemble, PaperError> {
        let study = Study { path: preset.path(), ..Study::new(model, self.trials, self.seed) };
        let mut ensemble = Ensemble::new(&study, Shard::WHOLE);
        let told = study.resume(&mut ensemble, self.watch.stop, |batch| {
            let share = batch.ensemble.trials() as f64 / self.trials as f64;
            (self.watch.progress)((number as f64 + share) / all as f64);
            ControlFlow::Continue(())
        });
        told.map_err(|error| PaperError::Study { robot: preset.name, error })?;
        if ensemble.trials() < self.trials { Err(PaperError::Stopped) } else { Ok(ensemble) }
    }
}

/// E_max,sys and σ of every robot of Table I.
pub fn table_one(bench: &Bench) -> Result<TableOne, PaperError> {
    let mut rows = Vec::new();
    for (number, preset) in PRESETS.iter().enumerate() {
        let ensemble = bench.ensemble(preset, preset.model()?, number, PRESETS.len())?;
        let (Some(e_max), Some(sigma)) = (ensemble.get(Metric::EMaxSys), ensemble.get(Metric::Sigma)) else { continue };
        rows.push(RobotOfTableOne {
            row: preset.published.row,
            robot: preset.name,
            e_max_sys_m: PublishedNumber::of(preset.published.e_max_sys, e_max),
            sigma_m: PublishedNumber::of(preset.published.sigma, sigma),
            from: From { sources: preset.sources, assumed: preset.assumed },
        });
    }
    Ok(TableOne { trials: bench.trials, rows, clapper_would_take: link_errors()? })
}

/// What each of the link's own errors must be to leave the CLAPPER's published E_max,sys.
fn link_errors() -> Result<Vec<LinkError>, PaperError> {
    let preset = preset("clapper")?;
    let (robot, path) = (preset.robot(), preset.path());
    let mut errors = Vec::new();
    for (effect, parameter, rest, step) in
        [("rotary_zero_difference", "angle_rad", 0.0, 1e-4), ("link_length", "ratio", 1.0, 1e-3)]
    {
        let mut model = Model::new(&robot);
        model.set(effect, parameter, rest + step)?;
        let off = |direction| {
            let (end, told) = (Track::from_path(&path, direction, &robot).end(&model.chain()), path.end(direction));
            libm::hypot(end.x - told.x, end.y - told.y)
        };
        let farthest = Direction::BOTH.map(off).into_iter().fold(0.0, f64::max);
        errors.push(LinkError { effect, parameter, size: step * preset.published.e_max_sys / farthest });
    }
    Ok(errors)
}

/// Standard deviation of an angle that is known to ±0.4 degrees, evenly, in rad.
const MEASURED: f64 = 0.4 / 1.732_050_807_568_877_2 * std::f64::consts::PI / 180.0;

/// The extended test of the robots of Table II: ten bumps of 10 mm under the inside wheel on the first leg. The CLAPPER stands a second
/// time, with headings measured to ±0.4 degrees, which is reported at second hand of a sonar device for such tests.
pub fn table_two(bench: &Bench) -> Result<TableTwo, PaperError> {
    let mut columns = Vec::new();
    let [clapper_corrected_rad, clapper_uncorrected_rad] = correction(bench.seed)?;
    let as_measured = TABLE_TWO.iter().filter(|column| column.preset == "clapper").map(|column| (column, MEASURED));
    let asked: Vec<_> = TABLE_TWO.iter().map(|column| (column, 0.0)).chain(as_measured).collect();
    for (number, (column, heading_noise_rad)) in asked.iter().copied().enumerate() {
        let preset = preset(column.preset)?;
        let mut model = preset.model()?;
        model.set("placed_bumps", "count", 10.0)?;
        if heading_noise_rad > 0.0 {
            model.set("reference_noise", "heading_sd_rad", heading_noise_rad)?;
        }
        let ensemble = bench.ensemble(preset, model, number, asked.len())?;
        let Some(simulated) = ensemble.get(Metric::NonsysOrientation) else { continue };
        let deviations = column.deviations();
        let extreme =
            |most: fn(f64, f64) -> f64| deviations.as_flattened().iter().copied().reduce(most).unwrap_or(f64::NAN);
        columns.push(RobotOfTableTwo {
            robot: column.robot,
            preset: column.preset,
            printed_rad: column.average.to_radians(),
            recomputed: PublishedNumber::of(column.recomputed().to_radians(), simulated),
            heading_noise_rad,
            runs_rad: [extreme(f64::min), extreme(f64::max)].map(f64::to_radians),
        });
    }
    Ok(TableTwo { trials: bench.trials, columns, clapper_corrected_rad, clapper_uncorrected_rad })
}

/// What ten bumps turn the CLAPPER by without other noise, its correction on and off, in rad.
fn correction(seed: u64) -> Result<[f64; 2], PaperError> {
    let preset = preset("clapper")?;
    let mut turned = [0.0; 2];
    for (turned, correction) in turned.iter_mut().zip([true, false]) {
        let robot = preset.robot();
        let drive = robot.drive.trucks().ok_or(PaperError::Robot("clapper"))?;
        let robot = Robot { drive: drive.with_correction(correction).into(), ..robot };
        let mut model = Model::new(&robot);
        model.set("placed_bumps", "count", 10.0)?;
        let study = Study { path: preset.path(), ..Study::new(model, 10, seed) };
        let ensemble = study.run(|_| ControlFlow::Continue(()));
        let ensemble = ensemble.map_err(|error| PaperError::Study { robot: preset.name, error })?;
        *turned = ensemble.get(Metric::NonsysOrientation).map_or(f64::NAN, Statistics::mean);
    }
    Ok(turned)
}
