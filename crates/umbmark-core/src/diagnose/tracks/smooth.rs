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

/// Something that an effect may depend on.
#[derive(Clone, Copy, Debug)]
pub struct Covariate {
    /// Its name, as formulas of the user's own have it.
    pub name: &'static str,
    /// In words.
    pub title: &'static str,
    /// Number of functions in the smooth.
    pub terms: usize,
    /// The functions, times what they are in proportion to, over one piece.
    value: fn(&Piece, &mut [f64]),
}

/// A piece of a run with what covariates are scaled by.
struct Piece<'a> {
    at: &'a Context,
    rotation: f64,
    wheel_way: [f64; 2],
    duration: f64,
    way: f64,
    wheelbase: f64,
    runs: f64,
    fastest: f64,
    fastest_turn: f64,
}

/// The covariate that stands for errors that repeat themselves, whatever their cause.
pub const ALONG_THE_WAY: &str = "distance";

/// Everything that smooths are asked about.
pub const COVARIATES: [Covariate; 14] = [
    Covariate {
        name: "speed",
        title: "the speed",
        terms: 2,
        value: |p, out| {
            powers(p.at.speed.abs() / p.fastest, p.at.length, out);
        },
    },
    Covariate {
        name: "turn_rate",
        title: "the turn rate",
        terms: 3,
        value: |p, out| {
            let rate = p.at.turn_rate.abs() / p.fastest_turn;
            out.copy_from_slice(&[p.rotation * rate, p.rotation.abs(), p.rotation.abs() * rate]);
        },
    },
    Covariate {
        name: "acceleration",
        title: "the acceleration",
        terms: 2,
        value: |p, out| {
            let change = 0.5 * (p.at.speed_change[0] + p.at.speed_change[1]);
            out.copy_from_slice(&[change, change.abs()]);
        },
    },
    Covariate {
        name: "turn_acceleration",
        title: "the change of the turn rate",
        terms: 2,
        value: |p, out| {
            let change = p.at.speed_change[1] - p.at.speed_change[0];
            out.copy_from_slice(&[change, change * p.at.turn_rate.signum() * change.signum()]);
        },
    },
    Covariate {
        name: "wheel_angle_left",
        title: "the angle of the left wheel",
        terms: 6,
        value: |p, out| {
            cyclic(p.at.wheel_angle[0] + 0.5 * p.at.wheel_rotation[0], p.wheel_way[0], out);
        },
    },
    Covariate {
        name: "wheel_angle_right",
        title: "the angle of the right wheel",
        terms: 6,
        value: |p, out| {
            cyclic(p.at.wheel_angle[1] + 0.5 * p.at.wheel_rotation[1], p.wheel_way[1], out);
        },
    },
    Covariate {
        name: "heading",
        title: "the heading in the room",
        terms: 6,
        value: |p, out| {
            cyclic(p.at.heading + 0.5 * p.rotation, p.at.length, out);
        },
    },
    Covariate {
        name: "time",
        title: "the time in the run",
        terms: 3,
        value: |p, out| {
            powers(p.at.time / p.duration, p.at.length, out);
        },
    },
    Covariate {
        name: "session_distance",
        title: "the place of the run in the session",
        terms: 2,
        value: |p, out| {
            powers(p.at.run / p.runs, p.at.length, out);
        },
    },
    Covariate {
        name: "since_turn",
        title: "the way since the last turn",
        terms: 3,
        value: |p, out| {
            decays(p.at, 1.0, out);
        },
    },
    Covariate {
        name: "since_turn * last_turn",
        title: "the way since the last turn and its sense",
        terms: 3,
        value: |p, out| decays(p.at, p.at.last_turn, out),
    },
    Covariate {
        name: "last_turn",
        title: "the sense of the last turn",
        terms: 1,
        value: |p, out| {
            out[0] = p.at.last_turn * p.at.length;
        },
    },
    Covariate {
        name: "direction",
        title: "the sense of the run",
        terms: 1,
        value: |p, out| {
            out[0] = p.at.direction * p.at.length;
        },
    },
    Covariate {
        name: "distance",
        title: "the place in the run and its sense",
        terms: 12,
        value: |p, out| {
            out.fill(0.0);
            let own = if p.at.direction < 0.0 { &mut out[..6] } else { &mut out[6..] };
            cyclic(
                std::f64::consts::TAU * p.at.distance / p.way,
                p.at.length + 0.5 * p.wheelbase * p.rotation.abs(),
                own,
            );
        },
    },
];

/// x, x², ... times `exposure`.
fn powers(x: f64, exposure: f64, out: &mut [f64]) {
    let mut power = exposure;
    for value in out {
        power *= x;
        *value = power;
    }
}

/// cos x, sin x, cos 2x ... times `exposure`.
fn cyclic(x: f64, exposure: f64, out: &mut [f64]) {
    for (k, pair) in out.chunks_exact_mut(2).enumerate() {
        let (sine, cosine) = libm::sincos((k + 1) as f64 * x);
        (pair[0], pair[1]) = (exposure * cosine, exposure * sine);
    }
}

/// What exp(-d/λ) loses over the piece, for λ of 5, 15 and 50 cm.
fn decays(at: &Context, sign: f64, out: &mut [f64]) {
    for (value, length) in out.iter_mut().zip([0.05, 0.15, 0.5]) {
        let left = |d: f64| libm::exp(-d / length);
        *value = sign * (left(at.since_turn) - left(at.since_turn + at.length));
    }
}

/// The columns of every covariate for every motion: run by run, in the order of [`COVARIATES`] and [`Motion::ALL`], terms last.
pub fn smooth_columns(observed: &Observed, model: &Model) -> Vec<Vec<Column>> {
    let contexts = || observed.tracks().flat_map(|track| track.contexts());
    let most = |of: fn(&Context) -> f64| contexts().map(of).fold(f64::MIN_POSITIVE, f64::max);
    let scales = [most(|c| c.speed.abs()), most(|c| c.turn_rate.abs())];
    let runs = observed.runs.len().max(1) as f64;
    let (chain, wheelbase) = (model.chain(), observed.robot.drive.wheelbase());
    observed.runs.par_iter().map(|run| of_run(run, &chain, wheelbase, scales, runs)).collect()
}

fn of_run(
    run: &ObservedRun,
    chain: &Chain<f64>,
    wheelbase: f64,
    [fastest, fastest_turn]: [f64; 2],
    runs: f64,
) -> Vec<Column> {
    let terms: usize = COVARIATES.iter().map(|c| c.terms).sum();
    let track = &run.track;
    let way = track.length().max(f64::MIN_POSITIVE);
    let duration = track.contexts().last().map_or(1.0, |c| c.time + c.duration).max(f64::MIN_POSITIVE);
    let mut states = vec![[0.0; 3]; 3 * terms];
    let mut columns = vec![vec![[0.0; 3]; run.blocks.len()]; 3 * terms];
    let mut basis = vec![0.0; terms];
    let (mut pose, mut made) = (chain.start(), 0);
    for (index, block) in run.blocks.iter().enumerate() {
        let until = track.seen_after()[block.first + (block.count - 1) / 2];
        for (travel, at) in track.travel()[made..until].iter().zip(&track.contexts()[made..until]) {
            let motion = chain.displacement(&at.headed(pose.heading), travel);
            let middle = pose.moved(&crate::geometry::Displacement2 {
                forward: 0.5 * motion.forward,
                sideways: 0.5 * motion.sideways,
                rotation: 0.5 * motion.rotation,
            });
            let wheel_way = [travel.left.abs(), travel.right.abs()];
            let piece = Piece {
                at,
                rotation: motion.rotation,
                wheel_way,
                duration,
                way,
                wheelbase,
                runs,
                fastest,
                fastest_turn,
            };
            let mut rest = basis.as_mut_slice();
            for covariate in &COVARIATES {
                let own;
                (own, rest) = rest.split_at_mut(covariate.terms);
                (covariate.value)(&piece, own);
            }
            let (sine, cosine) = libm::sincos(middle.heading);
            let added = [[cosine, sine, 0.0], [-sine, cosine, 0.0], [middle.y, -middle.x, 1.0]];
            for (state, (motion, value)) in states.iter_mut().zip(by_motion(&basis)) {
                for k in 0..3 {
                    state[k] += value * added[motion][k];
                }
            }
            pose = pose.moved(&motion);
        }
        made = until;
        for (column, s) in columns.iter_mut().zip(&states) {
            column[index] = [s[0] - block.place.y * s[2], s[1] + block.place.x * s[2], s[2]];
        }
    }
    columns
}

/// Every term of the basis for every motion, in the order of the columns.
fn by_motion(basis: &[f64]) -> impl Iterator<Item = (usize, f64)> + '_ {
    let mut first = 0;
    COVARIATES.iter().flat_map(move |covariate| {
        let own = &basis[first..first + covariate.terms];
        first += covariate.terms;
        (0..3).flat_map(move |motion| own.iter().map(move |value| (motion, *value)))
    })
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
