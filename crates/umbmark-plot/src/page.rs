//! One page of everything: a single file that needs no network.

mod identifiers;
mod provenance;
mod quality;
mod summary;
mod unseen;
mod verdict;

use minijinja::value::Serde;
use minijinja::{Environment, Value, context};
use serde::Serialize;
use serde_json::json;
use umbmark_core::action::Wording;

use crate::figure::{Axis, Figure, Table};
use crate::kind::KINDS;
use crate::render::{legend, plotly, svg};
use crate::scale;
use crate::study::Study;
use crate::tone::Tone;

use summary::Summary;

pub use minijinja::Error as PageError;
pub use provenance::{Origin, Provenance};
pub use summary::change;
pub use verdict::said;

const TEMPLATE: &str = include_str!("page/report.html");
const TILE: &str = include_str!("page/tile.html");
const TABLE: &str = include_str!("page/table.html");
const STYLE: &str = include_str!("page/report.css");
const SCRIPT: &str = include_str!("page/report.js");
/// The library that draws figures in pages.
pub const PLOTLY: &str = include_str!("../vendor/plotly-basic.min.js");

/// What a part of the page is about, and the sections that stand in it first to last; all others stand in the last.
const CHAPTERS: [(&str, &str, &[&str]); 3] = [
    ("where", "Where it fails", &["return_errors", "tracks", "residuals_by_move"]),
    ("evidence", "Evidence", &["learning", "laws", "parameters", "quality", "next"]),
    ("all", "All other figures", &[]),
];

/// A part of the page.
#[derive(Debug, Serialize)]
struct Chapter {
    id: &'static str,
    title: &'static str,
    sections: Vec<Section>,
}

impl Chapter {
    /// All of them that have something to say.
    fn of(mut sections: Vec<Section>) -> Vec<Chapter> {
        let mut chapters = Vec::new();
        for (id, title, first) in CHAPTERS {
            let place = |section: &Section| first.iter().position(|own| *own == section.id);
            let (mut own, rest): (Vec<Section>, Vec<Section>) =
                sections.into_iter().partition(|section| first.is_empty() || place(section).is_some());
            own.sort_by_key(|section| place(section));
            sections = rest;
            chapters.push(Chapter { id, title, sections: own });
        }
        chapters.retain(|chapter| !chapter.sections.is_empty());
        chapters
    }
}

/// A section: one kind of figure, or one kind of list, for each study.
#[derive(Debug, Serialize)]
struct Section {
    id: &'static str,
    title: String,
    parts: Vec<Part>,
}

/// What a section says of one study.
#[derive(Debug, Default, Serialize)]
struct Part {
    study: String,
    figure: Option<Drawn>,
    /// Why there is no figure.
    absent: Option<String>,
    lists: Vec<List>,
}

/// A figure, ready for the page.
#[derive(Debug, Serialize)]
struct Drawn {
    id: String,
    title: String,
    shows: String,
    good: String,
    says: String,
    height: f64,
    /// Least width of the plot in characters.
    least: usize,
    legend: Vec<(String, &'static str, &'static str)>,
    print: String,
    table: Rows,
}

/// Sentences or a table under a heading.
#[derive(Debug, Default, Serialize)]
struct List {
    title: String,
    sentences: Vec<String>,
    table: Option<Rows>,
}

#[derive(Debug, Serialize)]
struct Rows {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl From<Table> for Rows {
    fn from(table: Table) -> Rows {
        Rows { header: table.header, rows: table.rows }
    }
}

/// The page of one study, or of several side by side, with what the program calls its actions; `seen` hears how many of [`KINDS`] are built.
pub fn page(
    studies: &[Study],
    provenance: &Provenance,
    actions: Wording,
    mut seen: impl FnMut(usize),
) -> Result<String, PageError> {
    let mut figures = serde_json::Map::new();
    let mut sections: Vec<Section> = Vec::new();
    let mut absent = Vec::new();
    for (index, kind) in KINDS.iter().enumerate() {
        seen(index);
        match figure_section(studies, kind, &mut figures) {
            section if section.parts.iter().any(|part| part.figure.is_some()) => sections.push(section),
            section => absent.push(section),
        }
        match kind.name {
            "confusability" => {
                sections.push(list_section(studies, "unseen", "What these runs cannot show", unseen::unseen));
                sections.push(list_section(studies, "next", "What to measure next", unseen::next));
            }
            "runs" => {
                sections.push(list_section(studies, "quality", "Is the data good?", quality::quality));
            }
            _ => {}
        }
    }
    let runs = |study: &Study| {
        let run = |run: &umbmark_core::dataset::Run| json!({ "name": run.name, "direction": run.direction.map(|d| d.name()) });
        json!({ "name": study.name, "runs": study.data.runs.iter().map(run).collect::<Vec<_>>() })
    };
    let tones: serde_json::Map<_, _> =
        Tone::ALL.iter().map(|t| (t.name().to_owned(), json!([t.on_white(), t.on_black()]))).collect();
    let data = json!({ "figures": figures, "studies": studies.iter().map(runs).collect::<Vec<_>>(), "tones": tones });
    let mut environment = Environment::new();
    environment.add_filter("ids", identifiers::marked);
    environment.add_template("report.html", TEMPLATE)?;
    environment.add_template("table.html", TABLE)?;
    environment.add_template("tile.html", TILE)?;
    let filters: Vec<_> = studies.iter().map(filter).collect();
    let summaries: Vec<Summary> = studies.iter().map(|study| Summary::of(study, actions)).collect();
    environment.get_template("report.html")?.render(context! {
        title => title(studies),
        robot => robot(studies),
        summaries => Value::from(Serde(summaries)),
        changed => Value::from(Serde(summary::changed(studies))),
        partial => studies.iter().any(Study::is_partial),
        many => studies.len() > 1,
        chapters => Value::from(Serde(Chapter::of(sections))),
        absent => Value::from(Serde(&absent)),
        filters => Value::from(Serde(&filters)),
        tones => Tone::ALL.map(|t| (t.name(), t.on_white(), t.on_black())),
        provenance => Value::from(Serde(provenance)),
        style => Value::from_safe_string(STYLE.to_owned()),
        script => Value::from_safe_string(SCRIPT.to_owned()),
        plotly => Value::from_safe_string(PLOTLY.to_owned()),
        data => Value::from_safe_string(data.to_string().replace('<', "\\u003c")),
    })
}

fn title(studies: &[Study]) -> String {
    let names: Vec<&str> = studies.iter().map(|study| study.name.as_str()).collect();
    names.join(" and ")
}

/// What the robot of all studies is called; nothing where they are several.
fn robot(studies: &[Study]) -> Option<String> {
    let mut names = studies.iter().map(|study| study.data.robot.as_ref().map(|robot| robot.name.clone()));
    let first = names.next()??;
    names.all(|name| name.as_ref() == Some(&first)).then_some(first).filter(|name| !name.is_empty())
}

/// The runs that can be chosen.
fn filter(study: &Study) -> serde_json::Value {
    let directions: Vec<&str> = umbmark_core::path::Direction::BOTH
        .into_iter()
        .filter(|direction| study.data.runs.iter().any(|run| run.direction == Some(*direction)))
        .map(|direction| direction.name())
        .collect();
    let names: Vec<&str> = study.data.runs.iter().map(|run| run.name.as_str()).collect();
    json!({ "name": study.name, "directions": directions, "runs": names })
}

fn figure_section(
    studies: &[Study],
    kind: &crate::kind::FigureKind,
    figures: &mut serde_json::Map<String, serde_json::Value>,
) -> Section {
    let mut built: Vec<_> = studies.iter().map(|study| study.begin().and_then(|()| (kind.build)(study))).collect();
    align(built.iter_mut().flatten().collect());
    let title = built.iter().flatten().next().map_or_else(|| spoken(kind.about), |figure| figure.title.clone());
    let mut parts = Vec::new();
    for (index, (study, figure)) in studies.iter().zip(built).enumerate() {
        let mut part = Part { study: study.name.clone(), ..Part::default() };
        match figure {
            Ok(figure) => {
                let drawn = drawn(figure, index, figures);
                part.figure = Some(drawn);
            }
            Err(absent) => part.absent = Some(absent.to_string()),
        }
        parts.push(part);
    }
    Section { id: kind.name, title, parts }
}

fn drawn(figure: Figure, index: usize, figures: &mut serde_json::Map<String, serde_json::Value>) -> Drawn {
    let id = format!("{}-{index}", figure.kind);
    let mut plot = plotly::figure(&figure);
    let height = plot["layout"]["height"].as_f64().unwrap_or(400.0);
    plot["study"] = json!(index);
    figures.insert(id.clone(), plot);
    let legend = legend::entries(&figure);
    let legend =
        legend.iter().map(|(name, tone, mark)| ((*name).to_owned(), tone.name(), legend::word(mark, *tone))).collect();
    let print = svg::svg(&figure, &svg::Style { width_mm: 130.0, id: format!("print-{id}") });
    let least =
        figure.panels.iter().map(|panel| panel.x.names.len() + usize::from(!panel.x.names.is_empty()) * 14).max();
    Drawn {
        title: figure.title,
        shows: figure.told.shows,
        good: figure.told.good,
        says: figure.told.says,
        height,
        least: least.unwrap_or(0),
        legend,
        print,
        table: figure.table.into(),
        id,
    }
}

fn list_section(studies: &[Study], id: &'static str, title: &str, of: fn(&Study) -> Vec<List>) -> Section {
    let part = |study: &Study| Part { study: study.name.clone(), lists: of(study), ..Part::default() };
    Section { id, title: title.into(), parts: studies.iter().map(part).collect() }
}

/// Words as the beginning of a sentence.
fn spoken(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Gives the same kind of figure the same ends in all studies, so that they can be compared by eye.
fn align(mut figures: Vec<&mut Figure>) {
    let panels = figures.iter().map(|figure| figure.panels.len()).min().unwrap_or(0);
    if figures.len() < 2 || figures.iter().any(|figure| figure.panels.len() != panels) {
        return;
    }
    for index in 0..panels {
        let (x, y): (Vec<_>, Vec<_>) = figures.iter().map(|figure| scale::ends(&figure.panels[index])).unzip();
        let widest = |ends: Vec<[f64; 2]>| {
            ends.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [a, b]| [low.min(a), high.max(b)])
        };
        let (x, y) = (widest(x), widest(y));
        for figure in &mut figures {
            let panel = &mut figure.panels[index];
            for (axis, ends) in [(&mut panel.x, x), (&mut panel.y, y)] {
                widen(axis, ends);
            }
        }
    }
}

fn widen(axis: &mut Axis, ends: [f64; 2]) {
    if axis.names.is_empty() {
        axis.range = Some(ends);
    }
}
