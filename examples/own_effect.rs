//! An effect of one's own, written in Rust and fitted to measured runs: `cargo run --release -p umbmark-tests --example own_effect`.
//!
//! The floor is suspected to turn the robot, to the left where it heads up the room and to the right where it heads down.

#![allow(clippy::print_stdout)]

use std::error::Error;

use umbmark_core::effect::{About, ActsOn, BodyLaw, Effect, Entry, Here, Model};
use umbmark_core::evidence::fit;
use umbmark_core::geometry::{Displacement2, Real};
use umbmark_core::parameter::Parameter;
use umbmark_plot::kind;
use umbmark_plot::render::svg;
use umbmark_plot::study::{Options, Study};

struct Tilt;

impl Effect for Tilt {
    const ABOUT: About = About {
        name: "tilt",
        title: "a floor that turns the robot, most where it heads along y",
        acts_on: ActsOn::Body,
        parameters: &[Parameter::size(
            "rad_per_m",
            "tilt",
            "rad/m",
            5e-3,
            (-1.0, 1.0),
            "turn to the left per metre where it heads along y",
        )],
        equation: "rotation ← rotation + k · length · sin(heading)",
        physics: "A side force on the casters of a robot that drives across a slope.",
        signature: "A turn to one side on a leg, and to the other on the leg opposite.",
        confused_with: &["floor_slope_yaw"],
        separated_by: "nothing: it is the half of floor_slope_yaw that lies along y",
        source: "this example",
    };

    fn varies(p: &[f64]) -> bool {
        p[0] != 0.0
    }
}

impl BodyLaw for Tilt {
    fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
        let (sine, _) = at.heading.sine_cosine();
        motion.rotation += p[0] * sine * at.length;
    }
}

static TILT: Entry = Entry::of::<Tilt>().body::<Tilt>();

fn main() -> Result<(), Box<dyn Error>> {
    let data = umbmark_io::load("examples/hidden")?;
    let mut model = Model::new(data.robot.as_ref().ok_or("robot.toml is missing")?);
    for known in ["wheel_diameter_ratio", "wheelbase", "scale"] {
        model.add(known)?.free = true;
    }
    model.add_entry(&TILT)?.free = true;

    let fitted = fit(&data, &model)?;
    for estimate in &fitted.estimates {
        println!("{:<22} {:<10} {:9.6}", estimate.effect, estimate.parameter, estimate.value);
    }

    let study = Study::new("examples/hidden", data, Some(("tilt".into(), fitted.model)), Options::default());
    let draw = kind::find("residuals_by_heading").ok_or("no such figure")?.build;
    let figure = draw(&study)?;
    println!("{}", figure.told.says);
    std::fs::write("own_effect.svg", svg::svg(&figure, &svg::Style::default()))?;
    Ok(())
}
