//! The arguments of every verb that reads measurements.

use std::path::{Path, PathBuf};

use umbmark_core::dataset::Dataset;
use umbmark_core::drive::Robot;
use umbmark_core::evidence::memory_of_tests;
use umbmark_io::{DatasetError, Topics, memory_to_read};

use crate::Session;

/// Where the measurements are.
#[derive(Debug, clap::Args)]
pub struct DataArguments {
    /// A dataset folder, an OptiOdom folder, or one file of either (returns.csv, a log in CSV or MCAP, a bag of ROS 1 or 2);
    /// several of one robot are read as one
    #[arg(value_name = "DATA", required = true)]
    pub places: Vec<PathBuf>,

    #[command(flatten)]
    topics: TopicArguments,
}

/// What is read of MCAP files and bags.
#[derive(Debug, clap::Args)]
pub struct TopicArguments {
    /// Topic of the wheels in MCAP files and bags, if it is not found by type; append :LEFT,RIGHT for the names of the joints, or
    /// :left,right or :right,left for the order in a list of counts
    #[arg(long, value_name = "TOPIC", help_heading = "MCAP files and bags")]
    ticks: Option<String>,

    /// Topic of the absolute poses in MCAP files and bags; append :FRAME to choose one of several transforms; "none" reads no poses
    #[arg(long, value_name = "TOPIC", help_heading = "MCAP files and bags")]
    reference: Option<String>,
}

impl DataArguments {
    /// What was said of topics.
    pub fn topics(&self) -> Topics {
        self.topics.topics()
    }

    /// Reads them.
    pub fn load(&self, session: &Session) -> anyhow::Result<Dataset> {
        self.say_needs(session)?;
        Ok(self.read()?)
    }

    /// Reads them to test error sources.
    pub fn load_to_test(&self, session: &Session) -> anyhow::Result<Dataset> {
        let data = self.load(session)?;
        session.needs(memory_of_tests(&data))?;
        Ok(data)
    }

    /// Says how much memory reading needs, or refuses it.
    pub fn say_needs(&self, session: &Session) -> anyhow::Result<()> {
        session.needs(self.places.iter().map(memory_to_read).sum())
    }

    /// Reads them, whatever that needs.
    pub fn read(&self) -> Result<Dataset, DatasetError> {
        umbmark_io::load_together(&self.places, &self.topics())
    }

    /// Reads logs that are of a robot, where no other stands beside them.
    pub fn load_of(&self, robot: &Robot) -> Result<Dataset, DatasetError> {
        umbmark_io::load_together_of(&self.places, &self.topics(), robot)
    }

    /// The places, for people.
    pub fn named(&self) -> String {
        self.places.iter().map(|place| place.display().to_string()).collect::<Vec<_>>().join(", ")
    }
}

impl TopicArguments {
    /// What was said of topics.
    pub fn topics(&self) -> Topics {
        Topics { ticks: self.ticks.clone(), reference: self.reference.clone() }
    }

    /// The flags again, for a command that is proposed.
    pub fn said(&self) -> String {
        let flags = [("--ticks", &self.ticks), ("--reference", &self.reference)];
        let given = flags.into_iter().filter_map(|(flag, value)| Some((flag, value.as_ref()?)));
        given.map(|(flag, value)| format!(" {flag} {}", shlex::try_quote(value).unwrap_or_default())).collect()
    }

    /// Reads a dataset.
    pub fn load(&self, place: &Path) -> Result<Dataset, DatasetError> {
        umbmark_io::load_with(place, &self.topics())
    }

    /// Reads a dataset to test error sources: what that needs is said first, or refused.
    pub fn load_to_test(&self, place: &Path, session: &Session) -> anyhow::Result<Dataset> {
        session.needs(memory_to_read(place))?;
        let data = self.load(place)?;
        session.needs(memory_of_tests(&data))?;
        Ok(data)
    }
}
