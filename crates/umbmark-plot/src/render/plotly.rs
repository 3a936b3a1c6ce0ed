//! The JSON of a figure for Plotly: in pages, and as `plotly.graph_objects.Figure(json)` in Python.
//!
//! Traces carry in `meta` what a page needs to recolour and to filter them: `tone`, `direction`, and for cells both shades. Indices of
//! runs are in `customdata`.

use serde_json::{Map, Value, json};

use super::font::FAMILY;
use crate::figure::{Axis, Figure, Layer, Mark, Panel};
use crate::scale;
use crate::tone::shade;

/// Between panels \[px\].
const BETWEEN: f64 = 62.0;
/// Between an effect and its parameter, in names; a page begins a line after it.
const NAME_OF: &str = ": ";
/// Above the first panel and below the last \[px\].
const MARGINS: (f64, f64) = (26.0, 52.0);

/// A figure as `data` and `layout`.
pub fn figure(figure: &Figure) -> Value {
    let heights: Vec<f64> = figure.panels.iter().map(height).collect();
    let gaps = BETWEEN * figure.panels.len().saturating_sub(1) as f64;
    let whole = heights.iter().sum::<f64>() + gaps;
    let mut layout = Map::from_iter([
        ("height".to_owned(), json!(whole + MARGINS.0 + MARGINS.1)),
        ("margin".to_owned(), json!({ "t": MARGINS.0, "b": MARGINS.1, "l": 56, "r": 12 })),
        ("showlegend".to_owned(), json!(false)),
        ("hovermode".to_owned(), json!("closest")),
        ("dragmode".to_owned(), json!(false)),
        ("barmode".to_owned(), json!("overlay")),
        ("bargap".to_owned(), json!(0.08)),
        ("font".to_owned(), json!({ "family": FAMILY, "size": 12 })),
        ("paper_bgcolor".to_owned(), json!("rgba(0,0,0,0)")),
        ("plot_bgcolor".to_owned(), json!("rgba(0,0,0,0)")),
    ]);
    let (mut data, mut titles, mut top) = (Vec::new(), Vec::new(), whole);
    for (index, (panel, height)) in figure.panels.iter().zip(heights).enumerate() {
        let number = if index == 0 { String::new() } else { (index + 1).to_string() };
        let domain = [((top - height) / whole).max(0.0), top / whole];
        let (x, y) = axes(panel, &number, domain);
        layout.insert(format!("xaxis{number}"), x);
        layout.insert(format!("yaxis{number}"), y);
        data.extend(drawn(panel).map(|layer| trace(layer, &number)));
        if !panel.title.is_empty() {
            titles.push(title(&panel.title, domain[1]));
        }
        top -= height + BETWEEN;
    }
    layout.insert("annotations".into(), json!(titles));
    json!({ "data": data, "layout": layout })
}

/// How far the wheels had rolled at each place of each trace of a [`figure`] \[m\], in the order of its `data`: a page that links figures
/// finds a place of a run in the others by it. Empty for traces whose places stand for whole runs, or for none.
pub fn rolled(figure: &Figure) -> Value {
    figure.panels.iter().flat_map(drawn).map(|layer| numbers(&layer.rolled)).collect()
}

/// The layers of a panel that become traces.
fn drawn(panel: &Panel) -> impl Iterator<Item = &Layer> {
    panel.layers.iter().filter(|layer| !layer.is_empty())
}

/// Height of a panel \[px\].
fn height(panel: &Panel) -> f64 {
    // Such names take two lines.
    let is_high = panel.y.names.len() <= 6 || panel.y.names.iter().any(|name| name.contains(NAME_OF));
    match (panel.equal, panel.y.names.len()) {
        (true, 0) => 400.0,
        (true, names) => (names as f64 * if is_high { 30.0 } else { 20.0 } + 60.0).max(220.0),
        (false, 0) => 230.0,
        (false, names) => (names as f64 * if is_high { 38.0 } else { 25.0 }).max(90.0),
    }
}

fn title(words: &str, top: f64) -> Value {
    json!({
        "text": format!("<b>{}</b>", escaped(words)), "x": 0, "xref": "paper", "xanchor": "left", "y": top, "yref": "paper",
        "yanchor": "bottom", "showarrow": false,
    })
}

fn axes(panel: &Panel, number: &str, domain: [f64; 2]) -> (Value, Value) {
    let (x_ends, y_ends) = scale::ends(panel);
    let mut x = axis(&panel.x, x_ends);
    let mut y = axis(&panel.y, y_ends);
    x.insert("anchor".into(), json!(format!("y{number}")));
    y.insert("anchor".into(), json!(format!("x{number}")));
    y.insert("domain".into(), json!(domain));
    if panel.equal && panel.y.names.is_empty() {
        y.insert("scaleanchor".into(), json!(format!("x{number}")));
    }
    if !panel.x.names.is_empty() {
        x.insert("tickangle".into(), json!(-90));
    }
    (Value::Object(x), Value::Object(y))
}

fn axis(axis: &Axis, [low, high]: [f64; 2]) -> Map<String, Value> {
    let mut told = Map::from_iter([
        ("title".to_owned(), json!({ "text": escaped(&axis.title), "standoff": 8 })),
        ("range".to_owned(), if axis.falling { json!([high, low]) } else { json!([low, high]) }),
        ("automargin".to_owned(), json!(true)),
        ("zeroline".to_owned(), json!(false)),
        ("showline".to_owned(), json!(true)),
        ("ticks".to_owned(), json!("")),
    ]);
    if !axis.names.is_empty() {
        let names: Vec<String> = axis.names.iter().map(|name| escaped(name).replace(NAME_OF, ":<br>")).collect();
        told.insert("tickvals".into(), json!((0..names.len()).collect::<Vec<_>>()));
        told.insert("ticktext".into(), json!(names));
        told.insert("showgrid".into(), json!(false));
    }
    told
}

fn trace(layer: &Layer, number: &str) -> Value {
    let colour = layer.tone.on_white();
    let mut trace = Map::from_iter([
        ("type".to_owned(), json!("scatter")),
        ("name".to_owned(), json!(escaped(&layer.name))),
        ("x".to_owned(), numbers(&layer.x)),
        ("y".to_owned(), numbers(&layer.y)),
        ("xaxis".to_owned(), json!(format!("x{number}"))),
        ("yaxis".to_owned(), json!(format!("y{number}"))),
        ("meta".to_owned(), meta(layer)),
    ]);
    let more = match &layer.mark {
        Mark::Line => json!({ "mode": "lines", "line": { "color": colour, "width": 2 } }),
        Mark::Dashes => json!({ "mode": "lines", "line": { "color": colour, "width": 1.5, "dash": "dash" } }),
        Mark::Dots => json!({ "mode": "markers", "marker": { "color": colour, "size": 7, "symbol": symbol(layer) } }),
        Mark::Rings => {
            let symbol = format!("{}-open", symbol(layer));
            json!({ "mode": "markers", "marker": { "color": colour, "size": 9, "symbol": symbol } })
        }
        Mark::Crosses => {
            let line = json!({ "width": 2, "color": colour });
            json!({ "mode": "markers", "marker": { "color": colour, "size": 13, "symbol": "cross-thin", "line": line } })
        }
        Mark::Bars(width) => {
            json!({ "type": "bar", "textposition": "none", "width": rounded(*width), "marker": { "color": colour } })
        }
        Mark::Spans(low, high) => spans(layer, low, high),
        Mark::Cells(values) => cells(layer, values),
        Mark::Words(words) => json!({ "mode": "text", "text": words.iter().map(|w| escaped(w)).collect::<Vec<_>>() }),
    };
    trace.extend(more.as_object().cloned().unwrap_or_default());
    trace.extend(hover(layer));
    if !layer.runs.is_empty() {
        trace.insert("customdata".into(), json!(layer.runs));
    }
    Value::Object(trace)
}

/// The shape of a place.
fn symbol(layer: &Layer) -> &'static str {
    if layer.tone.is_modelled() { "diamond" } else { "circle" }
}

fn hover(layer: &Layer) -> Map<String, Value> {
    let mut hover = Map::new();
    if !layer.said.is_empty() {
        hover.insert("text".into(), json!(layer.said.iter().map(|word| escaped(word)).collect::<Vec<_>>()));
        hover.insert("hovertemplate".into(), json!("%{text}<extra></extra>"));
    } else if layer.runs.is_empty() {
        hover.insert("hoverinfo".into(), json!("skip"));
    } else {
        hover.insert("hovertemplate".into(), json!("%{x:.3~f}, %{y:.3~f}<extra>%{fullData.name}</extra>"));
    }
    hover
}

fn meta(layer: &Layer) -> Value {
    let mut meta = Map::from_iter([("tone".to_owned(), json!(layer.tone.name()))]);
    meta.extend(layer.direction.map(|direction| ("direction".to_owned(), json!(direction.name()))));
    if let Mark::Cells(values) = &layer.mark {
        for (name, dark) in [("light", false), ("dark", true)] {
            meta.insert(name.into(), json!(values.iter().map(|value| shade(*value, dark)).collect::<Vec<_>>()));
        }
    }
    Value::Object(meta)
}

fn spans(layer: &Layer, low: &[f64], high: &[f64]) -> Value {
    let colour = layer.tone.on_white();
    let beside = |ends: &[f64]| numbers(&layer.x.iter().zip(ends).map(|(x, end)| (end - x).abs()).collect::<Vec<_>>());
    json!({
        "mode": "markers",
        "marker": { "color": colour, "size": 9, "symbol": symbol(layer) },
        "error_x": {
            "type": "data", "symmetric": false, "array": beside(high), "arrayminus": beside(low),
            "color": colour, "thickness": 2.5, "width": 5,
        },
    })
}

/// Bars of height one, each standing where its cell begins.
fn cells(layer: &Layer, values: &[f64]) -> Value {
    let shades: Vec<String> = values.iter().map(|value| shade(*value, false)).collect();
    json!({
        "type": "bar",
        "textposition": "none",
        "y": vec![1; values.len()],
        "base": layer.y.iter().map(|y| y - 0.5).collect::<Vec<_>>(),
        "width": 1,
        "marker": { "color": shades, "line": { "width": 0 } },
    })
}

/// Six digits; nothing where there is no number.
fn numbers(values: &[f64]) -> Value {
    json!(values.iter().map(|value| rounded(*value)).collect::<Vec<_>>())
}

fn rounded(value: f64) -> Value {
    if !value.is_finite() {
        return Value::Null;
    }
    let short: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if short == short.trunc() && short.abs() < 1e15 { json!(short as i64) } else { json!(short) }
}

/// Words that Plotly takes for words: it reads a few tags.
fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_gaps_are_null() {
        assert_eq!(numbers(&[1.0 / 3.0, f64::NAN, 2.0, -0.0, 123456.78]), json!([0.333333, null, 2, 0, 123457]));
    }
}
