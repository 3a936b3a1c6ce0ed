//! End points beside the circle through START.

use umbmark_core::diagnose::OnCircle;
use umbmark_core::effect::TestKind;
use umbmark_core::path::{Direction, SQUARE};

use super::FigureKind;
use crate::figure::{Axis, Figure, Layer, Mark, Panel, Table, Told};
use crate::study::{Absent, Study};
use crate::tone::Tone;

const MM: f64 = 1e3;

pub(super) static FIGURE: FigureKind =
    FigureKind { name: "circle", about: "end points beside the circle through START", build: figure };

fn figure(study: &Study) -> Result<Figure, Absent> {
    let path = study.data.path.as_ref().filter(|path| std::ptr::eq(path.shape(), &SQUARE));
    let side = path.map(|path| path.values()[0]);
    let side = side.ok_or_else(|| {
        Absent("The circle through START exists for squares only, and this path is not a square.".into())
    })?;
    let circle = &study.comparison()?.circle;
    if circle.is_empty() {
        return Err(Absent("The circle needs at least two runs in one direction whose end was measured.".into()));
    }
    let clouds: Vec<Cloud> = Direction::BOTH.into_iter().filter_map(|d| Cloud::new(study, d, side)).collect();
    let (least, most) = clouds
        .iter()
        .flat_map(|cloud| cloud.angles.iter().chain(&cloud.heading))
        .fold((0.0f64, 0.0f64), |(low, high), angle| (low.min(*angle), high.max(*angle)));
    let margin = 0.15 * (most - least).max(0.01);
    let mut layers = vec![arc(side, least - margin, most + margin)];
    layers.push(Layer::new("START", Tone::Measured, Mark::Crosses, [[0.0, 0.0]]));
    layers.extend(clouds.iter().flat_map(|cloud| cloud.layers(side)));
    let panel = Panel {
        title: "clockwise runs mirrored".into(),
        x: Axis::of("x error [mm]"),
        y: Axis::of("y error, to the inside [mm]"),
        equal: true,
        layers,
    };
    Ok(Figure {
        kind: "circle",
        title: "The circle through START".into(),
        told: told(circle, study.level()),
        panels: vec![panel],
        table: table(circle),
    })
}

/// Where the end point lies once the path is turned about the centre of the square \[mm\].
fn turned(side: f64, angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    let half = 0.5 * side;
    [MM * (half - half * cosine + half * sine), MM * (half - half * sine - half * cosine)]
}

fn arc(side: f64, from: f64, to: f64) -> Layer {
    let places = (0..=80).map(|i| turned(side, from + (to - from) * f64::from(i) / 80.0));
    Layer::new("circle about the centre of the square", Tone::Limit, Mark::Line, places)
}

/// The end points of a direction.
struct Cloud {
    direction: Direction,
    runs: Vec<usize>,
    names: Vec<String>,
    places: Vec<[f64; 2]>,
    /// About the centre of the square.
    angles: Vec<f64>,
    /// The mean return heading, as an angle about the centre.
    heading: Option<f64>,
}

impl Cloud {
    fn new(study: &Study, direction: Direction, side: f64) -> Option<Cloud> {
        let returns = study.returns(TestKind::Systematic, direction);
        let inside = direction.sign();
        let places: Vec<[f64; 2]> = returns.iter().map(|(_, e)| [MM * e.x, MM * inside * e.y]).collect();
        let half = 0.5 * MM * side;
        let angle = |[x, y]: &[f64; 2]| (x - y).atan2(2.0 * half - x - y);
        let headings: Vec<f64> = returns.iter().filter_map(|(_, e)| e.heading).map(|h| inside * h).collect();
        let heading = umbmark_core::geometry::mean_angle(headings.iter().copied());
        (!returns.is_empty()).then(|| Cloud {
            direction,
            runs: returns.iter().map(|(index, _)| *index).collect(),
            names: returns.iter().map(|(index, _)| study.data.runs[*index].name.clone()).collect(),
            angles: places.iter().map(angle).collect(),
            places,
            heading: heading.filter(|_| headings.len() == returns.len()),
        })
    }

    fn layers(&self, side: f64) -> Vec<Layer> {
        let (name, tone) = (self.direction.name(), Tone::of(self.direction));
        let dots = Layer::new(format!("{name} runs"), tone, Mark::Dots, self.places.iter().copied())
            .of(self.direction)
            .saying(self.names.clone())
            .from_runs(self.runs.clone());
        let mark = self.heading.map(|heading| {
            let said =
                format!("{name}: place that follows from the mean return heading, {:.2} deg", heading.to_degrees());
            Layer::new(format!("{name} by heading"), tone, Mark::Crosses, [turned(side, heading)])
                .of(self.direction)
                .saying(vec![said])
        });
        std::iter::once(dots).chain(mark).collect()
    }
}

fn told(circle: &[OnCircle], level: f64) -> Told {
    let one = |c: &OnCircle| {
        let half = 0.5 * MM * (c.off_interval.high - c.off_interval.low);
        let side = if c.mean_off < 0.0 { "inside" } else { "outside" };
        let judged = match (c.off_interval.contains(0.0), c.explained()) {
            (_, true) => "on it",
            (true, false) => "on it, but not where their heading puts them",
            (false, _) => "off it",
        };
        let off = crate::scale::written(MM * c.mean_off.abs(), 0);
        format!("{} runs end {off} ± {half:.0} mm {side} the circle: {judged}", c.direction.name())
    };
    let explained = circle.iter().all(OnCircle::explained);
    let means = if explained { "E_d and E_b can explain them" } else { "E_d and E_b alone cannot explain them" };
    Told {
        shows:
            "An error that is the same on every side of the square turns the end point about the square's centre, by as much \
                as the heading turns: along the circle. Crosses show the place that follows from the measured mean headings."
                .into(),
        good: "Dots lie on the circle, around the cross of their direction: E_d and E_b can explain them.".into(),
        says: format!(
            "{} ({:.0} % intervals). {means}.",
            circle.iter().map(one).collect::<Vec<_>>().join("; "),
            100.0 * level
        ),
    }
}

fn table(circle: &[OnCircle]) -> Table {
    let row = |c: &OnCircle| {
        let half = |i: umbmark_core::stats::Interval| 0.5 * (i.high - i.low);
        let angle = c.turned_less_heading.zip(c.turned_interval);
        [
            c.direction.name().to_owned(),
            format!("{:.1} ± {:.1}", MM * c.mean_off, MM * half(c.off_interval)),
            format!("{:.1}", MM * c.distance),
            c.implied.map_or("–".into(), |implied| format!("{:.1}", MM * implied)),
            angle.map_or("–".into(), |(a, i)| format!("{:.2} ± {:.2}", a.to_degrees(), half(i).to_degrees())),
        ]
    };
    let header =
        ["direction", "off the circle [mm]", "distance [mm]", "distance by heading [mm]", "angle less heading [deg]"];
    Table::new(header, circle.iter().map(row))
}
