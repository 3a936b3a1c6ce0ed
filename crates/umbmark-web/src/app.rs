//! What is answered: files of the page, and questions about the dataset on the bench.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use bytes::Bytes;
use hyper::{Method, StatusCode};
use percent_encoding::percent_decode_str;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use umbmark_core::action::Wording;
use umbmark_core::calibrate::Correction;
use umbmark_core::dataset::Dataset;
use umbmark_core::drive::{DriveKind, Robot};
use umbmark_core::effect::{CATALOGUE, Formula, Target};
use umbmark_core::inspect::LogContents;
use umbmark_core::parameter::Parameter;
use umbmark_core::preset::{PRESETS, Preset, Published};
use umbmark_core::result;
use umbmark_io::export::{Export, TARGETS, Target as Exported};
use umbmark_io::{Existing, KnownNumbers, Proposal, Topics, Words, contents};
use umbmark_plot::kind;
use umbmark_plot::page::{Origin, Provenance, page};
use umbmark_plot::render::{legend, plotly};
use umbmark_plot::study::{Options, Study};

use crate::act::{Act, Moved, formula_of};
use crate::bench::{Bench, MODEL, Trouble};
use crate::cloud;
use crate::dropped;
use crate::guard::Guard;
use crate::job::Jobs;
use crate::page;
use crate::state::State;
use crate::typed::{self, Typed};
use crate::{ServeError, Served};

/// Everything that is served.
#[derive(Debug)]
pub struct App {
    /// Who may ask.
    pub guard: Guard,
    served: Served,
    pool: Arc<ThreadPool>,
    jobs: Arc<Jobs>,
    bench: Mutex<Option<Arc<Bench>>>,
    /// Logs whose robot is not known yet.
    waiting: Mutex<Option<PathBuf>>,
    report: Arc<Mutex<Option<Vec<u8>>>>,
    /// Held while a figure is worked out. A thread of the pool that waits for others may take up other work: if that were a second figure of
    /// the same study, it could wait for what it is itself in the middle of.
    drawing: Mutex<()>,
}

/// A question.
#[derive(Debug)]
pub struct Asked {
    /// GET or POST.
    pub method: Method,
    /// Behind the token.
    pub path: String,
    /// Behind the question mark.
    pub query: String,
    /// What is sent along.
    pub body: Bytes,
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    /// Its status.
    pub status: StatusCode,
    /// Its type.
    pub kind: &'static str,
    /// Its bytes.
    pub body: Vec<u8>,
    /// The name under which a browser keeps it.
    pub download: Option<String>,
}

impl Answer {
    /// A refusal with its reason.
    pub fn refused(status: StatusCode, why: &str) -> Answer {
        let body = json!({ "error": why }).to_string().into_bytes();
        Answer { status, kind: "application/json", body, download: None }
    }

    fn file(kind: &'static str, body: Vec<u8>, name: &str) -> Answer {
        Answer { status: StatusCode::OK, kind, body, download: Some(name.to_owned()) }
    }
}

impl From<Result<Value, Trouble>> for Answer {
    fn from(told: Result<Value, Trouble>) -> Answer {
        match told {
            Ok(value) => Answer {
                status: StatusCode::OK,
                kind: "application/json",
                body: value.to_string().into_bytes(),
                download: None,
            },
            Err(trouble) => Answer::refused(StatusCode::UNPROCESSABLE_ENTITY, &trouble.to_string()),
        }
    }
}

/// Numbers of a name plate, as they are typed.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Plate {
    numbers: Vec<(String, f64)>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Law {
    name: String,
    acts_on: String,
    formula: String,
    parameters: BTreeMap<String, f64>,
}

type Values = BTreeMap<String, BTreeMap<String, f64>>;

impl App {
    /// An app with the dataset that was named.
    pub fn new(served: Served, guard: Guard) -> Result<App, ServeError> {
        let pool = ThreadPoolBuilder::new().num_threads(served.threads).build();
        let pool = pool.map_err(|error| ServeError::System(std::io::Error::other(error)))?;
        let app = App {
            guard,
            pool: Arc::new(pool),
            jobs: Arc::default(),
            bench: Mutex::new(None),
            waiting: Mutex::new(None),
            report: Arc::default(),
            drawing: Mutex::new(()),
            served,
        };
        if let Some(place) = app.served.place.clone() {
            app.open(&place)?;
        }
        Ok(app)
    }

    /// Stops the work that goes on.
    pub fn stop(&self) {
        self.jobs.stop();
    }

    /// Answers a question.
    pub fn answer(&self, asked: &Asked) -> Answer {
        let query = |name: &str| self.query(&asked.query, name);
        match (asked.method.as_str(), asked.path.as_str()) {
            ("GET", "api/state") => self.state(query("since")).into(),
            ("GET", "api/inspection") => self.bench().map(|bench| bench.inspection().clone()).into(),
            ("GET", "api/paths") => self.bench().and_then(|bench| bench.paths()).into(),
            ("GET", "api/catalogue") => Ok(catalogue()).into(),
            ("GET", "api/schema") => Ok(State::schema()).into(),
            ("GET", "api/figure") => self.figure(&query("name").unwrap_or_default()).into(),
            ("GET", "api/commands") => self.commands().into(),
            ("GET", "api/model.toml") => match self.bench().and_then(|bench| bench.model_file()) {
                Ok(file) => Answer::file("application/toml", file.text().into_bytes(), MODEL),
                Err(trouble) => Err(trouble).into(),
            },
            ("GET", "api/export") => self.export(&query("to").unwrap_or_default()),
            ("GET", "api/report.html") => match &*self.report.lock().unwrap_or_else(PoisonError::into_inner) {
                Some(bytes) => Answer::file("text/html; charset=utf-8", bytes.clone(), "report.html"),
                None => Answer::refused(StatusCode::NOT_FOUND, "no report was made yet"),
            },
            ("POST", "api/act") => self.act(&asked.body).into(),
            ("POST", "api/predict") => match self.predict(&asked.body) {
                Ok(body) => Answer { status: StatusCode::OK, kind: "application/json", body, download: None },
                Err(trouble) => Err(trouble).into(),
            },
            ("POST", "api/formula") => read(&asked.body).and_then(|law: Law| checked(&law)).into(),
            ("POST", "api/job") => self.job(&query("kind").unwrap_or_default(), &asked.body).into(),
            ("POST", "api/cancel") => {
                self.jobs.stop();
                Ok(json!({})).into()
            }
            ("POST", "api/cloud") => {
                read(&asked.body).and_then(|asked: cloud::Asked| self.pool.install(|| asked.cloud())).into()
            }
            ("POST", "api/drop") => {
                let name = query("name").unwrap_or_default();
                dropped::begin(&self.served.drops, &name).map(|folder| json!({ "folder": folder })).into()
            }
            ("POST", "api/file") => {
                let (to, name) = (query("to").unwrap_or_default(), query("name").unwrap_or_default());
                let written = dropped::folder(&self.served.drops, &to)
                    .and_then(|folder| dropped::write(&folder, &name, &asked.body));
                written.map(|()| json!({})).into()
            }
            ("POST", "api/open") => {
                let place = dropped::folder(&self.served.drops, &query("folder").unwrap_or_default());
                place.and_then(|folder| dropped::place(&folder)).and_then(|place| self.open(&place)).into()
            }
            ("POST", "api/plate") => read(&asked.body).and_then(|plate: Plate| self.plate(&plate)).into(),
            ("POST", "api/table") => read(&asked.body).and_then(|table: Typed| self.table(&table)).into(),
            ("GET", name) => match page::file(name) {
                Some((kind, body)) => Answer { status: StatusCode::OK, kind, body, download: None },
                None => Answer::refused(StatusCode::NOT_FOUND, "there is nothing of this name"),
            },
            _ => Answer::refused(StatusCode::NOT_FOUND, "there is nothing of this name"),
        }
    }

    /// A word behind the question mark.
    fn query(&self, query: &str, name: &str) -> Option<String> {
        let pairs = query.split('&').filter_map(|pair| pair.split_once('='));
        let value = pairs.into_iter().find(|(own, _)| *own == name)?.1;
        percent_decode_str(value).decode_utf8().ok().map(std::borrow::Cow::into_owned)
    }

    fn bench(&self) -> Result<Arc<Bench>, Trouble> {
        let bench = self.bench.lock().unwrap_or_else(PoisonError::into_inner);
        bench.clone().ok_or_else(|| Trouble("No data are open: drop a log, or type returns into the table.".into()))
    }

    /// Everything that the page shows, or only that nothing has changed.
    fn state(&self, since: Option<String>) -> Result<Value, Trouble> {
        let job = self.jobs.told();
        let bench = self.bench.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let drops = self.served.drops.display().to_string();
        let Some(bench) = bench else { return Ok(json!({ "key": "empty", "job": job, "drops": drops })) };
        let key = format!("{} {} {}", bench.revision(), bench.is_prepared(), bench.place.display());
        if since.is_some_and(|since| since == key) {
            return Ok(json!({ "key": key, "job": job }));
        }
        Ok(json!({ "key": key, "job": job, "drops": drops, "bench": bench.told()? }))
    }

    /// Opens a place, or says what is missing to read it.
    fn open(&self, place: &Path) -> Result<Value, Trouble> {
        self.jobs.busy()?;
        let topics =
            if Some(place) == self.served.place.as_deref() { self.served.topics.clone() } else { Topics::default() };
        let opened = self.pool.install(|| Bench::open(place, &topics, self.served.options));
        match opened {
            Ok(bench) => {
                let bench = Arc::new(bench);
                *self.bench.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(&bench));
                bench.prepare(&self.pool);
                *self.report.lock().unwrap_or_else(PoisonError::into_inner) = None;
                Ok(json!({ "opened": place.display().to_string() }))
            }
            Err(trouble) => {
                let found = contents(place, &topics, &Words::PLAIN).unwrap_or_default();
                if found.iter().all(|log| log.wheels.is_err()) {
                    return Err(trouble);
                }
                *self.waiting.lock().unwrap_or_else(PoisonError::into_inner) = Some(place.to_owned());
                Ok(json!({ "waiting": self.asks(place, &found) }))
            }
        }
    }

    /// What has to be typed before logs can be read.
    fn asks(&self, place: &Path, found: &[LogContents]) -> Value {
        let proposal = Proposal::of(place, &self.folder_beside(place), &Topics::default(), &[], &Words::PLAIN).ok();
        let proposed = proposal.as_ref().map_or(&[][..], |proposal| &proposal.numbers);
        let number = |parameter: &Parameter| {
            let own = proposed.iter().find(|number| number.key == parameter.name);
            json!({
                "name": parameter.name, "unit": parameter.unit, "meaning": parameter.meaning,
                "value": own.and_then(|number| number.value), "source": own.map(|number| number.source.clone()),
            })
        };
        json!({
            "place": place.display().to_string(),
            "logs": found.iter().map(result::LogContents::from).collect::<Vec<_>>(),
            "numbers": Robot::NUMBERS.iter().map(number).collect::<Vec<_>>(),
        })
    }

    fn folder_beside(&self, place: &Path) -> PathBuf {
        let name = place.file_stem().map_or_else(|| "robot".into(), |name| name.to_string_lossy().into_owned());
        self.served.drops.join(format!("{name} dataset"))
    }

    /// Makes a dataset of the logs that wait, with the numbers of the robot.
    fn plate(&self, plate: &Plate) -> Result<Value, Trouble> {
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let place = waiting.ok_or_else(|| Trouble("No logs wait for their robot.".into()))?;
        let mut known = KnownNumbers::default();
        for (name, value) in &plate.numbers {
            let parameter = Robot::NUMBERS.iter().find(|parameter| parameter.name == name);
            let parameter = parameter.ok_or_else(|| Trouble(format!("A robot has no {name}.")))?;
            let value = parameter.check(*value).map_err(Trouble::because)?;
            known.push(parameter.name, value, "as typed");
        }
        let name =
            self.folder_beside(&place).file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let folder = self.served.drops.join(dropped::begin(&self.served.drops, &name)?);
        let proposal =
            Proposal::of(&place, &folder, &Topics::default(), &[known], &Words::PLAIN).map_err(Trouble::because)?;
        if !proposal.to_fill_in().is_empty() {
            let _ = std::fs::remove_dir(&folder);
            let columns = proposal.columns.join(", ");
            return Err(Trouble(match columns.is_empty() {
                true => format!("Still missing: {}.", proposal.to_fill_in().join(", ")),
                false => format!(
                    "No column is called {columns}: put a robot.toml beside the logs whose [columns] say which these are."
                ),
            }));
        }
        proposal.write(&folder, Existing::Keep).map_err(Trouble::because)?;
        self.open(&folder)
    }

    /// Makes a dataset of typed returns, or tells every mistake at its cell.
    fn table(&self, table: &Typed) -> Result<Value, Trouble> {
        self.jobs.busy()?;
        let data: Dataset = match table.dataset() {
            Ok(data) => data,
            Err(mistakes) => return Ok(json!({ "mistakes": mistakes })),
        };
        let folder = self.served.drops.join(dropped::begin(&self.served.drops, "typed returns")?);
        typed::save(&data, &folder)?;
        self.open(&folder)
    }

    fn act(&self, body: &[u8]) -> Result<Value, Trouble> {
        let (act, bench): (Act, _) = (read(body)?, self.bench()?);
        if !matches!(act, Act::Hide { .. }) {
            self.jobs.busy()?;
        }
        if act.drafts() {
            bench.wait();
        }
        self.pool.install(|| bench.act(&act))?;
        self.state(None)
    }

    fn predict(&self, body: &[u8]) -> Result<Vec<u8>, Trouble> {
        let (values, bench): (Values, _) = (read(body)?, self.bench()?);
        self.pool.install(|| bench.predict(&values))
    }

    /// Begins long work, of which some is told what to do.
    fn job(&self, kind: &str, what: &[u8]) -> Result<Value, Trouble> {
        let (bench, pool) = (self.bench()?, Arc::clone(&self.pool));
        let number = match kind {
            "fit" => self.jobs.begin("fit", move |_| {
                bench.wait();
                pool.install(|| bench.fit())
            }),
            "hold" => {
                let moved: Moved = read(what)?;
                self.jobs.begin("fit", move |_| {
                    bench.wait();
                    pool.install(|| bench.hold(&moved))
                })
            }
            "diagnose" => self.jobs.begin("diagnose", move |watch| {
                bench.wait();
                pool.install(|| bench.diagnose(watch))
            }),
            "learn" => self.jobs.begin("learn", move |watch| {
                bench.wait();
                pool.install(|| bench.learn(watch))
            }),
            "report" => {
                let (report, options, actions) = (Arc::clone(&self.report), self.served.options, self.served.actions);
                self.jobs.begin("report", move |watch| {
                    let text = pool.install(|| report_of(&bench, (options, actions), watch.progress))?;
                    *report.lock().unwrap_or_else(PoisonError::into_inner) = Some(text.into_bytes());
                    Ok(())
                })
            }
            _ => Err(Trouble(format!("There is no work called \"{kind}\"."))),
        }?;
        Ok(json!({ "number": number }))
    }

    /// A figure of the model that is looked at.
    fn figure(&self, name: &str) -> Result<Value, Trouble> {
        let kind = kind::find(name).ok_or_else(|| Trouble(format!("There is no figure called \"{name}\".")))?;
        let study = self.bench()?.study()?;
        let drawing = self.drawing.lock().unwrap_or_else(PoisonError::into_inner);
        let figure = self.pool.install(|| (kind.build)(&study));
        drop(drawing);
        let figure = match figure {
            Ok(figure) => figure,
            Err(absent) => return Ok(json!({ "absent": absent.to_string() })),
        };
        let legend: Vec<_> = legend::entries(&figure)
            .iter()
            .map(|(name, tone, mark)| json!([name, tone.name(), legend::word(mark, *tone)]))
            .collect();
        let runs: Vec<_> = study.data.runs.iter().map(|run| run.name.clone()).collect();
        Ok(json!({
            "plot": plotly::figure(&figure), "rolled": plotly::rolled(&figure), "title": figure.title, "told": figure.told, "legend": legend, "table": figure.table, "runs": runs,
        }))
    }

    /// The file of a target of `export`.
    fn export(&self, to: &str) -> Answer {
        let written = || {
            let target = Exported::named(to).ok_or_else(|| Trouble(format!("There is no target called \"{to}\".")))?;
            let file = self.bench()?.model_file()?;
            let export = Export { noise: file.noise, ..Export::of(&file.model) };
            target.write(&export).map_err(Trouble::because)
        };
        match written() {
            Ok(written) => Answer::file("text/plain; charset=utf-8", written.text.into_bytes(), &format!("{to}.txt")),
            Err(trouble) => Err(trouble).into(),
        }
    }

    /// The commands that repeat the work.
    fn commands(&self) -> Result<Value, Trouble> {
        let bench = self.bench()?;
        let place = shell_word(&bench.place.display().to_string());
        let (step, draft) = bench.step();
        let model = bench.model()?;
        let own = model.has_formulas();
        let mut lines = vec![format!("umbmark inspect {place}")];
        if step.learnt && !draft {
            lines.push(format!("umbmark learn {place} -o {MODEL}"));
        } else if own || model.parts().iter().any(|part| !part.fixed.is_empty()) || !model.is_free() {
            lines.push(format!(
                "umbmark fit {place} --model my_{MODEL} -o {MODEL}    # my_{MODEL}: the model taken away here"
            ));
        } else {
            let adds =
                model.parts().iter().filter(|part| part.free).map(|part| format!(" --add {}", part.effect.name()));
            lines.push(format!("umbmark fit {place}{} -o {MODEL}", adds.collect::<String>()));
        }
        lines.push(format!("umbmark diagnose {place} --model {MODEL}"));
        lines.push(format!("umbmark compare {place} --model {MODEL}"));
        lines.push(format!("umbmark report {place} --model {MODEL} -o report.html"));
        lines.push(format!("umbmark export {MODEL} --to ros2_control -o robot.yaml"));
        Ok(json!({ "commands": lines }))
    }
}

/// The page of `report` for the model that is looked at.
fn report_of(
    bench: &Bench,
    (options, actions): (umbmark_core::diagnose::Options, Wording),
    progress: &(dyn Fn(f64) + Sync),
) -> Result<String, Trouble> {
    let model = bench.model()?;
    let made = Options { diagnose: options, ..Options::default() };
    let study = Study::new(bench.name(), Arc::clone(&bench.data), Some((MODEL.to_owned(), model)), made);
    let command = format!("umbmark report {} --model {MODEL}", shell_word(&bench.place.display().to_string()));
    let files = Origin::of_dataset(&bench.place).map_err(Trouble::because)?;
    let provenance = Provenance { version: umbmark_core::VERSION.to_owned(), seed: options.seed, command, files };
    let all = kind::KINDS.len() as f64;
    page(&[study], &provenance, actions, |done| progress(done as f64 / all)).map_err(Trouble::because)
}

/// A JSON body.
fn read<T: DeserializeOwned>(body: &[u8]) -> Result<T, Trouble> {
    serde_json::from_slice(body).map_err(|error| Trouble(format!("This is not understood: {error}.")))
}

/// Whether a formula is one.
fn checked(law: &Law) -> Result<Value, Trouble> {
    formula_of(&law.name, &law.acts_on, &law.formula, &law.parameters)?;
    Ok(json!({}))
}

/// Effects, what formulas act on and may depend on, figures, targets, and robots of the paper.
fn catalogue() -> Value {
    json!({
        "effects": CATALOGUE.iter().map(|entry| result::Effect::from(*entry)).collect::<Vec<_>>(),
        "acts_on": Target::ALL.map(Target::name),
        "variables": Formula::variables(),
        "figures": kind::all().map(|kind| json!({ "name": kind.name, "about": kind.about })).collect::<Vec<_>>(),
        "targets": TARGETS.iter().map(|target| json!({ "name": target.name, "about": target.about })).collect::<Vec<_>>(),
        "plate": Robot::NUMBERS.iter().map(|p| json!({ "name": p.name, "unit": p.unit, "meaning": p.meaning, "usual": usual(p) })).collect::<Vec<_>>(),
        "paper": of_the_paper(),
        "version": umbmark_core::VERSION,
    })
}

/// The LabMates of Table I: what the cloud is drawn with, and what was published.
fn of_the_paper() -> Vec<Value> {
    let labmates = PRESETS.iter().filter(|preset| preset.robot().drive.kind() == DriveKind::Differential);
    let one = |preset: &Preset| {
        let model = preset.model().ok()?;
        let [e_d, e_b, _] = Correction::of(&model).values();
        let noise = model.values().nth(model.place_of("wheel_noise", "k_sqrt_m")?)?;
        let Published { row, e_max_sys, sigma } = preset.published;
        Some(json!({ "row": row, "e_d": e_d, "e_b": e_b, "noise": noise, "e_max_sys_m": e_max_sys, "sigma_m": sigma }))
    };
    labmates.filter_map(one).collect()
}

/// The value of the paper's robot.
fn usual(parameter: &Parameter) -> Option<f64> {
    Robot::labmate().number(parameter.name)
}

/// A word as shells take it.
fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}
