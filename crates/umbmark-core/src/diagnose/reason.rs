//! Why the verdict is not "explained" although no further effect is certified.

use super::remains::{Remains, Repeating};
use super::tracks::repeats::Repeated;
use super::tracks::{OddRun, Unequal};
use crate::setup::{Fault, Suspicion};

/// One reason.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// A column, a unit or a frame contradicts its name.
    Fault(Fault),
    /// A noise size reached the limit of its search: the residuals are not noise.
    NoiseAtLimit {
        /// Which size, in words.
        what: &'static str,
        /// In the unit of the report.
        value: f64,
        /// That unit.
        unit: &'static str,
    },
    /// A noise size is far above that of encoders, floor and reference.
    NoiseTooLarge {
        /// Which size, in words.
        what: &'static str,
        /// In the unit of the report.
        value: f64,
        /// The largest usual value for such robots.
        most: f64,
        /// Unit of both.
        unit: &'static str,
    },
    /// The error along the way, or at the ends, is larger than the noise would make it.
    LargerThanNoise {
        /// "along the way" or "at the ends".
        place: &'static str,
        /// Root mean square error \[m\], or \[rad\] if the heading is what is too large.
        left: f64,
        /// Its 95 % quantile if there were only noise.
        expected: f64,
        /// Whether both are headings.
        heading: bool,
    },
    /// A noise size is large, and runs that were left out are predicted better with noise of the usual sizes.
    NoiseAbsorbs {
        /// Which size, in words.
        what: &'static str,
        /// In the unit of the report.
        value: f64,
        /// That unit.
        unit: &'static str,
    },
    /// Runs that were left out are predicted worse than by the nominal robot, or by a model with fewer effects.
    WorseThanSimpler {
        /// \[m\]
        left_out: f64,
        /// \[m\]
        simpler: f64,
        /// The effect that was added last to the simpler model; `None` for the nominal robot.
        up_to: Option<&'static str>,
    },
    /// Fitted to the runs of the other levels of a condition, the model misses those of a level by more than it misses single runs left out.
    WorseElsewhere {
        /// The condition.
        condition: String,
        /// Of runs of a level that was left out \[m\].
        elsewhere: f64,
        /// Of single runs that were left out \[m\].
        left_out: f64,
    },
    /// The model misses the runs that it was fitted to by more than the nominal robot does.
    FarFromTheRuns {
        /// \[m\]
        inside: f64,
        /// \[m\]
        nominal: f64,
    },
    /// Runs that were left out are predicted far worse than those that were fitted: they do not agree, or are too few.
    LeftOutFarWorse {
        /// \[m\]
        left_out: f64,
        /// Of the runs that were fitted \[m\].
        inside: f64,
    },
    /// The residuals repeat from run to run.
    Repeats(Box<Repeated>),
    /// Part of the residuals is the same in every run of one path, by comparison of pairs of runs.
    SameInEveryRun {
        /// How much \[m\] or \[rad\].
        repeats: Repeating,
        /// Of how much.
        left: f64,
        /// Whether both are headings.
        heading: bool,
    },
    /// Errors of the model as it is written repeat in its runs, by the tests of `compare`.
    Depends {
        /// Of all tests.
        p: f64,
        /// What is off, and on what it depends, in words.
        what: String,
    },
    /// The headings of the reference are not those of the way that it measured: what is between them changes slowly.
    HeadingsWander {
        /// Root mean square of what changes slowly \[rad\].
        deviation: f64,
    },
    /// What the model leaves depends on something, surely, though held-out runs are hardly predicted better with it.
    Varies {
        /// Standard deviation of that, as a share of the way.
        share: f64,
        /// "forward" or "yaw".
        motion: &'static str,
        /// What it depends on, in words.
        on: &'static str,
    },
    /// An effect predicts held-out runs better and is significant by F, but runs so few or so different cannot certify it.
    Unconfirmed {
        /// The effect, first, and those that these runs cannot separate from it.
        class: Vec<&'static str>,
        /// p by F of it alone.
        p: f64,
        /// The greatest p of all tests, for all effects that were asked.
        p_adjusted: f64,
        /// Share by which the error of held-out positions or headings falls with it.
        fall: f64,
    },
    /// An effect of the reference leaves the scale open.
    UnknownScale {
        /// The effect, in words.
        title: &'static str,
        /// Share by which E_s may be off either way.
        share: f64,
    },
    /// One run is unlike the others.
    OddRun(OddRun),
    /// A first effect differs from run to run.
    RunsDiffer(Unequal),
    /// The data are in doubt.
    Data(Suspicion),
    /// The search for missing effects was stopped before its end.
    Stopped,
}

/// Counts may hide so many standard deviations of the counters' resolution.
const HIDDEN: f64 = 2.0;

impl Reason {
    /// The reason for doubt if part of the residuals is the same in every run, and larger than what the counters' resolution (standard
    /// deviations of a position and a heading) gives: the counts of runs without noise are alike, and so is what they hide.
    pub(crate) fn of_remains(remains: &Remains, resolution: [f64; 2]) -> Option<Reason> {
        let parts = [(Some(remains.position), resolution[0], false), (remains.heading, resolution[1], true)];
        let mut shown = parts.into_iter().filter_map(|(left, resolution, heading)| {
            let left = left?;
            let shown = |repeats: &Repeating| repeats.is_shown() && repeats.value > HIDDEN * resolution;
            let repeats = left.repeats.filter(shown)?;
            Some(Reason::SameInEveryRun { repeats, left: left.rms, heading })
        });
        shown.next()
    }

    /// Whether it concerns the data and not the model: a model that is fitted to such data is not written.
    pub fn is_of_data(&self) -> bool {
        match self {
            Reason::Fault(_) | Reason::HeadingsWander { .. } | Reason::UnknownScale { .. } => true,
            Reason::Data(suspicion) => suspicion.forbids_writing(),
            _ => false,
        }
    }

    /// Whether it lies in how the runs differ or in what they lack, whichever values are written.
    pub(crate) fn is_of_runs(&self) -> bool {
        matches!(self, Reason::OddRun(_) | Reason::RunsDiffer(_) | Reason::Unconfirmed { .. })
    }

    /// Whether the numbers of the model are wrong where it holds, beside what a missing effect makes of them: they must not be written.
    pub fn forbids_writing(&self) -> bool {
        let of_model = matches!(
            self,
            Reason::NoiseAtLimit { .. }
                | Reason::LargerThanNoise { .. }
                | Reason::WorseThanSimpler { .. }
                | Reason::FarFromTheRuns { .. }
                | Reason::LeftOutFarWorse { .. }
                | Reason::OddRun(_)
                | Reason::Stopped
        );
        of_model || self.is_of_data()
    }

    /// In a sentence, without a full stop.
    pub fn sentence(&self) -> String {
        match self {
            Reason::Fault(fault) => format!("{}; {}", fault.sentence(), fault.remedy()),
            Reason::NoiseAtLimit { what, value, unit } => format!(
                "the {what} reached the limit of its search ({value:.3} {unit}): what the model leaves is not noise"
            ),
            Reason::NoiseTooLarge { what, value, most, unit } => format!(
                "the {what} is {value:.2} {unit}; robots like this have at most {most:.2} {unit}, so the model leaves more than noise"
            ),
            Reason::NoiseAbsorbs { what, value, unit } => format!(
                "the {what} is {value:.2} {unit}, and held-out runs are predicted better with noise of the usual sizes: the fitted noise \
                 has absorbed something that the model lacks"
            ),
            Reason::Depends { p, what } => {
                let p = if *p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {p:.3}") };
                format!("what the model leaves repeats ({p}): {what}")
            }
            Reason::SameInEveryRun { repeats, left, heading } => {
                let (scale, unit) = if *heading { (1f64.to_degrees(), "deg") } else { (1e3, "mm") };
                let low = repeats.interval.map_or(0.0, |interval| interval.low);
                format!(
                    "the model leaves {:.2} {unit}, and at least {:.2} {unit} of it repeats in every run of one path",
                    scale * left,
                    scale * low
                )
            }
            Reason::LargerThanNoise { place, left, expected, heading } => {
                let (scale, unit) = if *heading { (1f64.to_degrees(), "deg") } else { (1e3, "mm") };
                format!(
                    "the model leaves {:.2} {unit} {place}; the fitted noise explains at most {:.2} {unit}",
                    scale * left,
                    scale * expected
                )
            }
            Reason::WorseThanSimpler { left_out, simpler, up_to } => format!(
                "the cross-validated error is {:.1} mm, worse than that of {} ({:.1} mm)",
                1e3 * left_out,
                up_to.map_or("the nominal robot".into(), |effect| format!("the model up to {effect}")),
                1e3 * simpler
            ),
            Reason::WorseElsewhere { condition, elsewhere, left_out } => format!(
                "runs of a {condition} are missed by {:.1} mm by the model fitted to those of every other one, and single runs left out by {:.1} mm: \
                 its numbers depend on the {condition}, or on what differs with it",
                1e3 * elsewhere,
                1e3 * left_out
            ),
            Reason::FarFromTheRuns { inside, nominal } => format!(
                "the model misses the runs that it was fitted to by {:.1} mm, the nominal robot by {:.1} mm",
                1e3 * inside,
                1e3 * nominal
            ),
            Reason::LeftOutFarWorse { left_out, inside } => format!(
                "the cross-validated error is {:.1} mm and the error of the fitted runs {:.1} mm: the runs disagree, or are too few",
                1e3 * left_out,
                1e3 * inside
            ),
            Reason::Repeats(repeated) => repeated.sentence(),
            Reason::Varies { share, motion, on } => format!(
                "the {motion} error depends on {on}, by {:.2} % of the way: the fitted numbers are averages over this change, which their intervals leave out",
                100.0 * share
            ),
            Reason::Unconfirmed { class, p, p_adjusted, fall } => format!(
                "held-out runs are predicted {:.0} % better with {} (p = {p:.0e} by F), but these runs are too few or too different to certify \
                 it (p = {p_adjusted:.2}): drive more runs",
                100.0 * fall,
                class.join(" or ")
            ),
            Reason::HeadingsWander { deviation } => format!(
                "the measured headings wander by {:.1} deg against the way that was measured: they drift, are set anew in each run, or the marker \
                 turned on the robot; leave the column of headings empty, and positions alone are fitted",
                deviation.to_degrees()
            ),
            Reason::UnknownScale { title, share } => format!(
                "the reference has {title}, and which of them is right it does not say: E_s and E_b may be {:.2} % off either way; measure a straight \
                 leg along each axis with a tape, and correct the reference",
                100.0 * share
            ),
            Reason::OddRun(odd) => odd.sentence(),
            Reason::RunsDiffer(unequal) => unequal.sentence(),
            Reason::Data(suspicion) => suspicion.sentence(),
            Reason::Stopped => {
                "the search for missing effects was stopped before its end: what it would have found is not in the numbers".into()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::remains::Left;
    use crate::stats::Interval;

    #[test]
    fn what_is_the_same_in_every_run_is_a_reason_where_counts_do_not_hide_it() {
        let of = |value: f64| {
            let repeats = Some(Repeating { value, interval: Some(Interval::around(value, 0.5 * value)) });
            let position = Left { rms: 1e-3, repeats };
            let remains = Remains {
                position,
                heading: None,
                pairs: 3,
                piece: None,
                chance: Vec::new(),
                disturbances: Vec::new(),
            };
            Reason::of_remains(&remains, [1e-4, 1e-4]).is_some()
        };
        assert!(of(3e-4) && !of(1.9e-4));
    }
}
