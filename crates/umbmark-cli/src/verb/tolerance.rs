//! `umbmark tolerance`: how many robots are good enough, and the cheapest tolerances that make it enough.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use umbmark_core::monte_carlo::Metric;
use umbmark_core::result::{self, Wanted};
use umbmark_core::sensitivity::tolerance::{Choice, Findings, Target, Tolerances, Varied};
use umbmark_core::sensitivity::{Correlation, Noise, Tests};
use umbmark_io::read_parameters;

use crate::Session;
use crate::distribution_text::distribution_words;
use crate::ensemble_report::unit;
use crate::prose::{hanging, wrapped};
use crate::study_flags::StudyFlags;
use crate::table::{table, with_precision_of};
use crate::terminal::histogram;

/// Arguments of `tolerance`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The parameters with their distributions, and the grades of each with their costs
    #[arg(value_name = "parameters.toml")]
    file: PathBuf,

    /// Largest allowed value of the metric: 50mm, or 2deg for a heading
    #[arg(long, value_name = "SIZE", value_parser = size, default_value = "50mm")]
    target: (f64, bool),

    /// The share of robots that must keep the target
    #[arg(long, value_name = "SHARE", value_parser = crate::numbers::probability, default_value = "0.95")]
    share: f64,

    /// The metric of the target; of a metric with a sign its absolute value
    #[arg(long, value_name = "METRIC", default_value = "e_max_sys_m")]
    metric: String,

    /// Robots drawn for each choice of grades
    #[arg(short = 'n', long, value_name = "N", default_value_t = 10_000, value_parser = crate::numbers::whole)]
    robots: u64,

    /// Apply the target to whole tests with their noise, instead of the robot's own systematic error
    #[arg(long)]
    with_noise: bool,

    #[command(flatten)]
    study: StudyFlags,
}

/// A length or an angle with its unit, in SI, and whether it is an angle.
fn size(text: &str) -> Result<(f64, bool), String> {
    let Some(degrees) = text.strip_suffix("deg") else { return super::mc::length(text).map(|metres| (metres, false)) };
    let value = crate::numbers::number(degrees.trim())?;
    if value > 0.0 { Ok((value.to_radians(), true)) } else { Err("must be positive".to_owned()) }
}

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let (study, known) = arguments.study.resolve(1, session.seed())?;
    let file = read_parameters(&arguments.file, &study)?;
    let metric = Metric::named(&arguments.metric)?;
    let (at_most, is_angle) = arguments.target;
    let wanted = if metric.is_angle() { "an angle, as in 2deg" } else { "a length, as in 50mm" };
    anyhow::ensure!(is_angle == metric.is_angle(), "--target: {} needs {wanted}", metric.name());
    let noise = if arguments.with_noise { Noise::Simulated } else { Noise::Absent };
    let first: Vec<_> = file.parameters.iter().map(|one| (one.quantity, one.grades[0].distribution)).collect();
    let tests = Tests::new(&study, &first, noise)?;
    let output = tests.metrics().iter().position(|one| *one == metric);
    let output = output.ok_or_else(|| anyhow::anyhow!("{} is not a metric of these tests", metric.name()))?;
    let target = Target { output, at_most, share: arguments.share };
    let correlations: Vec<Correlation> =
        file.correlations.iter().map(|(of, value)| Correlation { of: *of, value: *value }).collect();
    let tolerances = Tolerances {
        tests: &tests,
        parameters: &file.parameters,
        correlations: &correlations,
        robots: arguments.robots,
        seed: session.seed(),
    };
    let findings = session.watched("% of all choices", |watch| tolerances.search(&target, watch))??;
    let assumed = if arguments.with_noise { known.assumed } else { Vec::new() };
    let report = Report {
        findings: &findings,
        parameters: &file.parameters,
        target: &target,
        metric,
        assumed: &assumed,
        with_noise: arguments.with_noise,
        seed: session.seed(),
    };
    if findings.partial {
        session.message("partial", "stopped before all choices were tested");
    }
    if session.json() {
        let wanted = Wanted {
            parameters: &file.parameters,
            metric,
            target: &target,
            noise,
            seed: session.seed(),
            assumed: &assumed,
        };
        session.print_json(&result::Tolerance::new(&findings, &wanted))?;
    } else {
        let text = report.text(session.on_terminal());
        write!(session.out(), "{text}")?;
    }
    Ok(ExitCode::SUCCESS)
}

/// What was asked and found.
#[derive(Debug)]
pub struct Report<'a> {
    /// What was found.
    pub findings: &'a Findings,
    /// The parameters with their grades.
    pub parameters: &'a [Varied],
    /// What is to be kept.
    pub target: &'a Target,
    /// Its metric.
    pub metric: Metric,
    /// What was assumed.
    pub assumed: &'a [String],
    /// Whether whole tests with their noise are judged.
    pub with_noise: bool,
    /// Seed of the robots.
    pub seed: u64,
}

impl Report<'_> {
    /// The robots' histogram, the table of choices, and what to buy; in characters beyond ASCII where they are shown.
    pub fn text(&self, unicode: bool) -> String {
        let (unit, factor) = unit(self.metric);
        let now = &self.findings.now;
        let kind = if self.with_noise { "in whole tests with their noise" } else { "the robots' own, without noise" };
        let mut text = format!("{} of {} robots, {kind}\n", self.metric.name(), now.robots.sizes().len());
        self.assumed.iter().for_each(|assumption| text += &format!("  assumed: {assumption}\n"));
        let sizes = now.robots.sizes();
        text += &format!("\n{}\n", histogram(&classes(sizes, factor), unit, 40, unicode));
        let goal =
            format!("{:.0} % within {} {unit}", 100.0 * self.target.share, trimmed(self.target.at_most * factor));
        text += &format!("target: {goal}\n\n");
        let row = |label: String, choice: &Choice| {
            let share = choice.robots.share_within(self.target.at_most);
            let quantile = choice.robots.quantile(self.target.share);
            let percent = |share: f64| format!("{:.1}", 100.0 * share);
            let [low, high] = [quantile.interval.low, quantile.interval.high].map(|v| format!("{:.1}", v * factor));
            let size = with_precision_of(
                quantile.value * factor,
                0.1 * (quantile.interval.high - quantile.interval.low) * factor,
            );
            let interval = format!("{} .. {}", percent(share.interval.low), percent(share.interval.high));
            vec![label, trimmed(choice.cost), percent(share.value), interval, size, format!("{low} .. {high}")]
        };
        let mut rows = vec![row("now".to_owned(), now)];
        for choice in &self.findings.alone {
            rows.push(row(format!(" {}", self.changes(choice)), choice));
        }
        rows.push(row("all at last grade".to_owned(), &self.findings.last));
        if let Some(choice) = &self.findings.cheapest {
            rows.push(row("cheapest enough".to_owned(), choice));
        }
        let quantile = format!("{:.0} % [{unit}]", 100.0 * self.target.share);
        text += &table(&["grades", "cost", "within", "95 %", &quantile, "95 %"], rows);
        let legend = format!(
            "within: share of the robots that keep the target, in %. {quantile}: what so many of them keep. 95 %: the interval of \
             either. Cheapest enough: the cheapest choice that keeps the target."
        );
        text += &format!("\n\n{}\n", hanging("", 0, &legend));
        text += &wrapped(&self.verdict());
        text + &format!("\nseed {}, umbmark {}\n", self.seed, umbmark_core::VERSION)
    }

    /// What a choice has that is not so now.
    fn changes(&self, choice: &Choice) -> String {
        let changed = self.parameters.iter().zip(&choice.grades).zip(&self.findings.now.grades);
        let words = changed.filter(|((_, grade), now)| grade != now).map(|((one, grade), _)| {
            format!("{} {}", one.quantity.parameter().flag, distribution_words(&one.grades[*grade].distribution))
        });
        words.collect::<Vec<_>>().join(", ")
    }

    fn verdict(&self) -> String {
        let looked_at = self.findings.looked_at;
        match &self.findings.cheapest {
            Some(choice) if choice.grades == self.findings.now.grades => {
                "The robots keep the target with the present grades.\n".to_owned()
            }
            Some(choice) => format!(
                "Buy: {} (cost {}, {} more than now).\n\
                 Tested with {} robots that the search of {looked_at} choices did not use.\n",
                self.changes(choice),
                trimmed(choice.cost),
                trimmed(choice.cost - self.findings.now.cost),
                choice.robots.sizes().len(),
            ),
            None if self.findings.partial => {
                format!("None of the {looked_at} cheapest choices certainly keeps the target.\n")
            }
            None => format!(
                "None of the {looked_at} choices certainly keeps the target; offer tighter grades, or draw more robots.\n"
            ),
        }
    }
}

fn trimmed(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Shares of sorted sizes in sixteen classes up to the greatest but for one in a thousand.
fn classes(sizes: &[f64], factor: f64) -> Vec<(f64, f64)> {
    let top = sizes[(sizes.len() * 999 / 1000).min(sizes.len() - 1)] * factor;
    let width = (top / 16.0).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(width.log10().floor());
    let width = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|w| *w >= width).unwrap_or(width);
    let below = |edge: f64| sizes.partition_point(|size| size * factor < edge) as f64 / sizes.len() as f64;
    let count = (top / width).ceil().max(1.0) as usize;
    let edge = |i: usize| i as f64 * width;
    let upper = |i: usize| if i + 1 == count { 1.0 } else { below(edge(i + 1)) };
    (0..count).map(|i| (edge(i), upper(i) - below(edge(i)))).collect()
}
