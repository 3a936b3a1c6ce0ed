//! What a user does next with this tool, as data. Sentences and errors leave a place for it; the command puts a verb there, Python a call.

/// Something to do with this tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Action {
    /// Look up the effects of the catalogue and their parameters.
    ListEffects,
    /// Write a robot.toml and an empty return sheet to fill in.
    Begin,
    /// See whether the data are good.
    CheckData,
    /// See what a log holds.
    CheckLog,
    /// Check, score and calibrate by a return sheet that was filled in.
    ReadReturns,
    /// See how large the errors are.
    Score,
    /// Learn a model from the data.
    Learn,
    /// Write the new numbers to a file for the robot.
    WriteNumbers,
    /// Fit a model without its other effects, and write its numbers to a file for the robot.
    WriteFitted,
    /// Write the whole model as a table for the robot.
    WriteTable,
    /// Correct logs by a model.
    CorrectLogs,
}

/// How an edge says how something is done: code that stands for a noun, as in "`umbmark effects`".
pub type Wording = fn(Action) -> &'static str;

impl Action {
    /// Every action there is.
    pub const ALL: [Action; 11] = [
        Action::ListEffects,
        Action::Begin,
        Action::CheckData,
        Action::CheckLog,
        Action::ReadReturns,
        Action::Score,
        Action::Learn,
        Action::WriteNumbers,
        Action::WriteFitted,
        Action::WriteTable,
        Action::CorrectLogs,
    ];

    /// The same without a name of a command or of a function, for programs that have words of their own.
    pub fn plain(self) -> &'static str {
        match self {
            Action::ListEffects => "the catalogue",
            Action::Begin => "a new dataset",
            Action::CheckData => "an inspection",
            Action::CheckLog => "an inspection",
            Action::ReadReturns => "inspection, score and calibration",
            Action::Score => "the score",
            Action::Learn => "the learnt model",
            Action::WriteNumbers => "export the learnt model",
            Action::WriteFitted => "fit a model without them, and export it",
            Action::WriteTable => "export it as a table",
            Action::CorrectLogs => "odometry by the whole model",
        }
    }

    /// What is said behind an error that this is the way out of.
    ///
    /// ```
    /// use umbmark_core::action::Action;
    /// assert_eq!(Action::ListEffects.remedy(Action::plain), "the catalogue lists them");
    /// ```
    pub fn remedy(self, words: Wording) -> String {
        let done = words(self);
        match self {
            Action::ListEffects => format!("{done} lists them"),
            Action::Begin => format!("{done} writes one to fill in"),
            Action::CheckLog => format!("{done} tells what is in it"),
            Action::CorrectLogs => format!("{done} corrects them"),
            _ => done.to_owned(),
        }
    }
}
