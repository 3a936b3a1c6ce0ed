//! What is said of an ensemble: for people, and as a document.

use serde_json::{Map, Value};
use umbmark_core::document;
use umbmark_core::monte_carlo::{Distribution, Ensemble, Metric, Statistics};
use umbmark_plot::figure::Mark;

use crate::distribution_text::distribution_words;
use crate::table::{table, with_precision_of};
use crate::terminal::histogram;

/// An ensemble and what is to be said of it.
#[derive(Debug)]
pub struct Report<'a> {
    /// What the study is, as its document tells.
    pub study: &'a Map<String, Value>,
    /// Its seed.
    pub seed: u64,
    /// What was found.
    pub ensemble: &'a Ensemble,
    /// Whether trials that were asked for are not done.
    pub partial: bool,
    /// How long it took \[s\], and for how many trials, where that is known.
    pub took: Option<(f64, u64)>,
}

impl Report<'_> {
    fn trials_per_s(&self) -> Option<f64> {
        self.took.map(|(seconds, trials)| trials as f64 / seconds.max(1e-9))
    }

    /// One document.
    pub fn json(&self) -> Value {
        document::ensemble(self.ensemble, self.seed, self.partial, self.trials_per_s(), self.study)
    }

    /// A table and a histogram, in characters beyond ASCII where they are shown.
    pub fn text(&self, unicode: bool) -> String {
        let mut text = format!("Monte Carlo of UMBmark: {} trials of ", self.ensemble.trials());
        text += &heading(self.study).join("\n");
        text += "\n\n";
        text += &self.table();
        text += "\n\n";
        text += &theory(self.study);
        text += &self.published();
        if let Some(e_max) = self.ensemble.get(Metric::EMaxSys) {
            text += "E_max,sys over the trials\n";
            text += &distribution_of(e_max, unicode);
        }
        let speed = self.trials_per_s().map(|speed| format!(", {speed:.0} trials/s")).unwrap_or_default();
        let partial = if self.partial { ", PARTIAL: not all trials are done" } else { "" };
        let (seed, version) = (self.seed, umbmark_core::VERSION);
        text + &format!("\nseed {seed}{speed}, umbmark {version}{partial}\n")
    }

    /// Where the paper's numbers lie among those of the trials.
    fn published(&self) -> String {
        let told = &self.study["published"];
        let of = |key: &str| told[key].as_f64();
        let Some(((row, e_max_sys), sigma)) = told["row"].as_str().zip(of("e_max_sys_m")).zip(of("sigma_m")) else {
            return String::new();
        };
        let place = |metric: Metric, value: f64| {
            let above = self.ensemble.get(metric).map_or(f64::NAN, |s| 100.0 * s.share_below(value));
            format!("{:.0} mm (above {above:.0} % of the trials)", value * 1e3)
        };
        let (e_max_sys, sigma) = (place(Metric::EMaxSys, e_max_sys), place(Metric::Sigma, sigma));
        format!("Table I, {row}: E_max,sys {e_max_sys}, sigma {sigma}\n\n")
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
fn heading(study: &Map<String, Value>) -> Vec<String> {
    let list = |key: &str| study.get(key).and_then(Value::as_array).into_iter().flatten();
    let phrases = |key: &str, what: &str| -> Vec<String> {
        list(key).filter_map(Value::as_str).map(|phrase| format!("  {what}: {phrase}")).collect()
    };
    let path = &study["path"];
    let sizes = path["sizes"].as_object().into_iter().flatten();
    let sizes: Vec<String> = sizes.map(|(name, value)| format!("{name} {}", in_words(value))).collect();
    let shape = path["shape"].as_str().unwrap_or_default().replace('_', "-");
    let mut heading = vec![
        match runs(study) {
            [cw, 0] => format!("{cw} cw runs, uni-directional"),
            [0, ccw] => format!("{ccw} ccw runs, uni-directional"),
            [cw, ccw] => format!("{cw} cw + {ccw} ccw runs"),
        },
        format!("{}, {shape} ({})", study["robot"].as_str().unwrap_or_default(), sizes.join(", ")),
    ];
    for effect in list("effects").filter_map(Value::as_object) {
        let name = effect.get("name").and_then(Value::as_str).unwrap_or_default();
        let numbers = effect.iter().filter(|(key, _)| *key != "name");
        let numbers: Vec<String> = numbers.map(|(key, value)| format!("{key} {}", in_words(value))).collect();
        heading.push(format!("  {name}: {}", numbers.join(", ")));
    }
    heading.extend(phrases("sources", "from the paper"));
    heading.extend(phrases("assumed", "assumed"));
    heading
}

/// Numbers of runs \[cw, ccw\].
fn runs(study: &Map<String, Value>) -> [u64; 2] {
    ["cw", "ccw"].map(|direction| study["runs"][direction].as_u64().unwrap_or(0))
}

/// What the test gives without noise.
fn theory(study: &Map<String, Value>) -> String {
    let subject = if runs(study).contains(&0) { "Driven both ways, E_max,sys" } else { "E_max,sys" };
    let mm = |key: &str| study["noise_free"][key].as_f64().map(|value| format!("{:.1} mm", value * 1e3));
    match (mm("e_max_sys_m"), mm("first_order_e_max_sys_m")) {
        (Some(exact), Some(first)) => {
            format!("{subject} without noise: {exact} by exact kinematics, {first} to first order\n\n")
        }
        (Some(exact), None) => format!("{subject} without noise: {exact} by exact kinematics\n\n"),
        _ => String::new(),
    }
}

/// A value of a document: a number, a word, or a distribution.
fn in_words(value: &Value) -> String {
    let number = |key: &str| value.get(key).and_then(Value::as_f64);
    let (middle, spread) = (number("mean").zip(number("sd")), number("min").zip(number("max")));
    let distribution = match (middle, spread, number("mode")) {
        (Some((mean, sd)), _, _) => Some(Distribution::Normal { mean, sd }),
        (_, Some((min, max)), Some(mode)) => Some(Distribution::Triangular { min, mode, max }),
        (_, Some((min, max)), _) if value.get("scale").is_some() => Some(Distribution::LogUniform { min, max }),
        (_, Some((min, max)), _) => Some(Distribution::Uniform { min, max }),
        _ => None,
    };
    match (distribution, value) {
        (Some(distribution), _) => distribution_words(&distribution),
        (None, Value::String(word)) => word.clone(),
        (None, value) => value.as_f64().map(|number| number.to_string()).unwrap_or_default(),
    }
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
