//! The loop on tracks: made data with a known cause, and a real robot's. Nothing here reads the answers but the assertions.

use std::io::Write;
use std::path::PathBuf;
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{Options, Verdict};
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::evidence::fit;
use umbmark_core::learn::{Learnt, learn};
use umbmark_core::path::{Path, SQUARE, SpeedProfile};
use umbmark_core::simulate::record_test;
use umbmark_core::stats::student_t_quantile;

/// What is learnt of shared data; nothing, with a notice, where it is absent.
fn learnt(place: &str) -> Option<Learnt> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data").join(place);
    if !folder.exists() {
        let _ = writeln!(std::io::stderr(), "skipped: {} is not there", folder.display());
        return None;
    }
    let data = umbmark_io::load(&folder).unwrap();
    Some(learn(&data, &Options::default()).unwrap())
}

/// Effects of the model beside E_d, E_b and E_s.
fn added(learnt: &Learnt) -> Vec<&'static str> {
    let first = ["wheel_diameter_ratio", "wheelbase", "scale"];
    let effects = learnt.model.parts().iter().map(|part| part.effect.name());
    effects.filter(|effect| !first.contains(effect)).collect()
}

/// What cannot be told from an effect that was added.
fn class_of(learnt: &Learnt, effect: &str) -> Vec<&'static str> {
    learnt.steps.iter().find(|step| step.added == Some(effect)).unwrap().class.clone()
}

#[test]
fn the_hidden_effect_of_made_data_is_added_and_nothing_else() {
    for (set, class, parameter, truth) in [
        ("s51", "", "", 0.0),
        ("s52", "caster_kick", "kick_rad", 0.03),
        ("s53", "wheel_eccentricity_left", "", 0.0),
        ("s54", "floor_slope", "", 0.0),
        ("s55", "encoder_skew", "delay_right_s", -0.02),
        ("s56", "turn_slip_rate", "s_per_rad", 0.05),
        ("s57", "direction_dependent_wheelbase", "difference", 0.018),
    ] {
        let Some(learnt) = learnt(&format!("made/{set}")) else { return };
        let named = added(&learnt).first().map_or(vec![], |effect| class_of(&learnt, effect));
        assert_eq!(added(&learnt).len(), usize::from(!class.is_empty()), "{set}: {:?}", added(&learnt));
        assert!(class.is_empty() || named.contains(&class), "{set}: {named:?}");
        assert_eq!(learnt.verdict, Verdict::Explained, "{set}");
        if let Some(found) = learnt.diagnosis.fitted.iter().find(|e| e.parameter == parameter) {
            let apart = (found.value - truth).abs() / found.standard_error;
            assert!(apart < 3.0, "{set}: {} ± {}, truth {truth}", found.value, found.standard_error);
        }
    }
}

#[test]
fn bumps_on_the_first_leg_are_found_in_an_engines_data() {
    let Some(learnt) = learnt("made/p56") else { return };
    // The engine's tyres give way when it accelerates, in every set; that may be added behind.
    let bumps = learnt.steps.iter().position(|step| step.added == Some("placed_bumps")).unwrap();
    assert!(learnt.steps[bumps].held_out.position < 0.5 * learnt.steps[bumps - 1].held_out.position);
}

#[test]
fn a_scale_error_that_end_poses_cannot_see_shows_on_the_tracks_of_a_real_robot() {
    let Some(learnt) = learnt("optiodom/raw/square/230620202317") else { return };
    let scale = learnt.diagnosis.fitted.iter().find(|e| e.parameter == "e_s").unwrap();
    // The authors' own ticks and poses give -0.43 to -0.46 % by fits that take delay and lever arm for known.
    let apart = (scale.value - 0.9955) / scale.standard_error;
    assert!(apart.abs() < 1.96 && scale.value + 4.0 * scale.standard_error < 1.0, "{scale:?}");
    assert!((learnt.steps[0].held_out.position - 13.3e-3).abs() < 0.5e-3);
    assert!(learnt.steps.last().unwrap().held_out.position < 8.8e-3);
    assert_ne!(learnt.verdict, Verdict::Explained);
}

/// So many squares of some size \[m\] each way of a robot of this model, watched at 20 Hz.
fn watched(model: &Model, (runs, side): (usize, f64), seed: u64) -> Dataset {
    let path = Path::new(&SQUARE, &[side], SpeedProfile::default()).unwrap();
    record_test(model, &path, &[TestKind::Systematic], [runs, runs], 20.0, [seed, 0]).unwrap()
}

/// 40 sets of 3 + 3 squares, seeds 0 to 39, with headings and without: of 200 intervals of 95 %, 20 or more miss the truth with a probability
/// below 0.1 % if they are right (binomial), and so do 2 or fewer. A wrong heading moves a marker 130 mm off the axle sideways; where the
/// noise was thought to act at the axle, 32 and 29 missed; now 10 and 6 do.
#[test]
fn intervals_hold_where_a_marker_sits_off_the_axle() {
    let robot = Robot::labmate();
    let mut model = Model::new(&robot);
    let truth = [
        ("wheel_diameter_ratio", "e_d", 1.002),
        ("wheelbase", "e_b", 0.99),
        ("scale", "e_s", 1.003),
        ("marker_offset", "forward_m", 0.12),
        ("marker_offset", "left_m", -0.05),
    ];
    let noise = [("wheel_noise", "k_sqrt_m", 6e-4), ("reference_noise", "position_sd_m", 2e-3)];
    for (effect, parameter, value) in truth.iter().chain(&noise) {
        model.set(effect, parameter, *value).unwrap();
    }
    let mut asked = Model::new(&robot);
    for effect in ["wheel_diameter_ratio", "wheelbase", "scale", "marker_offset"] {
        asked.add(effect).unwrap().free = true;
    }
    let [mut whole, mut positions] = [Vec::new(), Vec::new()];
    for seed in 0..40 {
        let mut data = watched(&model, (3, 2.0), seed);
        for missed in [&mut whole, &mut positions] {
            let found = fit(&data, &asked).unwrap();
            for (_, parameter, value) in truth {
                let own = found.estimates.iter().find(|estimate| estimate.parameter == parameter).unwrap();
                let half = student_t_quantile(0.975, own.degrees_of_freedom) * own.standard_error;
                if (own.value - value).abs() > half {
                    missed.push((seed, parameter));
                }
            }
            let poses = data.runs.iter_mut().filter_map(|run| run.log.as_mut()).flat_map(|log| &mut log.reference);
            poses.for_each(|pose| pose.heading = None);
        }
    }
    for missed in [whole, positions] {
        assert!((3..20).contains(&missed.len()), "{}: {missed:?}", missed.len());
    }
}

/// A simulator's poses have no noise: what is left is what counts hide, and what the wheels do, in turns on the spot too. With noise of the
/// wheels in legs alone, the largest of some 3000 laws is 7 to 16 standard deviations here, and every tenth set is not explained.
#[test]
fn poses_without_noise_accuse_no_robot() {
    const K: f64 = 5e-4;
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in [("wheelbase", "e_b", 0.99), ("wheel_noise", "k_sqrt_m", K)] {
        model.set(effect, parameter, value).unwrap();
    }
    let (mut deviations, mut forward, mut accused) = (Vec::new(), Vec::new(), 0);
    for seed in 0..10 {
        let learnt = learn(&watched(&model, (3, 1.0), seed), &Options::default()).unwrap();
        deviations.push(learnt.diagnosis.repeats.as_ref().unwrap().deviations);
        forward.push(learnt.noise.unwrap().forward_per_metre);
        accused += usize::from(learnt.verdict != Verdict::Explained);
    }
    let middle = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let (largest, forward) = (middle(deviations), middle(forward));
    assert!(largest < 5.5 && accused <= 2, "{largest} {accused}");
    // Two wheels that err independently: their mean errs by k/√2.
    assert!((forward / (K / 2f64.sqrt()) - 1.0).abs() < 0.3, "{forward}");
}
