//! What is said of sensitivities.

use umbmark_core::monte_carlo::{Distribution, Metric, Quantity, Study};
use umbmark_core::result::{Asked, Found, Sensitivity};
use umbmark_core::sensitivity::{Correlation, Derivative, Estimate, OutputIndices, Screened};

use crate::distribution_text::distribution_words;
use crate::ensemble_report::{title, unit};
use crate::table::{table, with_precision_of};
use crate::terminal::bar;

/// What was asked and found.
#[derive(Debug)]
pub struct SensitivityReport<'a> {
    /// What was found.
    pub found: &'a Found,
    /// The parameters.
    pub parameters: &'a [(Quantity, Distribution)],
    /// Correlations of two of them.
    pub correlations: &'a [Correlation],
    /// The metrics, in the order of the outputs.
    pub metrics: &'a [Metric],
    /// The one that people see in full.
    pub metric: Metric,
    /// The study about which parameters vary.
    pub study: &'a Study,
    /// Whether tests are simulated with their noise.
    pub noisy: bool,
    /// What was assumed.
    pub assumed: &'a [String],
    /// Whether bars may be drawn in more than ASCII.
    pub unicode: bool,
}

impl SensitivityReport<'_> {
    /// Names of the inputs for people, the noise last where it is one.
    fn names(&self) -> Vec<&'static str> {
        let names = self.parameters.iter().map(|(quantity, _)| quantity.parameter().flag);
        names.chain(self.noisy.then_some("noise")).collect()
    }

    /// Whether less was done than requested.
    pub fn is_partial(&self) -> bool {
        self.found.is_partial()
    }

    /// All of it.
    pub fn result(&self) -> Sensitivity {
        Sensitivity::new(
            self.found,
            &Asked {
                varied: self.parameters,
                correlations: self.correlations,
                metrics: self.metrics,
                study: self.study,
                noisy: self.noisy,
                assumed: self.assumed,
            },
        )
    }

    /// Tables and bars.
    pub fn text(&self) -> String {
        let asked = match self.found {
            Found::Sobol(i) => format!("Sobol indices from {} base points, {} tests", i.base_points, i.evaluations),
            Found::Morris(s) => format!("Morris screening by {} trajectories, {} tests", s.trajectories, s.evaluations),
            Found::Local(_) => format!("Derivatives at the medians, {} tests each side", self.study.trials),
        };
        let kind = if self.noisy { "whole tests with noise" } else { "exact kinematics, without noise" };
        let mut text = format!("{asked} ({kind})\n{}, {}\n", self.study.robot().name, self.study.path.shape().name);
        let wide = self.names().iter().map(|name| name.len()).max().unwrap_or(0);
        for (quantity, distribution) in self.parameters {
            let parameter = quantity.parameter();
            let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
            text += &format!("  {:<wide$}  {}{unit}\n", parameter.flag, distribution_words(distribution));
        }
        for correlation in self.correlations {
            let [one, two] = correlation.of.map(|place| self.parameters[place].0.parameter().flag);
            text += &format!("  correlation of {one} and {two}: {}\n", correlation.value);
        }
        self.assumed.iter().for_each(|assumption| text += &format!("  assumed: {assumption}\n"));
        text.push('\n');
        let output = self.metrics.iter().position(|metric| *metric == self.metric);
        text += &output.map_or(String::new(), |output| self.in_full(output));
        text += &self.overview();
        let partial = if self.is_partial() { ", PARTIAL: not all requested tests were done" } else { "" };
        text + &format!("\nseed {}, umbmark {}{partial}\n", self.study.seed, umbmark_core::VERSION)
    }

    fn in_full(&self, output: usize) -> String {
        match self.found {
            Found::Sobol(indices) => self.sobol(&indices.outputs[output]),
            Found::Morris(screening) => self.morris(&screening.outputs[output]),
            Found::Local(derivatives) => self.local(&derivatives[output]),
        }
    }

    /// To the left of its cell, which is set to the right as numbers are.
    fn bars(&self, share: f64) -> String {
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        format!("{:<BAR$}", bar(share, BAR, self.unicode))
    }

    fn sobol(&self, output: &OutputIndices) -> String {
        let (unit, factor) = unit(self.metric);
        let scaled = |estimate: &Estimate| with_half_width(estimate, factor);
        let mut text = format!(
            "{}: mean {} {unit}, standard deviation {} {unit}\n\n",
            title(self.metric),
            scaled(&output.mean),
            scaled(&output.std_dev)
        );
        let names = self.names();
        let rows = by_size(&output.total).into_iter().map(|i| {
            let (first, total) = (&output.first[i], &output.total[i]);
            vec![names[i].to_owned(), share(first), share(total), self.bars(total.value)]
        });
        text += &table(&["share of the variance", "alone, S", "with others, T", ""], rows);
        text.push('\n');
        if self.correlations.is_empty() && output.interactions().is_finite() {
            text += &format!("share of interactions: {:.3}\n", output.interactions());
        } else if !self.correlations.is_empty() {
            text += "correlated: S includes the share of correlated parameters, T only the own share\n";
        }
        if !output.second.is_empty() {
            let mut pairs: Vec<_> = output.second.iter().collect();
            pairs.sort_by(|a, b| b.1.value.total_cmp(&a.1.value));
            let rows = pairs.iter().take(PAIRS).map(|([i, j], estimate)| {
                vec![format!("{} x {}", names[*i], names[*j]), share(estimate), self.bars(estimate.value)]
            });
            text += &format!("\n{}\n", table(&["interaction of pairs", "S_ij", ""], rows));
        }
        text
    }

    fn morris(&self, effects: &[Screened]) -> String {
        let (unit, factor) = unit(self.metric);
        let names = self.names();
        let sizes: Vec<Estimate> = effects.iter().map(|one| one.size).collect();
        let most = sizes.iter().map(|size| size.value).fold(f64::MIN_POSITIVE, f64::max);
        let rows = by_size(&sizes).into_iter().map(|i| {
            let Screened { mean, size, spread } = &effects[i];
            let cells = [size, mean, spread].map(|estimate| with_half_width(estimate, factor));
            [vec![names[i].to_owned()], cells.to_vec(), vec![self.bars(size.value / most)]].concat()
        });
        let header = format!("{} [{unit}]", title(self.metric));
        table(&[header.as_str(), "size, mu*", "mean, mu", "spread, sigma", ""], rows) + "\n"
    }

    fn local(&self, derivatives: &[Derivative]) -> String {
        let (unit, factor) = unit(self.metric);
        let names = self.names();
        let sizes: Vec<Estimate> = derivatives.iter().map(|one| absolute(&one.per_spread)).collect();
        let most = sizes.iter().map(|size| size.value).fold(f64::MIN_POSITIVE, f64::max);
        let rows = by_size(&sizes).into_iter().map(|i| {
            let Derivative { per_unit, per_spread } = &derivatives[i];
            let of = self.parameters[i].0.parameter().unit;
            let per = if of.is_empty() { unit.to_owned() } else { format!("{unit} per {of}") };
            let slope = format!("{} {per}", with_half_width(per_unit, factor));
            vec![names[i].to_owned(), with_half_width(per_spread, factor), slope, self.bars(sizes[i].value / most)]
        });
        let header = format!("{} [{unit}]", title(self.metric));
        table(&[header.as_str(), "per spread", "per unit", ""], rows) + "\n"
    }

    /// One number of every metric for every parameter.
    fn overview(&self) -> String {
        let number = |output: usize, input: usize| match self.found {
            Found::Sobol(i) => format!("{:.3}", i.outputs[output].total[input].value),
            Found::Morris(s) => format!("{:.2}", s.outputs[output][input].size.value * unit(self.metrics[output]).1),
            Found::Local(d) => {
                format!("{:.2}", d[output][input].per_spread.value * unit(self.metrics[output]).1)
            }
        };
        let (what, names) = match self.found {
            Found::Sobol(_) => ("T of every metric", self.names()),
            Found::Morris(_) => ("mu* of every metric", self.names()),
            Found::Local(_) => {
                ("per spread, every metric", self.parameters.iter().map(|(q, _)| q.parameter().flag).collect())
            }
        };
        let header: Vec<&str> = std::iter::once(what).chain(names.iter().copied()).collect();
        let rows = self.metrics.iter().enumerate().map(|(output, metric)| {
            let label = match self.found {
                Found::Sobol(_) => title(*metric).to_owned(),
                _ => format!("{} [{}]", title(*metric), unit(*metric).0),
            };
            let cells = (0..names.len()).map(|input| number(output, input).replace("NaN", "-"));
            std::iter::once(label).chain(cells).collect()
        });
        format!("\n{}\n", table(&header, rows))
    }
}

/// The most pairs that people see.
const PAIRS: usize = 10;

/// Characters of a bar of 1.
const BAR: usize = 20;

/// Places in the order of falling values.
fn by_size(estimates: &[Estimate]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..estimates.len()).collect();
    order.sort_by(|a, b| estimates[*b].value.total_cmp(&estimates[*a].value));
    order
}

fn absolute(estimate: &Estimate) -> Estimate {
    Estimate { value: estimate.value.abs(), ..*estimate }
}

/// A share of the variance, to four digits at most.
fn share(estimate: &Estimate) -> String {
    let half = 0.5 * (estimate.interval.high - estimate.interval.low);
    let value = with_precision_of(estimate.value, half.max(FINEST));
    if value == "-" { value } else { format!("{value} ± {}", with_precision_of(half, half.max(FINEST))) }
}

/// Smaller parts of the variance are of no interest.
const FINEST: f64 = 1e-3;

/// `0.412 ± 0.006`, to the digits that the interval leaves.
fn with_half_width(estimate: &Estimate, factor: f64) -> String {
    let half = 0.5 * (estimate.interval.high - estimate.interval.low) * factor;
    let value = with_precision_of(estimate.value * factor, half);
    if half.is_finite() && value != "-" { format!("{value} ± {}", with_precision_of(half, half)) } else { value }
}
