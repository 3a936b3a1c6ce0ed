//! Every kind of figure of two small datasets: drawn to the letter, and said in words.
//!
//! `SNAPSHOTS=overwrite cargo test -p umbmark-plot --test figures` writes the golden files anew; look at them.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;

use snapbox::{Data, assert_data_eq};
use umbmark_core::action::Action;
use umbmark_core::diagnose;
use umbmark_plot::figure::{Figure, Layer};
use umbmark_plot::kind::{all, find};
use umbmark_plot::page::{Provenance, page};
use umbmark_plot::render::{bitmap, plotly, svg};
use umbmark_plot::study::{Options, Study};

fn study(name: &str) -> Study {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../umbmark-cli/tests/data").join(name);
    let diagnose = diagnose::Options { draws: 99, ..diagnose::Options::default() };
    Study::new(name, umbmark_io::load(folder).unwrap(), None, Options { diagnose, trials: 200 })
}

/// Return poses of a robot on a slope.
static SLOPE: LazyLock<Study> = LazyLock::new(|| study("slope"));
/// One tracked run each way.
static TRACKED: LazyLock<Study> = LazyLock::new(|| study("tracked"));

fn drawn(study: &Study) -> Vec<Figure> {
    all().filter_map(|kind| (kind.build)(study).ok()).collect()
}

fn golden(figure: &Figure, of: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{}_{of}.svg", figure.kind));
    assert_data_eq!(svg::svg(figure, &svg::Style::default()), Data::read_from(&file, None).raw());
}

#[test]
fn figures_of_return_poses_are_drawn_as_they_were() {
    let figures = drawn(&SLOPE);
    figures.iter().for_each(|figure| golden(figure, "slope"));
    let goldens = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")).unwrap();
    let drawn: BTreeSet<String> = figures.iter().map(|figure| format!("{}_slope.svg", figure.kind)).collect();
    let names = goldens.map(|file| file.unwrap().file_name().into_string().unwrap());
    assert_eq!(names.filter(|name| name.ends_with("_slope.svg")).collect::<BTreeSet<_>>(), drawn);
}

#[test]
fn figures_of_tracks_are_drawn_as_they_were() {
    let kinds = ["tracks", "residuals_along", "residuals_by_move"];
    for kind in kinds {
        golden(&(find(kind).unwrap().build)(&TRACKED).unwrap(), "tracked");
    }
}

#[test]
fn what_cannot_be_drawn_says_why_in_a_sentence() {
    for study in [&*SLOPE, &*TRACKED] {
        for kind in all() {
            let Err(absent) = (kind.build)(study) else { continue };
            let why = absent.to_string();
            assert!(why.ends_with('.') && why.len() > 20, "{}: {why}", kind.name);
        }
    }
}

#[test]
fn every_figure_says_what_it_shows_what_good_is_and_what_it_finds() {
    for figure in drawn(&SLOPE).iter().chain(&drawn(&TRACKED)) {
        for sentence in [&figure.told.shows, &figure.told.good, &figure.told.says] {
            assert!(sentence.ends_with('.') && !sentence.contains("NaN") && !sentence.contains("inf "), "{sentence}");
        }
        assert!(figure.table.rows.iter().all(|row| row.len() == figure.table.header.len()), "{}", figure.kind);
    }
}

#[test]
fn no_drawing_holds_what_is_no_number() {
    for figure in drawn(&SLOPE).iter().chain(&drawn(&TRACKED)) {
        let json = plotly::figure(figure).to_string();
        let svg = svg::svg(figure, &svg::Style::default());
        for text in [&json, &svg] {
            assert!(!text.contains("NaN") && !text.contains(":inf"), "{}", figure.kind);
        }
    }
}

#[test]
fn a_place_of_a_run_is_where_its_wheels_had_rolled_so_far_in_every_figure() {
    let of = |kind: &str| (find(kind).unwrap().build)(&TRACKED).unwrap();
    let ways = |layer: &Layer, run: usize| -> Vec<f64> {
        let own = layer.rolled.iter().zip(&layer.runs).filter(|(way, of)| **of == run && way.is_finite());
        own.map(|(way, _)| *way).collect()
    };
    let (along, tracks) = (of("residuals_along"), of("tracks"));
    let layers = |figure: &Figure| figure.panels.iter().flat_map(|panel| panel.layers.clone()).collect::<Vec<Layer>>();
    for layer in &layers(&along) {
        // The axis shows the same way.
        assert!(layer.rolled.iter().zip(&layer.x).all(|(way, x)| way == x || way.is_nan() && x.is_nan()));
    }
    for run in 0..2 {
        let whole = layers(&along).iter().find_map(|layer| ways(layer, run).last().copied()).unwrap();
        let drawn: Vec<Vec<f64>> = layers(&tracks).iter().map(|layer| ways(layer, run)).collect();
        let drawn: Vec<&Vec<f64>> = drawn.iter().filter(|ways| !ways.is_empty()).collect();
        // Computed, modelled and measured.
        assert_eq!(drawn.len(), 3);
        for ways in drawn {
            assert!(
                ways.is_sorted() && ways[0] < 0.05 && (ways[ways.len() - 1] - whole).abs() < 0.05,
                "{ways:?} {whole}"
            );
        }
    }
}

#[test]
fn the_ways_of_a_trace_are_as_many_as_its_places_or_none() {
    let mut with = 0;
    for figure in drawn(&SLOPE).iter().chain(&drawn(&TRACKED)) {
        let (traces, rolled) = (plotly::figure(figure), plotly::rolled(figure));
        let (traces, rolled) = (traces["data"].as_array().unwrap(), rolled.as_array().unwrap());
        assert_eq!(traces.len(), rolled.len(), "{}", figure.kind);
        for (trace, rolled) in traces.iter().zip(rolled).filter(|(_, rolled)| !rolled.as_array().unwrap().is_empty()) {
            let count = rolled.as_array().unwrap().len();
            assert_eq!(trace["customdata"].as_array().unwrap().len(), count, "{}", figure.kind);
            assert_eq!(trace["x"].as_array().unwrap().len(), count, "{}", figure.kind);
            with += 1;
        }
    }
    assert!(with > 10, "{with}");
}

#[test]
fn pictures_and_pages_for_paper_are_the_same_each_time() {
    let figure = (find("return_errors").unwrap().build)(&SLOPE).unwrap();
    let drawing = svg::svg(&figure, &svg::Style::default());
    let png = bitmap::png(&drawing, 192.0).unwrap();
    assert!(png == bitmap::png(&drawing, 192.0).unwrap());
    assert_eq!(&png[1..4], b"PNG");
    // 88 mm at 192 dots per inch.
    let width = u32::from_be_bytes(png[16..20].try_into().unwrap());
    assert_eq!(width, (88.0 * 192.0 / 25.4f64).ceil() as u32);
    let pdf = bitmap::pdf(&drawing).unwrap();
    assert!((0..8).all(|_| pdf == bitmap::pdf(&drawing).unwrap()));
    assert!(pdf.starts_with(b"%PDF"));
}

#[test]
fn a_page_of_one_study_is_one_file_without_a_network() {
    let text = page(std::slice::from_ref(&*SLOPE), &Provenance::default(), Action::plain, |_| ()).unwrap();
    assert!(text.len() < 5_000_000);
    for outside in ["<link", "<script src", "@import", "src=\"http"] {
        assert!(!text.contains(outside), "{outside}");
    }
}

#[test]
fn a_page_that_is_stopped_says_so_and_what_is_missing() {
    let stop = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let stopped = [study("slope").stopped_by(&stop)];
    let last = |done: usize| stop.store(done >= 1, std::sync::atomic::Ordering::Relaxed);
    let text = page(&stopped, &Provenance::default(), Action::plain, last).unwrap();
    assert!(stopped[0].is_partial());
    for part in ["<strong>PARTIAL.</strong>", "The work was stopped before this part was finished.", "from START"] {
        assert!(text.contains(part), "{part}");
    }
    assert!(
        !page(std::slice::from_ref(&*SLOPE), &Provenance::default(), Action::plain, |_| ())
            .unwrap()
            .contains("PARTIAL")
    );
}

#[test]
fn figures_are_written_down_and_come_back_as_they_were() {
    for study in [&*SLOPE, &*TRACKED] {
        for figure in drawn(study) {
            let written = serde_json::to_string(&figure).unwrap();
            let read: Figure = serde_json::from_str(&written).unwrap();
            assert_eq!(svg::svg(&read, &svg::Style::default()), svg::svg(&figure, &svg::Style::default()));
            assert_eq!(plotly::figure(&read), plotly::figure(&figure), "{}", figure.kind);
        }
    }
    assert!(serde_json::from_str::<Figure>("{\"kind\": \"pie\"}").unwrap_err().to_string().contains("no kind"));
}
