//! The table of limits, simulated.

use super::{BINS, Lines, TABLE, limits};
use crate::diagnose::tests::trials;
use crate::drift::scores::{COMPONENTS, Scorer};
use crate::drift::statistic::{Kind, Scan, Signature};
use crate::random::Stream;
use rayon::prelude::*;

/// A robot whose two or three numbers move each component, as the limits are simulated with.
fn usual(components: usize) -> Signature {
    let mut signature = Signature { components, numbers: if components == 4 { 3 } else { 2 }, ..Signature::default() };
    let by_direction = [[[1.0, 1.0], [1.0, -1.0], [0.7, -0.7]], [[1.0, -1.0], [-1.0, -1.0], [0.7, 0.7]]];
    for (slopes, rows) in signature.slopes.iter_mut().zip(by_direction) {
        for (slope, row) in slopes.iter_mut().zip(rows).take(components) {
            slope[..2].copy_from_slice(&row);
        }
    }
    if components == 4 {
        signature.slopes.iter_mut().for_each(|slopes| slopes[3][2] = 1.0);
    }
    signature
}

/// Heights at which crossings are counted: from 3 in steps of a half.
const HEIGHTS: usize = 36;

fn height(level: usize) -> f64 {
    3.0 + 0.5 * level as f64
}

/// Crossings of each height, and runs at which there could have been one, by bin and kind.
#[derive(Clone)]
struct Counts {
    crossed: Vec<[[u64; 3]; BINS.len()]>,
    asked: Vec<[[u64; 3]; BINS.len()]>,
}

impl Counts {
    fn none() -> Counts {
        let none = vec![[[0; 3]; BINS.len()]; HEIGHTS];
        Counts { crossed: none.clone(), asked: none }
    }

    fn and(mut self, other: Counts) -> Counts {
        let add = |to: &mut Vec<[[u64; 3]; BINS.len()]>, from: Vec<[[u64; 3]; BINS.len()]>| {
            let (to, from) = (to.as_flattened_mut().as_flattened_mut(), from);
            to.iter_mut().zip(from.as_flattened().as_flattened()).for_each(|(to, from)| *to += from);
        };
        add(&mut self.crossed, other.crossed);
        add(&mut self.asked, other.asked);
        self
    }

    /// One robot to which nothing happens.
    fn watch(mut self, signature: &Signature, directions: usize, stream: &mut Stream) -> Counts {
        let count = signature.components;
        let mut scorers = [Scorer::new(count), Scorer::new(count)];
        let mut scan = Scan::new(signature);
        let mut next = [0; 3];
        let mut run = 0;
        while scan.scored() < BINS[BINS.len() - 1] {
            let direction = run % directions;
            run += 1;
            let mut components = [0.0; COMPONENTS];
            components[..count].iter_mut().for_each(|value| *value = stream.normal());
            let scored = scorers[direction].add(&components);
            scan.add(direction, scored.as_ref());
            if scored.is_none() {
                continue;
            }
            let bin = BINS.iter().position(|last| scan.scored() <= *last).unwrap_or(0);
            for (kind, peak) in scan.peaks().iter().enumerate() {
                (next[kind]..HEIGHTS).for_each(|level| self.asked[level][bin][kind] += 1);
                while next[kind] < HEIGHTS && peak.height > height(next[kind]) {
                    self.crossed[next[kind]][bin][kind] += 1;
                    next[kind] += 1;
                }
            }
        }
        self
    }

    /// The weighted line through the logarithms of the rates; where crossings are too few, `later`.
    fn line(&self, bin: usize, kind: usize, later: [f64; 2]) -> [f64; 2] {
        let [mut n, mut x, mut y, mut xx, mut xy] = [0.0; 5];
        let mut points = 0;
        for level in 0..HEIGHTS {
            let (crossed, asked) = (self.crossed[level][bin][kind] as f64, self.asked[level][bin][kind] as f64);
            // Of alarms that are not rare, the tail has not its shape yet.
            if crossed >= 25.0 && crossed < 0.005 * asked {
                let (weight, at, rate) = (crossed.min(400.0), height(level), libm::log(crossed / asked));
                points += 1;
                n += weight;
                x += weight * at;
                y += weight * rate;
                xx += weight * at * at;
                xy += weight * at * rate;
            }
        }
        if points < 3 {
            return later;
        }
        let slope = (n * xy - x * y) / (n * xx - x * x);
        [(y - slope * x) / n, -slope]
    }
}

/// The lines for so many components and directions, from so many simulated robots.
#[expect(clippy::needless_range_loop, reason = "indices as in the equation")]
fn lines(components: usize, directions: usize, robots: u64, seed: u64) -> Lines {
    let signature = usual(components);
    let purpose = (10 * components + directions) as u64;
    let watched = (0..robots).into_par_iter().fold(Counts::none, |counts, robot| {
        counts.watch(&signature, directions, &mut Stream::new(seed, purpose, robot))
    });
    let counts = watched.reduce(Counts::none, Counts::and);
    let mut lines: Lines = [[[f64::NAN; 2]; 3]; BINS.len()];
    for kind in 0..Kind::ALL.len() {
        let mut later = [f64::NAN; 2];
        for bin in (0..BINS.len()).rev() {
            later = counts.line(bin, kind, later);
            lines[bin][kind] = later;
        }
    }
    lines
}

/// The table as it stands in the code.
#[test]
#[ignore = "20 minutes in release"]
fn the_table_is_what_the_simulation_gives() {
    for components in 2..=COMPONENTS {
        for directions in 1..=2 {
            let robots = if (components, directions) == (4, 2) { 40_000 } else { 400_000 };
            let lines = lines(components, directions, robots, 27);
            let rounded = lines.map(|bin| bin.map(|[a, b]| [(a * 1e3).round() / 1e3, (b * 1e4).round() / 1e4]));
            println!("{rounded:?}");
            assert_eq!(rounded, TABLE[2 * (components - 2) + directions - 1], "{components} {directions}");
        }
    }
}

/// Seed 5; 500 robots of each layout, 120 scored runs each; one alarm in 200 runs is asked, and counted until the first of each robot.
#[test]
fn robots_that_do_not_change_are_accused_as_often_as_is_asked() {
    for components in 2..=COMPONENTS {
        for directions in 1..=2 {
            let signature = usual(components);
            let watch = |robot: u64| {
                let mut stream = Stream::new(5, (10 * components + directions) as u64, robot);
                let mut scorers = [Scorer::new(components), Scorer::new(components)];
                let mut scan = Scan::new(&signature);
                for run in 0.. {
                    let mut values = [0.0; COMPONENTS];
                    values[..components].iter_mut().for_each(|value| *value = stream.normal());
                    let scored = scorers[run % directions].add(&values);
                    scan.add(run % directions, scored.as_ref());
                    let limits = limits(&signature, directions, scan.scored(), 0.005);
                    let is_alarm = scan.peaks().iter().zip(limits).any(|(peak, limit)| peak.height > limit);
                    if is_alarm || scan.scored() == 120 {
                        return (usize::from(is_alarm), scan.scored());
                    }
                }
                (0, 0)
            };
            let add = |a: (usize, usize), b: (usize, usize)| (a.0 + b.0, a.1 + b.1);
            let (alarms, runs) = (0..trials(500)).into_par_iter().map(watch).reduce(|| (0, 0), add);
            let rate = alarms as f64 / runs as f64;
            println!("{components} components, {directions} directions: {alarms} alarms in {runs} runs, {rate:.5}");
            // Upwards 4 standard errors and 10 %; downwards more, because kinds overlap: in one direction, place and numbers are the same.
            let error = 4.0 / (alarms as f64).sqrt();
            let off = libm::log(rate / 0.005);
            assert!(off < 0.1 + error && off > -0.5 - error, "{rate}");
        }
    }
}
