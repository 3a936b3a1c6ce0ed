//! Counts per revolution that are a factor off: edges of a decoder that are counted once, twice or four times, a gear that was left out.

use super::agreement::Agreement;
use super::faults::{NEAR, VAGUE};
use super::returns::way;
use super::suspicion::Suspicion;
use crate::drive::Robot;
use crate::effect::TestKind;
use crate::path::{Direction, Path};
use crate::run::Run;
use crate::stats::robust::median;

/// Factors that are usual, as powers: of two for decoders and of ten for gears and typing errors.
const BASES: [f64; 2] = [2.0, 10.0];
/// Tolerance, as a share, within which a factor is two, or one half: the wheels of no robot are twice as large as its maker says.
const DOUBLE: f64 = 0.03;
/// The way by the counts may differ from the commanded path by this factor: people drive a path a little larger or smaller, not twice.
const OTHER_WAY: f64 = 1.8;

/// Way and rotations by the reference, both so many times those by the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountsFactor {
    /// That many times.
    pub ratio: f64,
    /// The robot's ticks per revolution.
    pub nominal: f64,
}

impl CountsFactor {
    /// The factor by which way and rotations are off alike; `None` if they are not, or if one of them is not determined.
    pub(super) fn of(found: &Agreement, robot: &Robot) -> Option<CountsFactor> {
        let (ratio, gain) = (found.scale(), found.turn[0].abs());
        let alike = robot.drive.kind().has_axle_wheels()
            && found.shown == [true; 2]
            && found.misfits.iter().all(|misfit| *misfit < VAGUE)
            && (gain / ratio - 1.0).abs() < NEAR;
        alike.then(|| CountsFactor { ratio, nominal: robot.encoder.ticks_per_revolution() })
    }

    /// Whether it is two or one half.
    pub(super) fn is_double(&self) -> bool {
        [2.0, 0.5].iter().any(|factor| (self.ratio / factor - 1.0).abs() < DOUBLE)
    }

    /// The factor that most runs have, to a power of two; among equally many runs, the one that is nearest to 1.
    pub(super) fn of_most(runs: &[CountsFactor]) -> Option<CountsFactor> {
        let alike = |one: &CountsFactor| runs.iter().filter(|other| other.beside(one).is_none()).count();
        let off = |one: &CountsFactor| libm::log(one.ratio).abs();
        let better = |a: &&CountsFactor, b: &&CountsFactor| alike(a).cmp(&alike(b)).then(off(b).total_cmp(&off(a)));
        runs.iter().max_by(better).copied()
    }

    /// The power of two by which the counts of a run are off beside those of others, if they are.
    pub(super) fn beside(&self, others: &CountsFactor) -> Option<CountsFactor> {
        let ratio = self.ratio / others.ratio;
        let power = libm::exp2(libm::log2(ratio).round());
        (power != 1.0 && (ratio / power - 1.0).abs() < DOUBLE).then_some(CountsFactor { ratio: power, ..*self })
    }

    /// The usual factor that is near, or the ratio itself.
    pub(super) fn nearest(&self) -> f64 {
        self.usual().unwrap_or(self.ratio)
    }

    /// The usual factor that is near, if there is one.
    fn usual(&self) -> Option<f64> {
        let nearest = |base: f64| libm::pow(base, (libm::log(self.ratio) / libm::log(base)).round());
        BASES.into_iter().map(nearest).find(|factor| *factor != 1.0 && (self.ratio / factor - 1.0).abs() < NEAR)
    }

    /// Ticks per revolution that agree with the reference: exact for a usual factor, else to three digits.
    fn ticks(&self) -> String {
        let rounded = |value: f64, digits: i32| {
            let size = libm::pow(10.0, f64::from(digits) - libm::floor(libm::log10(value)));
            (value * size).round() / size
        };
        match self.usual() {
            Some(factor) => format!("{}", rounded(self.nominal / factor, 9)),
            None => format!("about {}", rounded(self.nominal / self.ratio, 2)),
        }
    }

    /// What is wrong, in words.
    pub(super) fn sentence(&self) -> String {
        format!(
            "by the reference the robot drives and turns {:.3} times as far as by its counts: ticks_per_revolution is off by that factor",
            self.ratio
        )
    }

    /// The line to change.
    pub(super) fn remedy(&self) -> String {
        format!(
            "write ticks_per_revolution = {} under [robot] in robot.toml instead of {} (a decoder counts one, two or four edges of each \
             line, and a gear multiplies them), or correct the wheel diameter there",
            self.ticks(),
            self.nominal
        )
    }
}

/// The suspicion that the counts are a factor off, where only the commanded path tells it: the wheels roll much farther than that, or much
/// less.
pub(super) fn by_path(runs: &[Run], robot: &Robot, path: &Path) -> Option<Suspicion> {
    if !robot.drive.kind().has_axle_wheels() || !path.suits(robot) {
        return None;
    }
    let arm = 0.5 * robot.drive.wheelbase();
    let commanded = |direction: Direction| -> f64 {
        let moves = path.moves(direction).into_iter().map(|part| part.displacement());
        moves.map(|d| d.forward.abs().max(arm * d.rotation.abs())).sum()
    };
    let of = |run: &Run| Some(way(run.log.as_ref()?, robot)? / commanded(run.direction.unwrap_or(Direction::Ccw)));
    let ratios: Vec<f64> = runs.iter().filter(|run| run.test == TestKind::Systematic).filter_map(of).collect();
    let ratio = median(ratios.iter().copied().filter(|ratio| ratio.is_finite()));
    let far = ratio > 0.0 && !(1.0 / OTHER_WAY..OTHER_WAY).contains(&ratio);
    far.then(|| Suspicion::OtherWay(CountsFactor { ratio: 1.0 / ratio, nominal: robot.encoder.ticks_per_revolution() }))
}
