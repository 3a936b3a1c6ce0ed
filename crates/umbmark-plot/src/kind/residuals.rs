//! Where errors of tracks are made and what they depend on, before and after the model.

use umbmark_core::compare::tracks::{Against, Bin, Mean, Rate, TrackErrors};

use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::kind::p_is;
use crate::scale::written;
use crate::study::{Absent, Study};
use crate::tone::Tone;

/// Factors and units of errors forward, to the left, and of the heading.
pub(super) const COMPONENTS: [(&str, f64, &str); 3] =
    [("forward", 1e3, "mm"), ("to the left", 1e3, "mm"), ("heading", 180.0 / std::f64::consts::PI, "deg")];

/// The nominal robot and the model beside the tracks.
pub(super) fn models(study: &Study) -> Result<(&TrackErrors, &TrackErrors), Absent> {
    match study.along()? {
        [nominal, model] => Ok((nominal, model)),
        _ => Err(Absent("The tracks were not compared.".into())),
    }
}

pub(super) fn by(
    study: &Study,
    kind: &'static str,
    title: &str,
    covariates: &[&str],
    rates: &[Rate],
) -> Result<Figure, Absent> {
    let (nominal, model) = models(study)?;
    let wanted = |a: &&Against| covariates.contains(&a.covariate.name) && rates.contains(&a.rate) && a.test.is_some();
    let pairs: Vec<(&Against, &Against)> = model
        .against
        .iter()
        .filter(wanted)
        .filter_map(|own| {
            let same = |a: &&Against| a.rate == own.rate && a.covariate.name == own.covariate.name;
            Some((nominal.against.iter().find(same)?, own))
        })
        .collect();
    if pairs.is_empty() {
        return Err(Absent(format!("The runs have no range of {title}, or are too few to test dependence on it.")));
    }
    let told = Told {
        shows: format!(
            "Errors from one measured pose to the next, divided by the driven distance or angle, against {title}: of the \
             nominal robot and of {}, with {:.0} % intervals from the differences between runs.",
            study.model_name(),
            100.0 * study.level()
        ),
        good: "Those of the model lie on the dashed line at zero everywhere; a slope or a wave is a missing effect."
            .into(),
        says: says(title, &pairs, model.tests, study.options.diagnose.size),
    };
    Ok(Figure {
        kind,
        title: kind.replace('_', " ").replacen('r', "R", 1),
        told,
        panels: pairs.iter().map(|(nominal, model)| against_panel(nominal, model)).collect(),
        table: table(&pairs),
    })
}

fn says(title: &str, pairs: &[(&Against, &Against)], tests: usize, size: f64) -> String {
    let p_of = |a: &Against| a.test.map_or(1.0, |test| test.p);
    let all = |a: &Against| (p_of(a) * tests as f64).min(1.0);
    let depending: Vec<String> = pairs
        .iter()
        .filter(|(_, model)| all(model) < size)
        .map(|(_, model)| format!("{} ({} of all {tests} tests)", model.rate.name(), p_is(all(model))))
        .collect();
    if !depending.is_empty() {
        return format!("The residual of the model depends on {title}: {}.", depending.join(", "));
    }
    let least = pairs.iter().map(|(_, model)| p_of(model)).fold(1.0, f64::min);
    format!(
        "The residual of the model shows no dependence on {title} (smallest {}, one of {tests} tests).",
        p_is(least)
    )
}

fn against_panel(nominal: &Against, model: &Against) -> Panel {
    let (scale, unit) = model.rate.display();
    // The bins are the same, being cut by what was driven.
    let driven = |against: &Against| {
        model
            .bins
            .iter()
            .zip(&against.bins)
            .filter(|(own, _)| own.mean.is_some())
            .map(|(_, bin)| *bin)
            .collect::<Vec<Bin>>()
    };
    let labels: Vec<String> = driven(model).iter().map(|bin| label(model, bin)).collect();
    let of = |against: &Against| -> Vec<Option<Mean>> { driven(against).iter().map(|bin| bin.mean).collect() };
    let layers = pair_of_layers(&labels, &of(nominal), &of(model), scale, unit);
    let side = match model.covariate.name {
        "wheel_angle_left" => ", left wheel",
        "wheel_angle_right" => ", right wheel",
        _ => "",
    };
    Panel {
        title: format!("{}{side}", model.rate.name()),
        x: Axis::of(format!("error [{unit}]")),
        y: Axis::named(labels).falling(),
        equal: false,
        layers,
    }
}

/// Zero, the nominal robot and the model, one row below the other.
pub(super) fn pair_of_layers(
    labels: &[String],
    nominal: &[Option<Mean>],
    model: &[Option<Mean>],
    scale: f64,
    unit: &str,
) -> Vec<Layer> {
    let row = |name: &str, tone: Tone, means: &[Option<Mean>], shift: f64| {
        let seen: Vec<(usize, Mean)> = means.iter().enumerate().filter_map(|(i, mean)| Some((i, (*mean)?))).collect();
        let end = |pick: fn(&umbmark_core::stats::Interval) -> f64| {
            seen.iter().map(|(_, m)| scale * m.interval.as_ref().map_or(m.value, pick)).collect::<Vec<f64>>()
        };
        let said =
            seen.iter().map(|(i, m)| format!("{name}, {}: {} {unit}", labels[*i], with_half(m, scale))).collect();
        let places = seen.iter().map(|(i, m)| [scale * m.value, *i as f64 + shift]);
        Layer::new(name, tone, Mark::Spans(end(|i| i.low), end(|i| i.high)), places).saying(said)
    };
    vec![
        Layer::new("", Tone::Quiet, Mark::Dashes, [[0.0, -0.5], [0.0, labels.len() as f64 - 0.5]]),
        row("nominal robot", Tone::Computed, nominal, -0.16),
        row("model", Tone::Model, model, 0.16),
    ]
}

pub(super) fn with_half(mean: &Mean, scale: f64) -> String {
    let half = mean.interval.map(|i| format!(" ± {:.2}", 0.5 * scale * (i.high - i.low))).unwrap_or_default();
    format!("{}{half}", written(scale * mean.value, 2))
}

/// A bin in words.
fn label(against: &Against, bin: &Bin) -> String {
    match against.covariate.name {
        "run" => return of_runs(bin),
        "last_turn" => return of_last_turn(bin, against.rate.of_turns()).to_owned(),
        _ => {}
    }
    let unit = against.covariate.units[usize::from(against.rate.of_turns())];
    let cyclic = against.covariate.cyclic();
    let (scale, unit) = if cyclic { (1f64.to_degrees(), "°") } else { (1.0, unit) };
    let decimals = if cyclic { 0 } else { 2 };
    let [low, high] = [bin.span.low, bin.span.high].map(|end| written(scale * end, decimals));
    let sense = match bin.span.sense {
        s if s > 0.0 => "left, ",
        s if s < 0.0 => "right, ",
        _ => "",
    };
    let space = if unit.is_empty() || cyclic { "" } else { " " };
    if bin.span.high.is_finite() {
        format!("{sense}{low} to {high}{space}{unit}")
    } else {
        format!("{sense}over {low}{space}{unit}")
    }
}

/// A bin of runs, which are counted from 1 in words.
fn of_runs(bin: &Bin) -> String {
    let [first, last] = [bin.span.low + 1.5, bin.span.high + 0.5].map(|run| run.round() as i64);
    if first == last { format!("run {first}") } else { format!("runs {first} to {last}") }
}

/// A bin of the sense of the last turn, or of the turn itself.
fn of_last_turn(bin: &Bin, is_turn: bool) -> &'static str {
    match (bin.span.low, is_turn) {
        (low, true) if low < 0.0 => "right turns",
        (_, true) => "left turns",
        (low, false) if low < 0.0 => "after a right turn",
        (low, false) if low > 0.0 => "after a left turn",
        _ => "before any turn",
    }
}

fn table(pairs: &[(&Against, &Against)]) -> Table {
    let rows = pairs.iter().flat_map(|(nominal, model)| {
        let (scale, unit) = model.rate.display();
        let told = move |bin: Option<&Bin>| bin.and_then(|b| b.mean).map_or("–".to_owned(), |m| with_half(&m, scale));
        model.bins.iter().enumerate().map(move |(i, bin)| {
            [format!("{} [{unit}]", model.rate.name()), label(model, bin), told(nominal.bins.get(i)), told(Some(bin))]
        })
    });
    Table::new(["error", "where", "nominal robot", "model"], rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::compare::tracks::Span;

    fn bin(low: f64, high: f64) -> Bin {
        Bin { span: Span { low, high, sense: 0.0 }, amount: 1.0, mean: None }
    }

    #[test]
    fn runs_are_counted_from_one_and_bins_of_several_say_both_ends() {
        assert_eq!(of_runs(&bin(-0.5, 0.5)), "run 1");
        assert_eq!(of_runs(&bin(1.5, 3.5)), "runs 3 to 4");
    }

    #[test]
    fn the_sense_of_the_last_turn_is_a_word() {
        let ends = [[-1.0, 0.0], [0.0, 1.0], [1.0, f64::INFINITY]].map(|[low, high]| bin(low, high));
        let of = |is_turn: bool| ends.iter().map(|bin| of_last_turn(bin, is_turn)).collect::<Vec<_>>();
        assert_eq!(of(false), ["after a right turn", "before any turn", "after a left turn"]);
        assert_eq!(of(true)[0], "right turns");
        assert_eq!(of(true)[2], "left turns");
    }
}
