//! Where errors arise: in which leg, turn, direction, at which speed, in which run.

use super::followed::Followed;
use super::mean::Mean;
use crate::geometry::Pose2;
use crate::inspect::{Done, MoveDone};
use crate::path::Direction;

/// The end of a move counts as measured if a measurement lies within this wheel travel \[m\], or this share of the move.
const NEAR: (f64, f64) = (0.05, 0.1);
/// Speeds are different if they differ by more than this share.
const APART: f64 = 0.15;

/// How parts of the path are grouped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// One move of the path, in the runs of one direction.
    Move,
    /// All moves of a kind, in the runs of one direction.
    Kind,
    /// Turns to the left and to the right.
    Sense,
    /// Moves of a kind at about one speed; only if there are several speeds.
    Speed,
    /// Whole runs of one direction.
    Direction,
    /// One run.
    Run,
}

impl By {
    /// All, in the order of tables.
    pub const ALL: [By; 6] = [By::Move, By::Kind, By::Sense, By::Speed, By::Direction, By::Run];

    /// As a key.
    pub fn key(self) -> &'static str {
        match self {
            By::Move => "moves",
            By::Kind => "kinds",
            By::Sense => "senses",
            By::Speed => "speeds",
            By::Direction => "directions",
            By::Run => "runs",
        }
    }
}

/// A part of the path, and the error that arises there.
///
/// The error of one move, or of one run, is the error that it adds alone, in the frame of the predicted end: P⁻¹ M with P the predicted and M the measured motion from its beginning to its end, a stop that follows included.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// How it is grouped.
    pub by: By,
    /// What it is called: "leg 1", "turns to the left", or a run's name.
    pub name: String,
    /// Of the runs, where it is of one direction.
    pub direction: Option<Direction>,
    /// How many moves (or runs) it has.
    pub count: usize,
    /// Mean error: forward, sideways \[m\], rotation \[rad\], with an interval from the scatter between runs. A rotation that was not
    /// measured is 0.
    pub mean: [Mean; 3],
    /// Standard deviation of single errors \[m, m, rad\], n - 1; `None` for one.
    pub spread: Option<[f64; 3]>,
    /// Its share in the mean squared error of all measured positions and, where they were measured, headings.
    ///
    /// An error persists: it moves and rotates the rest of the path. With c the part of an error r that arises here, the share is Σ c·r / Σ
    /// r·r over all measurements of all runs. Shares of all moves, of all kinds, of both directions, or of all runs add up to 1. A negative
    /// share compensates errors of other parts.
    pub share: Share,
}

/// Shares in sums of squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// In that of all positions.
    pub position: f64,
    /// In that of all headings.
    pub heading: f64,
    /// In that of the end positions.
    pub end: f64,
}

impl Share {
    fn plus(self, other: Share) -> Share {
        Share {
            position: self.position + other.position,
            heading: self.heading + other.heading,
            end: self.end + other.end,
        }
    }
}

/// What is done in a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MoveKind {
    Leg,
    Turn,
    Arc,
    /// Several moves without a measurement between them.
    Several,
}

impl MoveKind {
    fn name(self) -> &'static str {
        match self {
            MoveKind::Leg => "leg",
            MoveKind::Turn => "turn",
            MoveKind::Arc => "arc",
            MoveKind::Several => "moves",
        }
    }
}

/// One move of one run.
pub(super) struct Made {
    run: usize,
    direction: Option<Direction>,
    kind: MoveKind,
    name: String,
    /// \[m/s\], of turns \[rad/s\]
    speed: f64,
    /// +1 to the left, -1 to the right, 0 for legs.
    sense: f64,
    own: [f64; 3],
    share: Share,
}

/// The moves of a run, each up to where the next begins. Moves without a measurement between them are merged.
pub(super) fn made(index: usize, run: &Followed, moves: &[MoveDone], time: &[f64]) -> Vec<Made> {
    let rolled = run.observed.track.rolled();
    let made_at = |sample: usize| {
        let since_start = time[sample] - time[0];
        run.observed.track.contexts().partition_point(|at| at.time < since_start - 1e-9)
    };
    let driven: Vec<&MoveDone> = moves.iter().filter(|m| m.done != Done::Stop).collect();
    let mut counts = [0; 3];
    let (mut parts, mut first, mut waiting) = (Vec::new(), 0, Vec::new());
    for (number, m) in driven.iter().enumerate() {
        let last = number + 1 == driven.len();
        let kind = kind(&m.done);
        counts[kind as usize] += 1;
        waiting.push((number + 1, *m, format!("{} {}", kind.name(), counts[kind as usize])));
        let end = driven.get(number + 1).map_or(rolled.len() - 1, |next| made_at(next.from));
        let until = run.places.partition_point(|place| place.made <= end).saturating_sub(1);
        let place = if last { run.places.len() - 1 } else { until };
        let boundary = if last { run.places[place].rolled } else { rolled[end] };
        let rolls = boundary - run.places[first].rolled;
        if place == first || (boundary - run.places[place].rolled > NEAR.0.max(NEAR.1 * rolls) && !last) {
            continue;
        }
        parts.push((first, place, std::mem::take(&mut waiting)));
        first = place;
    }
    let shares = shares(run, &parts.iter().map(|(a, b, _)| [*a, *b]).collect::<Vec<_>>());
    let build = |((a, b, moves), share): ((usize, usize, Vec<Numbered>), Share)| {
        let own = seen_from(run, a, b);
        let (kind, name, sense, speed) = told(&moves, time);
        Made { run: index, direction: run.direction, kind, name, speed, sense, own, share }
    };
    parts.into_iter().zip(shares).map(build).collect()
}

/// A move with its number among all moves of its run, and its name.
type Numbered<'a> = (usize, &'a MoveDone, String);

fn kind(done: &Done) -> MoveKind {
    match done {
        Done::Turn { .. } => MoveKind::Turn,
        Done::Arc { .. } => MoveKind::Arc,
        Done::Leg { .. } | Done::Stop => MoveKind::Leg,
    }
}

/// Kind, name, sense and mean speed of the moves between two places.
fn told(moves: &[Numbered], time: &[f64]) -> (MoveKind, String, f64, f64) {
    let [(_, m, name)] = moves else {
        let (first, last) = (moves.first().map_or(0, |m| m.0), moves.last().map_or(0, |m| m.0));
        return (MoveKind::Several, format!("moves {first} to {last}"), 0.0, 0.0);
    };
    let seconds = (time[m.to] - time[m.from]).max(f64::MIN_POSITIVE);
    let (size, sense) = match m.done {
        Done::Turn { angle } => (angle.abs(), angle.signum()),
        Done::Arc { length, angle } => (length, angle.signum()),
        Done::Leg { length, .. } => (length, 0.0),
        Done::Stop => (0.0, 0.0),
    };
    (kind(&m.done), name.clone(), sense, size / seconds)
}

/// P⁻¹ M from one place to another.
fn seen_from(run: &Followed, from: usize, to: usize) -> [f64; 3] {
    let (a, b) = (&run.places[from], &run.places[to]);
    let own = a.predicted.between(&b.predicted).between(&a.measured.between(&b.measured));
    [own.x, own.y, own.heading]
}

/// Σ c·r of each part, over all places of a run.
///
/// A robot that moved as measured up to place i and as predicted after it would be at M_i P_i⁻¹ P_k at a later place k. The error at k that
/// arises between i and j is the change of this pose from i to j.
fn shares(run: &Followed, parts: &[[usize; 2]]) -> Vec<Share> {
    let as_measured_until = |i: usize, k: usize| -> Pose2 {
        let until = &run.places[i];
        until.measured.compose(&until.predicted.between(&run.places[k].predicted))
    };
    let last = run.places.len() - 1;
    let of_part = |[from, to]: &[usize; 2]| {
        let mut share = Share::default();
        for k in *from + 1..=last {
            let place = &run.places[k];
            let after = if k <= *to { place.measured } else { as_measured_until(*to, k) };
            let before = as_measured_until(*from, k);
            let [dx, dy] = [place.measured.x - place.predicted.x, place.measured.y - place.predicted.y];
            let product = (after.x - before.x) * dx + (after.y - before.y) * dy;
            share.position += product;
            share.heading += (after.heading - before.heading) * (place.measured.heading - place.predicted.heading);
            share.end += if k == last { product } else { 0.0 };
        }
        share
    };
    parts.iter().map(of_part).collect()
}

/// All parts, gathered in every way.
pub(super) fn gathered(runs: &[Followed], made: &[Made], confidence: f64) -> Vec<Part> {
    let whole = made.iter().fold(Share::default(), |sum, m| sum.plus(m.share));
    let mut parts = Vec::new();
    for by in [By::Move, By::Kind, By::Sense, By::Speed] {
        let keys = if by == By::Speed { speeds(made) } else { made.iter().map(|m| key(by, m)).collect() };
        let mut named: Vec<(String, Option<Direction>)> = keys.iter().flatten().cloned().collect();
        let mut seen = Vec::new();
        named.retain(|name| {
            !seen.contains(name) && {
                seen.push(name.clone());
                true
            }
        });
        named.sort_by_key(|(_, direction)| direction.map(|d| d as usize));
        for (name, direction) in named {
            let own = made.iter().zip(&keys).filter(|(_, k)| k.as_ref() == Some(&(name.clone(), direction)));
            let own: Vec<(usize, [f64; 3], Share)> = own.map(|(m, _)| (m.run, m.own, m.share)).collect();
            parts.extend(part(by, name, direction, &own, &whole, confidence));
        }
    }
    let ends: Vec<(usize, [f64; 3], Share)> = runs
        .iter()
        .enumerate()
        .map(|(index, run)| {
            let own = made.iter().filter(|m| m.run == index).fold(Share::default(), |sum, m| sum.plus(m.share));
            (index, seen_from(run, 0, run.places.len() - 1), own)
        })
        .collect();
    for direction in [Some(Direction::Cw), Some(Direction::Ccw), None] {
        let own: Vec<_> = ends.iter().filter(|(run, ..)| runs[*run].direction == direction).copied().collect();
        let name = if direction.is_some() { "whole runs" } else { "runs without a sense" };
        parts.extend(part(By::Direction, name.to_owned(), direction, &own, &whole, confidence));
    }
    for (end, run) in ends.iter().zip(runs) {
        let name = run.observed.name.clone();
        parts.extend(part(By::Run, name, run.direction, &[*end], &whole, confidence));
    }
    parts
}

fn key(by: By, m: &Made) -> Option<(String, Option<Direction>)> {
    match (by, m.kind) {
        (By::Move, _) => Some((m.name.clone(), m.direction)),
        (By::Kind, MoveKind::Several) => Some(("several moves".to_owned(), m.direction)),
        (By::Kind, kind) => Some((format!("all {}s", kind.name()), m.direction)),
        (By::Sense, MoveKind::Turn | MoveKind::Arc) => {
            Some((format!("{}s to the {}", m.kind.name(), if m.sense > 0.0 { "left" } else { "right" }), None))
        }
        _ => None,
    }
}

/// Names by kind and speed, for kinds that are driven at several speeds.
fn speeds(made: &[Made]) -> Vec<Option<(String, Option<Direction>)>> {
    let groups = |kind: MoveKind| {
        let mut speeds: Vec<f64> = made.iter().filter(|m| m.kind == kind).map(|m| m.speed).collect();
        speeds.sort_by(f64::total_cmp);
        let groups: Vec<Vec<f64>> = speeds.chunk_by(|a, b| *b <= *a * (1.0 + APART)).map(<[f64]>::to_vec).collect();
        groups
    };
    let all = [MoveKind::Leg, MoveKind::Turn, MoveKind::Arc].map(|kind| (kind, groups(kind)));
    let name = |m: &Made| {
        let (kind, groups) = all.iter().find(|(kind, groups)| *kind == m.kind && groups.len() > 1)?;
        let own = groups.iter().find(|g| g.contains(&m.speed))?;
        let unit = if *kind == MoveKind::Turn { "rad/s" } else { "m/s" };
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        Some((format!("{}s at {mean:.2} {unit}", kind.name()), None))
    };
    made.iter().map(name).collect()
}

/// A part from its moves: run, error, and share before normalisation.
fn part(
    by: By,
    name: String,
    direction: Option<Direction>,
    own: &[(usize, [f64; 3], Share)],
    whole: &Share,
    confidence: f64,
) -> Option<Part> {
    let mean = |k: usize| {
        let by_run: Vec<f64> = own
            .chunk_by(|a, b| a.0 == b.0)
            .map(|of_run| of_run.iter().map(|(_, e, _)| e[k]).sum::<f64>() / of_run.len() as f64)
            .collect();
        Mean::of(&by_run, confidence)
    };
    let n = own.len() as f64;
    let spread = [0, 1, 2].map(|k| {
        let centre = own.iter().map(|(_, e, _)| e[k]).sum::<f64>() / n;
        (own.iter().map(|(_, e, _)| (e[k] - centre).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()
    });
    let sum = own.iter().fold(Share::default(), |sum, (_, _, share)| sum.plus(*share));
    let of = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    Some(Part {
        by,
        name,
        direction,
        count: own.len(),
        mean: [mean(0)?, mean(1)?, mean(2)?],
        spread: (own.len() > 1).then_some(spread),
        share: Share {
            position: of(sum.position, whole.position),
            heading: of(sum.heading, whole.heading),
            end: of(sum.end, whole.end),
        },
    })
}
