//! Reasons against a learnt model that its own errors give.

use super::story::{Crossed, Error, Step};
use crate::diagnose::Reason;

/// A model misses by more than the nominal robot, or a model with fewer effects, where its error exceeds this multiple of the other's: three
/// numbers that are fitted to few runs cost something where the nominal robot is right.
const WORSE: f64 = 1.5;
/// Errors of held-out runs are compared with those of simpler models from so many runs on.
const ENOUGH_RUNS: usize = 5;
/// A difference d between one of n levels and the others is missed by d (n - 1)/n where all runs are fitted, and by d where those of the level are
/// left out: n/(n - 1) times as much. This share of the excess counts. In 210 tests by tape on floors that do not differ it was at most 0.44 of
/// it (tests/worlds/floors.py).
const OF_A_DIFFERENCE: f64 = 0.5;
/// Held-out runs disagree with those fitted where their error exceeds this multiple.
const FAR_WORSE: f64 = 5.0;

/// What speaks against the model of the last step, by its errors in some runs and those of the steps before, the nominal robot first; `noise` is
/// that of single positions \[m\]. A model whose every size may be zero (`is_nominal`) is the nominal robot, and is not compared with it. Where
/// the runs beside one do not determine every number (`is_told` is false), that one is not theirs to predict: one square driven each way.
pub(super) fn misfits(steps: &[Step], runs: usize, noise: f64, is_nominal: bool, is_told: bool) -> Vec<Reason> {
    let [nominal, .., end] = steps else { return Vec::new() };
    let (inside, left_out) = (end.error.position, end.held_out.position);
    let mut reasons = Vec::new();
    let simpler = steps[usize::from(is_nominal)..steps.len() - 1].iter();
    let best = simpler.min_by(|a, b| a.held_out.position.total_cmp(&b.held_out.position));
    if let Some(best) = best.filter(|best| runs >= ENOUGH_RUNS && left_out > WORSE * best.held_out.position) {
        reasons.push(Reason::WorseThanSimpler { left_out, simpler: best.held_out.position, up_to: best.added });
    }
    if inside > WORSE * nominal.error.position.max(noise) {
        reasons.push(Reason::FarFromTheRuns { inside, nominal: nominal.error.position });
    }
    if is_told && left_out > FAR_WORSE * inside.max(noise) {
        reasons.push(Reason::LeftOutFarWorse { left_out, inside });
    }
    reasons
}

/// What speaks against the model of the last step by the runs of levels of conditions that were left out: fitted to those of the other levels, it
/// misses them by more than it misses single runs that are left out. `noise` is that of single positions \[m\]. Where the runs of one level alone
/// tell an effect, those of the others cannot predict them.
pub(super) fn elsewhere(steps: &[Step], conditions: &[Crossed], runs: usize, noise: f64) -> Vec<Reason> {
    let Some(end) = steps.last().filter(|_| runs >= ENOUGH_RUNS) else { return Vec::new() };
    let of_condition = |(own, error): (&Crossed, &Error)| {
        let (elsewhere, left_out) = (error.position, end.held_out.position);
        let condition = own.names[0].clone();
        let worse = 1.0 + OF_A_DIFFERENCE / own.levels.len().saturating_sub(1).max(1) as f64;
        (own.only.is_empty() && elsewhere > worse * left_out.max(noise)).then_some(Reason::WorseElsewhere {
            condition,
            elsewhere,
            left_out,
        })
    };
    conditions.iter().zip(&end.elsewhere).filter_map(of_condition).collect()
}

#[cfg(test)]
mod tests {
    use super::super::story::Error;
    use super::*;

    /// A row of a table whose model misses its own runs and held-out ones by so many millimetres.
    fn row(added: Option<&'static str>, [inside, left_out]: [f64; 2]) -> Step {
        let error = |mm: f64| Error { position: 1e-3 * mm, heading: None, weighted: 1.0 };
        let (error, held_out) = (error(inside), error(left_out));
        let elsewhere = Vec::new();
        Step {
            added,
            class: Vec::new(),
            p_adjusted: None,
            law: None,
            error,
            held_out,
            elsewhere,
            aicc: None,
            bic: None,
        }
    }

    /// The reasons against a model that misses its own runs and held-out ones by so many millimetres, the nominal robot by 10 mm.
    fn against(missed: [f64; 2], runs: usize, noise: f64, is_nominal: bool) -> Vec<Reason> {
        let steps = [row(None, [10.0, 10.0]), row(Some("scale"), [12.0, 12.0]), row(Some("slip"), missed)];
        misfits(&steps, runs, 1e-3 * noise, is_nominal, true)
    }

    /// A delay alone predicts held-out runs with 17 mm, and with all that is fitted behind it 125 mm are left, where the nominal robot has 90.
    #[test]
    fn a_model_is_doubted_that_predicts_worse_than_an_earlier_row() {
        let steps = [
            row(None, [90.0, 90.0]),
            row(Some("reference_delay"), [45.0, 17.0]),
            row(Some("caster_kick"), [99.0, 125.0]),
        ];
        let worse = Reason::WorseThanSimpler { left_out: 0.125, simpler: 0.017, up_to: Some("reference_delay") };
        assert!(worse.sentence().ends_with("worse than that of the model up to reference_delay (17.0 mm)"));
        assert_eq!(misfits(&steps, 9, 1e-3, false, true), std::slice::from_ref(&worse));
        assert_eq!(misfits(&steps, 9, 1e-3, true, true), [worse]);
    }

    #[test]
    fn a_model_that_is_worse_than_the_nominal_robot_is_doubted_in_its_own_runs_however_few_and_in_others_from_five_on()
    {
        assert_eq!(against([14.0, 14.0], 6, 1.0, false), []);
        let left_out = Reason::WorseThanSimpler { left_out: 0.016, simpler: 0.01, up_to: None };
        assert_eq!(against([14.0, 16.0], 5, 1.0, false), [left_out]);
        assert_eq!(against([14.0, 16.0], 4, 1.0, false), []);
        assert_eq!(against([14.0, 16.0], 5, 1.0, true), []);
        let inside = Reason::FarFromTheRuns { inside: 0.016, nominal: 0.01 };
        assert_eq!(against([16.0, 14.0], 1, 1.0, false), [inside]);
        // Within the noise of single poses nothing is worse.
        assert_eq!(against([16.0, 14.0], 1, 11.0, false), []);
    }

    #[test]
    fn runs_that_disagree_are_doubted_unless_the_noise_is_as_large() {
        let disagree = Reason::LeftOutFarWorse { left_out: 0.011, inside: 0.002 };
        assert_eq!(against([2.0, 11.0], 2, 1.0, false), [disagree]);
        assert_eq!(against([2.0, 11.0], 2, 2.5, false), []);
        let steps = [row(None, [10.0, 10.0]), row(Some("wheelbase"), [2.0, 11.0])];
        assert_eq!(misfits(&steps, 2, 1e-3, false, false), [], "one run does not tell what the other shows");
    }

    #[test]
    fn what_is_missed_elsewhere_is_held_against_what_a_difference_of_the_levels_makes_of_it() {
        let told = |levels: usize, elsewhere: f64, only: Vec<(&'static str, String)>| {
            let mut end = row(None, [10.0, 10.0]);
            end.elsewhere = vec![Error { position: 1e-3 * elsewhere, ..end.held_out }];
            let levels = (0..levels).map(|level| level.to_string()).collect();
            let own = Crossed { names: vec!["floor".into()], levels, only };
            super::elsewhere(&[end], &[own], 12, 1e-3).len()
        };
        let none = Vec::new;
        assert_eq!([told(2, 14.9, none()), told(2, 15.1, none())], [0, 1]);
        assert_eq!([told(3, 12.4, none()), told(3, 12.6, none())], [0, 1]);
        assert_eq!(
            told(2, 30.0, vec![("wheelbase", "0".into())]),
            0,
            "runs of another floor do not tell the wheelbase"
        );
    }
}
