//! The scores of a UMBmark test: Eqs. 1 to 6 of Borenstein & Feng (1995), with intervals.
//!
//! | score | meaning | equation |
//! |---|---|---|
//! | centre of gravity | mean return error of a direction | 2 |
//! | r_c.g. | its distance from START | 3 |
//! | E_max,sys | the larger of the two distances | 4 |
//! | σ | spread of one coordinate about the centre of gravity, n - 1, pooled | section 3.3 |
//! | ε_θ nonsys | average absolute orientation error with bumps | 5, 6 |
//!
//! The paper numbers only Eqs. 1, 5 and 6; 2 to 4 are the three displays between, in their order. All errors are absolute minus
//! computed, in the frame of START.

mod change;
mod extended;
mod interval;
mod scatter;
mod summary;

use crate::dataset::{Dataset, ReturnError, Run};
use crate::effect::TestKind;
use crate::path::Direction;
use crate::setup::Setup;
use std::sync::Arc;

pub use change::{Change, ChangeError, Outcome};
pub use extended::{Convention, Extended, nonsystematic_orientation};
pub use interval::{CentroidInterval, Ellipse, FEWEST_RUNS, Intervals, e_max_sys_interval, noise_band, sigma_interval};
pub use scatter::Scatter;
pub use summary::{Cluster, Summary, summarise};

/// What leaves nothing to score.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScoreError {
    /// No run with a direction and a return error.
    #[error(
        "none of {runs} runs has both a direction (cw or ccw) and a return error; \
         give the absolute and the computed end pose of each run"
    )]
    NothingReturned {
        /// How many runs there are.
        runs: usize,
    },
    /// Invalid probability.
    #[error("confidence level must be between 0 and 1, both excluded, got {value}")]
    Level {
        /// What was given.
        value: f64,
    },
    /// A return error that is no number.
    #[error("return error of run {run} must be finite, got ({x}, {y}) m{}; correct or remove the run", in_radians(*heading))]
    NotFinite {
        /// Name of the run.
        run: String,
        /// \[m\]
        x: f64,
        /// \[m\]
        y: f64,
        /// \[rad\]
        heading: Option<f64>,
    },
}

fn in_radians(heading: Option<f64>) -> String {
    heading.map(|rad| format!(", {rad} rad")).unwrap_or_default()
}

/// Return errors sorted by test and direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Returns {
    /// Regular clockwise runs.
    pub cw: Vec<ReturnError>,
    /// Regular counter-clockwise runs.
    pub ccw: Vec<ReturnError>,
    /// Clockwise runs with bumps.
    pub bumps_cw: Vec<ReturnError>,
    /// Counter-clockwise runs with bumps.
    pub bumps_ccw: Vec<ReturnError>,
}

impl Returns {
    /// The return errors of the runs that have one, and a direction.
    pub fn of(runs: &[Run]) -> Returns {
        let mut returns = Returns::default();
        for run in runs {
            if let (Some(direction), Some(error)) = (run.direction, run.returned) {
                returns.of_mut(run.test, direction).push(error);
            }
        }
        returns
    }

    fn of_mut(&mut self, test: TestKind, direction: Direction) -> &mut Vec<ReturnError> {
        match (test, direction) {
            (TestKind::Systematic, Direction::Cw) => &mut self.cw,
            (TestKind::Systematic, Direction::Ccw) => &mut self.ccw,
            (TestKind::Bumps, Direction::Cw) => &mut self.bumps_cw,
            (TestKind::Bumps, Direction::Ccw) => &mut self.bumps_ccw,
        }
    }
}

/// Everything that a set of runs scores.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Centres of gravity, E_max,sys and σ of the regular test.
    pub summary: Summary,
    /// The probability that the intervals hold with.
    pub level: f64,
    /// Intervals of the regular test; `None` with fewer than [`FEWEST_RUNS`] runs in a direction.
    pub intervals: Option<Intervals>,
    /// E_max,sys that chance alone stays below with probability `level` \[m\]; see [`noise_band`].
    pub noise_band: Option<f64>,
    /// The extended test, where both tests have headings in both directions.
    pub extended: Option<Extended>,
    /// What could not be computed and why, and what looks wrong.
    pub warnings: Vec<String>,
    /// What was found of the runs before they were scored; nothing where only their return errors were given.
    pub setup: Arc<Setup>,
}

/// [`score`] of a dataset. What its return errors and tracks say of faults, outlying runs and jumps stands first among the warnings;
/// this needs the nominal robot.
pub fn score_dataset(data: &Dataset, level: f64) -> Result<Score, ScoreError> {
    let mut scored = score(&data.runs, level)?;
    if let Some(robot) = &data.robot {
        scored.setup = Arc::new(Setup::of(&data.runs, robot, data.path.as_ref()));
        scored.warnings.splice(0..0, scored.setup.notices().iter().map(|notice| sentence(notice)));
        if data.drives_other_paths() {
            scored.warnings.insert(0, "The datasets drive different paths: these scores are of none of them.".into());
        }
    }
    Ok(scored)
}

/// Words as a sentence, with a capital letter and a full stop.
pub(crate) fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}

/// Scores a set of runs, with intervals that hold with probability `level`.
///
/// Runs without a direction or a return error are left out. Of one direction alone the centre of gravity is given and
/// E_max,sys is not; the warnings say why.
///
/// ```
/// use umbmark_core::{dataset::{ReturnError, Run}, effect::TestKind, path::Direction, score::score};
/// let run = |direction, number, x, y| Run {
///     name: format!("run {number}"),
///     number,
///     direction: Some(direction),
///     test: TestKind::Systematic,
///     log: None,
///     returned: Some(ReturnError { x, y, heading: None }),
/// };
/// let runs = [
///     run(Direction::Cw, 1, -0.21, -0.19), run(Direction::Cw, 2, -0.19, -0.21), run(Direction::Cw, 3, -0.20, -0.23),
///     run(Direction::Ccw, 1, 0.02, 0.01), run(Direction::Ccw, 2, 0.01, -0.02), run(Direction::Ccw, 3, 0.00, -0.02),
/// ];
/// let score = score(&runs, 0.95)?;
/// assert!((score.summary.e_max_sys().unwrap() - 0.29).abs() < 1e-3);
/// assert!(score.intervals.unwrap().e_max_sys.unwrap().contains(0.29));
/// assert!(score.warnings.is_empty());
/// # Ok::<(), umbmark_core::score::ScoreError>(())
/// ```
pub fn score(runs: &[Run], level: f64) -> Result<Score, ScoreError> {
    all_finite(runs)?;
    let returns = Returns::of(runs);
    if returns.cw.is_empty() && returns.ccw.is_empty() {
        return Err(ScoreError::NothingReturned { runs: runs.len() });
    }
    let Returns { cw, ccw, bumps_cw, bumps_ccw } = &returns;
    score_returns([cw, ccw], [bumps_cw, bumps_ccw], level)
}

/// The same for return errors that are sorted, and finite: of regular runs and of runs with bumps, each cw and ccw. Rows of an
/// array of x, y and heading are read where they lie.
pub fn score_returns<E: Copy + Into<ReturnError>>(
    regular: [&[E]; 2],
    bumps: [&[E]; 2],
    level: f64,
) -> Result<Score, ScoreError> {
    if !(level > 0.0 && level < 1.0) {
        return Err(ScoreError::Level { value: level });
    }
    let [cw, ccw] = regular;
    let summary = summarise(cw, ccw);
    if summary.cw.is_none() && summary.ccw.is_none() {
        return Err(ScoreError::NothingReturned { runs: bumps[0].len() + bumps[1].len() });
    }
    let mut warnings = Vec::new();
    let (n_cw, n_ccw) = (cw.len(), ccw.len());
    warn_of_missing_direction(n_cw, n_ccw, &mut warnings);
    let enough = warn_of_few_runs(n_cw, n_ccw, &mut warnings);
    let scatter = enough.then(|| Scatter::about(&summary, cw, ccw)).flatten();
    let chance = summary.sigma_axis().filter(|_| enough && n_cw > 0 && n_ccw > 0);
    Ok(Score {
        summary,
        level,
        intervals: scatter.map(|s| Intervals::new(&summary, &s, level)),
        noise_band: chance.map(|sigma| noise_band(sigma, n_cw, n_ccw, level)),
        extended: score_extended(bumps, regular, level, &mut warnings),
        warnings,
        setup: Arc::default(),
    })
}

fn all_finite(runs: &[Run]) -> Result<(), ScoreError> {
    for run in runs {
        if let Some(ReturnError { x, y, heading }) = run.returned
            && !(x.is_finite() && y.is_finite() && heading.is_none_or(f64::is_finite))
        {
            return Err(ScoreError::NotFinite { run: run.name.clone(), x, y, heading });
        }
    }
    Ok(())
}

fn warn_of_missing_direction(n_cw: usize, n_ccw: usize, warnings: &mut Vec<String>) {
    let (missing, present) = match (n_cw, n_ccw) {
        (0, _) => ("clockwise (cw)", "counter-clockwise"),
        (_, 0) => ("counter-clockwise (ccw)", "clockwise"),
        _ => return,
    };
    warnings.push(format!(
        "E_max,sys is refused: there are no {missing} runs. In {present} runs alone, unequal wheel diameters and a wrong \
         wheelbase can cancel, and a robot with large errors scores well. Drive the path in the other direction as well."
    ));
}

fn warn_of_few_runs(n_cw: usize, n_ccw: usize, warnings: &mut Vec<String>) -> bool {
    let few: Vec<String> = [(n_cw, "cw"), (n_ccw, "ccw")]
        .iter()
        .filter(|(n, _)| (1..FEWEST_RUNS).contains(n))
        .map(|(n, direction)| format!("{n} {direction}"))
        .collect();
    if !few.is_empty() {
        warnings.push(format!(
            "No intervals: {FEWEST_RUNS} or more runs a direction are needed, got {}. The paper drives 5.",
            few.join(" and ")
        ));
    }
    few.is_empty()
}

fn score_extended<E: Copy + Into<ReturnError>>(
    bumps: [&[E]; 2],
    regular: [&[E]; 2],
    level: f64,
    warnings: &mut Vec<String>,
) -> Option<Extended> {
    if bumps.iter().all(|errors| errors.is_empty()) {
        return None;
    }
    let extended = Extended::new(bumps, regular, level);
    match &extended {
        None => warnings.push(
            "The extended test has no score: Eq. 5 needs return headings of both directions, with bumps and without."
                .into(),
        ),
        Some(extended) if !extended.contradictions.is_empty() => {
            let directions: Vec<&str> = extended.contradictions.iter().map(|d| d.name()).collect();
            warnings.push(format!(
                "Signs: bumps under the inside wheel turn a robot towards it (cw runs: negative, ccw runs: positive heading), \
                 but the {} runs turned the other way. Are the headings clockwise-positive, or computed minus absolute?",
                directions.join(" and ")
            ));
        }
        Some(_) => {}
    }
    extended
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(test: TestKind, direction: Direction, errors: &[(f64, f64, f64)]) -> Vec<Run> {
        let run = |(i, (x, y, heading)): (usize, &(f64, f64, f64))| Run {
            name: format!("{}_{}", direction.name(), i + 1),
            number: i as u32 + 1,
            direction: Some(direction),
            test,
            log: None,
            returned: Some(ReturnError { x: *x, y: *y, heading: Some(*heading) }),
        };
        errors.iter().enumerate().map(run).collect()
    }

    const CW: [(f64, f64, f64); 3] = [(-0.21, -0.19, -0.05), (-0.19, -0.21, -0.06), (-0.20, -0.23, -0.04)];
    const CCW: [(f64, f64, f64); 3] = [(0.02, 0.01, 0.01), (0.01, -0.02, 0.02), (0.0, -0.02, 0.0)];

    fn both() -> Vec<Run> {
        let mut all = runs(TestKind::Systematic, Direction::Cw, &CW);
        all.extend(runs(TestKind::Systematic, Direction::Ccw, &CCW));
        all
    }

    #[test]
    fn one_direction_keeps_its_centroid_and_its_interval_and_is_refused_e_max_sys_with_the_reason() {
        let s = score(&runs(TestKind::Systematic, Direction::Cw, &CW), 0.95).unwrap();
        assert!((s.summary.cw.unwrap().y + 0.21).abs() < 1e-12);
        assert_eq!((s.summary.e_max_sys(), s.noise_band), (None, None));
        let intervals = s.intervals.unwrap();
        assert!(intervals.cw.unwrap().y.contains(-0.21) && intervals.e_max_sys.is_none() && intervals.ccw.is_none());
        assert!(s.warnings.len() == 1 && s.warnings[0].contains("no counter-clockwise (ccw) runs"));
    }

    #[test]
    fn two_runs_a_direction_score_without_intervals_and_say_so() {
        let few: Vec<Run> = both().into_iter().filter(|run| run.number < 3).collect();
        let s = score(&few, 0.95).unwrap();
        assert!(s.summary.e_max_sys().is_some() && s.intervals.is_none() && s.noise_band.is_none());
        assert!(s.warnings[0].contains("got 2 cw and 2 ccw"), "{:?}", s.warnings);
    }

    #[test]
    fn runs_with_bumps_score_apart_from_regular_ones() {
        let mut all = both();
        all.extend(runs(TestKind::Bumps, Direction::Cw, &CW.map(|(x, y, h)| (x, y, h - 0.1))));
        all.extend(runs(TestKind::Bumps, Direction::Ccw, &CCW.map(|(x, y, h)| (x, y, h + 0.08))));
        let s = score(&all, 0.95).unwrap();
        assert_eq!(s.summary, score(&both(), 0.95).unwrap().summary);
        let extended = s.extended.unwrap();
        assert!((extended.orientation(Convention::Mean) - 0.09).abs() < 1e-12);
        assert!(s.warnings.is_empty(), "{:?}", s.warnings);
    }

    #[test]
    fn bumps_that_turn_the_robot_away_from_the_wheel_are_pointed_out() {
        let mut all = both();
        all.extend(runs(TestKind::Bumps, Direction::Cw, &CW.map(|(x, y, h)| (x, y, h + 0.1))));
        all.extend(runs(TestKind::Bumps, Direction::Ccw, &CCW.map(|(x, y, h)| (x, y, h + 0.08))));
        let s = score(&all, 0.95).unwrap();
        assert!(s.warnings[0].contains("but the cw runs turned the other way"), "{:?}", s.warnings);
    }

    #[test]
    fn nothing_to_score_and_impossible_numbers_are_errors_with_the_value() {
        assert_eq!(score(&[], 0.95), Err(ScoreError::NothingReturned { runs: 0 }));
        let bumps: [&[ReturnError]; 2] =
            [&[ReturnError { x: 0.1, y: 0.0, heading: None }; 2], &[ReturnError::from([0.0; 3])]];
        assert_eq!(score_returns([&[], &[]], bumps, 0.95), Err(ScoreError::NothingReturned { runs: 3 }));
        for value in [1.0, 0.0, -0.5] {
            assert_eq!(score(&both(), value), Err(ScoreError::Level { value }));
        }
        let mut broken = runs(TestKind::Systematic, Direction::Cw, &[(f64::NAN, 0.0, 0.5)]);
        let message = |runs: &[Run]| score(runs, 0.95).unwrap_err().to_string();
        let told = "return error of run cw_1 must be finite, got (NaN, 0) m";
        assert_eq!(message(&broken), format!("{told}, 0.5 rad; correct or remove the run"));
        broken[0].returned.as_mut().unwrap().heading = None;
        assert_eq!(message(&broken), format!("{told}; correct or remove the run"));
    }

    #[test]
    fn chance_is_told_of_both_directions_and_of_one_alone_which_is_missing() {
        let s = score(&both(), 0.9).unwrap();
        assert_eq!(s.noise_band, Some(noise_band(s.summary.sigma_axis().unwrap(), 3, 3, 0.9)));
        for (driven, missing) in [(Direction::Ccw, "no clockwise (cw)"), (Direction::Cw, "no counter-clockwise (ccw)")]
        {
            let alone: Vec<Run> = both().into_iter().filter(|run| run.direction == Some(driven)).collect();
            let s = score(&alone, 0.9).unwrap();
            assert!(s.noise_band.is_none() && s.warnings[0].contains(missing), "{s:?}");
        }
    }
}
