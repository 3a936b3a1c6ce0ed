//! Each run among the others of its direction.

use nalgebra::{Matrix2, Vector2};
use umbmark_core::dataset::ReturnError;
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;
use umbmark_core::stats::f_upper_tail;

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::kind::p_is;
use crate::study::{Absent, Study};
use crate::tone::Tone;

/// Fewer runs a direction say nothing of one among them: the scatter of the others is a plane's.
const FEWEST: usize = 5;
/// A run is called unusual where one so far off would be seen in fewer than this share of tests without any.
const UNUSUAL: f64 = 0.05;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "runs", about: "each run's distance from the others: outliers, drift", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let mut all: Vec<Among> = Vec::new();
    for direction in Direction::BOTH {
        all.extend(among(&study.returns(TestKind::Systematic, direction), direction));
    }
    if all.is_empty() {
        return Err(Absent(format!("At least {FEWEST} runs in one direction are needed to find unusual ones.")));
    }
    let name = |run: usize| study.data.runs[run].name.clone();
    let count = all.len() as f64;
    let dots = |direction: Direction| {
        let own: Vec<(usize, &Among)> = all.iter().enumerate().filter(|(_, a)| a.direction == direction).collect();
        let said = |a: &Among| format!("{}: {}", name(a.run), p_is(a.p));
        Layer::new(
            format!("{} runs", direction.name()),
            Tone::of(direction),
            Mark::Dots,
            own.iter().map(|(i, a)| [*i as f64 + 1.0, -a.p.max(1e-12).log10()]),
        )
        .of(direction)
        .saying(own.iter().map(|(_, a)| said(a)).collect())
        .from_runs(own.iter().map(|(_, a)| a.run).collect())
    };
    let limit = -(UNUSUAL / count).log10();
    let mut layers = vec![Layer::new("unusual above", Tone::Limit, Mark::Dashes, [[0.5, limit], [count + 0.5, limit]])];
    layers.extend(Direction::BOTH.map(dots).into_iter().filter(|layer| !layer.is_empty()));
    let panel = Panel {
        title: String::new(),
        x: Axis::of("run, in the order of the data").from_to(0.0, count + 1.0),
        y: Axis::of("how unusual: −log₁₀ p"),
        equal: false,
        layers,
    };
    let unusual: Vec<String> = all.iter().filter(|a| a.p < UNUSUAL / count).map(|a| name(a.run)).collect();
    let says = match unusual.len() {
        0 => "No run is unusual.".to_owned(),
        _ => format!("Check {}: was it bumped, mistyped, or measured in another way?", unusual.join(", ")),
    };
    let told = Told {
        shows: "Distance of each end point from those of the other runs of its direction, as the probability p that chance gives \
                this distance or more (Hotelling's T², the run itself left out)."
            .into(),
        good: format!(
            "All dots lie below the dashed line, with no trend along the session. Without a bad run, the highest dot is above the line in {:.0} % of \
             tests.",
            100.0 * UNUSUAL
        ),
        says,
    };
    let table = Table::new(["run", "p"], all.iter().map(|a| [name(a.run), format!("{:.3}", a.p)]));
    Ok(Figure { kind: "runs", title: "Each run among the others".into(), told, panels: vec![panel], table })
}

/// A run beside the others.
struct Among {
    run: usize,
    direction: Direction,
    p: f64,
}

/// Each run of a direction against the mean and scatter of the others.
fn among(returns: &[(usize, ReturnError)], direction: Direction) -> Vec<Among> {
    if returns.len() < FEWEST {
        return Vec::new();
    }
    let place = |e: &ReturnError| Vector2::new(e.x, e.y);
    let of = |(i, (run, error)): (usize, &(usize, ReturnError))| {
        let others: Vec<Vector2<f64>> =
            returns.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, (_, e))| place(e)).collect();
        let p = outside(&place(error), &others)?;
        Some(Among { run: *run, direction, p })
    };
    returns.iter().enumerate().filter_map(of).collect()
}

/// p of a place so far from the mean of others: T² = m/(m + 1) dᵀ S⁻¹ d, (m - 2)/(2 (m - 1)) T² is F with 2 and m - 2 degrees of
/// freedom for m normal others. `None` where they have no scatter.
fn outside(place: &Vector2<f64>, others: &[Vector2<f64>]) -> Option<f64> {
    let m = others.len() as f64;
    let mean = others.iter().sum::<Vector2<f64>>() / m;
    let scatter = others.iter().map(|o| (o - mean) * (o - mean).transpose()).sum::<Matrix2<f64>>() / (m - 1.0);
    let d = place - mean;
    let t2 = m / (m + 1.0) * d.dot(&(scatter.try_inverse()? * d));
    let p = f_upper_tail(t2.max(0.0) * (m - 2.0) / (2.0 * (m - 1.0)), [2.0, m - 2.0]);
    p.is_finite().then_some(p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::random::Stream;

    /// 4000 tests of 5 normal runs, seed 7: p is uniform, so a share of 0.05 ± 0.0034 (one standard error) is below 0.05; held to
    /// four of those.
    #[test]
    fn p_of_a_run_that_is_like_the_others_is_uniform() {
        const TESTS: u64 = 4000;
        let below = (0..TESTS).filter(|trial| {
            let mut stream = Stream::new(7, 0, *trial);
            let mut place = || Vector2::new(stream.normal(), 3.0 * stream.normal());
            let others: Vec<Vector2<f64>> = (0..4).map(|_| place()).collect();
            outside(&place(), &others).unwrap() < 0.05
        });
        let share = below.count() as f64 / TESTS as f64;
        assert!((share - 0.05).abs() < 4.0 * 0.0034, "{share}");
    }

    #[test]
    fn runs_without_scatter_are_not_judged() {
        assert_eq!(outside(&Vector2::new(1.0, 0.0), &[Vector2::zeros(); 4]), None);
    }
}
