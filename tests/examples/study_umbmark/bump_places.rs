//! How return position and heading depend on where the ten bumps lie (Fig. 6 of the paper).

use crate::figure::{COLOURS, Figure};
use crate::shares::moments;
use crate::{Study, labmate};
use umbmark_core::dataset::ReturnError;
use umbmark_core::drive::Wheel;
use umbmark_core::effect::{About, ActsOn, Bump, BumpLaw, Effect, Entry, Stretch, TestKind, extra_travel};
use umbmark_core::parameter::Parameter;
use umbmark_core::path::{Direction, Path};
use umbmark_core::random::Stream;
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

const fn number(name: &'static str, usual: f64, meaning: &'static str) -> Parameter {
    Parameter::shape(name, name, "", usual, (0.0, 1.0), meaning)
}

/// Ten bumps of 10 mm under the inside wheel on the first leg, wherever wanted.
struct BumpsSomewhere;

impl Effect for BumpsSomewhere {
    const ABOUT: About = About {
        name: "bumps_somewhere",
        title: "ten bumps within a part of the first leg",
        acts_on: ActsOn::Wheels,
        parameters: &[
            number("middle", 0.5, "middle of the bumps, as a share of the leg"),
            number("width", 1.0, "length over which they are spread evenly, as a share of the leg"),
            number("random", 0.0, "1 for places at random on the whole leg"),
        ],
        equation: "each bump loses D of the inside wheel's travel",
        physics: "a cable of 10 mm, wheels of 75 mm radius",
        signature: "heading turns by D/b a bump",
        confused_with: &[],
        separated_by: "",
        source: "Borenstein & Feng (1995), Fig. 6",
    };
}

impl BumpLaw for BumpsSomewhere {
    fn bumps(p: &[f64], stretch: &Stretch, stream: &mut Stream, met: &mut Vec<Bump>) {
        if stretch.test != TestKind::Bumps || stretch.index != 0 {
            return;
        }
        let wheel = if stretch.direction == Direction::Ccw { Wheel::Left } else { Wheel::Right };
        for i in 0..10 {
            let even = p[0] + p[1] * ((f64::from(i) + 0.5) / 10.0 - 0.5);
            let at = if p[2] == 1.0 { stream.uniform() } else { even.clamp(0.0, 1.0) };
            met.push(Bump { at, wheel, lost: extra_travel(0.010, 0.075, true) });
        }
    }
}

static BUMPS: Entry = Entry::of::<BumpsSomewhere>().bumps::<BumpsSomewhere>();

/// Return errors of counter-clockwise runs with bumps placed like this.
fn driven(study: &Study, [middle, width, random]: [f64; 3], k: f64, runs: u64) -> Vec<ReturnError> {
    let mut model = labmate(1.0, 1.0, k);
    model.add_entry(&BUMPS).unwrap().values = vec![middle, width, random];
    let mut simulator = Simulator::new(model.robot(), &Path::umbmark(), Odometry::Continuous, Phase::Edge).unwrap();
    let mut truth = Truth::new(&model);
    let one = |run: u64| {
        simulator.open(&mut truth, study.seed, run);
        simulator.run(&mut truth, Direction::Ccw, TestKind::Bumps)
    };
    (0..runs).map(one).collect()
}

fn distance(error: &ReturnError) -> f64 {
    1e3 * error.x.hypot(error.y)
}

fn degrees(error: &ReturnError) -> f64 {
    error.heading.unwrap().to_degrees()
}

/// Prints both against the place, draws both.
pub fn study(study: &Study) {
    println!("## Where the bumps lie: ten of 10 mm within a tenth of the first leg, no noise, ccw\n");
    println!("| middle of the bumps | return position off [mm] | return heading off [deg] |");
    println!("|---|---|---|");
    let mut position = Vec::new();
    for i in 0..=18 {
        let middle = 0.05 + 0.05 * f64::from(i);
        let error = driven(study, [middle, 0.1, 0.0], 0.0, 1)[0];
        position.push((middle * 4.0, distance(&error)));
        if i % 3 == 0 {
            println!("| {:.2} m | {:.1} | {:.4} |", middle * 4.0, distance(&error), degrees(&error));
        }
    }
    let even = driven(study, [0.5, 1.0, 0.0], 0.0, 1)[0];
    println!("| evenly on the leg | {:.1} | {:.4} |\n", distance(&even), degrees(&even));
    let runs = study.tests(20_000);
    println!("{runs} runs each, mean ± standard deviation from run to run (standard error of the mean):\n");
    println!("| bumps | noise | position off [mm] | heading off [deg] |");
    println!("|---|---|---|---|");
    for (name, k) in [("none", 0.0), ("sigma 45 mm", 1e-3)] {
        for (places, values) in [("evenly", [0.5, 1.0, 0.0]), ("at random on the leg", [0.5, 1.0, 1.0])] {
            let errors = driven(study, values, k, runs);
            let of = |which: fn(&ReturnError) -> f64, decimals: usize| {
                let [mean, sd, error] = moments(&errors.iter().map(which).collect::<Vec<f64>>());
                format!("{mean:.decimals$} ± {sd:.decimals$} ({error:.decimals$})")
            };
            println!("| {places} | {name} | {} | {} |", of(distance, 1), of(degrees, 3));
        }
    }
    let mut figure = Figure::new(
        "Ten bumps within 0.4 m of the first leg; the heading is 5.73 deg off wherever they lie",
        "middle of the bumps on the first leg [m]",
        "return position off [mm]",
        [0.0, 4.0],
        [0.0, 500.0],
    );
    figure.curve(&position, COLOURS[0], "simulated");
    let theory: Vec<(f64, f64)> =
        position.iter().map(|(at, _)| (*at, 1e3 * at * degrees(&even).to_radians())).collect();
    figure.dots(&theory, COLOURS[1], "place x heading (first order)");
    figure.save(study.folder, "bump_places.svg");
    println!();
}
