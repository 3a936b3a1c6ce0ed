//! Distributions on the command line, in words, and in documents.

use umbmark_core::monte_carlo::Distribution;

use crate::numbers::number;

/// What a distribution looks like on the command line.
const FORMS: &str = "normal:MEAN:SD, uniform:MIN:MAX, triangular:MIN:MODE:MAX or loguniform:MIN:MAX";

/// A name and its distribution: `ed=normal:1:0.001`.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// The name.
    pub name: String,
    /// Its distribution.
    pub distribution: Distribution,
}

/// Reads NAME=DISTRIBUTION.
pub fn named(text: &str) -> Result<Named, String> {
    let wrong = || format!("write NAME=DISTRIBUTION, as in ed=normal:1:0.001; distributions are {FORMS}");
    let (name, rest) = text.split_once('=').ok_or_else(wrong)?;
    let mut words = rest.split(':');
    let kind = words.next().unwrap_or_default();
    let numbers: Vec<f64> = words.map(number).collect::<Result<_, _>>()?;
    let distribution = match (kind, numbers.as_slice()) {
        ("normal", [mean, sd]) => Distribution::Normal { mean: *mean, sd: *sd },
        ("uniform", [min, max]) => Distribution::Uniform { min: *min, max: *max },
        ("triangular", [min, mode, max]) => Distribution::Triangular { min: *min, mode: *mode, max: *max },
        ("loguniform", [min, max]) => Distribution::LogUniform { min: *min, max: *max },
        _ => return Err(wrong()),
    };
    Ok(Named { name: name.to_owned(), distribution })
}

/// A distribution for people.
pub fn distribution_words(distribution: &Distribution) -> String {
    match distribution {
        Distribution::Normal { mean, sd } => format!("{mean} ± {sd}"),
        Distribution::Uniform { min, max } => format!("{min} .. {max}"),
        Distribution::Triangular { min, mode, max } => format!("{min} .. {max}, mostly {mode}"),
        Distribution::LogUniform { min, max } => format!("{min} .. {max}, uniform in the logarithm"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read_and_nothing_else() {
        for (text, expected) in [
            ("ed=normal:1:0.001", Distribution::Normal { mean: 1.0, sd: 0.001 }),
            ("ed=uniform:-1:2", Distribution::Uniform { min: -1.0, max: 2.0 }),
            ("ed=triangular:1:2:5", Distribution::Triangular { min: 1.0, mode: 2.0, max: 5.0 }),
            ("ed=loguniform:100:1e4", Distribution::LogUniform { min: 100.0, max: 1e4 }),
        ] {
            assert_eq!(named(text), Ok(Named { name: "ed".to_owned(), distribution: expected }));
        }
        assert_eq!(named("ed=normal:1,0:2").unwrap_err(), "write decimals with a point, as in 1.002");
        for text in ["ed", "ed=normal:1", "ed=gauss:1:2", "ed=uniform:1:2:3"] {
            assert!(named(text).unwrap_err().contains("as in ed=normal:1:0.001"), "{text}");
        }
    }
}
