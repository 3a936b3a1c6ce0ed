//! Effects that the model lacks, and that bias what it tells.

use super::Verdict;
use crate::effect::{find, parameter_of};

/// An effect that the model lacks, of a size that these runs allow, and its bias of fitted numbers.
///
/// With columns A of what is fitted and a of the effect, all whitened, an effect of size s that is left out biases the fitted numbers by
/// (AᵀA)⁻¹Aᵀa s (omitted-variable bias). s is the size that these runs show, of an effect that is significant and not in the model; of
/// another its usual size, or its minimum detectable size where that is smaller.
///
/// Source: W. H. Greene, Econometric Analysis, 7th ed., 2012.
#[derive(Clone, Debug, PartialEq)]
pub struct Confounder {
    /// The effect.
    pub effect: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// Its size \[unit of the parameter\].
    pub size: f64,
    /// The numbers that it moves, either way, beyond their intervals and by more than a tenth of their usual size.
    pub biases: Vec<Bias>,
}

/// By how much an effect that is left out biases a fitted number.
#[derive(Clone, Debug, PartialEq)]
pub struct Bias {
    /// The effect that the number belongs to.
    pub effect: &'static str,
    /// The number.
    pub parameter: &'static str,
    /// The bias, without its sign \[unit of the number\].
    pub bias: f64,
    /// Half the width of the number's interval \[same unit\].
    pub half_width: f64,
}

impl Confounder {
    /// The largest of its biases, in half-widths.
    pub fn worst(&self) -> f64 {
        self.biases.iter().map(|own| own.bias / own.half_width).fold(0.0, f64::max)
    }

    /// Its name with its size, the number to two digits: "speed_slip of 0.015 s/m".
    fn with_size(&self) -> String {
        let unit = parameter_of(self.effect, self.parameter).map_or("", |own| own.unit);
        let digits = format!("{:.1e}", self.size);
        let size = digits.parse::<f64>().map_or(digits, |size| size.to_string());
        format!("{} of {size} {unit}", self.effect).trim_end().to_owned()
    }
}

/// Whether the intervals hold, by how much the worst of some confounders, largest first, would move each number, and what would show the
/// first of them; `None` for no confounder. Beside the verdict "explained" an effect that is missing is a possibility, and beside others a
/// finding.
pub(super) fn sentence(confounders: &[Confounder], verdict: Verdict) -> Option<String> {
    let mut worst: Vec<(&Bias, &Confounder)> = Vec::new();
    for own in confounders {
        for bias in &own.biases {
            match worst.iter_mut().find(|(known, _)| (known.effect, known.parameter) == (bias.effect, bias.parameter)) {
                Some(known) if known.0.bias >= bias.bias => {}
                Some(known) => *known = (bias, own),
                None => worst.push((bias, own)),
            }
        }
    }
    let (_, first) = worst.first()?;
    let one = |(bias, own): &(&Bias, &Confounder)| {
        format!("{} of {} by {:.4} ({})", bias.parameter, bias.effect, bias.bias, own.with_size())
    };
    let moved: Vec<String> = worst.iter().map(one).collect();
    let shown = find(first.effect)
        .ok()
        .map_or(String::new(), |entry| format!(" What would show {}: {}.", first.effect, entry.about.separated_by));
    let hold = match verdict {
        Verdict::Explained => "The intervals hold if the model lacks no effect. These runs allow effects",
        _ => "The intervals do not allow for what the model does not explain. These runs allow further effects",
    };
    Some(format!("{hold} that would move {}.{shown}", moved.join(", ")))
}
