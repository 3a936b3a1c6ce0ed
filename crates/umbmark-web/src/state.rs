//! What the page shows of a user's work, as one JSON document that is written beside the data.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use umbmark_core::effect::Model;
use umbmark_core::result;
use umbmark_io::Existing;
use umbmark_io::whole_file::{FileError, WholeFile};

use crate::words;

/// The version of the document.
pub const VERSION: u32 = 1;
/// Its name in a folder of data, and the end of its name beside a file. Programs that read data pass over names with a point before them.
const NAME: &str = ".workbench.json";
/// A document is never longer \[bytes\].
const LONGEST: u64 = 16 << 20;

/// The work on one dataset: the models in the order in which they were made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Version of this document.
    pub version: u32,
    /// Grows with each change.
    pub revision: u64,
    /// The accepted models, from the nominal robot on.
    pub steps: Vec<Step>,
    /// Number of the step that is looked at, from 0.
    pub at: usize,
    /// A model that is tried and not accepted yet; null if there is none.
    pub draft: Option<Draft>,
    /// Names of the runs that are not drawn. All runs are fitted.
    pub hidden: Vec<String>,
}

/// Root mean square errors of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Errors {
    /// Error of positions in the runs that the model was fitted to, in m.
    pub rmse_m: Option<f64>,
    /// The same of headings, in rad; null where none were measured.
    pub heading_rmse_rad: Option<f64>,
    /// Error of positions in held-out runs, in m; null where nothing was fitted.
    pub heldout_rmse_m: Option<f64>,
    /// The same of headings, in rad.
    pub heldout_heading_rmse_rad: Option<f64>,
    /// Akaike's information criterion, corrected for few runs; null where these are too few.
    pub aicc: Option<f64>,
}

impl From<&result::Step> for Errors {
    fn from(step: &result::Step) -> Errors {
        Errors {
            rmse_m: step.rmse_m,
            heading_rmse_rad: step.heading_rmse_rad,
            heldout_rmse_m: step.heldout_rmse_m,
            heldout_heading_rmse_rad: step.heldout_heading_rmse_rad,
            aicc: step.aicc,
        }
    }
}

/// An accepted model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// What was done, in a few words.
    pub words: String,
    /// Whether `learn` did it, rather than the user.
    pub learnt: bool,
    /// The model as text of a model.toml.
    pub model: String,
    /// Names of its effects.
    pub effects: Vec<String>,
    /// p of the effect that was added, corrected for all that were tested; null where nothing was tested.
    pub p_adjusted: Option<f64>,
    /// Its errors.
    pub errors: Errors,
}

/// A model that is tried.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Draft {
    /// What was done, in a few words.
    pub words: String,
    /// The model as text of a model.toml.
    pub model: String,
    /// Its errors; of held-out runs only once it is fitted.
    pub errors: Errors,
    /// Whether its free values are fitted.
    pub fitted: bool,
    /// The number that was held while the others were fitted; null where all were. The next fit is free to change it.
    #[serde(default)]
    pub held: Option<Held>,
    /// p of the effect that was added, as it was suggested; null where nothing was tested.
    pub p_adjusted: Option<f64>,
}

/// A number of a model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Held {
    /// Its effect.
    pub effect: String,
    /// Its name there.
    pub parameter: String,
}

impl Held {
    /// Whether it is this number.
    pub fn is(&self, effect: &str, parameter: &str) -> bool {
        self.effect == effect && self.parameter == parameter
    }

    /// Whether fits of a model keep it although its effect is free.
    pub fn is_fixed(&self, model: &Model) -> bool {
        let own = model.parts().iter().filter(|part| part.effect.name() == self.effect);
        own.into_iter().any(|part| part.fixed.iter().any(|name| *name == self.parameter))
    }

    /// That it is held, and at which value; `None` if the model does not have it.
    pub fn words(&self, model: &Model) -> Option<String> {
        let value = model.get(&self.effect, &self.parameter)?;
        Some(words::held(&self.effect, &self.parameter, value))
    }
}

/// Why a document is not read.
#[derive(Debug, thiserror::Error)]
pub enum StateError {
    /// The system does not let us.
    #[error("{}: cannot be read: {error}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// It is not one.
    #[error("{}: is no document of the workbench: {why}; move it away to begin anew", file.display())]
    Wrong {
        /// The file.
        file: PathBuf,
        /// Why.
        why: String,
    },
}

impl State {
    /// The file of a place: in a folder of data, or beside a file.
    pub fn file_of(place: &Path) -> PathBuf {
        if place.is_dir() {
            return place.join(NAME);
        }
        let name = place.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        place.with_file_name(format!(".{name}{NAME}"))
    }

    /// Reads a document, if there is one.
    pub fn read(file: &Path) -> Result<Option<State>, StateError> {
        let failed = |error| StateError::Read { file: file.to_owned(), error };
        let wrong = |why: String| StateError::Wrong { file: file.to_owned(), why };
        let length = match std::fs::metadata(file) {
            Ok(found) if found.is_file() => found.len(),
            Ok(_) => return Err(wrong("it is no file".into())),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(failed(error)),
        };
        if length > LONGEST {
            return Err(wrong(format!("it has {length} bytes")));
        }
        let text = std::fs::read_to_string(file).map_err(failed)?;
        let state: State = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        if state.version != VERSION {
            return Err(wrong(format!("its version is {}, and {VERSION} is read", state.version)));
        }
        if state.steps.is_empty() || state.at >= state.steps.len() {
            return Err(wrong("it has no step that is looked at".into()));
        }
        Ok(Some(state))
    }

    /// Writes the document beside and renames it.
    pub fn write(&self, file: &Path) -> Result<(), FileError> {
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        WholeFile::write(file, Existing::Replace, text.as_bytes())
    }

    /// The schema of the document.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(State).to_value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> State {
        let errors = Errors { rmse_m: Some(0.1 + 0.2), ..Errors::default() };
        let step = Step { words: "nominal robot".into(), model: "[robot]\n".into(), errors, ..Step::default() };
        State { version: VERSION, revision: 7, steps: vec![step], ..State::default() }
    }

    #[test]
    fn a_document_reads_back_to_the_last_bit_and_nothing_else_is_left_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = State::file_of(folder.path());
        assert_eq!(State::read(&file).unwrap(), None);
        some().write(&file).unwrap();
        assert_eq!(State::read(&file).unwrap(), Some(some()));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_draft_that_tells_of_no_held_number_holds_none() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.json");
        let held = Some(Held { effect: "wheelbase".into(), parameter: "e_b".into() });
        let state = State { draft: Some(Draft { held, ..Draft::default() }), ..some() };
        state.write(&file).unwrap();
        assert_eq!(State::read(&file).unwrap(), Some(state.clone()));
        let mut written = serde_json::to_value(&state).unwrap();
        written["draft"].as_object_mut().unwrap().remove("held");
        std::fs::write(&file, written.to_string()).unwrap();
        let read = State::read(&file).unwrap().and_then(|state| state.draft).unwrap();
        assert_eq!(read, Draft::default());
    }

    #[test]
    fn a_document_that_is_none_is_refused_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.json");
        let mut later = some();
        later.version = 2;
        let mut beyond = some();
        beyond.at = 1;
        let texts = [
            ("{", "EOF while parsing"),
            ("{\"version\":1}", "missing field"),
            (&serde_json::to_string(&later).unwrap(), "its version is 2"),
            (&serde_json::to_string(&beyond).unwrap(), "no step that is looked at"),
        ];
        for (text, why) in texts {
            std::fs::write(&file, text).unwrap();
            let told = State::read(&file).unwrap_err().to_string();
            assert!(told.contains(why) && told.contains("a.json"), "{told}");
        }
    }

    #[test]
    fn the_schema_names_every_field_and_its_meaning() {
        let schema = State::schema();
        let written = serde_json::to_value(some()).unwrap();
        let keys = written.as_object().unwrap().keys();
        let told = |key: &String| schema["properties"][key]["description"].is_string();
        assert!(keys.clone().count() == 6 && keys.into_iter().all(told), "{schema}");
    }
}
