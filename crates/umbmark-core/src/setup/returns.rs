//! Return errors that the robot did not make: typing errors in single runs, and columns in another unit.
//!
//! A run is compared with the other runs of its direction and test, coordinate by coordinate. Several typing errors can hide each other if
//! the runs are tested one at a time, so all are searched together: of all ways to leave out i runs, the one that leaves the least scatter
//! is tested by
//!
//! ```text
//! F(i, ν) = ((S_0 - S_i)/i) / (S_i/ν),   ν = N - groups - i
//! ```
//!
//! S: sum of squares about the group means, pooled over the directions of a test. p is multiplied by the number of subsets, N over i, by
//! the number of sizes i, of coordinates and of tests (Bonferroni), so normal scatter gives a false alarm in at most [`FALSE_ALARMS`] of all data sets.

mod elsewhere;

use super::Fault;
use super::by_positions::headings_by_positions;
use crate::drive::{Robot, WheelTravel};
use crate::effect::TestKind;
use crate::geometry::wrap;
use crate::path::{Direction, Path};
use crate::run::{ReturnError, Run, TickLog};
use crate::stats::{ln_f_upper_tail, median, t_two_sided};

/// Share of data sets with normal scatter in which a run is named.
const FALSE_ALARMS: f64 = 1e-3;
/// In a smaller group it is undetermined which run is wrong.
const FEWEST: usize = 3;
/// At most this share of all runs is taken as wrong, beyond the first two.
const MAX_WRONG_SHARE: f64 = 0.25;
/// At most so many runs are taken as wrong.
const MOST_WRONG: usize = 300;
/// Scatter is never smaller than the reading of a tape \[m\] and of a protractor \[rad\].
const READING: [f64; 3] = [5e-4, 5e-4, 9e-4];
/// Values closer than this are equal: they differ by rounding only.
const EQUAL: f64 = 1e-9;
/// Runs whose distance differs from the median by a larger share are a different drive.
const SAME_WAY: f64 = 0.2;
/// A return error above this share of the distance is implausible in centimetres, too.
const BELIEVED: f64 = 0.2;
/// Headings are in radians if they differ by less than this \[rad\] from those that follow from the positions.
const NEAR: f64 = 0.1;
/// A unit is rejected if the mean headings differ from the expected ones by this many standard errors.
const BEYOND: f64 = 6.0;
/// In the right unit, the distance of the headings from those that follow from the positions shrinks to this share.
const NEARER: f64 = 0.25;

/// Median deviation of headings \[rad\] that is implausible for a protractor.
const WILD: f64 = 0.1;
/// The same, implausible for any instrument.
const HOPELESS: f64 = 0.3;
/// Headings are implausible if the positions deviate by less than this share of the deviation that such headings would cause over an eighth
/// of the distance.
const ALONE: f64 = 0.06;

/// A coordinate of a return error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// Along the START heading \[m\].
    X,
    /// To the left \[m\].
    Y,
    /// \[rad\]
    Heading,
}

impl Coordinate {
    const ALL: [Coordinate; 3] = [Coordinate::X, Coordinate::Y, Coordinate::Heading];

    /// As in files: "x", "y" or "heading".
    pub fn name(self) -> &'static str {
        match self {
            Coordinate::X => "x",
            Coordinate::Y => "y",
            Coordinate::Heading => "heading",
        }
    }

    /// A value with its unit, in degrees where it is a heading.
    fn shown(self, value: f64) -> String {
        match self {
            Coordinate::Heading => format!("{:.2} deg", value.to_degrees()),
            _ => format!("{value:.3} m"),
        }
    }
}

/// A coordinate that is far from those of the other runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviant {
    /// Which one.
    pub coordinate: Coordinate,
    /// Its value \[m, rad\].
    pub value: f64,
    /// Mean of the other runs \[m, rad\].
    pub usual: f64,
    /// Distance from that mean, in standard deviations of a run about it.
    pub deviations: f64,
}

/// A run whose return error is far from those of the other runs of its direction.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlyingReturn {
    /// The run's name.
    pub run: String,
    /// Its test.
    pub test: TestKind,
    /// Its direction.
    pub direction: Option<Direction>,
    /// Number of the other runs that it was compared with.
    pub others: usize,
    /// Distance of its end position from their mean \[m\].
    pub moved: f64,
    /// Its heading less their mean \[rad\]; `None` without headings.
    pub turned: Option<f64>,
    /// The coordinates that are off, the farthest first: one at least.
    pub deviants: Vec<Deviant>,
}

impl OutlyingReturn {
    /// Distance of the farthest coordinate, in standard deviations.
    pub fn deviations(&self) -> f64 {
        self.deviants.first().map_or(0.0, |deviant| deviant.deviations)
    }

    /// What is wrong, in words.
    pub fn sentence(&self) -> String {
        let turned = self.turned.map(|t| format!(" and {:.1} deg", t.to_degrees().abs())).unwrap_or_default();
        let direction = self.direction.map_or(String::new(), |direction| format!("{} ", direction.name()));
        let bumps = if self.test == TestKind::Bumps { " with bumps" } else { "" };
        let one = |d: &Deviant| {
            format!(
                "{} is {}, their mean is {}",
                d.coordinate.name(),
                d.coordinate.shown(d.value),
                d.coordinate.shown(d.usual)
            )
        };
        let values: Vec<String> = self.deviants.iter().map(one).collect();
        format!(
            "the return error of run {} lies {:.3} m{turned} from the mean of the other {} {direction}runs{bumps} ({:.0} standard deviations): {}",
            self.run,
            self.moved,
            self.others,
            self.deviations(),
            values.join("; ")
        )
    }

    /// What to do.
    pub fn remedy(&self) -> String {
        format!("correct the numbers of run {}, or leave the run out if it was disturbed", self.run)
    }
}

/// What the return errors alone show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Returned {
    /// Columns in another unit than their name says.
    pub faults: Vec<Fault>,
    /// Runs that are far from the others.
    pub outlying: Vec<OutlyingReturn>,
}

impl Returned {
    /// Examines the return errors of all runs.
    pub fn of(runs: &[Run], robot: &Robot, path: Option<&Path>) -> Returned {
        let ways: Vec<Option<f64>> = runs.iter().map(|run| run.log.as_ref().and_then(|log| way(log, robot))).collect();
        let fault =
            elsewhere::of(runs, path).or_else(|| too_far(runs, &ways, path)).or_else(|| in_degrees(runs, robot, path));
        // If a unit is wrong, outlying values in it mean nothing.
        let outlying = if fault.is_none() { outlying(runs, &ways) } else { Vec::new() };
        Returned { faults: fault.into_iter().collect(), outlying }
    }
}

/// Way by the ticks of a log \[m\]; `None` where the robot has none.
pub(super) fn way(log: &TickLog, robot: &Robot) -> Option<f64> {
    let per_tick = robot.metres_per_tick();
    let asides = log.asides(robot);
    let steps = log.left.windows(2).zip(log.right.windows(2));
    let way: f64 = steps
        .enumerate()
        .map(|(k, (l, r))| {
            let travel = WheelTravel { left: (l[1] - l[0]) * per_tick.left, right: (r[1] - r[0]) * per_tick.right };
            let aside = asides.get(k + 1).map_or(0.0, |[to, _]| (to - asides[k][0]).abs());
            travel.rolled().max(aside)
        })
        .sum();
    (way > 0.0 && way.is_finite()).then_some(way)
}

/// Return errors that are larger than any can be. With a path that leads back to START, the limit is the length of the path. Otherwise it is
/// twice the way driven: neither the robot nor the place where its odometry says it is can be farther from START than that way.
fn too_far(runs: &[Run], ways: &[Option<f64>], path: Option<&Path>) -> Option<Fault> {
    let distances = runs.iter().filter_map(|run| run.returned).map(|e| libm::hypot(e.x, e.y));
    let distance = median(distances.filter(|d| d.is_finite()).collect())?;
    let by_path = path.map(Path::length).filter(|length| *length > 0.0);
    let by_logs = || median(ways.iter().flatten().copied().collect());
    let (way, most) = by_path.map(|path| (path, path)).or_else(|| by_logs().map(|way| (way, 2.0 * way)))?;
    let unit = if distance / 100.0 > BELIEVED * way { "mm" } else { "mm or cm" };
    (distance > most).then_some(Fault::ReturnsIn { unit, distance, way })
}

/// Headings that agree with the positions as degrees but not as radians.
fn in_degrees(runs: &[Run], robot: &Robot, path: Option<&Path>) -> Option<Fault> {
    let path = path?;
    let regular = |direction: Direction| {
        let own = runs.iter().filter(move |run| run.test == TestKind::Systematic && run.direction == Some(direction));
        own.filter_map(|run| run.returned).collect::<Vec<_>>()
    };
    let both = Direction::BOTH.map(regular);
    let headings = both.each_ref().map(|own| own.iter().filter_map(|e| e.heading).collect::<Vec<f64>>());
    let enough = (0..2).all(|k| both[k].len() >= FEWEST && headings[k].len() == both[k].len());
    if !enough || headings.iter().flatten().all(|heading| heading.abs() < NEAR) {
        return None;
    }
    let expected = headings_by_positions(&both, robot, path)?;
    let degrees = 1f64.to_degrees();
    let (mut as_given, mut as_degrees, mut certain) = (0.0, 0.0, false);
    let (mut turns, mut places) = (Vec::new(), Vec::new());
    for own in &both {
        let middle =
            [|e: &ReturnError| e.x, |e: &ReturnError| e.y].map(|of| (of, median(own.iter().map(of).collect())));
        for (of, middle) in middle {
            places.extend(own.iter().map(|e| (of(e) - middle.unwrap_or(0.0)).abs()));
        }
    }
    for (headings, expected) in headings.iter().zip(expected) {
        // Degrees that were read as radians can wrap around; single typing errors do not change the median.
        let first = headings[0];
        let about_first: Vec<f64> = headings.iter().map(|heading| wrap(heading - first)).collect();
        let middle = first + median(about_first)?;
        let (given, turned) = (wrap(middle - expected), wrap(middle - degrees * expected));
        let apart: Vec<f64> = headings.iter().map(|heading| wrap(heading - middle).abs()).collect();
        let error = 1.4826 * median(apart.clone())? / (headings.len() as f64).sqrt();
        turns.extend(apart);
        as_given += given * given;
        as_degrees += turned * turned;
        certain |= given.abs() > NEAR.max(BEYOND * error);
    }
    // A random rotation also moves the robot sideways, so headings cannot scatter alone.
    let (turns, places) = (median(turns)?, median(places)?);
    let alone = turns > WILD && places < ALONE * turns * path.length() / 8.0;
    let agree = certain && as_degrees < NEARER * NEARER * as_given;
    (agree || alone && (turns > HOPELESS || as_degrees < as_given)).then_some(Fault::ReturnHeadingsInDegrees)
}

/// The runs of a test in a direction, with their values of each coordinate.
struct Group {
    direction: Option<Direction>,
    /// Places among all runs.
    runs: Vec<usize>,
}

fn outlying(runs: &[Run], ways: &[Option<f64>]) -> Vec<OutlyingReturn> {
    let tests = [TestKind::Systematic, TestKind::Bumps].map(|test| (test, groups(runs, ways, test)));
    let told = tests.iter().filter(|(_, groups)| !groups.is_empty()).count();
    let mut found: Vec<(usize, Deviant, usize)> = Vec::new();
    for (_, groups) in tests.iter().filter(|(_, groups)| !groups.is_empty()) {
        let level = FALSE_ALARMS / (told * Coordinate::ALL.len()) as f64;
        for coordinate in Coordinate::ALL {
            found.extend(odd_ones(runs, groups, coordinate, level));
        }
    }
    let mut named: Vec<OutlyingReturn> = Vec::new();
    let mut places: Vec<usize> = found.iter().map(|(run, ..)| *run).collect();
    places.sort_unstable();
    places.dedup();
    for place in &places {
        let own = found.iter().filter(|(run, ..)| run == place);
        let mut deviants: Vec<Deviant> = own.map(|(_, deviant, _)| *deviant).collect();
        deviants.sort_by(|a, b| b.deviations.total_cmp(&a.deviations));
        let run = &runs[*place];
        let Some(group) = tests.iter().flat_map(|(_, groups)| groups).find(|group| group.runs.contains(place)) else {
            continue;
        };
        let others: Vec<usize> = group.runs.iter().copied().filter(|other| !places.contains(other)).collect();
        let off = |coordinate| {
            let value = coordinate_of(run, coordinate)?;
            let values: Vec<f64> = others
                .iter()
                .filter_map(|other| coordinate_of(&runs[*other], coordinate))
                .map(|v| near(v, value, coordinate))
                .collect();
            (!values.is_empty()).then(|| value - values.iter().sum::<f64>() / values.len() as f64)
        };
        named.push(OutlyingReturn {
            run: run.name.clone(),
            test: run.test,
            direction: group.direction,
            others: others.len(),
            moved: libm::hypot(off(Coordinate::X).unwrap_or(0.0), off(Coordinate::Y).unwrap_or(0.0)),
            turned: off(Coordinate::Heading),
            deviants,
        });
    }
    named
}

/// For a heading: the equivalent angle nearest to another one; positions are unchanged.
fn near(value: f64, to: f64, coordinate: Coordinate) -> f64 {
    if coordinate == Coordinate::Heading { to + wrap(value - to) } else { value }
}

fn coordinate_of(run: &Run, coordinate: Coordinate) -> Option<f64> {
    let returned = run.returned?;
    let value = match coordinate {
        Coordinate::X => Some(returned.x),
        Coordinate::Y => Some(returned.y),
        Coordinate::Heading => returned.heading,
    };
    value.filter(|value| value.is_finite())
}

/// The directions of a test that have enough runs, all of the same distance.
fn groups(runs: &[Run], ways: &[Option<f64>], test: TestKind) -> Vec<Group> {
    let of = |direction: Option<Direction>| {
        let own = |place: &usize| {
            let run = &runs[*place];
            run.test == test && run.direction == direction && coordinate_of(run, Coordinate::X).is_some()
        };
        let runs: Vec<usize> = (0..runs.len()).filter(own).collect();
        let ways: Vec<f64> = runs.iter().filter_map(|place| ways[*place]).collect();
        let usual = median(ways.clone()).unwrap_or(0.0);
        let alike = ways.iter().all(|way| (way - usual).abs() <= SAME_WAY * usual);
        (runs.len() >= FEWEST && alike).then_some(Group { direction, runs })
    };
    [Some(Direction::Cw), Some(Direction::Ccw), None].into_iter().filter_map(of).collect()
}

/// Runs with an outlying value of a coordinate, each with the number of the other runs in its group.
fn odd_ones(runs: &[Run], groups: &[Group], coordinate: Coordinate, level: f64) -> Vec<(usize, Deviant, usize)> {
    let mut of_groups: Vec<Vec<(usize, f64)>> = Vec::new();
    for group in groups {
        let own: Vec<(usize, f64)> =
            group.runs.iter().filter_map(|run| Some((*run, coordinate_of(&runs[*run], coordinate)?))).collect();
        if own.len() < FEWEST {
            continue;
        }
        // Headings are unwrapped about their mean direction.
        let (sine, cosine) = own.iter().fold((0.0, 0.0), |(s, c), (_, v)| (s + libm::sin(*v), c + libm::cos(*v)));
        let middle = libm::atan2(sine, cosine);
        let mut own: Vec<(usize, f64)> =
            own.iter().map(|(run, value)| (*run, near(*value, middle, coordinate))).collect();
        own.sort_by(|a, b| a.1.total_cmp(&b.1));
        of_groups.push(own);
    }
    let least = READING[coordinate as usize].max(0.5 * finest(&of_groups));
    let Some((kept, deviation, freedom)) = subset(&of_groups, least, level) else { return Vec::new() };
    let all: usize = of_groups.iter().map(Vec::len).sum();
    let mut odd = Vec::new();
    for (own, kept) in of_groups.iter().zip(kept) {
        let usual = mean(&own[kept.clone()]);
        let rest = own.iter().enumerate().filter(|(place, _)| !kept.contains(place)).map(|(_, own)| own);
        for (run, value) in rest {
            let deviations = (value - usual).abs() / deviation;
            let t = deviations / (1.0 + 1.0 / kept.len() as f64).sqrt();
            if t_two_sided(t, freedom) * (all as f64) < level {
                odd.push((*run, Deviant { coordinate, value: *value, usual, deviations }, kept.len()));
            }
        }
    }
    odd
}

/// The smallest difference between unequal values: an upper limit of their rounding step.
fn finest(groups: &[Vec<(usize, f64)>]) -> f64 {
    let differences = groups.iter().flat_map(|own| own.windows(2).map(|pair| pair[1].1 - pair[0].1));
    let least = differences.filter(|difference| *difference > EQUAL).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

fn mean(own: &[(usize, f64)]) -> f64 {
    own.iter().map(|(_, value)| value).sum::<f64>() / own.len().max(1) as f64
}

/// Sorted values of each group that are kept, with their pooled standard deviation and its degrees of freedom; `None` if no value is
/// certainly wrong.
fn subset(groups: &[Vec<(usize, f64)>], least: f64, level: f64) -> Option<(Vec<std::ops::Range<usize>>, f64, f64)> {
    let all: usize = groups.iter().map(Vec::len).sum();
    let possible: usize = groups.iter().map(|own| (own.len() - 1) / 2).sum();
    let most = possible.min(2.max((MAX_WRONG_SHARE * all as f64) as usize)).min(MOST_WRONG);
    // By the number of values left out in the groups so far: the least sum of squares, and what is kept for it.
    let mut best: Vec<Option<(f64, Vec<std::ops::Range<usize>>)>> = vec![None; most + 1];
    best[0] = Some((0.0, Vec::new()));
    for own in groups {
        let sums = Sums::of(own);
        let windows: Vec<(f64, std::ops::Range<usize>)> =
            (0..=((own.len() - 1) / 2).min(most)).map(|out| sums.narrowest(own.len() - out)).collect();
        let so_far = std::mem::replace(&mut best, vec![None; most + 1]);
        for (before, told) in so_far.iter().enumerate().filter_map(|(i, told)| Some((i, told.as_ref()?))) {
            for (out, (squares, range)) in windows.iter().enumerate().take(most + 1 - before) {
                let sum = told.0 + squares;
                if best[before + out].as_ref().is_none_or(|known| sum < known.0) {
                    best[before + out] = Some((sum, [told.1.as_slice(), std::slice::from_ref(range)].concat()));
                }
            }
        }
    }
    let whole = best[0].as_ref()?.0;
    // Logarithms: of thousands of runs there are more subsets than a number holds, and tails below every number.
    let (mut found, mut smallest, mut subsets) = (None, libm::log(level), 0.0);
    for (out, told) in best.into_iter().enumerate().skip(1) {
        subsets += libm::log((all + 1 - out) as f64 / out as f64);
        let (Some((squares, kept)), freedom) = (told, all as f64 - (groups.len() + out) as f64) else { continue };
        if freedom < 1.0 {
            continue;
        }
        let variance = squares / freedom + least * least;
        let f = (whole - squares) / out as f64 / variance;
        let p = ln_f_upper_tail(f, [out as f64, freedom]) + subsets + libm::log(most as f64);
        if p < smallest {
            (smallest, found) = (p, Some((kept, variance.sqrt(), freedom)));
        }
    }
    found
}

/// Sums of the first values of a sorted group, and of their squares, about the middle one.
struct Sums {
    sums: Vec<[f64; 2]>,
}

impl Sums {
    fn of(own: &[(usize, f64)]) -> Sums {
        let middle = own.get(own.len() / 2).map_or(0.0, |own| own.1);
        let after = own.iter().scan([0.0; 2], |sums, (_, value)| {
            let off = value - middle;
            *sums = [sums[0] + off, sums[1] + off * off];
            Some(*sums)
        });
        Sums { sums: std::iter::once([0.0; 2]).chain(after).collect() }
    }

    /// The `count` neighbouring values that scatter least: their sum of squares about their mean, and their range.
    fn narrowest(&self, count: usize) -> (f64, std::ops::Range<usize>) {
        let squares = |first: usize| {
            let [[from, from_squares], [to, to_squares]] = [self.sums[first], self.sums[first + count]];
            (to_squares - from_squares - (to - from).powi(2) / count.max(1) as f64).max(0.0)
        };
        let all = (0..self.sums.len() - count).map(|first| (squares(first), first..first + count));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0..count))
    }
}

#[cfg(test)]
mod tests;
