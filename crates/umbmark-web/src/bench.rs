//! One dataset on the bench: what is computed of it, by the functions that the verbs call, and the work on it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rayon::ThreadPool;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{self, diagnose};
use umbmark_core::effect::{Model, Part};
use umbmark_core::evidence::Fit;
use umbmark_core::learn::{Kept, learn_from};
use umbmark_core::path::Direction;
use umbmark_core::result;
use umbmark_core::solve::Solution;
use umbmark_core::watch::Watch;
use umbmark_io::{ModelFile, Topics};
use umbmark_plot::study::{Absent, Drives, Options, Study};

use crate::act::{Act, Moved, fix, has};
use crate::later::Later;
use crate::state::{Draft, Errors, Held, State, Step, VERSION};
use crate::words;

/// Suggestions whose worth is worked out.
const WORTHS: usize = 3;
/// How long a page waits for runs to be ready for fits before it shows the rest.
const A_MOMENT: Duration = Duration::from_millis(300);
/// What the file of a model is called.
pub const MODEL: &str = "model.toml";

/// Something that cannot be done, in a sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Trouble(pub String);

impl Trouble {
    /// For this reason.
    pub fn because(why: impl std::fmt::Display) -> Trouble {
        Trouble(why.to_string())
    }
}

/// A dataset and the work on it.
#[derive(Debug)]
pub struct Bench {
    /// Where it was read from.
    pub place: PathBuf,
    /// The runs.
    pub data: Arc<Dataset>,
    options: diagnose::Options,
    inspection: Value,
    kept: Later<Kept>,
    drives: Result<Drives, Absent>,
    file: PathBuf,
    work: Mutex<Work>,
}

/// What changes.
#[derive(Debug)]
struct Work {
    state: State,
    /// Why the state is not saved.
    unsaved: Option<String>,
    /// The last diagnosis, and the model that it is of.
    found: Option<(String, Value)>,
    /// The last fit, and the model that it gave.
    fitted: Option<(String, Value)>,
    /// What is known beside the last model that was asked about.
    study: Option<(String, Arc<Study>)>,
}

/// Where a model has the robot in each run, and its error: asked for again and again while a slider is dragged.
#[derive(Debug, Serialize)]
struct Prediction {
    runs: Vec<Predicted>,
    errors: Option<Errors>,
}

/// The poses of one run \[m, rad\].
#[derive(Debug, Serialize)]
struct Predicted {
    x: Vec<f64>,
    y: Vec<f64>,
    heading: Vec<f64>,
}

impl Bench {
    /// Puts a dataset on the bench, with the work that was left beside it. Nothing is fitted before it is [prepared](Bench::prepare).
    pub fn open(place: &Path, topics: &Topics, options: diagnose::Options) -> Result<Bench, Trouble> {
        let data = umbmark_io::load_with(place, topics).map_err(Trouble::because)?;
        let robot = data.nominal_robot().map_err(Trouble::because)?.clone();
        let found = data.inspect();
        let inspection = result::Inspection::new(&place.display().to_string(), &data, &found, &[]);
        let drives = Drives::of(&data);
        let file = State::file_of(place);
        let state = match State::read(&file).map_err(Trouble::because)? {
            Some(state) => {
                let models = state.steps.iter().map(|step| &step.model).chain(state.draft.iter().map(|d| &d.model));
                for text in models {
                    ModelFile::parse(&file.display().to_string(), text, Some(&robot)).map_err(Trouble::because)?;
                }
                state
            }
            None => {
                let model = ModelFile::new(Model::new(&robot)).text();
                let step = Step { words: "nominal robot".into(), model, ..Step::default() };
                State { version: VERSION, steps: vec![step], ..State::default() }
            }
        };
        let work = Work { state, unsaved: None, found: None, fitted: None, study: None };
        Ok(Bench {
            place: place.to_owned(),
            data: Arc::new(data),
            options,
            inspection: serde_json::to_value(&inspection).map_err(Trouble::because)?,
            kept: Later::default(),
            drives,
            file,
            work: Mutex::new(work),
        })
    }

    /// Makes the runs ready for fits, on a thread of its own, and waits a moment for it: of short logs the page has all at once.
    pub fn prepare(self: &Arc<Bench>, pool: &Arc<ThreadPool>) {
        let (bench, pool) = (Arc::clone(self), Arc::clone(pool));
        let work = move || bench.kept.make(|| pool.install(|| bench.prepared()));
        match std::thread::Builder::new().name("prepare".into()).spawn(work) {
            Ok(_) => self.kept.wait(Some(A_MOMENT)),
            Err(error) => self.kept.make(|| Err(Trouble(format!("The system gives no thread: {error}.")))),
        }
    }

    /// The runs, ready for fits, once the error of the nominal robot is known.
    fn prepared(&self) -> Result<Kept, Trouble> {
        let kept = Kept::new(&self.data, &self.options).map_err(Trouble::because)?;
        let unknown = |step: &Step| step.errors == Errors::default();
        let first = self.work().state.steps.first().filter(|step| unknown(step)).cloned();
        let errors = first.and_then(|step| kept.as_it_is(&self.parse(&step.model).ok()?).ok());
        if let (Some(errors), Some(step)) = (errors, self.work().state.steps.first_mut().filter(|step| unknown(step))) {
            step.errors = Errors::from(&result::Step::from(&errors));
        }
        Ok(kept)
    }

    /// Waits until the runs are ready for fits; never on a thread of the pool, which may be the one that makes them ready.
    pub fn wait(&self) {
        self.kept.wait(None);
    }

    fn work(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn kept(&self) -> Result<Arc<Kept>, Trouble> {
        let still = || Trouble("The runs are still made ready for fits.".into());
        self.kept.found().unwrap_or_else(|| Err(still()))
    }

    /// Whether the runs are ready for fits, or cannot be made so.
    pub fn is_prepared(&self) -> bool {
        self.kept.found().is_some()
    }

    /// The number of the last change.
    pub fn revision(&self) -> u64 {
        self.work().state.revision
    }

    /// What `inspect` finds.
    pub fn inspection(&self) -> &Value {
        &self.inspection
    }

    /// The document, and what belongs to the model that is looked at.
    pub fn told(&self) -> Result<Value, Trouble> {
        let work = self.work();
        let text = current(&work.state).to_owned();
        let of = |known: &Option<(String, Value)>| {
            known.as_ref().filter(|(of, _)| *of == text).map(|(_, told)| told.clone())
        };
        let model = self.parse(&text)?;
        Ok(json!({
            "state": work.state,
            "model": self.parts(&model, work.state.draft.as_ref().and_then(|draft| draft.held.as_ref())),
            "found": of(&work.found),
            "fitted": of(&work.fitted),
            "unfit": self.kept.found().and_then(Result::err).map(|trouble| trouble.to_string()),
            "preparing": !self.is_prepared(),
            "file": self.file.display().to_string(),
            "unsaved": work.unsaved,
            "place": self.place.display().to_string(),
        }))
    }

    /// The effects of a model, with what a form needs of their numbers.
    fn parts(&self, model: &Model, held: Option<&Held>) -> Vec<Value> {
        let part = |part: &Part| {
            let numbers = part.effect.parameters().iter().zip(&part.values).map(|(parameter, value)| {
                let default = parameter.default.resolve(model.robot());
                json!({
                    "name": parameter.name, "unit": parameter.unit, "meaning": parameter.meaning, "value": value, "default": default,
                    "typical": parameter.typical, "bounds": [finite(parameter.bounds.0), finite(parameter.bounds.1)],
                    "choices": parameter.choices(), "fixed": part.fixed.contains(&parameter.name),
                    "held": held.is_some_and(|held| held.is(part.effect.name(), parameter.name)),
                })
            });
            let formula = part.effect.formula();
            json!({
                "effect": part.effect.name(),
                "title": part.effect.entry().map(|entry| entry.about.title),
                "formula": formula.map(|formula| json!({ "text": formula.text(), "acts_on": formula.target().name() })),
                "free": part.free, "numbers": numbers.collect::<Vec<_>>(), "meaning": model.meaning(part.effect.name()),
            })
        };
        model.parts().iter().map(part).collect()
    }

    pub(crate) fn parse(&self, text: &str) -> Result<Model, Trouble> {
        let robot = self.data.nominal_robot().map_err(Trouble::because)?;
        Ok(ModelFile::parse(MODEL, text, Some(robot)).map_err(Trouble::because)?.model)
    }

    /// The text of the model that is looked at.
    pub fn model_text(&self) -> String {
        current(&self.work().state).to_owned()
    }

    /// The model that is looked at.
    pub fn model(&self) -> Result<Model, Trouble> {
        self.parse(&self.model_text())
    }

    /// The file of the model that is looked at, as it is taken away.
    pub fn model_file(&self) -> Result<ModelFile, Trouble> {
        let robot = self.data.nominal_robot().map_err(Trouble::because)?;
        ModelFile::parse(MODEL, &self.model_text(), Some(robot)).map_err(Trouble::because)
    }

    /// Changes the work, and saves it.
    pub(crate) fn change(&self, of: impl FnOnce(&mut State) -> Result<(), Trouble>) -> Result<(), Trouble> {
        let mut work = self.work();
        let mut state = work.state.clone();
        of(&mut state)?;
        state.revision += 1;
        work.unsaved = state.write(&self.file).err().map(|error| error.to_string());
        work.state = state;
        Ok(())
    }

    /// The errors of a model with the values that it has.
    pub(crate) fn errors(&self, model: &Model) -> Result<Errors, Trouble> {
        let error = self.kept()?.error(model).map_err(Trouble::because)?;
        Ok(Errors { rmse_m: finite(error.position), heading_rmse_rad: error.heading, ..Errors::default() })
    }

    /// The runs as they were driven, without a model.
    pub fn paths(&self) -> Result<Value, Trouble> {
        let drives = self.drives.as_ref().map_err(Trouble::because)?;
        let run = |driven: &umbmark_plot::study::Driven| {
            let of = |value: fn(&umbmark_core::geometry::Pose2) -> f64| -> Vec<Value> {
                driven.computed.iter().map(|pose| short(value(pose))).collect()
            };
            json!({
                "name": self.data.runs[driven.run].name,
                "direction": driven.direction.map(Direction::name),
                "time": driven.time.iter().map(|t| short(*t)).collect::<Vec<_>>(),
                "computed": { "x": of(|p| p.x), "y": of(|p| p.y), "heading": of(|p| p.heading) },
                "measured": {
                    "x": driven.measured.iter().map(|(at, _)| short(at[0])).collect::<Vec<_>>(),
                    "y": driven.measured.iter().map(|(at, _)| short(at[1])).collect::<Vec<_>>(),
                    "place": driven.measured.iter().map(|(_, place)| *place).collect::<Vec<_>>(),
                },
                "rolled": driven.rolled.iter().map(|way| short(*way)).collect::<Vec<_>>(),
                "dense": driven.dense,
            })
        };
        Ok(json!({ "recorded": drives.recorded, "runs": drives.runs.iter().map(run).collect::<Vec<_>>() }))
    }

    /// Where a model with these values has the robot, and its error, as JSON; nothing is changed.
    pub fn predict(&self, values: &BTreeMap<String, BTreeMap<String, f64>>) -> Result<Vec<u8>, Trouble> {
        let mut model = self.model()?;
        for (effect, numbers) in values {
            has(&model, effect)?;
            for (parameter, value) in numbers {
                model.set(effect, parameter, *value).map_err(Trouble::because)?;
            }
        }
        let drives = self.drives.as_ref().map_err(Trouble::because)?;
        let run = |driven: &umbmark_plot::study::Driven| {
            let poses = driven.modelled(&model);
            let of = |value: fn(&umbmark_core::geometry::Pose2) -> f64, places: f64| -> Vec<f64> {
                poses.iter().map(|pose| (value(pose) * places).round() / places).collect()
            };
            Predicted { x: of(|p| p.x, 1e5), y: of(|p| p.y, 1e5), heading: of(|p| p.heading, 1e3) }
        };
        let of_runs = || drives.runs.par_iter().map(run).collect();
        let (runs, errors) = rayon::join(of_runs, || self.errors(&model).ok());
        serde_json::to_vec(&Prediction { runs, errors }).map_err(Trouble::because)
    }

    /// Fits the free values of the model that is looked at. A number that was held for the last fit is free again.
    pub fn fit(&self) -> Result<(), Trouble> {
        self.fit_beside(None)
    }

    /// Sets a number of the model that is looked at and fits its other free numbers, as `fit --fix EFFECT.PARAMETER=VALUE` does.
    pub fn hold(&self, moved: &Moved) -> Result<(), Trouble> {
        let Moved { effect, parameter, value } = moved;
        self.act(&Act::Set { effect: effect.clone(), parameter: parameter.clone(), value: *value })?;
        self.fit_beside(Some(Held { effect: effect.clone(), parameter: parameter.clone() }))
    }

    /// Fits the free values of the model that is looked at, but for a number that is held.
    fn fit_beside(&self, own: Option<Held>) -> Result<(), Trouble> {
        let (text, mut model) = (self.model_text(), self.model()?);
        let released = self.draft_now().and_then(|draft| draft.held);
        released.iter().for_each(|number| fix(&mut model, number, false));
        // What the user holds by name stays held.
        let held = own.clone().filter(|number| !number.is_fixed(&model));
        held.iter().for_each(|number| fix(&mut model, number, true));
        if !model.is_free() {
            return Err(Trouble(match &own {
                Some(_) => "No other number of the model is free.".into(),
                None => "No number of the model is free: add an effect, or set a mark at \"fit\".".into(),
            }));
        }
        let (fit, step) = self.kept()?.fit(&model).map_err(Trouble::because)?;
        let told =
            serde_json::to_value(result::Fitted::new(&fit, 1.0 - self.options.size)).map_err(Trouble::because)?;
        let Fit { model, noise, .. } = fit;
        let said = own.as_ref().and_then(|number| number.words(&model));
        let released = released.map(|number| words::named(&number.effect, &number.parameter));
        let fitted = ModelFile { noise, ..ModelFile::new(model) }.text();
        self.change(|state| {
            if current(state) != text {
                return Err(Trouble("The model was changed while it was fitted.".into()));
            }
            let before = state.draft.take();
            let p_adjusted = before.as_ref().and_then(|draft| draft.p_adjusted);
            let words = before.map_or_else(String::new, |draft| draft.words);
            let words = words::fitted(&words, released.as_deref(), said.as_deref());
            let errors = Errors::from(&result::Step::from(&step));
            state.draft = Some(Draft { words, model: fitted.clone(), errors, fitted: true, held, p_adjusted });
            Ok(())
        })?;
        self.work().fitted = Some((fitted, told));
        Ok(())
    }

    /// Asks what the model that is looked at is missing, as `diagnose` does, and what the first suggestions are worth.
    pub fn diagnose(&self, watch: &Watch) -> Result<(), Trouble> {
        let (text, model) = (self.model_text(), self.model()?);
        let diagnosis = diagnose(&self.data, &model, &self.options).map_err(Trouble::because)?;
        (watch.progress)(0.5);
        let mut worth = serde_json::Map::new();
        for (index, suspect) in diagnosis.ranking.iter().take(WORTHS).enumerate() {
            if watch.is_stopped() {
                break;
            }
            let mut with = diagnosis.model.clone();
            if with.add(suspect.best).map(|part| part.free = true).is_ok()
                && let Ok((_, step)) = self.kept()?.fit(&with)
            {
                let errors = Errors::from(&result::Step::from(&step));
                worth.insert(suspect.best.to_owned(), json!(errors));
            }
            (watch.progress)(0.5 + 0.5 * (index + 1) as f64 / WORTHS as f64);
        }
        let told = json!({ "diagnosis": result::Diagnosis::new(&diagnosis, &self.options), "worth": worth });
        let mut work = self.work();
        work.found = Some((text, told));
        work.state.revision += 1;
        Ok(())
    }

    /// Does the whole loop as `learn` does; its steps become the story.
    pub fn learn(&self, watch: &Watch) -> Result<(), Trouble> {
        let robot = self.data.nominal_robot().map_err(Trouble::because)?;
        let learnt = learn_from(&self.data, &Model::new(robot), &self.options, watch).map_err(Trouble::because)?;
        let solution = Solution::of(&self.data, learnt, &self.options).map_err(Trouble::because)?;
        let learnt = &solution.learnt;
        let (mut steps, mut effects): (Vec<Step>, Vec<String>) = (Vec::new(), Vec::new());
        let last = learnt.steps.len().saturating_sub(1);
        for (index, step) in learnt.steps.iter().enumerate() {
            effects.extend(step.added.map(str::to_owned));
            let words = step.added.map_or_else(|| "nominal robot".to_owned(), |effect| format!("+ {effect}"));
            let model = if index == last {
                ModelFile::learnt(&solution).text()
            } else {
                self.part_of(&learnt.model, &effects)?
            };
            steps.push(Step {
                words,
                learnt: true,
                model,
                effects: effects.clone(),
                p_adjusted: step.p_adjusted,
                errors: Errors::from(&result::Step::from(step)),
            });
        }
        let told = json!({
            "diagnosis": result::Diagnosis::new(&learnt.diagnosis, &self.options),
            "learnt": result::Learnt::new(&solution, &self.options),
            "worth": {},
        });
        let Some(text) = steps.last().map(|step| step.model.clone()) else {
            return Err(Trouble("Nothing was learnt.".into()));
        };
        self.change(|state| {
            (state.at, state.steps, state.draft) = (steps.len() - 1, steps, None);
            Ok(())
        })?;
        self.work().found = Some((text, told));
        Ok(())
    }

    /// A model with some of its effects, fitted where that succeeds.
    fn part_of(&self, model: &Model, effects: &[String]) -> Result<String, Trouble> {
        let mut own = Model::new(model.robot());
        let parts = model.parts().iter().filter(|part| effects.iter().any(|effect| effect == part.effect.name()));
        parts.for_each(|part| own.adopt(part));
        if !own.is_free() {
            return Ok(ModelFile::new(own).text());
        }
        Ok(match self.kept()?.fit(&own) {
            Ok((fit, _)) => ModelFile { noise: fit.noise, ..ModelFile::new(fit.model) }.text(),
            Err(_) => ModelFile::new(own).text(),
        })
    }

    /// What is known beside the model that is looked at.
    pub fn study(&self) -> Result<Arc<Study>, Trouble> {
        let (text, model) = (self.model_text(), self.model()?);
        let mut work = self.work();
        if let Some((_, study)) = work.study.as_ref().filter(|(of, _)| *of == text) {
            return Ok(Arc::clone(study));
        }
        let options = Options { diagnose: self.options, ..Options::default() };
        let study = Study::new(self.name(), Arc::clone(&self.data), Some((MODEL.to_owned(), model)), options);
        let study = Arc::new(study);
        work.study = Some((text, Arc::clone(&study)));
        Ok(study)
    }

    /// The place by the last part of its name.
    pub fn name(&self) -> String {
        self.place.file_name().unwrap_or(self.place.as_os_str()).to_string_lossy().into_owned()
    }

    /// The model that is tried.
    pub(crate) fn draft_now(&self) -> Option<Draft> {
        self.work().state.draft.clone()
    }

    /// The step that is looked at, and whether there is a draft.
    pub fn step(&self) -> (Step, bool) {
        let work = self.work();
        (work.state.steps[work.state.at].clone(), work.state.draft.is_some())
    }
}

/// The text of the model that is looked at.
fn current(state: &State) -> &str {
    match &state.draft {
        Some(draft) => &draft.model,
        None => state.steps.get(state.at).map_or("", |step| &step.model),
    }
}

/// A number, or nothing where it is not finite.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// A number for a drawing: six places behind the point.
fn short(value: f64) -> Value {
    json!((value * 1e6).round() / 1e6)
}
