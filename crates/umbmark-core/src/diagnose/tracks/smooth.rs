//! Effects outside the catalogue: what a smooth function of how the robot drives would do to its poses.
//!
//! Each smooth adds to the forward, the sideways or the yaw motion, in proportion to the way driven (or to the rotation, or
//! to the way of one wheel), a function of one covariate. Its columns are sums along the run, in the error coordinates of
//! [`Growth`](crate::likelihood::Growth): cheap, and in the same tests as the catalogue's effects.

use crate::effect::{Chain, Context, Model};

use crate::likelihood::{Column, Observed, ObservedRun};
use rayon::prelude::*;

/// What a smooth adds to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Way forward.
    Forward,
    /// Way to the left.
    Sideways,
    /// Rotation.
    Yaw,
}

impl Motion {
    /// All three.
    pub const ALL: [Motion; 3] = [Motion::Forward, Motion::Sideways, Motion::Yaw];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Motion::Forward => "forward",
            Motion::Sideways => "sideways",
            Motion::Yaw => "yaw",
        }
    }
}

/// What a smooth is in proportion to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exposure {
    /// Way driven.
    Way,
    /// Way driven, in the sense of the last turn.
    WayInSense,
    /// Way of the left or the right wheel.
    WheelWay(usize),
    /// Rotation, either way.
    Rotation,
    /// Time in which the wheels move.
    Time,
    /// The same, in the sense of the turn.
    TimeInSense,
    /// Way driven and way of the wheels in turns.
    AnyWay,
}

impl Exposure {
    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Exposure::Rotation => "rad",
            Exposure::Time | Exposure::TimeInSense => "s",
            _ => "m",
        }
    }

    fn of(self, p: &Piece) -> f64 {
        match self {
            Exposure::Way => p.at.length,
            Exposure::WayInSense => p.at.length * p.at.last_turn,
            Exposure::WheelWay(wheel) => p.wheel_way[wheel],
            Exposure::Rotation | Exposure::TimeInSense if !p.scales.turns => 0.0,
            Exposure::Rotation => p.rotation.abs(),
            Exposure::Time | Exposure::TimeInSense if p.at.stands() => 0.0,
            Exposure::Time => p.at.duration,
            Exposure::TimeInSense => p.at.duration * p.at.turn_rate.signum(),
            Exposure::AnyWay => p.at.length + 0.5 * p.scales.wheelbase * p.rotation.abs(),
        }
    }
}

/// Something that an effect may depend on.
#[derive(Clone, Copy, Debug)]
pub struct Covariate {
    /// Its name, as formulas of the user's own have it.
    pub name: &'static str,
    /// In words.
    pub title: &'static str,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// What the smooth is in proportion to.
    pub exposure: Exposure,
    /// Number of functions in the smooth.
    pub terms: usize,
    /// Its value over a piece.
    pub value: fn(&Piece) -> f64,
    /// The value that counts as one.
    pub scale: fn(&Scales) -> f64,
    /// The functions of the scaled value.
    pub basis: fn(f64, &mut [f64]),
}

/// The greatest values in the data.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// \[m/s\]
    pub speed: f64,
    /// \[rad/s\]
    pub turn_rate: f64,
    /// Duration of a run \[s\].
    pub duration: f64,
    /// Number of runs.
    pub runs: f64,
    /// Wheelbase \[m\].
    pub wheelbase: f64,
    /// Whether the runs turn.
    pub turns: bool,
}

impl Scales {
    /// Of some runs.
    pub fn new(observed: &Observed) -> Scales {
        let contexts = || observed.tracks().flat_map(|track| track.contexts());
        let most = |of: fn(&Context) -> f64| contexts().map(of).fold(f64::MIN_POSITIVE, f64::max);
        Scales {
            speed: most(|c| c.speed.abs()),
            turn_rate: most(|c| c.turn_rate.abs()),
            duration: most(|c| c.time + c.duration),
            runs: observed.runs.len().max(1) as f64,
            wheelbase: observed.robot.drive.wheelbase(),
            turns: observed.turns(),
        }
    }
}

/// A piece of a run with what covariates are scaled by.
pub struct Piece<'a> {
    at: &'a Context,
    rotation: f64,
    wheel_way: [f64; 2],
    /// Length of the run \[m\].
    way: f64,
    scales: &'a Scales,
}

impl Piece<'_> {
    /// A piece as the odometry has it, in a run of length `way`.
    pub fn believed<'a>(at: &'a Context, way: f64, scales: &'a Scales) -> Piece<'a> {
        Piece { at, rotation: at.turn_rate * at.duration, wheel_way: at.wheel_rotation.map(f64::abs), way, scales }
    }

    /// Whether the smooths of a covariate add to it.
    pub fn counts(&self, covariate: &Covariate) -> bool {
        covariate.exposure.of(self) != 0.0
    }
}

/// The covariate that stands for errors that repeat themselves, whatever their cause.
pub const ALONG_THE_WAY: &str = "distance";

const fn covariate(name: &'static str, title: &'static str, terms: usize, value: fn(&Piece) -> f64) -> Covariate {
    Covariate { name, title, unit: "", exposure: Exposure::Way, terms, value, scale: |_| 1.0, basis: powers }
}

/// Everything that smooths may depend on.
pub const COVARIATES: [Covariate; 14] = [
    Covariate { unit: "m/s", scale: |s| s.speed, ..covariate("speed", "the speed", 2, |p| p.at.speed.abs()) },
    Covariate {
        unit: "rad/s",
        exposure: Exposure::Rotation,
        scale: |s| s.turn_rate,
        basis: |x, out| out.copy_from_slice(&[x, 1.0, x.abs()]),
        ..covariate("turn_rate", "the turn rate", 3, |p| p.at.turn_rate.abs() * p.rotation.signum())
    },
    Covariate {
        unit: "m/s²",
        exposure: Exposure::Time,
        basis: with_its_size,
        ..covariate("acceleration", "the acceleration", 2, |p| p.at.acceleration())
    },
    Covariate {
        unit: "rad/s²",
        exposure: Exposure::TimeInSense,
        basis: with_its_size,
        ..covariate("turn_acceleration", "the change of the turn rate", 2, turn_acceleration)
    },
    Covariate {
        unit: "rad",
        exposure: Exposure::WheelWay(0),
        basis: cyclic,
        ..covariate("wheel_angle_left", "the angle of the left wheel", 6, |p| wheel_angle(p, 0))
    },
    Covariate {
        unit: "rad",
        exposure: Exposure::WheelWay(1),
        basis: cyclic,
        ..covariate("wheel_angle_right", "the angle of the right wheel", 6, |p| wheel_angle(p, 1))
    },
    Covariate {
        unit: "rad",
        basis: cyclic,
        ..covariate("heading", "the heading in the room", 6, |p| p.at.believed_heading + 0.5 * p.rotation)
    },
    Covariate {
        unit: "s",
        scale: |s| s.duration,
        ..covariate("time", "the time in the run", 3, |p| p.at.time + 0.5 * p.at.duration)
    },
    Covariate {
        scale: |s| s.runs,
        ..covariate("session_distance", "the place of the run in the session", 2, |p| p.at.run)
    },
    Covariate { unit: "m", basis: decays, ..covariate("since_turn", "the way since the last turn", 3, since_turn) },
    Covariate {
        unit: "m",
        exposure: Exposure::WayInSense,
        basis: decays,
        ..covariate("since_turn * last_turn", "the way since the last turn and its sense", 3, since_turn)
    },
    covariate("last_turn", "the sense of the last turn", 1, |p| p.at.last_turn),
    covariate("direction", "the sense of the run", 1, |p| p.at.direction),
    Covariate {
        exposure: Exposure::AnyWay,
        basis: |x, out| {
            out.fill(0.0);
            let own = if x.is_sign_negative() { &mut out[..6] } else { &mut out[6..] };
            cyclic(std::f64::consts::TAU * x.abs(), own);
        },
        ..covariate(ALONG_THE_WAY, "the place in the run and its sense", 12, |p| {
            (p.at.distance / p.way).copysign(p.at.direction)
        })
    },
];

fn wheel_angle(p: &Piece, wheel: usize) -> f64 {
    p.at.wheel_angle[wheel] + 0.5 * p.at.wheel_rotation[wheel]
}

fn since_turn(p: &Piece) -> f64 {
    p.at.since_turn + 0.5 * p.at.length
}

/// Positive where a turn, whatever its sense, gets faster.
fn turn_acceleration(p: &Piece) -> f64 {
    p.at.turn_acceleration() * p.at.turn_rate.signum()
}

/// x, x², ...
fn powers(x: f64, out: &mut [f64]) {
    let mut power = 1.0;
    for value in out {
        power *= x;
        *value = power;
    }
}

/// x and |x|.
fn with_its_size(x: f64, out: &mut [f64]) {
    out.copy_from_slice(&[x, x.abs()]);
}

/// cos x, sin x, cos 2x ...
fn cyclic(x: f64, out: &mut [f64]) {
    let (sine, cosine) = libm::sincos(x);
    let (mut real, mut imaginary) = (1.0, 0.0);
    for pair in out.chunks_exact_mut(2) {
        (real, imaginary) = (real * cosine - imaginary * sine, imaginary * cosine + real * sine);
        (pair[0], pair[1]) = (real, imaginary);
    }
}

/// exp(-d/λ)/λ for λ of 5, 15 and 50 cm: each adds 1 in all.
fn decays(d: f64, out: &mut [f64]) {
    for (value, length) in out.iter_mut().zip([0.05, 0.15, 0.5]) {
        *value = libm::exp(-d / length) / length;
    }
}

/// The columns of every covariate for every motion: run by run, in the order of [`COVARIATES`] and [`Motion::ALL`], terms last.
pub fn smooth_columns(observed: &Observed, model: &Model) -> Vec<Vec<Column>> {
    let (scales, chain) = (Scales::new(observed), model.chain());
    observed.runs.par_iter().map(|run| of_run(run, &chain, &scales)).collect()
}

fn of_run(run: &ObservedRun, chain: &Chain<f64>, scales: &Scales) -> Vec<Column> {
    let terms: usize = COVARIATES.iter().map(|c| c.terms).sum();
    let track = &run.track;
    let way = track.length().max(f64::MIN_POSITIVE);
    // Sums of each term times what turns a motion of the body into one of START's frame.
    let mut states: [Vec<f64>; 5] = std::array::from_fn(|_| vec![0.0; terms]);
    let mut columns = vec![vec![[0.0; 3]; run.blocks.len()]; 3 * terms];
    let mut basis = vec![0.0; terms];
    let (mut pose, mut made, mut turns) = (track.start(chain), 0, [0.0; 5]);
    for (index, block) in run.blocks.iter().enumerate() {
        let reached = run.made_at(block);
        let until = (reached.ceil() as usize).min(track.travel().len()).max(made);
        for (travel, at) in track.travel()[made..until].iter().zip(&track.contexts()[made..until]) {
            let motion = chain.displacement(&at.at_pose(&pose), travel);
            let middle = pose.moved(&crate::geometry::Displacement2 {
                forward: 0.5 * motion.forward,
                sideways: 0.5 * motion.sideways,
                rotation: 0.5 * motion.rotation,
            });
            let wheel_way = [travel.left.abs(), travel.right.abs()];
            let piece = Piece { at, rotation: motion.rotation, wheel_way, way, scales };
            let mut rest = basis.as_mut_slice();
            for covariate in &COVARIATES {
                let own;
                (own, rest) = rest.split_at_mut(covariate.terms);
                let exposure = covariate.exposure.of(&piece);
                (covariate.basis)((covariate.value)(&piece) / (covariate.scale)(scales), own);
                own.iter_mut().for_each(|value| *value *= exposure);
            }
            let (sine, cosine) = libm::sincos(middle.heading);
            turns = [cosine, sine, middle.x, middle.y, 1.0];
            for (state, added) in states.iter_mut().zip(turns) {
                state.iter_mut().zip(&basis).for_each(|(state, value)| *state += value * added);
            }
            pose = pose.moved(&motion);
        }
        made = until;
        // Not yet of the last piece.
        let ahead = (until as f64 - reached).clamp(0.0, 1.0);
        let (mut column, mut first) = (columns.iter_mut(), 0);
        for covariate in &COVARIATES {
            for motion in Motion::ALL {
                for term in first..first + covariate.terms {
                    let Some(column) = column.next() else { continue };
                    let at = |k: usize| states[k][term] - ahead * turns[k] * basis[term];
                    let [cosine, sine, x, y, one] = std::array::from_fn(at);
                    column[index] = match motion {
                        Motion::Forward => [cosine, sine, 0.0],
                        Motion::Sideways => [-sine, cosine, 0.0],
                        Motion::Yaw => [y - block.place.y * one, block.place.x * one - x, one],
                    };
                }
            }
            first += covariate.terms;
        }
    }
    columns
}

/// The groups of columns, in the order of [`smooth_columns`]: covariate, motion, first column and number.
pub fn groups() -> Vec<(&'static Covariate, Motion, usize, usize)> {
    let mut first = 0;
    let mut groups = Vec::new();
    for covariate in &COVARIATES {
        for motion in Motion::ALL {
            groups.push((covariate, motion, first, covariate.terms));
            first += covariate.terms;
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::{Formula, Target};
    use crate::likelihood::watched::watched;

    /// A covariate, a motion, one of the terms, and what it is multiplied by.
    type Term = (&'static str, Motion, usize, f64);
    /// What a formula acts on, and its text.
    type Law = (Target, String);

    /// What k does to the poses of each run, for laws that add k times these formulas.
    fn by_formulas(observed: &Observed, laws: &[Law]) -> Vec<Column> {
        let mut sums: Vec<Column> = observed.runs.iter().map(|run| vec![[0.0; 3]; run.blocks.len()]).collect();
        for (target, text) in laws {
            let mut model = Model::new(&observed.robot);
            model.add_formula(Formula::new("own", *target, &format!("k * {text}"), &["k"]).unwrap(), &[0.0]).unwrap();
            for (sum, own) in sums.iter_mut().zip(observed.columns(&model, &[0])) {
                add(sum, &own[0], 1.0);
            }
        }
        sums
    }

    fn add(sum: &mut Column, column: &Column, factor: f64) {
        sum.iter_mut().flatten().zip(column.iter().flatten()).for_each(|(sum, value)| *sum += factor * value);
    }

    /// Oracle: exact derivatives of replays with formulas that do the same, on squares driven both ways. Both are of the poses in a
    /// block, of their middle or of their mean, and so agree to what a block adds.
    #[test]
    fn a_smooth_moves_the_robot_as_a_formula_does_that_adds_the_same() {
        use Motion::{Forward, Sideways, Yaw};
        use Target::{
            ForwardPerRadian, ForwardScale, HeadingPerMetre, LeftWheelScale, RightWheelScale, SidewaysPerMetre,
            SidewaysPerRadian, TurnScale,
        };
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        let smooths = smooth_columns(&observed, &model);
        let Scales { speed, turn_rate, duration, wheelbase, .. } = Scales::new(&observed);
        assert!((speed - 0.2).abs() < 1e-2 && (turn_rate - 0.4 / 0.34).abs() < 0.1, "{speed} {turn_rate}");
        let wheel = 1.0 / wheelbase;
        let rolls =
            |wheel: &str, sense: &str| format!("cos(wheel_angle_{wheel}) * sign(speed {sense} 0.17 * turn_rate)");
        let way = observed.runs[0].track.length();
        let place = format!("sin(4 * pi * distance / {way})");
        let same: [(&[Term], &[Law]); 15] = [
            (&[("speed", Yaw, 0, speed)], &[(HeadingPerMetre, "abs(speed)".into())]),
            (&[("speed", Sideways, 1, speed * speed)], &[(SidewaysPerMetre, "speed^2".into())]),
            (&[("speed", Forward, 0, speed)], &[(ForwardScale, "abs(speed)".into())]),
            (&[("turn_rate", Yaw, 0, turn_rate)], &[(TurnScale, "abs(turn_rate)".into())]),
            (&[("turn_rate", Yaw, 2, turn_rate)], &[(TurnScale, "turn_rate".into())]),
            (&[("turn_rate", Forward, 2, turn_rate)], &[(ForwardPerRadian, "abs(turn_rate)".into())]),
            (&[("turn_rate", Sideways, 0, turn_rate)], &[(SidewaysPerRadian, "turn_rate".into())]),
            (&[("heading", Yaw, 3, 1.0)], &[(HeadingPerMetre, "sin(2 * heading)".into())]),
            (&[("time", Sideways, 1, duration * duration)], &[(SidewaysPerMetre, "time^2".into())]),
            (&[("since_turn", Yaw, 1, 0.15)], &[(HeadingPerMetre, "exp(-since_turn / 0.15)".into())]),
            (
                &[("since_turn * last_turn", Forward, 2, 0.5)],
                &[(ForwardScale, "last_turn * exp(-since_turn / 0.5)".into())],
            ),
            (&[("direction", Yaw, 0, 1.0)], &[(HeadingPerMetre, "direction".into())]),
            (
                &[("wheel_angle_left", Forward, 0, 0.5), ("wheel_angle_left", Yaw, 0, -wheel)],
                &[(LeftWheelScale, rolls("left", "-"))],
            ),
            (
                &[("wheel_angle_right", Forward, 0, 0.5), ("wheel_angle_right", Yaw, 0, wheel)],
                &[(RightWheelScale, rolls("right", "+"))],
            ),
            // One half of the terms is of either sense.
            (
                &[(ALONG_THE_WAY, Yaw, 3, 1.0), (ALONG_THE_WAY, Yaw, 9, 1.0)],
                &[(HeadingPerMetre, place.clone()), (TurnScale, format!("sign(turn_rate) * 0.17 * {place}"))],
            ),
        ];
        for (terms, formulas) in same {
            let expected = by_formulas(&observed, formulas);
            for (run, (columns, expected)) in smooths.iter().zip(&expected).enumerate() {
                let mut sum = vec![[0.0; 3]; expected.len()];
                for (name, motion, term, factor) in terms {
                    let own = groups().into_iter().find(|(c, m, ..)| c.name == *name && m == motion).unwrap();
                    add(&mut sum, &columns[own.2 + term], *factor);
                }
                for k in 0..3 {
                    let most = expected.iter().map(|error| error[k].abs()).fold(0.0, f64::max);
                    let near = |(a, b): (&[f64; 3], &[f64; 3])| (a[k] - b[k]).abs() <= 0.1 * most + 1e-9;
                    assert!(sum.iter().zip(expected).all(near), "{terms:?} in run {run}, {k}");
                }
            }
        }
    }
}
