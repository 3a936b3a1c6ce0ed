//! What is varied: parameters with their distributions, from flags and files.

use std::path::PathBuf;

use anyhow::Context;
use umbmark_core::monte_carlo::{Distribution, Quantity, Study};
use umbmark_core::sensitivity::Correlation;
use umbmark_io::read_parameters;

use crate::distribution_text::{Named, named};
use crate::numbers::number;

/// The flags of what is varied.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Varied parameters")]
pub struct VaryFlags {
    /// Vary a parameter, by the name of its flag: ed=normal:1:0.001, side=uniform:2:6, es=triangular:0.99:1:1.02,
    /// ticks-per-revolution=loguniform:200:5000; also runs, encoder-rate and every other flag with a number
    #[arg(long, value_name = "NAME=DISTRIBUTION", value_parser = named)]
    vary: Vec<Named>,

    /// Vary the parameters of a file
    #[arg(long, value_name = "parameters.toml")]
    parameters: Option<PathBuf>,

    /// Correlate two of them: ed,eb=0.3 is the correlation of their normal scores (Gaussian copula)
    #[arg(long, value_name = "NAME,NAME=R", value_parser = pair)]
    correlate: Vec<(String, String, f64)>,
}

fn pair(text: &str) -> Result<(String, String, f64), String> {
    let wrong = || "write two parameters and their correlation, as in ed,eb=0.3".to_owned();
    let (names, value) = text.split_once('=').ok_or_else(wrong)?;
    let (one, two) = names.split_once(',').ok_or_else(wrong)?;
    Ok((one.to_owned(), two.to_owned(), number(value)?))
}

/// What is varied, resolved.
#[derive(Debug)]
pub struct Varied {
    /// The parameters and their distributions.
    pub parameters: Vec<(Quantity, Distribution)>,
    /// Correlations of two of them, by their places.
    pub correlations: Vec<Correlation>,
}

impl VaryFlags {
    /// What a study draws, then what the file varies, then what flags do: what comes later overrides what came before.
    pub fn resolve(&self, study: &Study) -> anyhow::Result<Varied> {
        let mut varied = Varied { parameters: Vec::new(), correlations: Vec::new() };
        for draw in &study.draws {
            let name = format!("{}.{}", draw.effect(), draw.parameter().name);
            varied.place(Quantity::find(&name, study)?, draw.distribution());
        }
        if let Some(file) = &self.parameters {
            let file = read_parameters(file, study)?;
            let places: Vec<usize> =
                file.parameters.iter().map(|one| varied.place(one.quantity, one.grades[0].distribution)).collect();
            let correlation = |([one, two], value): &([usize; 2], f64)| Correlation {
                of: [places[*one], places[*two]],
                value: *value,
            };
            varied.correlations.extend(file.correlations.iter().map(correlation));
        }
        for named in &self.vary {
            let quantity = Quantity::find(&named.name, study).context("--vary")?;
            named.distribution.check(quantity.parameter()).with_context(|| format!("--vary {}", named.name))?;
            varied.place(quantity, named.distribution);
        }
        anyhow::ensure!(
            !varied.parameters.is_empty(),
            "no parameter varies; give parameters and distributions, as in --vary ed=normal:1:0.001 --vary eb=normal:1:0.003"
        );
        for (one, two, value) in &self.correlate {
            let place = |name: &str| -> anyhow::Result<usize> {
                let key = Quantity::find(name, study).context("--correlate")?.key();
                let place = varied.parameters.iter().position(|(quantity, _)| quantity.key() == key);
                place.with_context(|| format!("--correlate: {name} does not vary; give it a distribution with --vary"))
            };
            let of = [place(one)?, place(two)?];
            varied.correlations.push(Correlation { of, value: *value });
        }
        Ok(varied)
    }
}

impl Varied {
    /// Gives a parameter its distribution, in the place of another; its place in the list.
    fn place(&mut self, quantity: Quantity, distribution: Distribution) -> usize {
        let known = self.parameters.iter().position(|(other, _)| other.key() == quantity.key());
        let place = known.unwrap_or(self.parameters.len());
        match known {
            Some(place) => self.parameters[place].1 = distribution,
            None => self.parameters.push((quantity, distribution)),
        }
        place
    }
}
