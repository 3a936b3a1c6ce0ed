//! Where errors of tracks are made and what they depend on, before and after the model.

use umbmark_core::compare::tracks::{Against, Bin, By, Mean, Part, Rate, TracksJudged};
use umbmark_core::path::Direction;

use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::kind::p_is;
use crate::scale::written;
use crate::study::{Absent, Study};
use crate::thin::thin;
use crate::tone::Tone;

/// Places of one panel of errors along the way.
const PLACES: usize = 6000;
/// Fewer of one run lose its shape.
const OF_RUN: usize = 24;

/// Factors and units of errors forward, to the left, and of the heading.
const COMPONENTS: [(&str, f64, &str); 3] =
    [("forward", 1e3, "mm"), ("to the left", 1e3, "mm"), ("heading", 180.0 / std::f64::consts::PI, "deg")];

pub(super) fn by_speed(study: &Study) -> Result<Figure, Absent> {
    by(study, "residuals_by_speed", "the speed", &["speed"], &Rate::DEPENDING)
}

pub(super) fn by_turn_rate(study: &Study) -> Result<Figure, Absent> {
    by(study, "residuals_by_turn_rate", "the turn rate", &["turn_rate"], &[Rate::Forward, Rate::Yaw, Rate::Turn])
}

pub(super) fn by_wheel_angle(study: &Study) -> Result<Figure, Absent> {
    let wheels = ["wheel_angle_left", "wheel_angle_right"];
    by(study, "residuals_by_wheel_angle", "the angle of a wheel", &wheels, &[Rate::Forward, Rate::Yaw])
}

pub(super) fn by_heading(study: &Study) -> Result<Figure, Absent> {
    by(study, "residuals_by_heading", "the heading in the room", &["heading"], &Rate::DEPENDING)
}

/// The nominal robot and the model beside the tracks.
fn models(study: &Study) -> Result<(&TracksJudged, &TracksJudged), Absent> {
    match &study.along()?.models[..] {
        [nominal, model] => Ok((nominal, model)),
        _ => Err(Absent("The tracks were not compared.".into())),
    }
}

fn by(study: &Study, kind: &'static str, title: &str, covariates: &[&str], rates: &[Rate]) -> Result<Figure, Absent> {
    let (nominal, model) = models(study)?;
    let wanted = |a: &&Against| covariates.contains(&a.covariate.name) && rates.contains(&a.rate) && a.p.is_some();
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
        return Err(Absent(format!("The runs have no range of {title}, or are too few to say what depends on it.")));
    }
    let told = Told {
        shows: format!(
            "Errors made from one measured pose to the next, in proportion to what was driven, against {title}: of the \
             nominal robot and of {}, with {:.0} % intervals that rest on how runs differ.",
            study.model_name(),
            100.0 * study.level()
        ),
        good: "Those of the model lie on the dashed line at zero everywhere; a slope or a wave is an effect that it lacks."
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
    let p_of = |a: &Against| a.p.unwrap_or(1.0);
    let all = |a: &Against| (p_of(a) * tests as f64).min(1.0);
    let depending: Vec<String> = pairs
        .iter()
        .filter(|(_, model)| all(model) < size)
        .map(|(_, model)| format!("{} ({} of all {tests} tests)", model.rate.name(), p_is(all(model))))
        .collect();
    if !depending.is_empty() {
        return format!("What the model leaves depends on {title}: {}.", depending.join(", "));
    }
    let least = pairs.iter().map(|(_, model)| p_of(model)).fold(1.0, f64::min);
    format!("What the model leaves is not seen to depend on {title} (smallest {}, one of {tests} tests).", p_is(least))
}

fn against_panel(nominal: &Against, model: &Against) -> Panel {
    let (scale, unit) = model.rate.display();
    let labels: Vec<String> = model.bins.iter().map(|bin| label(model, bin)).collect();
    let of = |against: &Against| -> Vec<Option<Mean>> { against.bins.iter().map(|bin| bin.mean).collect() };
    // The bins are the same, being cut by what was driven.
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
fn pair_of_layers(
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

fn with_half(mean: &Mean, scale: f64) -> String {
    let half = mean.interval.map(|i| format!(" ± {:.2}", 0.5 * scale * (i.high - i.low))).unwrap_or_default();
    format!("{}{half}", written(scale * mean.value, 2))
}

/// A bin in words.
fn label(against: &Against, bin: &Bin) -> String {
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

pub(super) fn by_move(study: &Study) -> Result<Figure, Absent> {
    let (nominal, model) = models(study)?;
    let moves = |judged: &TracksJudged| -> Vec<Part> {
        judged.parts.iter().filter(|part| part.by == By::Move).cloned().collect()
    };
    let (nominal, model) = (moves(nominal), moves(model));
    if model.is_empty() || model.len() != nominal.len() {
        return Err(Absent("The ends of legs and turns were not measured.".into()));
    }
    let name =
        |part: &Part| format!("{}{}", part.direction.map_or(String::new(), |d| format!("{} ", d.name())), part.name);
    let labels: Vec<String> = model.iter().map(name).collect();
    let panel = |(k, (component, scale, unit)): (usize, (&str, f64, &str))| {
        let of = |parts: &[Part]| parts.iter().map(|part| Some(part.mean[k])).collect::<Vec<_>>();
        Panel {
            title: component.to_owned(),
            x: Axis::of(format!("error made there [{unit}]")),
            y: Axis::named(labels.clone()).falling(),
            equal: false,
            layers: pair_of_layers(&labels, &of(&nominal), &of(&model), scale, unit),
        }
    };
    let most = model.iter().max_by(|a, b| a.share.position.total_cmp(&b.share.position));
    let says = most.map_or(String::new(), |part| {
        let share = 100.0 * part.share.position;
        format!(
            "Of the squared error that the model leaves, {share:.0} % comes from {}, more than from any other.",
            name(part)
        )
    });
    let rows = model.iter().zip(&nominal).zip(&labels).map(|((model, nominal), label)| {
        let cell = |part: &Part, k: usize| with_half(&part.mean[k], COMPONENTS[k].1);
        [
            label.clone(),
            cell(nominal, 0),
            cell(model, 0),
            cell(nominal, 1),
            cell(model, 1),
            cell(nominal, 2),
            cell(model, 2),
            format!("{:.0}", 100.0 * model.share.position),
        ]
    });
    let header =
        ["move", "forward [mm]", "model", "to the left [mm]", "model", "heading [deg]", "model", "share, model [%]"];
    Ok(Figure {
        kind: "residuals_by_move",
        title: "Residuals by leg and turn".into(),
        told: Told {
            shows: format!(
                "The error that each leg and turn adds, as the robot sees it, had it begun without any: mean over the runs with \
                 its {:.0} % interval, of the nominal robot and of {}.",
                100.0 * study.level(),
                study.model_name()
            ),
            good: "Those of the model lie on the dashed line at zero; one leg apart points to a place, all legs alike to the robot."
                .into(),
            says,
        },
        panels: COMPONENTS.into_iter().enumerate().map(panel).collect(),
        table: Table::new(header, rows),
    })
}

pub(super) fn along(study: &Study) -> Result<Figure, Absent> {
    let (nominal, model) = models(study)?;
    let most = (PLACES / model.residuals.len().max(1)).max(OF_RUN);
    let mut lines: [Vec<Layer>; 3] = Default::default();
    for direction in [Some(Direction::Cw), Some(Direction::Ccw), None] {
        let (mut places, mut runs): ([Vec<[f64; 2]>; 3], Vec<usize>) = Default::default();
        for run in model.residuals.iter().filter(|run| run.direction == direction) {
            let column = |k: usize| run.errors.iter().map(|error| error[k]).collect::<Vec<f64>>();
            let kept = thin(&[&column(0), &column(1), &column(2)], most);
            let index = study.data.runs.iter().position(|own| own.name == run.run).unwrap_or_default();
            runs.extend(std::iter::repeat_n(index, kept.len() + 1));
            for (k, places) in places.iter_mut().enumerate() {
                places.extend(kept.iter().map(|i| [run.rolled[*i], COMPONENTS[k].1 * run.errors[*i][k]]));
                places.push([f64::NAN, f64::NAN]);
            }
        }
        for (lines, places) in lines.iter_mut().zip(places).filter(|(_, places)| !places.is_empty()) {
            let name = direction.map_or("runs".to_owned(), |d| format!("{} runs", d.name()));
            let layer = Layer::new(name, direction.map_or(Tone::Measured, Tone::of), Mark::Line, places);
            lines.push(Layer { direction, ..layer.from_runs(runs.clone()) });
        }
    }
    let panel = |(layers, (component, _, unit)): (Vec<Layer>, (&str, f64, &str))| Panel {
        title: component.to_owned(),
        x: Axis::of("way rolled [m]"),
        y: Axis::of(format!("error [{unit}]")),
        equal: false,
        layers,
    };
    let mm = |judged: &TracksJudged| format!("{:.1}", 1e3 * judged.along.position);
    let end = |judged: &TracksJudged| format!("{:.1}", 1e3 * judged.end.position);
    let rows = [nominal, model].map(|judged| [judged.name.clone(), mm(judged), end(judged)]);
    Ok(Figure {
        kind: "residuals_along",
        title: "Residuals along the way".into(),
        told: Told {
            shows: format!(
                "Where the robot is, seen from where {} has it, along each run: forward, to the left, and turned to the left.",
                study.model_name()
            ),
            good: "Lines wander about zero, each its own way; runs that stray together show what the model lacks."
                .into(),
            says: format!(
                "The root mean square distance is {} mm along the way, {} mm for the nominal robot.",
                mm(model),
                mm(nominal)
            ),
        },
        panels: lines.into_iter().zip(COMPONENTS).map(panel).collect(),
        table: Table::new(["model", "along the way [mm]", "at the ends [mm]"], rows),
    })
}
