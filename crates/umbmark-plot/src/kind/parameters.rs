//! The numbers of a model with their intervals.

use umbmark_core::effect::{Model, parameter_of};
use umbmark_core::evidence::Estimate;
use umbmark_core::stats::student_t_quantile;

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::study::{Absent, Study};
use crate::tone::Tone;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "parameters", about: "the model's numbers with their intervals", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let diagnosis = study.diagnosis()?;
    if diagnosis.fitted.is_empty() {
        return Err(Absent("The model has no free parameter that these runs show.".into()));
    }
    let numbers: Vec<Number> =
        diagnosis.fitted.iter().map(|e| Number::new(e, &diagnosis.model, study.level())).collect();
    let row = |pick: fn(&Number) -> f64| numbers.iter().map(pick).collect::<Vec<f64>>();
    let spans = Mark::Spans(row(|n| n.low / n.usual), row(|n| n.high / n.usual));
    let places = numbers.iter().enumerate().map(|(i, n)| [n.departure / n.usual, i as f64]);
    let count = numbers.len() as f64;
    let layers = vec![
        Layer::new("", Tone::Quiet, Mark::Dashes, [[0.0, -0.5], [0.0, count - 0.5]]),
        Layer::new("", Tone::Model, spans, places).saying(numbers.iter().map(Number::said).collect()),
    ];
    let panel = Panel {
        title: String::new(),
        x: Axis::of("in usual sizes"),
        y: Axis::named(numbers.iter().map(|n| n.name.clone()).collect()).falling(),
        equal: false,
        layers,
    };
    Ok(Figure {
        kind: "parameters",
        title: "The model's numbers".into(),
        told: told(&numbers, study),
        panels: vec![panel],
        table: Table::new(
            ["parameter", "value", "from", "to", "usual size"],
            numbers.iter().map(|n| {
                let at = |departure: f64| n.written(n.value - n.departure + departure);
                [n.name.clone(), n.written(n.value), at(n.low), at(n.high), format!("{:.2e}", n.usual)]
            }),
        ),
    })
}

/// A fitted number, as its departure from where it does nothing.
struct Number {
    name: String,
    unit: &'static str,
    value: f64,
    departure: f64,
    /// Ends of its interval, as departures.
    low: f64,
    high: f64,
    usual: f64,
}

impl Number {
    fn new(estimate: &Estimate, model: &Model, level: f64) -> Number {
        let parameter = parameter_of(estimate.effect, estimate.parameter);
        let rest = parameter.map_or(0.0, |p| p.default.resolve(model.robot()));
        let departure = estimate.value - rest;
        let half = student_t_quantile(0.5 + 0.5 * level, estimate.degrees_of_freedom) * estimate.standard_error;
        let half = if half.is_finite() { half } else { 0.0 };
        // A number of the user's own has no usual size but its own.
        let own = departure.abs().max(half).max(f64::MIN_POSITIVE);
        Number {
            name: format!("{}: {}", estimate.effect, estimate.parameter),
            unit: parameter.map_or("", |p| p.unit),
            value: estimate.value,
            departure,
            low: departure - half,
            high: departure + half,
            usual: parameter.map_or(own, |p| p.typical),
        }
    }

    fn half(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    fn written(&self, value: f64) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let decimals = if self.half() > 0.0 { (1.0 - self.half().log10().floor()).clamp(0.0, 9.0) } else { 6.0 };
        format!("{}{unit}", crate::scale::written(value, decimals as usize))
    }

    fn said(&self) -> String {
        if self.half() > 0.0 {
            format!("{} = {} ± {}", self.name, self.written(self.value), self.written(self.half()))
        } else {
            format!("{} = {}, interval unknown", self.name, self.written(self.value))
        }
    }

    fn certain(&self) -> bool {
        self.half() > 0.0 && (self.low > 0.0 || self.high < 0.0)
    }
}

fn told(numbers: &[Number], study: &Study) -> Told {
    let percent = 100.0 * study.level();
    let certain: Vec<String> = numbers.iter().filter(|n| n.certain()).map(Number::said).collect();
    let says = if certain.is_empty() {
        "Every interval contains the value without effect.".to_owned()
    } else {
        format!("Different from the value without effect: {}.", certain.join("; "))
    };
    Told {
        shows: format!(
            "Distance of each fitted number of {} from the value that has no effect, with its {percent:.0} % interval. The unit \
             of each is its usual size among robots.",
            study.model_name()
        ),
        good: "Intervals are short, and those of found effects do not contain the dashed line at zero.".into(),
        says,
    }
}
