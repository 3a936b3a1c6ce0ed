//! What is said of an ensemble.

use umbmark_core::monte_carlo::{Distribution, Ensemble, Metric, Statistics};
use umbmark_core::result::{Keyed, MonteCarlo, NumberOrWord, Setting, Study};
use umbmark_plot::figure::Mark;

use crate::distribution_text::distribution_words;
use crate::prose::wrapped;
use crate::table::{table, with_precision_of};
use crate::terminal::histogram;

/// An ensemble and what its report contains.
#[derive(Debug)]
pub struct Report<'a> {
    /// What the study is.
    pub study: &'a Study,
    /// Its seed.
    pub seed: u64,
    /// What was found.
    pub ensemble: &'a Ensemble,
    /// Whether requested trials are not done.
    pub partial: bool,
    /// How long it took \[s\], and for how many trials, where that is known.
    pub took: Option<(f64, u64)>,
}

impl Report<'_> {
    fn trials_per_s(&self) -> Option<f64> {
        self.took.map(|(seconds, trials)| trials as f64 / seconds.max(1e-9))
    }

    /// All of it.
    pub fn result(&self) -> MonteCarlo {
        MonteCarlo::new(self.ensemble, self.seed, self.partial, self.trials_per_s(), self.study)
    }

    /// A table and a histogram, in characters beyond ASCII where they are shown.
    pub fn text(&self, unicode: bool) -> String {
        let mut text = format!("Monte Carlo of UMBmark: {} trials of ", self.ensemble.trials());
        text += &heading(self.study).join("\n");
        text = wrapped(&text) + "\n";
        text += &self.table();
        text += "\n\n";
        text += &theory(self.study);
        text += &self.published();
        if let Some(e_max) = self.ensemble.get(Metric::EMaxSys) {
            text += "E_max,sys over the trials\n";
            text += &distribution_of(e_max, unicode);
        }
        let speed = self.trials_per_s().map(|speed| format!(", {speed:.0} trials/s")).unwrap_or_default();
        let partial = if self.partial { ", PARTIAL: not all trials were done" } else { "" };
        let (seed, version) = (self.seed, umbmark_core::VERSION);
        text + &format!("\nseed {seed}{speed}, umbmark {version}{partial}\n")
    }

    /// Where the paper's numbers lie among those of the trials.
    fn published(&self) -> String {
        let Some(published) = &self.study.published else { return String::new() };
        let place = |metric: Metric, value: f64| {
            let above = self.ensemble.get(metric).map_or(f64::NAN, |s| 100.0 * s.share_below(value));
            format!("{:.0} mm (above {above:.0} % of the trials)", value * 1e3)
        };
        let e_max_sys = place(Metric::EMaxSys, published.e_max_sys_m);
        let sigma = place(Metric::Sigma, published.sigma_m);
        format!("Table I, {}: E_max,sys {e_max_sys}, sigma {sigma}\n\n", published.row)
    }

    fn table(&self) -> String {
        let rows = self.ensemble.statistics().map(|(metric, s)| {
            let (unit, factor) = unit(metric);
            let cell = |value: f64| with_precision_of(value * factor, s.std_error() * factor);
            let mut row = vec![format!("{} [{unit}]", title(metric)), cell(s.mean()), cell(s.std_error())];
            row.push(cell(s.std_dev()));
            row.extend([0.05, 0.5, 0.95].map(|q| cell(s.quantile(q))));
            row
        });
        table(&["metric", "mean", "std error", "std dev", "5 %", "50 %", "95 %"], rows)
    }
}

/// What a study is, in lines for people.
fn heading(study: &Study) -> Vec<String> {
    let phrases = |phrases: &[String], what: &str| -> Vec<String> {
        phrases.iter().map(|phrase| format!("  {what}: {phrase}")).collect()
    };
    let sizes: Vec<String> = study.path.sizes.iter().map(|(name, value)| format!("{name} {value}")).collect();
    let shape = study.path.shape.replace('_', "-");
    let mut heading = vec![
        match (study.runs.cw, study.runs.ccw) {
            (cw, 0) => format!("{cw} cw runs, uni-directional"),
            (0, ccw) => format!("{ccw} ccw runs, uni-directional"),
            (cw, ccw) => format!("{cw} cw + {ccw} ccw runs"),
        },
        format!("{}, {shape} ({})", study.robot, sizes.join(", ")),
    ];
    for effect in &study.effects {
        let name = effect.get("name").map(in_words).unwrap_or_default();
        let numbers = effect.iter().filter(|(key, _)| *key != "name");
        let numbers: Vec<String> = numbers.map(|(key, value)| format!("{key} {}", in_words(value))).collect();
        heading.push(format!("  {name}: {}", numbers.join(", ")));
    }
    heading.extend(phrases(&study.sources, "from the paper"));
    heading.extend(phrases(&study.assumed, "assumed"));
    heading
}

/// What the test gives without noise.
fn theory(study: &Study) -> String {
    let one_way = study.runs.cw == 0 || study.runs.ccw == 0;
    let subject = if one_way { "Driven both ways, E_max,sys" } else { "E_max,sys" };
    let mm = |length: Option<f64>| length.map(|value| format!("{:.1} mm", value * 1e3));
    match (mm(study.noise_free.e_max_sys_m), mm(study.noise_free.first_order_e_max_sys_m)) {
        (Some(exact), Some(first)) => {
            format!("{subject} without noise: {exact} by exact kinematics, {first} to first order\n\n")
        }
        (Some(exact), None) => format!("{subject} without noise: {exact} by exact kinematics\n\n"),
        _ => String::new(),
    }
}

/// A value of an effect: a number, a word, or a distribution.
fn in_words(value: &Setting) -> String {
    match value {
        Setting::Word(word) => word.clone(),
        Setting::Number(number) => number.to_string(),
        Setting::Drawn(keys) => distribution(keys).as_ref().map(distribution_words).unwrap_or_default(),
    }
}

fn distribution(keys: &Keyed<NumberOrWord>) -> Option<Distribution> {
    let number = |key: &str| match keys.get(key)? {
        NumberOrWord::Number(number) => Some(*number),
        NumberOrWord::Word(_) => None,
    };
    if let (Some(mean), Some(sd)) = (number("mean"), number("sd")) {
        return Some(Distribution::Normal { mean, sd });
    }
    let (min, max) = (number("min")?, number("max")?);
    Some(match (number("mode"), keys.get("scale")) {
        (Some(mode), _) => Distribution::Triangular { min, mode, max },
        (None, Some(_)) => Distribution::LogUniform { min, max },
        (None, None) => Distribution::Uniform { min, max },
    })
}

/// The unit that people read a metric in, and how many of it are one of SI.
pub fn unit(metric: Metric) -> (&'static str, f64) {
    if metric.is_angle() { ("deg", 180.0 / std::f64::consts::PI) } else { ("mm", 1e3) }
}

/// What people call a metric.
pub fn title(metric: Metric) -> &'static str {
    match metric {
        Metric::EMaxSys => "E_max,sys",
        Metric::Sigma => "sigma (per axis)",
        Metric::CentroidCwX => "centroid cw, x",
        Metric::CentroidCwY => "centroid cw, y",
        Metric::CentroidCcwX => "centroid ccw, x",
        Metric::CentroidCcwY => "centroid ccw, y",
        Metric::ReturnHeadingCw => "return heading cw",
        Metric::ReturnHeadingCcw => "return heading ccw",
        Metric::NonsysOrientation => "orientation, bumps",
    }
}

/// A histogram of lengths in mm.
fn distribution_of(statistics: &Statistics, unicode: bool) -> String {
    let panel = umbmark_plot::kind::histogram(statistics);
    let bars = panel.layers.iter().filter_map(|layer| match layer.mark {
        Mark::Bars(width) => Some((layer, width)),
        _ => None,
    });
    let classes: Vec<(f64, f64)> = bars
        .flat_map(|(layer, width)| layer.x.iter().zip(&layer.y).map(move |(x, y)| (x - 0.5 * width, 0.01 * y)))
        .collect();
    histogram(&classes, "mm", 40, unicode)
}
