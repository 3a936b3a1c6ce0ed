use super::*;
use crate::engine::random_lines::{Source, cases};
use crate::engine::{Monoid, double_double, oracle, word_product};
use std::f64::consts::PI;

/// The robot of the design figures: wheels of 0.15 m, 2000 ticks a turn, wheelbase 0.34 m.
fn nominal() -> TickGeometry {
    TickGeometry::new(PI * 0.15 / 2000.0, PI * 0.15 / 2000.0, 0.34).unwrap()
}

/// As nominal, but 8000 ticks of one wheel are a whole turn of the robot, exactly.
fn commensurate() -> TickGeometry {
    TickGeometry::new(PI * 0.15 / 2000.0, PI * 0.15 / 2000.0, 0.3).unwrap()
}

fn calibrated() -> TickGeometry {
    TickGeometry::new(2.353e-4, 2.353e-4 * 1.0012, 0.3372).unwrap()
}

/// Largest errors of position \[m\] and rotation \[rad\] against the double-double tick loop.
fn errors(geometry: &TickGeometry, line: &WheelLine) -> (f64, f64) {
    let motion = TickOdometry::new(*geometry).motion(line);
    let [x, y, heading, cosine, sine] = double_double::motion(geometry, line);
    let off = |value: f64, reference: double_double::DoubleDouble| {
        (double_double::DoubleDouble::from(value) - reference).value().abs()
    };
    let position = off(motion.pose.x, x).max(off(motion.pose.y, y));
    let rotation = off(motion.pose.heading, heading).max(off(motion.cosine, cosine)).max(off(motion.sine, sine));
    (position, rotation)
}

#[test]
fn a_segment_ends_where_the_double_double_tick_loop_ends() {
    let mut source = Source(3);
    for i in 0..cases(600) {
        let ticks = if i % 20 == 0 { 100_000 } else { 3_000 };
        let line = source.line(ticks);
        for geometry in [nominal(), commensurate(), calibrated()] {
            let (position, rotation) = errors(&geometry, &line);
            assert!(position <= 1e-12 && rotation <= 1e-12, "{line:?} {geometry:?}: {position:e} m, {rotation:e} rad");
        }
    }
}

#[test]
fn patterns_of_almost_whole_turns_lose_no_digits() {
    for (left, right) in [(12.0, 95_988.0), (-12.0, 96_000.0), (12.3, 96_012.7), (-4.1, 96_003.0)] {
        let line = WheelLine::from_ticks([0.3, 0.6], [left, right]).unwrap();
        let (position, rotation) = errors(&commensurate(), &line);
        assert!(position <= 1e-12 && rotation <= 1e-12, "{left} {right}: {position:e} m, {rotation:e} rad");
    }
}

/// Almost straight, through a part of a turn, and round about; forward and backward. Left in, the rounding of the ticks would be 1e-11 m.
#[test]
fn what_the_rounded_ticks_of_a_long_line_add_up_to_is_taken_off() {
    for [left, right] in [[2.0e6, 2.0e6 / 1.0012], [2.0e6, 1.9988e6], [-2.0e6, -1.994e6]] {
        let line = WheelLine::from_ticks([0.3, 0.6], [left, right]).unwrap();
        let (position, rotation) = errors(&calibrated(), &line);
        assert!(position <= 1e-12 && rotation <= 1e-12, "{left} {right}: {position:e} m, {rotation:e} rad");
    }
}

/// 1e7 ticks are 2.4 km. With equal tick lengths the half rotations of the two letters are exact opposites and their rounding
/// cancels; with unequal ones it adds up along the way, and is taken off.
#[test]
#[ignore = "a minute; to be run after a change of the kernels"]
fn ten_million_ticks_stay_within_their_bound() {
    let mut source = Source(4);
    for _ in 0..40 {
        let line = source.line(10_000_000);
        for geometry in [nominal(), commensurate(), calibrated()] {
            let (position, rotation) = errors(&geometry, &line);
            println!("{position:.1e} m, {rotation:.1e} rad, {:?} ticks", line.counts());
            assert!(position <= 2e-11 && rotation <= 2e-11, "{line:?}: {position:e} m, {rotation:e} rad");
        }
    }
}

#[test]
fn the_tick_loop_in_f64_agrees() {
    let mut source = Source(5);
    for geometry in [nominal(), calibrated()] {
        for _ in 0..cases(300) {
            let line = source.line(5_000);
            let (fast, slow) = (TickOdometry::new(geometry).motion(&line), oracle::motion(&geometry, &line));
            let error = (fast.pose.x - slow.pose.x).abs().max((fast.pose.y - slow.pose.y).abs());
            assert!(error <= 1e-12, "{line:?}: {error:e} m");
            assert_eq!(fast.pose.heading, slow.pose.heading);
            assert!((fast.cosine - slow.cosine).abs() <= 1e-12 && (fast.sine - slow.sine).abs() <= 1e-12);
        }
    }
}

#[test]
fn the_oracle_does_not_drift() {
    for geometry in [nominal(), calibrated()] {
        let line = WheelLine::from_ticks([0.1, 0.7], [100_000.3, 100_020.8]).unwrap();
        let (motion, [x, y, ..]) = (oracle::motion(&geometry, &line), double_double::motion(&geometry, &line));
        let error = (motion.pose.x - x.value()).abs().max((motion.pose.y - y.value()).abs());
        assert!(error <= 2e-14, "{error:e} m");
    }
}

#[test]
fn the_ideal_robot_drives_exactly_straight_because_simultaneous_ticks_are_one_letter() {
    let geometry = nominal();
    let ticks = 4.0 / geometry.left();
    let leg = WheelLine::from_ticks([0.0, 0.0], [ticks, ticks]).unwrap();
    let motion = TickOdometry::new(geometry).motion(&leg);
    assert_eq!((motion.pose.y, motion.pose.heading, motion.sine, motion.cosine), (0.0, 0.0, 0.0, 1.0));
    assert!((motion.pose.x - 16_976.0 * geometry.left()).abs() < 1e-12);

    // Were one of the two to come first, the robot would zigzag to its side: δ L / (2 b) = 1.386 mm on 4 m.
    let tick = |letter| MidHeading::of_letter(&geometry, letter, [false; 2]);
    let ordered = word_product(&leg, |letter| match letter {
        Letter::Joint => tick(Letter::Right).then(&tick(Letter::Left)),
        letter => tick(letter),
    });
    assert!((ordered.end()[1] - 1.386e-3).abs() < 1e-6, "{}", ordered.end()[1]);
}

#[test]
fn driving_back_leads_back() {
    let mut source = Source(6);
    let odometry = TickOdometry::new(calibrated());
    for _ in 0..2_000 {
        let there = source.line(20_000);
        let back = there.followed_by(there.travel().map(|units| -units)).unwrap();
        if there.backward() == [false; 2] || there.backward() == [true; 2] {
            // The order of the ticks on the way back may differ where two fall into one unit, never the counts.
            let motion = odometry.motion(&there).then(&odometry.motion(&back));
            assert!(motion.pose.heading.abs() < 1e-13);
        }
        assert_eq!(back.end_phases(), there.start());
    }
}

fn bits(motion: &Motion) -> [u64; 5] {
    [motion.pose.x, motion.pose.y, motion.pose.heading, motion.cosine, motion.sine].map(f64::to_bits)
}

#[test]
fn many_lines_at_once_give_the_same_bits_as_one_by_one_on_every_instruction_set() {
    let mut source = Source(7);
    for geometry in [nominal(), commensurate(), calibrated(), TickGeometry::new(0.05, 0.04, 0.03).unwrap()] {
        let odometry = TickOdometry::new(geometry);
        let lines: Vec<WheelLine> = (0..cases(40_000))
            .map(|i| {
                source.line(match i % 5 {
                    0 => 40,
                    1 => 1_000_000,
                    4 if i % 50 == 4 => 4_000_000,
                    _ => 20_000,
                })
            })
            .collect();
        let alone: Vec<_> = lines.iter().map(|line| bits(&odometry.motion(line))).collect();
        for instructions in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            let mut motions = vec![Motion::IDENTITY; lines.len()];
            odometry.limited_to(instructions).motions(&lines, &mut motions);
            for ((line, motion), alone) in lines.iter().zip(&motions).zip(&alone) {
                assert_eq!(bits(motion), *alone, "{instructions:?} {line:?}");
            }
        }
    }
}

#[test]
fn slices_of_any_length_are_filled_and_nothing_beyond() {
    let mut source = Source(8);
    let odometry = TickOdometry::new(nominal());
    let lines: Vec<WheelLine> = (0..20).map(|_| source.line(1_000)).collect();
    for (given, room) in [(0, 3), (1, 1), (7, 9), (9, 7), (20, 20), (17, 30)] {
        let mut motions = vec![Motion { sine: 9.0, ..Motion::IDENTITY }; room];
        odometry.motions(&lines[..given], &mut motions);
        for (i, motion) in motions.iter().enumerate() {
            let untouched = Motion { sine: 9.0, ..Motion::IDENTITY };
            assert_eq!(*motion, lines[..given].get(i).map_or(untouched, |line| odometry.motion(line)));
        }
    }
}
