//! The report of a plan: for people, and as a document.

use umbmark_core::diagnose::{Experiment, Unseen, Why};
use umbmark_core::plan::{Alternative, Answer, Drift, Findings, MOST_RUNS, OfRuns, Request, Setting, Shown, Sought};

use crate::model_report::unit_of;
use crate::prose::hanging;
use crate::table::table;

/// Numbers of runs that are printed where there are more.
pub const PRINTED: [usize; 7] = [3, 4, 5, 7, 10, 20, 30];
/// Those of them that least sizes are printed for.
const LEAST_AT: [usize; 5] = [3, 5, 10, 20, 30];
/// So many experiments are printed.
const EXPERIMENTS: usize = 5;

/// Where the robot and its scatter are from.
#[derive(Debug)]
pub struct Known {
    /// What was assumed, a phrase each.
    pub assumed: Vec<String>,
    /// Whether they are from measured runs.
    pub from_data: bool,
}

/// All that the report contains.
#[derive(Debug)]
pub struct Report<'a> {
    /// What is driven.
    pub summary: &'a str,
    /// The robot on its path.
    pub setting: &'a Setting,
    /// Its source.
    pub known: &'a Known,
    /// What was asked.
    pub request: &'a Request<'a>,
    /// What was found.
    pub findings: &'a Findings,
}

fn millimetres(value: f64) -> String {
    format!("{:.1}", 1e3 * value)
}

fn or_dash(value: Option<f64>, text: impl Fn(f64) -> String) -> String {
    value.map_or("-".to_owned(), text)
}

/// A size to two digits.
fn brief(value: f64) -> String {
    let size = value.abs();
    if size > 0.0 && !(1e-3..1e4).contains(&size) {
        return format!("{value:.1e}");
    }
    let decimals = (1 - size.max(1e-9).log10().floor() as i32).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

fn name_of(sought: &Sought) -> String {
    format!("{} of {}", sought.parameter.name, sought.effect.about.name)
}

/// For people.
pub fn text(report: &Report) -> String {
    let setting = report.setting;
    let mut text = format!("Plan for {}\n", setting.robot().name);
    text += &hanging("", 2, report.summary);
    text += &heading(report);
    text += &answers(report);
    text += &intervals(report);
    text += &least(report);
    text += &alternatives(report);
    text += &orders(report);
    text += "\numbmark plan -o protocol.html writes the steps and the table to fill in.\n";
    text
}

fn heading(report: &Report) -> String {
    let setting = report.setting;
    let mut text = String::new();
    let from = if report.known.from_data { "from the data" } else { "expected" };
    let interval = report.request.sigma_interval;
    let between = interval.map(|i| format!(" ({} to {})", millimetres(i.low), millimetres(i.high))).unwrap_or_default();
    text += &hanging(
        "",
        2,
        &format!(
            "sigma {} mm{between}, {from}; E_max,sys of the robot itself {} mm",
            millimetres(setting.sigma()),
            millimetres(setting.e_max_sys())
        ),
    );
    for assumption in &report.known.assumed {
        text += &hanging("", 2, &format!("assumed: {assumption}"));
    }
    text
}

fn answers(report: &Report) -> String {
    if report.findings.answers.is_empty() {
        return String::new();
    }
    let runs = |runs: Option<usize>| runs.map_or(format!("> {MOST_RUNS}"), |n| n.to_string());
    let row = |a: &Answer| {
        let unit = unit_of(a.sought.effect.about.name, a.sought.parameter.name);
        let needed = match a.shown {
            Shown::Absorbed(_) => "never".to_owned(),
            _ => runs(a.runs),
        };
        let range = a.runs_at_sigma.filter(|_| a.runs.is_some());
        let range = range.map_or("-".to_owned(), |[low, high]| format!("{} to {}", runs(low), runs(high)));
        vec![
            format!("{} {}{unit} of {}", a.sought.parameter.name, a.value, a.sought.effect.about.name),
            needed,
            range,
            format!("{:.1} %", 100.0 * a.power),
        ]
    };
    let title = format!("to detect with {:.0} %", 100.0 * report.request.power);
    let header = [
        title.as_str(),
        "runs a direction",
        "for sigma's range",
        &format!("power with {0} + {0}", report.request.runs),
    ];
    let mut text = format!("\n{}\n", table(&header, report.findings.answers.iter().map(row)));
    for answer in &report.findings.answers {
        let name = answer.sought.effect.about.name;
        let why = match &answer.shown {
            Shown::Fitted(_) | Shown::Asked => continue,
            Shown::Absorbed(by) => {
                let best = answer.separable.iter().find(|e| e.sd >= ENOUGH).or(answer.separable.first());
                let advice = best.map_or(String::new(), |e| {
                    format!(
                        " To separate them: {} ({:.1} standard deviations in {:.0} min).",
                        e.experiment, e.sd, e.minutes
                    )
                });
                format!(
                    "{name} cannot be seen in return poses: it is indistinguishable from {} there.{advice}",
                    by.join(" with ")
                )
            }
            Shown::BelowNoise => format!(
                "with {0} + {0} runs diagnose does not test {name}: its usual size is below half a standard deviation of the means",
                report.request.runs
            ),
        };
        text += &hanging("", 2, &why);
    }
    text
}

/// Standard deviations that are seen in nine cases of ten.
const ENOUGH: f64 = 3.24;

fn intervals(report: &Report) -> String {
    let row = |row: &OfRuns| {
        let i = &row.interval;
        vec![
            i.runs.to_string(),
            format!("{:.0}", 2.0 * i.runs as f64 * report.setting.minutes_a_run()),
            format!("{} ± {}", millimetres(i.mean), millimetres(i.std_dev)),
            millimetres(i.half_width),
            format!("{:.1}", 100.0 * i.coverage),
            millimetres(i.noise_band),
        ]
    };
    let header = ["runs", "min", "E_max,sys reads [mm]", "interval ± [mm]", "covers [%]", "chance alone [mm]"];
    let rows = &report.findings.by_runs;
    let shown = |of: &&OfRuns| rows.len() <= PRINTED.len() || PRINTED.contains(&of.interval.runs);
    format!("\n{}\n", table(&header, rows.iter().filter(shown).map(row)))
}

fn least(report: &Report) -> String {
    let runs: Vec<&OfRuns> =
        report.findings.by_runs.iter().filter(|row| LEAST_AT.contains(&row.interval.runs)).collect();
    let mut header = vec![format!("least size detected with {:.0} %, runs:", 100.0 * report.request.power)];
    header.extend(runs.iter().map(|row| row.interval.runs.to_string()));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let row = |(i, sought): (usize, &Sought)| {
        let cells = runs.iter().map(|row| or_dash(row.least[i], brief));
        std::iter::once(name_of(sought)).chain(cells).collect()
    };
    let mut text = format!("\n{}\n", table(&header, report.findings.sizes.iter().enumerate().map(row)));
    let absorbed = |u: &&Unseen| matches!(u.why, Why::Absorbed(_));
    let names: Vec<&str> = report.findings.unseen.iter().filter(absorbed).map(|u| u.effect).collect();
    if !names.is_empty() {
        text += &hanging("never:", 8, &format!("{} (E_d or E_b does what they do)", names.join(", ")));
    }
    text
}

fn alternatives(report: &Report) -> String {
    let mut header = vec!["instead".to_owned(), "runs".into(), "min".into(), "sigma [mm]".into(), "± [mm]".into()];
    header.extend(report.findings.compared.iter().map(|s| format!("least {}", s.parameter.name)));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let row = |a: &Alternative| {
        let runs = if a.runs[1] == 0 { format!("{} + 0", a.runs[0]) } else { format!("{} + {}", a.runs[0], a.runs[1]) };
        let cells = [runs, format!("{:.0}", a.minutes), millimetres(a.sigma), or_dash(a.half_width, millimetres)];
        let least = a.least.iter().map(|size| or_dash(*size, brief));
        std::iter::once(a.what.clone()).chain(cells).chain(least).collect()
    };
    let mut text = format!("\n{}\n", table(&header, report.findings.alternatives.iter().map(row)));
    if let Some(e) = &report.findings.extended {
        text += &hanging(
            "bumps",
            8,
            &format!(
                "{0} + {0} runs over {1:.0} bumps, {2:.0} min more: orientation error {3:.2} ± {4:.2} deg (half the interval)",
                e.runs,
                e.bumps,
                e.minutes,
                e.orientation.to_degrees(),
                e.half_width.to_degrees()
            ),
        );
    }
    text
}

fn orders(report: &Report) -> String {
    let row = |d: &Drift| {
        let cells = d.errors.iter().map(|(_, error, sd)| format!("{error:+.1e} ({sd:+.1} sd)"));
        let what = format!("{} grows by {}", d.parameter, brief(d.change));
        [what, d.order.name().to_owned()].into_iter().chain(cells).collect()
    };
    let Some(first) = report.findings.drifts.first() else { return String::new() };
    let mut header = vec!["in the session".to_owned(), "order".into()];
    header.extend(first.errors.iter().map(|(name, _, _)| format!("error of {name}")));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    format!("\n{}\n", table(&header, report.findings.drifts.iter().map(row)))
}

/// Experiments that separate two effects.
#[derive(Debug)]
pub struct Separation {
    /// The two.
    pub pair: [String; 2],
    /// The data that they are added to.
    pub after: String,
    /// The most informative per minute first.
    pub experiments: Vec<Experiment>,
}

impl Separation {
    /// For people.
    pub fn text(&self) -> String {
        let [a, b] = &self.pair;
        let title = format!("Experiments that separate {a} from {b}, together with {}", self.after);
        let mut text = hanging("", 0, &title) + "\n";
        if self.experiments.iter().all(|e| e.sd < 1.0) {
            text += &hanging("", 2, "No available experiment separates them by one standard deviation.");
            return text;
        }
        text += "    sd  min  sd^2/min\n";
        for e in self.experiments.iter().take(EXPERIMENTS) {
            let sure = if e.sd >= ENOUGH { "" } else { " (not sure)" };
            let numbers = format!("{:>6.1} {:>4.0} {:>9.2}", e.sd, e.minutes, e.sd * e.sd / e.minutes);
            text += &hanging(&numbers, 24, &format!("{}{sure}", e.experiment));
        }
        text += "\n";
        text += &hanging(
            "",
            2,
            "sd: distance between the two, in standard deviations, at usual sizes. From 3.24 on, 90 % of cases are separated at 5 % false alarms.",
        );
        text
    }
}
