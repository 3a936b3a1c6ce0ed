//! One test for all repeating patterns: thousands of laws outside the catalogue, and one p-value for all of them.
//!
//! The whitened residuals of a fitted model are correlated with the whitened columns of every law of [`Laws`], after the model's own
//! columns are projected out of each. The statistic is the largest score in standard deviations. If nothing repeats, the signs of whole
//! runs can be flipped, which gives its distribution: the largest score of all laws is compared with the largest under each flip. If few
//! runs determine a column, quarters of runs are flipped.
//!
//! Each of the most significant laws is then fitted together with the model and cross-validated. The law is the shortest of those that
//! predict held-out runs as well as the best, within one standard error.
//!
//! Source: as [`flips`](super::flips); the choice by one standard error, Breiman, Friedman, Olshen & Stone (1984).

mod added;
mod extent;
mod families;
mod front;
mod law;
mod laws;
mod lengths;
mod pick;
mod shaping;
mod signs;
mod steps;

use super::examination::Examination;
use crate::effect::Model;
use crate::likelihood::{Column, Noise, Observed};
use front::front;
use laws::Laws;
use pick::{picks, sense_of};
use rayon::prelude::*;
use signs::{Asked, Sums, of_run, p_of_all};
use steps::{TrackStep, steps};

pub(super) use added::suspect;
pub use law::{Repeated, UnlistedLaw};

/// Searches the residuals of a model for a repeating pattern: the most significant law, even if it does not count; `None` if the runs can
/// show no law. `own` holds, run by run, the columns that are fitted too, each with one (x, y, heading) \[m, m, rad\] per block, and last
/// the residual.
pub fn what_repeats(
    observed: &Observed,
    model: &Model,
    noise: &Noise,
    own: &[Vec<Column>],
    seed: u64,
) -> Option<Repeated> {
    let chain = model.chain();
    let steps: Vec<Vec<TrackStep>> = observed.runs.par_iter().map(|run| steps(run, &chain)).collect();
    let laws = Laws::of(&steps, &observed.robot, observed.turns());
    let runs = observed.runs.par_iter().zip(own).zip(&steps).enumerate();
    let sums = runs.flat_map_iter(|(index, ((run, own), steps))| of_run(index, run, own, &laws, steps, noise));
    let sums: Vec<Sums> = sums.collect();
    let senses: Vec<f64> = sums.iter().map(|unit| sense_of(&observed.runs[unit.run])).collect();
    let plain = Asked::new(&sums, &vec![1.0; sums.len()])?;
    let both = [-1.0, 1.0].iter().all(|sense| senses.contains(sense));
    let turned = both.then(|| Asked::new(&sums, &senses)).flatten();
    drop(sums);
    let asked: Vec<&Asked> = std::iter::once(&plain).chain(&turned).collect();
    let p = p_of_all(&asked, seed)?;
    let (mut picks, square) = picks(&asked, &laws);
    shaping::shape(&mut picks, (observed, noise, own), &laws, &steps);
    let mut front = front(observed, noise, own, &laws, &steps, &picks);
    if front.is_empty() {
        return None;
    }
    front.iter_mut().zip(1..).for_each(|(law, number)| law.number = number);
    let law = front.remove(0);
    Some(Repeated {
        p,
        deviations: square.sqrt(),
        laws: asked.iter().map(|asked| asked.shown()).sum(),
        runs: observed.runs.len(),
        law,
        others: front,
    })
}

/// The strongest repeating pattern beyond the model of an examination and the effects of the reference.
pub(super) fn beside(exam: &Examination, seed: u64) -> Option<Repeated> {
    let own = exam.some_columns(&[&exam.base(None)[..], &[exam.system.residual()]].concat());
    what_repeats(&exam.fitted.observed, &exam.fitted.model, &exam.fitted.noise, &own, seed)
}

#[cfg(test)]
mod tests {
    use super::super::smooth::Motion;
    use super::super::tests::{complete, fitted, on_grain};
    use super::steps::Per;
    use super::*;
    use crate::drive::Robot;
    use crate::effect::effects_text;
    use crate::effect::{Formula, Target};
    use crate::likelihood::watched::watched;

    #[test]
    fn nothing_counts_beside_a_complete_model() {
        let repeated = beside(complete(), 1).unwrap();
        assert!(!repeated.counts(0.02) && repeated.laws > 1000, "{repeated:?}");
    }

    /// Patterns that count by p, by size, and by gain; each of the others just misses one threshold.
    #[test]
    fn a_law_counts_by_its_p_its_score_and_what_it_predicts() {
        let repeated = beside(complete(), 1).unwrap();
        let counts = |p: f64, deviations: f64, gain: f64, runs: usize| {
            let law = UnlistedLaw { gain, ..repeated.law.clone() };
            Repeated { p, deviations, laws: 4000, runs, law, ..repeated.clone() }.counts(0.02)
        };
        assert!(counts(0.01, 12.0, 0.03, 10));
        assert!(!counts(0.02, 12.0, 0.03, 10) && !counts(0.01, 10.0, 0.03, 10) && !counts(0.01, 12.0, 0.01, 10));
        assert!(counts(0.05, 20.0, 0.11, 10));
        assert!(!counts(0.06, 20.0, 0.11, 10) && !counts(0.05, 12.0, 0.11, 10) && !counts(0.05, 20.0, 0.09, 10));
        assert!(counts(0.2, 8.0, 0.4, 4));
        assert!(!counts(0.21, 8.0, 0.4, 4) && !counts(0.2, 4.4, 0.43, 4) && !counts(0.2, 8.0, 0.39, 4));
        assert!(!counts(0.2, 8.0, 0.4, 3));
        assert!(counts(0.05, 6.0, 0.71, 4));
        assert!(!counts(0.06, 6.0, 0.71, 4) && !counts(0.05, 5.0, 0.71, 4) && !counts(0.05, 6.0, 0.69, 4));
        assert!(!counts(0.05, 6.0, 0.71, 3));
        let doubt = |deviations: f64, gain: f64, runs: usize| {
            let law = UnlistedLaw { gain, ..repeated.law.clone() };
            let doubted = Repeated { p: 0.3, deviations, laws: 4000, runs, law, ..repeated.clone() };
            assert!(!doubted.counts(0.0) && doubted.sentence().starts_with("what the model leaves may repeat ("));
            doubted.is_doubt(0.02)
        };
        assert!(doubt(8.0, 0.1, 4));
        assert!(!doubt(6.0, 0.1, 4) && !doubt(8.0, 0.09, 4) && !doubt(8.0, 0.1, 3));
    }

    #[test]
    fn a_law_that_no_catalogue_lists_is_named_with_what_it_follows() {
        let exam = Examination::new(super::super::tests::fitted_to(&on_grain())).unwrap();
        let repeated = beside(&exam, 1).unwrap();
        assert!(repeated.counts(0.1) && repeated.p < 0.01, "{repeated:?}");
        assert_eq!((repeated.law.acts_on, repeated.law.per), ("yaw", "metre"));
        assert_eq!(repeated.law.by(), "a wave of 2 times the heading");
        assert!(repeated.law.left_out[1] < 0.5 * repeated.law.left_out[0], "{repeated:?}");
        let law = repeated.law.model.as_ref().unwrap();
        assert!(
            effects_text(law).contains(
                "acts_on = \"heading_per_metre\"\nformula = \"a * cos(2 * heading) + b * sin(2 * heading)\"\n"
            ),
            "{}",
            effects_text(law)
        );
        let sizes = ["a", "b"].map(|name| law.get("yaw_by_heading", name).unwrap());
        assert!((sizes[0] - 0.02).abs() < 1e-3, "{sizes:?}");
        assert_eq!(beside(&exam, 1), Some(repeated));
    }

    /// Oracle: exact derivatives of replays with a formula that does the same, on squares driven both ways.
    #[test]
    fn a_law_moves_the_robot_as_a_formula_does_that_adds_the_same() {
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        let chain = model.chain();
        let steps: Vec<Vec<TrackStep>> = observed.runs.iter().map(|run| steps(run, &chain)).collect();
        let laws = Laws::of(&steps, &observed.robot, observed.turns());
        for (words, per, motion, target, formula) in [
            ("a wave of 2 times the heading", "metre", 2, Target::HeadingPerMetre, "cos(2 * heading)"),
            ("the square of the speed", "metre", 1, Target::SidewaysPerMetre, "speed^2"),
            ("the speed", "metre", 0, Target::ForwardScale, "abs(speed)"),
            ("the size of the turn rate", "radian turned", 0, Target::ForwardPerRadian, "abs(turn_rate)"),
            ("the time in the run", "metre", 2, Target::HeadingPerMetre, "time"),
        ] {
            let mut with = Model::new(&observed.robot);
            let text = format!("k * {formula}");
            with.add_formula(Formula::new("own", target, &text, &["k"]).unwrap(), &[0.0]).unwrap();
            let expected = observed.columns(&with, &[0]);
            let is_it = |term: &usize| laws.words(*term) == words && laws.terms[*term].per.name() == per;
            let term = (0..laws.terms.len()).find(is_it).unwrap();
            for ((run, expected), steps) in observed.runs.iter().zip(&expected).zip(&steps) {
                let own = &laws.columns(&[term], run, steps)[motion];
                for k in 0..3 {
                    let most = expected[0].iter().map(|error| error[k].abs()).fold(0.0, f64::max);
                    let near = |(a, b): (&[f64; 3], &[f64; 3])| (a[k] - b[k]).abs() <= 0.1 * most + 1e-9;
                    assert!(own.iter().zip(&expected[0]).all(near), "{words}, {k}");
                }
            }
        }
    }

    /// Oracle: the mean of the exact derivatives of all poses of a block, on the first leg, where a scale of one adds the way.
    #[test]
    fn a_law_stands_at_the_mean_of_the_poses_of_a_block() {
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        let mut with = Model::new(&observed.robot);
        with.add_formula(Formula::new("own", Target::ForwardScale, "k", &["k"]).unwrap(), &[0.0]).unwrap();
        for (run, exact) in observed.runs.iter().zip(&observed.columns(&with, &[0])) {
            let steps = steps(run, &model.chain());
            // Behind the ramp the robot makes a centimetre between poses, and blocks hold odd and even numbers of them.
            for (block, exact) in exact[0].iter().enumerate().take(6).skip(3) {
                let way: f64 = steps.iter().filter(|step| step.block <= block).map(|step| step.way).sum();
                let off = way - exact[0];
                assert!(off.abs() < 2e-4, "{block}: {off}");
            }
        }
    }

    #[test]
    fn where_runs_do_not_turn_no_law_of_turns_is_asked_and_cosines_keep_their_sines() {
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        let chain = model.chain();
        let steps: Vec<Vec<TrackStep>> = observed.runs.iter().map(|run| steps(run, &chain)).collect();
        let [all, straight] = [true, false].map(|turns| Laws::of(&steps, &observed.robot, turns));
        let text = |laws: &Laws, term: usize| laws.functions[laws.terms[term].function].formula.0.clone();
        let is_of_turns = |laws: &Laws, k: usize| {
            matches!(laws.terms[k].per, Per::Radian | Per::Turned) || text(laws, k).contains("turn")
        };
        let told = |laws: &Laws, term: usize| {
            let own = laws.terms[term];
            (text(laws, term), own.per.name(), own.twin.map(|twin| text(laws, twin)))
        };
        let others: Vec<_> =
            (0..all.terms.len()).filter(|term| !is_of_turns(&all, *term)).map(|term| told(&all, term)).collect();
        let kept: Vec<_> = (0..straight.terms.len()).map(|term| told(&straight, term)).collect();
        assert_eq!(kept, others);
        assert!(observed.turns() && others.len() + 20 < all.terms.len(), "{}", others.len());
    }

    /// Oracle: the columns of the law itself, and exact derivatives of replays of the formula that it is written as.
    #[test]
    fn every_law_moves_the_robot_as_the_formula_does_that_it_is_written_as() {
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        let chain = model.chain();
        let steps: Vec<Vec<TrackStep>> = observed.runs.iter().map(|run| steps(run, &chain)).collect();
        let laws = Laws::of(&steps, &observed.robot, observed.turns());
        let (mut written, mut of_wheels, mut lost) = (0, 0, Vec::new());
        for term in 0..laws.terms.len() {
            let terms: Vec<usize> =
                std::iter::once(term).chain(laws.terms[term].twin.filter(|twin| *twin > term)).collect();
            if laws.terms[term].twin.is_some_and(|twin| twin < term) {
                continue;
            }
            for (which, motion) in Motion::ALL.into_iter().enumerate() {
                let sizes = vec![0.0; terms.len()];
                let Some(formula) = laws.model(term, (&sizes, &laws.shapes(term)), (motion, false), &observed.robot)
                else {
                    continue;
                };
                written += 1;
                of_wheels += usize::from(laws.acts_on(term, motion).ends_with("wheel"));
                assert!(observed.tracks().all(|track| track.check(&formula).is_ok()), "{}", laws.words(term));
                let numbers: Vec<usize> = (0..sizes.len()).collect();
                let derivatives = observed.columns(&formula, &numbers);
                for ((run, exact), steps) in observed.runs.iter().zip(&derivatives).zip(&steps) {
                    let own: Vec<Column> =
                        laws.columns(&terms, run, steps).into_iter().skip(which).step_by(Motion::ALL.len()).collect();
                    for (own, exact) in own.iter().zip(exact) {
                        let size = |column: &Column| column.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
                        let off: Column =
                            own.iter().zip(exact).map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]]).collect();
                        let words = laws.words(term);
                        // Blocks hold some decimetres and seconds: what turns over within them is its mean in one, and its middle in the other.
                        let is_quick = ["wave", "more than"].iter().any(|quick| words.contains(quick));
                        if size(&off) > if is_quick { 0.6 } else { 0.15 } * size(exact) + 1e-6 {
                            lost.push((
                                laws.words(term).to_owned(),
                                laws.terms[term].per,
                                motion,
                                size(&off),
                                size(exact),
                            ));
                        }
                    }
                }
            }
        }
        assert!(written > 500 && of_wheels >= 18, "{written}, {of_wheels}");
        assert!(lost.len() < written / 10, "{} of {written}: {:#?}", lost.len(), &lost);
    }

    #[test]
    fn an_effect_that_the_model_lacks_counts_and_is_said_in_a_sentence() {
        let exam = Examination::new(fitted(&[("floor_slope", "drift_x", 6e-3)])).unwrap();
        let repeated = beside(&exam, 1).unwrap();
        assert!(repeated.counts(0.02), "{repeated:?}");
        let said = repeated.sentence();
        assert!(said.starts_with("what the model leaves repeats (p = ") && said.contains(&repeated.law.by()), "{said}");
    }
}
