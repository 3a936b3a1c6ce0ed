//! `plan`.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_cli::told;
use umbmark_core::dataset::Dataset as CoreDataset;
use umbmark_core::diagnose::{Options, first_model, separating};
use umbmark_core::path::Path as CorePath;
use umbmark_core::plan::{Measured, Order, PlanError, Protocol, Request, Setting, Sought, expected_dataset};
use umbmark_core::result;
use umbmark_core::stats::Interval;

use crate::arguments::threads;
use crate::dataset::Dataset;
use crate::diagnose::options_of;
use crate::model::Model;
use crate::path::Path;
use crate::work::{Watch, watched};
use crate::{choice, json, probability, refused};

const ORDERS: [(&str, Order); 3] =
    [("mirrored", Order::Mirrored), ("alternating", Order::Alternating), ("blocks", Order::Blocks)];

/// Whose test is planned: measured runs, or a model on a path; and the scatter and the headings that are expected.
#[derive(FromPyObject)]
pub struct Whose {
    data: Option<Py<Dataset>>,
    model: Option<Model>,
    path: Option<Path>,
    sigma_m: Option<f64>,
    with_heading: bool,
    seed: u64,
}

/// A robot on its path, and what is known of it.
struct Known {
    setting: Setting,
    sigma_interval: Option<Interval>,
    told: told::Known,
}

impl Whose {
    fn data(&self) -> Option<Arc<CoreDataset>> {
        self.data.as_ref().map(|data| Arc::clone(&data.get().0))
    }

    /// What is known of the robot, on the present threads.
    fn known(&self) -> Result<Known, PlanError> {
        let given = |path: &Option<Path>, or: CorePath| path.as_ref().map_or(or, |path| path.0.clone());
        let (path, truth, measured) = match (self.data(), &self.model) {
            (Some(data), model) => {
                let Measured { path, truth, with_heading, sigma_interval } = Measured::new(&data)?;
                let truth = model.as_ref().map_or(truth, |model| model.model.clone());
                (given(&self.path, path), truth, Some((with_heading, sigma_interval)))
            }
            (None, Some(model)) => (given(&self.path, CorePath::umbmark()), model.model.clone(), None),
            (None, None) => (given(&self.path, CorePath::umbmark()), Model::noisy_labmate()?, None),
        };
        let (setting, assumed) = Setting::expecting(&path, &truth, self.sigma_m, self.seed)?;
        let headings = measured.is_none_or(|(with_heading, _)| with_heading);
        let interval = measured.and_then(|(_, interval)| interval).filter(|_| self.sigma_m.is_none());
        Ok(Known {
            setting: setting.with_heading(headings && self.with_heading),
            sigma_interval: interval,
            told: told::Known {
                assumed: assumed.into_iter().map(str::to_owned).collect(),
                from_data: measured.is_some(),
            },
        })
    }

    fn check(&self) -> PyResult<()> {
        if self.sigma_m.is_some_and(|sigma| !(sigma > 0.0 && sigma.is_finite())) {
            return Err(PyValueError::new_err("sigma_m must be positive and finite"));
        }
        match self.model.as_ref().and_then(|model| model.draws.first()) {
            Some(draw) => Err(PyValueError::new_err(format!(
                "one robot is planned for; give {} of {} a value, not a distribution",
                draw.parameter().name,
                draw.effect()
            ))),
            None => Ok(()),
        }
    }
}

/// What a test would show: its document, its words, and the sheet to drive it by as Markdown and as HTML.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn plan(
    py: Python<'_>,
    whose: Whose,
    runs: usize,
    see: Vec<(String, f64)>,
    power: f64,
    numbers: Vec<usize>,
    order: &str,
    options: (f64, usize, u64),
    #[pyo3(from_py_with = threads)] threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String, String, String)> {
    whose.check()?;
    let (order, options) = (choice("order", order, &ORDERS)?, options_of(options, false)?);
    probability("power", power)?;
    if power <= options.size {
        return Err(PyValueError::new_err(format!("power must be greater than size, {}, got {power}", options.size)));
    }
    let work = move |watch: &Watch| -> Result<_, PlanError> {
        let Known { setting, sigma_interval, told: known } = whose.known()?;
        let sought = |(name, value): &(String, f64)| Ok((Sought::named(name, *value, setting.robot())?, *value));
        let see = see.iter().map(sought).collect::<Result<Vec<_>, PlanError>>()?;
        let request = Request { runs, see: &see, power, numbers: &numbers, sigma_interval, options };
        let findings = watch.work(|watch| request.findings(&setting, watch))?;
        let sheet = Protocol::new(&setting, runs, order, setting.bumps(), told::ACTIONS);
        let found = result::Plan::new(&setting, &request, &findings, &known.assumed);
        let text = told::plan(&told::Plan {
            summary: &sheet.summary,
            setting: &setting,
            known: &known,
            request: &request,
            findings: &findings,
        });
        Ok((found, text, sheet))
    };
    let (found, text, sheet) = watched(py, threads, progress, work)?.map_err(refused)?;
    Ok((json(&found)?, text, sheet.markdown(), sheet.html()))
}

/// Experiments that tell two effects apart, together with the data or a planned test.
#[pyfunction]
pub fn separate(
    py: Python<'_>,
    pair: (String, String),
    whose: Whose,
    runs: usize,
    options: (f64, usize, u64),
    #[pyo3(from_py_with = threads)] threads: usize,
) -> PyResult<(String, String)> {
    whose.check()?;
    let options: Options = options_of(options, false)?;
    if pair.0 == pair.1 {
        return Err(PyValueError::new_err(format!("two different effects are needed, got {} twice", pair.0)));
    }
    let work = move |_: &Watch| -> Result<_, PlanError> {
        let names = [pair.0.as_str(), pair.1.as_str()];
        let (data, beside) = match whose.data() {
            Some(data) => (data, "the data".to_owned()),
            None => {
                let planned = expected_dataset(&whose.known()?.setting, runs);
                (Arc::new(planned), format!("a test of {runs} + {runs} runs"))
            }
        };
        let experiments = separating(&data, &first_model(&data)?, names)?;
        let found = result::Separation::new(names, &beside, &experiments, &options);
        Ok((found, told::Separation { pair: names.map(str::to_owned), after: beside, experiments }.text()))
    };
    let (found, text) = watched(py, threads, None, work)?.map_err(refused)?;
    Ok((json(&found)?, text))
}
