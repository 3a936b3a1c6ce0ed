//! An effect of the user's own against the same law of the catalogue: one replay of a tracked run, for values and derivatives.
//!
//! `cargo bench -p umbmark-benches --bench formula`; throughput is in pieces per second. A formula is to take no more than
//! three times as long.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Evaluate, Formula, Model, Target};
use umbmark_core::geometry::seeded;
use umbmark_core::path::{Direction, Path};
use umbmark_core::replay::Track;

/// The catalogue's law and its formula, by name.
type Pair = (&'static str, Model, Model);

fn pairs() -> Vec<Pair> {
    let robot = Robot::labmate();
    let listed = |effect: &str, values: &[(&str, f64)]| {
        let mut model = Model::new(&robot);
        for (parameter, value) in values {
            model.set(effect, parameter, *value).expect("it is in the catalogue");
        }
        model
    };
    let own = |formulas: &[(Target, &str, &[&str], &[f64])]| {
        let mut model = Model::new(&robot);
        for (i, (target, text, names, values)) in formulas.iter().enumerate() {
            let formula = Formula::new(&format!("own_{i}"), *target, text, names).expect("a formula");
            model.add_formula(formula, values).expect("a name of its own");
        }
        model
    };
    let slope = &[("cosine_rad_per_m", 1e-3), ("sine_rad_per_m", 2e-3)];
    let text = "c * cos(heading) + s * sin(heading)";
    let drift = |sign| (if sign > 0.0 { "d * distance / 2" } else { "-d * distance / 2" }, &["d"][..], &[4e-3][..]);
    let (left, right) = (drift(-1.0), drift(1.0));
    vec![
        (
            "floor_slope_yaw",
            listed("floor_slope_yaw", slope),
            own(&[(Target::HeadingPerMetre, text, &["c", "s"], &[1e-3, 2e-3])]),
        ),
        (
            "diameter_drift",
            listed("diameter_drift", &[("per_m", 4e-3)]),
            own(&[
                (Target::LeftWheelScale, left.0, left.1, left.2),
                (Target::RightWheelScale, right.0, right.1, right.2),
            ]),
        ),
    ]
}

fn replay<T: Evaluate>(criterion: &mut Criterion, kind: &str, values: fn(&Model) -> Vec<T>) {
    let track = Track::watched(&Path::umbmark(), Direction::Ccw, &Robot::labmate());
    for (name, listed, own) in pairs() {
        let mut group = criterion.benchmark_group(format!("formula {name} {kind}"));
        group.throughput(Throughput::Elements(track.travel().len() as u64));
        for (which, model) in [("nothing", Model::new(&Robot::labmate())), ("listed", listed), ("formula", own)] {
            let chain = model.chain_with(&values(&model));
            group.bench_function(which, |bencher| bencher.iter(|| black_box(&track).end(&chain)));
        }
        group.finish();
    }
}

fn formula(criterion: &mut Criterion) {
    replay(criterion, "values", |model| model.values().collect());
    replay(criterion, "derivatives", |model| seeded(model.values(), &[0, 1][..model.values().count().min(2)]));
}

criterion_group!(benches, formula);
criterion_main!(benches);
