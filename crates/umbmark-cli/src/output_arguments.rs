//! The arguments of every verb that writes a dataset.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use umbmark_core::dataset::Dataset;
use umbmark_io::whole_file::is_standard_output;
use umbmark_io::{DatasetError, Existing, Layout};

use crate::prose::hanging;

/// Where a dataset goes, and how.
#[derive(Debug, clap::Args)]
pub struct OutputArguments {
    /// Folder to write; or NAME.mcap for one run as a log of ROS 2
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,

    /// The layout to write [default: csv, and mcap for NAME.mcap]
    #[arg(long, value_name = "LAYOUT", value_parser = names())]
    to: Option<String>,

    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(Layout::written().map(|layout| layout.name))
}

/// The layouts, for the end of a verb's help.
pub fn layouts() -> String {
    let lines = Layout::written().map(|layout| hanging(&format!("  {}", layout.name), 12, layout.about));
    format!("Layouts:\n{}", lines.collect::<String>())
}

impl OutputArguments {
    /// The layout that was asked for, by name or by the ending of the place.
    pub fn layout(&self) -> &'static Layout {
        self.to.as_deref().and_then(Layout::named).unwrap_or_else(|| Layout::of_place(&self.output))
    }

    /// Writes a dataset; says what is lost.
    pub fn write(&self, data: &Dataset) -> Result<Vec<String>, DatasetError> {
        let existing = if self.force { Existing::Replace } else { Existing::Keep };
        if is_standard_output(&self.output) {
            let (file, reason) = (
                self.output.display().to_string(),
                "a dataset is a folder, and standard output cannot hold one".into(),
            );
            return Err(DatasetError::Unwritable { file, reason });
        }
        self.layout().write(data, &self.output, existing)
    }
}
