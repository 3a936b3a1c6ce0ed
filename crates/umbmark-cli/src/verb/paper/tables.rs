//! Tables I and II, simulated.

use std::ops::ControlFlow;

use serde_json::{Value, json};
use umbmark_core::drive::{Drive, Robot};
use umbmark_core::effect::Model;
use umbmark_core::monte_carlo::{Ensemble, Metric, Statistics, Study};
use umbmark_core::path::Path;
use umbmark_core::preset::{PRESETS, Preset, TABLE_TWO};

use super::{Bench, Found};
use crate::table::table;

impl Bench<'_> {
    fn ensemble(&self, preset: &Preset, path: Path, model: Model) -> anyhow::Result<Ensemble> {
        let study = Study { path, ..Study::new(model, self.trials, self.session.seed()) };
        let mut progress = self.session.progress(self.trials, "trials");
        let ensemble = self.session.on_threads(|| {
            study.run(|batch| {
                progress.at(batch.ensemble.trials());
                ControlFlow::Continue(())
            })
        })?;
        ensemble.map_err(|error| anyhow::anyhow!("{}: {error}", preset.name))
    }
}

impl Bench<'_> {
    /// What ten bumps turn the CLAPPER by without other noise, its correction on and off \[rad\].
    fn correction(&self) -> anyhow::Result<[f64; 2]> {
        let preset = Preset::find("clapper").map_err(|_| anyhow::anyhow!("no robot clapper"))?;
        let Drive::Clapper(drive) = preset.robot().drive else { anyhow::bail!("the CLAPPER has two trucks") };
        let mut turned = [0.0; 2];
        for (turned, correction) in turned.iter_mut().zip([true, false]) {
            let robot = Robot { drive: Drive::Clapper(drive.with_correction(correction)), ..preset.robot() };
            let mut model = Model::new(&robot);
            model.set("placed_bumps", "count", 10.0)?;
            let study = Study { path: preset.path(), ..Study::new(model, 10, self.session.seed()) };
            let ensemble = study.run(|_| ControlFlow::Continue(()))?;
            *turned = ensemble.get(Metric::NonsysOrientation).map_or(f64::NAN, Statistics::mean);
        }
        Ok(turned)
    }
}

/// A published number among those that were simulated.
struct Place<'a> {
    published: f64,
    simulated: &'a Statistics,
    /// From SI to the unit of the table.
    factor: f64,
}

impl Place<'_> {
    const LEVEL: f64 = 0.95;

    fn middle(&self) -> [f64; 2] {
        let tail = 0.5 * (1.0 - Place::LEVEL);
        [tail, 1.0 - tail].map(|q| self.simulated.quantile(q))
    }

    fn share_below(&self) -> f64 {
        self.simulated.share_below(self.published)
    }

    fn cells(&self) -> Vec<String> {
        let [low, high] = self.middle();
        let scaled = |value: f64| format!("{:.*}", if self.factor > 500.0 { 0 } else { 2 }, value * self.factor);
        vec![
            scaled(self.published),
            scaled(self.simulated.mean()),
            format!("{} .. {}", scaled(low), scaled(high)),
            format!("{:.1} %", 100.0 * self.share_below()),
        ]
    }

    fn json(&self) -> Value {
        let [low, high] = self.middle();
        json!({
            "published": self.published, "mean": self.simulated.mean(), "middle_95": [low, high],
            "share_below_published": self.share_below(), "inside": (low..=high).contains(&self.published),
        })
    }
}

pub(super) fn one(bench: &Bench) -> anyhow::Result<Found> {
    let (mut rows, mut document, mut notes) = (Vec::new(), Vec::new(), String::new());
    for preset in PRESETS {
        let ensemble = bench.ensemble(preset, preset.path(), preset.model()?)?;
        let (Some(e_max), Some(sigma)) = (ensemble.get(Metric::EMaxSys), ensemble.get(Metric::Sigma)) else { continue };
        let e_max = Place { published: preset.published.e_max_sys, simulated: e_max, factor: 1e3 };
        let sigma = Place { published: preset.published.sigma, simulated: sigma, factor: 1e3 };
        let mut row = vec![preset.published.row.to_owned()];
        row.extend(e_max.cells());
        row.extend(sigma.cells().into_iter().take(2));
        rows.push(row);
        let facts = json!({ "sources": preset.sources, "assumed": preset.assumed });
        document.push(json!({
            "row": preset.published.row, "robot": preset.name, "e_max_sys_m": e_max.json(), "sigma_m": sigma.json(), "from": facts,
        }));
        notes += &format!("\n{} (--robot {})\n", preset.published.row, preset.name);
        preset.sources.iter().for_each(|text| notes += &format!("  from the paper: {text}\n"));
        preset.assumed.iter().for_each(|text| notes += &format!("  assumed: {text}\n"));
    }
    let header = ["Table I", "E_max,sys [mm]", "simulated", "middle 95 %", "below it", "sigma [mm]", "simulated"];
    let text = format!(
        "{}\n\n{} simulated tests of each. \"below it\": the share of them below the published E_max,sys.\n\
         The CLAPPER's 22 mm are more than noise of its published sigma makes (2.71 sigma/sqrt(5) = 13 mm at most in 95 %): they are\n\
         systematic, the paper does not say of what, and nothing was invented to make them.\n{notes}",
        table(&header, rows),
        bench.trials
    );
    Ok(Found { key: "table_1", text, document: json!({ "trials": bench.trials, "rows": document }) })
}

pub(super) fn two(bench: &Bench) -> anyhow::Result<Found> {
    let (mut rows, mut document) = (Vec::new(), Vec::new());
    let [on, off] = bench.correction()?;
    for column in TABLE_TWO {
        let preset = Preset::find(column.preset).map_err(|_| anyhow::anyhow!("no robot {}", column.preset))?;
        let mut model = preset.model()?;
        model.set("placed_bumps", "count", 10.0)?;
        let ensemble = bench.ensemble(preset, preset.path(), model)?;
        let Some(simulated) = ensemble.get(Metric::NonsysOrientation) else { continue };
        let recomputed = column.recomputed().to_radians();
        let place = Place { published: recomputed, simulated, factor: 1f64.to_degrees() };
        let deviations = column.deviations();
        let extreme =
            |most: fn(f64, f64) -> f64| deviations.as_flattened().iter().copied().reduce(most).unwrap_or(f64::NAN);
        let (least, most) = (extreme(f64::min), extreme(f64::max));
        let mut row = vec![column.robot.to_owned(), format!("{:.2}", column.average)];
        row.extend(place.cells());
        row.push(format!("{least:.1} .. {most:.1}"));
        rows.push(row);
        document.push(json!({
            "robot": column.robot, "preset": column.preset, "printed_rad": column.average.to_radians(),
            "recomputed": place.json(), "runs_rad": [least.to_radians(), most.to_radians()],
        }));
    }
    let header = ["Table II [deg]", "printed", "recomputed", "simulated", "middle 95 %", "below it", "its runs"];
    let text = format!(
        "{}\n\n{} simulated tests of each, ten bumps of 10 mm under the inside wheel on the first leg.\n\
         recomputed: half of Eq. (5), the mean over all runs, from the printed headings; the printed 8.35 of the LabMate needs\n\
         its two systematic means exchanged. \"its runs\": the least and the largest deviation of a single run.\n\
         The LabMate is taken to be the calibrated one, whose systematic headings are the smaller; the paper does not say which.\n\
         The K2A turns by D/(2 sqrt(3) rho) a bump if three equal wheels share its slip: that rests on the assumed wheels and circle,\n\
         and is not fitted to the printed number.\n\
         CLAPPER: {:.1} deg with its correction off, {:.3} deg with it: {:.0} times less. The printed runs carry errors of the\n\
         headings' measurement, of some tenths of a degree, that are not simulated.",
        table(&header, rows),
        bench.trials,
        off.to_degrees(),
        on.to_degrees(),
        off / on
    );
    Ok(Found {
        key: "table_2",
        text,
        document: json!({ "trials": bench.trials, "columns": document, "clapper_corrected_rad": on, "clapper_uncorrected_rad": off }),
    })
}
