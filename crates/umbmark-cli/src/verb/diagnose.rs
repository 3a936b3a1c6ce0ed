//! `umbmark diagnose`: which class of effects a model is missing.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{
    Detectable, Diagnosis, Experiment, GoodnessOfFit, Identifiability, Options, Suspect, Verdict, diagnose,
};
use umbmark_core::evidence::Level;
use umbmark_core::result;

use crate::Session;
use crate::data_arguments::DataArguments;
use crate::model_report::{
    circle_table, contrasts_table, estimates_table, meaning_text, model_of, outliers_text, p_text, unit_of,
};
use crate::prose::{details_text, hanging};
use crate::setup_report::{disturbances_text, faults_text, reasons_text, remains_text, taken_text};
use crate::table::{table, with_precision_of};
use crate::test_arguments::TestArguments;
use crate::unlisted::missing_text;

/// So many experiments are printed; --json has all.
const EXPERIMENTS: usize = 3;

/// Arguments of `diagnose`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    data: DataArguments,

    /// The model to test; its free effects are fitted [default: E_d and E_b, on tracks E_s too]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,

    #[command(flatten)]
    test: TestArguments,

    /// Exit with code 3 if the model does not explain the data
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let data = arguments.data.load_to_test(session)?;
    let model = model_of(arguments.model.as_deref(), &data, session)?;
    let options = arguments.test.options(session);
    let diagnosis = session.on_threads(|| diagnose(&data, &model, &options))??;
    for warning in data.warnings.iter().filter(|_| !session.json()) {
        session.message("warning", warning);
    }
    if session.json() {
        session.print_json(&result::Diagnosis::new(&diagnosis, &options))?;
    } else {
        let look = (session.on_terminal(), session.verbose());
        let text = text(&data, &diagnosis, &options, look);
        write!(session.out(), "{text}")?;
    }
    Ok(match diagnosis.verdict {
        Verdict::Explained => ExitCode::SUCCESS,
        _ if !arguments.check => ExitCode::SUCCESS,
        // Runs that test nothing are no reason to pass.
        Verdict::NotEnoughData => ExitCode::FAILURE,
        _ => ExitCode::from(3),
    })
}

/// A verdict in a sentence.
pub(super) fn in_words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Explained => {
            "explained: the model accounts for the measured error, and no test shows a further effect"
        }
        Verdict::MissingEffect => "the robot has an error source that the model lacks",
        Verdict::SeveralMissing => "the robot has several error sources that the model lacks",
        Verdict::UnlistedEffect => "the robot has an error source that no single effect of the catalogue explains",
        Verdict::NotEnoughData => "not enough data to test the model",
        Verdict::NotExplained => {
            "not explained: the model does not account for the measured error, but no single missing effect is certified"
        }
    }
}

/// The verdict, what to do, what is left and the fitted values; the tables of the tests behind that where they are wanted.
pub fn text(data: &Dataset, diagnosis: &Diagnosis, options: &Options, (terminal, verbose): (bool, bool)) -> String {
    let robot = data.robot.as_ref().map_or("", |robot| robot.name.as_str());
    let from = match diagnosis.level {
        Level::Ends => "return poses",
        Level::Tracks => "tracks",
    };
    let mut text = format!("Diagnosis of {robot} from {from}\n\n");
    text += &hanging("verdict", 10, in_words(diagnosis.verdict));
    text += &(faults_text(&diagnosis.setup) + &reasons_text(&diagnosis.reasons));
    for suspect in diagnosis.certified() {
        text += &hanging("missing", 10, &suspect.class.join(" or "));
        let said = suspect.meaning(diagnosis.model.robot());
        text += &said.map_or_else(String::new, |said| hanging("", 10, &said));
    }
    text += &next_text(diagnosis);
    let found = taken_text(&diagnosis.taken) + &disturbances_text(&diagnosis.setup);
    let left = outliers_text(&diagnosis.outliers, &diagnosis.setup) + &remains_text(diagnosis.remains.as_ref());
    let notes: String = diagnosis.remarks.iter().map(|remark| hanging("note", 10, remark)).collect();
    let details = found + &left + &notes;
    text += &if details.is_empty() { details } else { format!("\n{details}") };
    text += &missing_text(diagnosis, terminal);
    if !diagnosis.fitted.is_empty() {
        text += &format!("\n{}\n", estimates_table(&diagnosis.fitted, 1.0 - options.size));
        text += &meaning_text(&diagnosis.fitted, &diagnosis.model);
    }
    if verbose {
        text += &tests_text(diagnosis);
    }
    text += &unseen_text(diagnosis);
    if !verbose {
        text += &details_text("every test, and the smallest size of each effect that these runs would show");
    }
    text
}

/// All tests, and what the runs would have shown.
fn tests_text(diagnosis: &Diagnosis) -> String {
    let mut text = ranking_text(&diagnosis.ranking);
    text += &whole_model_text(&diagnosis.goodness_of_fit);
    text += &identifiability_text(&diagnosis.identifiability);
    if !diagnosis.contrasts.is_empty() {
        text += &format!("\n{}\n", contrasts_table(&diagnosis.contrasts));
    }
    if !diagnosis.circle.is_empty() {
        text += &format!("\n{}\n", circle_table(&diagnosis.circle));
    }
    text + &sizes_text(diagnosis)
}

/// What to do now: with the model, and with the robot.
fn next_text(diagnosis: &Diagnosis) -> String {
    let with_the_model = match diagnosis.verdict {
        Verdict::Explained => "use the model; the end of this text lists what these runs cannot show.",
        Verdict::MissingEffect | Verdict::SeveralMissing => {
            "umbmark learn adds the missing effect, fits it, and prints the cross-validated error with it."
        }
        Verdict::UnlistedEffect => {
            "umbmark learn --model FILE tries your own formula; umbmark compare shows where the error is made."
        }
        Verdict::NotEnoughData => {
            "drive at least three runs each way; umbmark plan says how many runs show which effect."
        }
        Verdict::NotExplained => "correct what the reasons name, then diagnose again; umbmark inspect checks the data.",
    };
    let mut text = format!("\nnext\n{}", hanging("", 2, with_the_model));
    if !diagnosis.next_experiments.is_empty() {
        text += "  further drives, the most informative per minute first\n";
        text += &experiments_text(&diagnosis.next_experiments);
    }
    text
}

/// The tests of the model as a whole, a row each.
fn whole_model_text(tests: &[GoodnessOfFit]) -> String {
    let row = |test: &GoodnessOfFit| {
        let freedom = test.degrees_of_freedom.map_or_else(String::new, |[a, b]| format!("F({a}, {b}) = "));
        vec![test.name.to_owned(), format!("{freedom}{:.2}", test.statistic), p_text(test.p)]
    };
    if tests.is_empty() {
        return String::new();
    }
    format!("\n{}\n", table(&["the model as a whole", "", "p"], tests.iter().map(row)))
}

fn identifiability_text(identifiability: &Identifiability) -> String {
    if identifiability.hidden.is_empty() {
        return String::new();
    }
    let row = |s: &umbmark_core::diagnose::Share| {
        let percent = |value: f64, scale: f64| format!("{:.2}", 0.01 * scale * value);
        vec![s.parameter.to_owned(), percent(s.position, 1e3), percent(s.heading, 1f64.to_degrees())]
    };
    let header = ["1 % of", "moves the end [mm]", "turns it [deg]"];
    let mut text = format!("\n{}\n", table(&header, identifiability.shares.iter().map(row)));
    for hidden in &identifiability.hidden {
        let names: Vec<&str> = hidden.weights.iter().map(|(name, _)| *name).collect();
        let said = match hidden.ratio {
            Some(ratio) => format!("{} acts like {ratio:.2} times as much {}", names[0], names[1]),
            None => format!("{} cannot be seen", names.join(" with ")),
        };
        text += &hanging("hidden", 10, &format!("rank {}: {said}", identifiability.rank));
    }
    text
}

/// So many suspects are printed; --json has all.
const SUSPECTS: usize = 8;

fn ranking_text(ranking: &[Suspect]) -> String {
    if ranking.is_empty() {
        return String::new();
    }
    let row = |s: &Suspect| {
        let e = &s.estimate[0];
        let error = with_precision_of(e.standard_error, e.standard_error);
        let unit = unit_of(e.effect, e.parameter);
        vec![
            s.best.to_owned(),
            format!("{} ± {error}{unit}", with_precision_of(e.value, e.standard_error)),
            format!("{:.1}", s.f),
            p_text(s.p),
            p_text(s.p_adjusted),
        ]
    };
    let mut text = String::from("\neffects tested, the likeliest first (adjusted p: for the number of tests)\n\n");
    let told = &ranking[..ranking.len().min(SUSPECTS)];
    text += &table(&["effect", "size", "F", "p", "adjusted p"], told.iter().map(row));
    text += "\n";
    for suspect in told.iter().filter(|suspect| suspect.class.len() > 1) {
        let others: Vec<&str> = suspect.class.iter().copied().filter(|name| *name != suspect.best).collect();
        text += &hanging("", 2, &format!("{} cannot be distinguished from {}", suspect.best, others.join(" or ")));
    }
    if let rest @ 1.. = ranking.len() - told.len() {
        text += &hanging("", 2, &format!("and {rest} more (--json)"));
    }
    text
}

/// How large each effect must be to be seen.
fn sizes_text(diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    let sizes = diagnosis.least_sizes();
    if !sizes.is_empty() {
        text += "\nsmallest sizes that this test would show with 80 % probability\n";
        let one = |d: &&Detectable| format!("{} {:.2e}", d.parameter, d.size);
        for effect in &sizes {
            let own: Vec<String> = effect.iter().map(one).collect();
            text += &hanging(&format!("  {}", effect[0].effect), 34, &own.join(", "));
        }
    }
    text + &diagnosis.confounding().map_or_else(String::new, |told| format!("\n{}", hanging("", 0, &told)))
}

/// What these runs cannot show.
fn unseen_text(diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    let (absorbed, below) = (diagnosis.absorbed(), diagnosis.below_noise());
    if !(absorbed.is_empty() && below.is_empty()) {
        text += "\nthis test cannot show\n";
    }
    for (by, names) in absorbed {
        text += &hanging("", 2, &format!("indistinguishable from {} here: {}", by.join(" with "), names.join(", ")));
    }
    if !below.is_empty() {
        text += &hanging("", 2, &format!("smaller than the scatter at the usual size: {}", below.join(", ")));
    }
    text
}

fn experiments_text(experiments: &[Experiment]) -> String {
    let mut text = String::new();
    for e in experiments.iter().take(EXPERIMENTS) {
        text += &hanging("  -", 4, &experiment_text(e));
    }
    if let rest @ 1.. = experiments.len().saturating_sub(EXPERIMENTS) {
        text += &hanging("", 4, &format!("and {rest} more (--json)"));
    }
    text
}

/// An experiment with what it separates, in a line.
pub(super) fn experiment_text(e: &Experiment) -> String {
    let [own, other] = e.separates.map(|name| match name.strip_prefix("law_") {
        Some(number) => format!("law {number} of the table"),
        None => name.to_owned(),
    });
    let sure = format!("{:.1} standard deviations expected, {:.0} min of driving", e.sd, e.minutes);
    format!("{}; separates {own} from {other} ({sure})", e.experiment)
}
