//! Numbers as they stand behind flags.

use std::ops::RangeInclusive;

use umbmark_core::geometry::Pose2;

/// A number written with a decimal point.
pub fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| {
        if text.contains(',') { "write decimals with a point, as in 1.002" } else { "not a number" }.to_owned()
    })?;
    if value.is_finite() { Ok(value) } else { Err("must be finite".to_owned()) }
}

/// A whole number, 0 or more; 1e6 is one too.
pub fn whole(text: &str) -> Result<u64, String> {
    let short = || text.parse().ok().filter(|n: &f64| n.fract() == 0.0 && (0.0..=9e15).contains(n)).map(|n| n as u64);
    text.parse().ok().or_else(short).ok_or_else(|| "must be a whole number, 0 or more".to_owned())
}

/// A whole number from a range; 1e6 is one too.
pub fn whole_in<N: TryFrom<u64>>(range: RangeInclusive<u64>) -> impl Fn(&str) -> Result<N, String> + Clone {
    move |text| {
        let within = whole(text).ok().filter(|n| range.contains(n)).and_then(|n| n.try_into().ok());
        within.ok_or_else(|| format!("must be a whole number between {} and {}", range.start(), range.end()))
    }
}

/// A probability between 0 and 1, both excluded.
pub fn probability(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err("must be between 0 and 1, both excluded".to_owned()) }
}

/// A pose: x and y in m, heading in rad.
pub fn pose(text: &str) -> Result<Pose2, String> {
    let numbers: Vec<f64> = text.split(',').map(number).collect::<Result<_, _>>()?;
    let [x, y, heading] = numbers[..] else {
        return Err(format!("must be x,y,heading, three numbers, but has {}", numbers.len()));
    };
    Ok(Pose2::new(x, y, heading))
}
