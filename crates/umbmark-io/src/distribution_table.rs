//! Distributions as tables of a file: `{ mean = 1.0, sd = 0.001 }`.

use super::document::Table;
use super::error::DatasetError;
use umbmark_core::monte_carlo::Distribution;
use umbmark_core::parameter::Parameter;

/// The forms that a distribution may have.
pub(super) const DISTRIBUTIONS: &str = "mean and sd, min and max, min, mode and max, or min, max and scale = \"log\"";

/// The distribution of a parameter in a table, which may have some other keys beside.
pub(super) fn read_distribution(
    table: &Table,
    parameter: &Parameter,
    others: &[&str],
) -> Result<Distribution, DatasetError> {
    let only = |own: &[&str]| table.only(&[own, others].concat());
    let bounded = |key: &str| -> Result<f64, DatasetError> {
        let value = table.need(key, DISTRIBUTIONS)?;
        let wrong = || value.wrong_value(format!("{key} of {}", parameter.name), &parameter.allowed(), "");
        let number = value.any_number().ok_or_else(wrong)?;
        parameter.check(number).map_err(|_| wrong())
    };
    if table.get("mean").is_some() || table.get("sd").is_some() {
        only(&["mean", "sd"])?;
        let (mean, sd) = (bounded("mean")?, table.need("sd", DISTRIBUTIONS)?);
        let size = sd.any_number().filter(|sd| *sd >= 0.0 && sd.is_finite());
        let name = format!("sd of {}", parameter.name);
        let size = size.ok_or_else(|| sd.wrong_value(name, "finite and 0 or more", ""))?;
        return Ok(Distribution::Normal { mean, sd: size });
    }
    only(&["min", "mode", "max", "scale"])?;
    let (min, max) = (bounded("min")?, bounded("max")?);
    let last = table.need("max", DISTRIBUTIONS)?;
    if min > max {
        return Err(last.wrong_value(
            format!("max of {}", parameter.name),
            &format!("min ({min}) or more"),
            "exchange them",
        ));
    }
    match (table.get("mode"), table.get("scale")) {
        (None, None) => Ok(Distribution::Uniform { min, max }),
        (Some(mode), None) => {
            let number = mode.any_number().filter(|mode| min <= *mode && *mode <= max);
            let name = format!("mode of {}", parameter.name);
            let wrong = || mode.wrong_value(name, &format!("between min ({min}) and max ({max})"), "");
            Ok(Distribution::Triangular { min, mode: number.ok_or_else(wrong)?, max })
        }
        (None, Some(scale)) if scale.word("\"log\"")? != "log" => Err(scale.wrong("\"log\"", "")),
        (None, Some(scale)) if min <= 0.0 => Err(scale.wrong("left out where min is 0 or less", "")),
        (None, Some(_)) => Ok(Distribution::LogUniform { min, max }),
        (Some(mode), Some(_)) => Err(mode.wrong("left out where scale is \"log\"", "")),
    }
}
