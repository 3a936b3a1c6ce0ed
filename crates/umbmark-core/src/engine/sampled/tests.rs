use super::*;
use crate::engine::UNITS_PER_TICK;
use crate::engine::oracle;
use crate::engine::random_lines::{Source, cases};

fn geometries() -> [TickGeometry; 2] {
    [TickGeometry::new(2.356e-4, 2.356e-4, 0.34), TickGeometry::new(2.353e-4, 2.356e-4, 0.3372)].map(Result::unwrap)
}

const UPDATES: [Update; 3] = [Update::Arc, Update::Midpoint, Update::Euler];

/// The counters after i of m equal pieces, from the exact quotient.
fn exact_counts(line: &WheelLine, i: i64, m: i64) -> [i64; 2] {
    [0, 1].map(|wheel| {
        let (start, travel) = (i128::from(line.start()[wheel]), i128::from(line.travel()[wheel]));
        // The counter of a backward wheel changes when a whole unit below the grid line is reached: see WheelLine.
        let done =
            if travel < 0 { -(-travel * i128::from(i)).div_euclid(i128::from(m)) } else { travel * i128::from(i) };
        let numerator = if travel < 0 { (start + done) * i128::from(m) } else { start * i128::from(m) + done };
        numerator.div_euclid(i128::from(UNITS_PER_TICK) * i128::from(m)) as i64
    })
}

fn distance(a: &Motion, b: &Motion) -> f64 {
    (a.pose.x - b.pose.x).abs().max((a.pose.y - b.pose.y).abs())
}

#[test]
fn readings_at_equal_fractions_are_those_of_the_exact_quotients() {
    let mut source = Source(11);
    for geometry in geometries() {
        for update in UPDATES {
            let mut odometry = SampledOdometry::new(geometry, update);
            for i in 0..cases(300) {
                let line = source.line(20_000);
                let readings = 1 + source.below(if i % 50 == 0 { 60_000 } else { 1_000 });
                let expected = odometry.from_counts((1..=readings).map(|k| exact_counts(&line, k, readings)));
                for motion in
                    [odometry.one_by_one(&line, readings as u32), odometry.at_constant_rate(&line, readings as u32)]
                {
                    // Reading by reading the direction drifts by its rounding.
                    let tolerance = 1e-12 * (1.0 + readings as f64 / 1_000.0);
                    assert!(distance(&motion, &expected) < tolerance, "{line:?} {readings} {update:?}");
                    assert_eq!(motion.pose.heading, expected.pose.heading);
                    assert_eq!((motion.cosine, motion.sine), (expected.cosine, expected.sine));
                }
            }
        }
    }
}

#[test]
fn readings_finer_than_the_ticks_are_tick_exact_however_the_speed_varies() {
    let mut source = Source(12);
    for geometry in geometries() {
        for _ in 0..40 {
            let start = [source.unit(), source.unit()];
            let travel = [source.unit() * 120.0 - 60.0, source.unit() * 120.0 - 60.0];
            let line = WheelLine::from_ticks(start, travel).unwrap();
            let odometry = SampledOdometry::new(geometry, Update::Arc);
            let exact = oracle::motion(&geometry, &line);
            let fine = 100_000;
            for power in [1, 2, 3] {
                let fractions = (1..=fine).map(|k| (f64::from(k) / f64::from(fine)).powi(power));
                let sampled = odometry.with_profile(&line, fractions);
                // Ticks of both wheels within one reading are a joint step, half a δ²/b = 1.6e-7 m from either order. It is
                // rare: in 100 000 readings of some 60 ticks hardly one.
                assert!(distance(&sampled, &exact) < 2e-7, "{line:?} {power}: {:e}", distance(&sampled, &exact));
                assert_eq!(sampled.pose.heading, exact.pose.heading);
            }
        }
    }
}

#[test]
fn a_profile_of_equal_fractions_is_a_constant_rate() {
    let mut source = Source(13);
    let mut odometry = SampledOdometry::new(geometries()[1], Update::Arc);
    for _ in 0..200 {
        let start = [source.unit(), source.unit()];
        let travel = [source.unit() * 4e3 - 2e3, source.unit() * 4e3 - 2e3];
        let line = WheelLine::from_ticks(start, travel).unwrap();
        let constant = odometry.at_constant_rate(&line, 256);
        let profile = odometry.with_profile(&line, (1..=256).map(|k| f64::from(k) / 256.0));
        assert!(distance(&constant, &profile) < 1e-13, "{line:?}");
    }
}

#[test]
fn readings_along_a_profile_are_those_taken_one_by_one_whether_few_or_many_and_slow_or_fast() {
    let mut source = Source(15);
    for geometry in geometries() {
        for instructions in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            for update in UPDATES {
                let mut odometry = SampledOdometry::new(geometry, update).limited_to(instructions);
                for (i, reach) in (0..cases(120)).zip([8.0, 100.0, 900.0, 20_000.0].into_iter().cycle()) {
                    let start = [source.unit(), source.unit()];
                    let travel = [0, 1].map(|_| (2.0 * source.unit() - 1.0) * reach);
                    let line = WheelLine::from_ticks(start, travel).unwrap();
                    let readings = if i % 3 == 0 { 5 } else { 70 };
                    let shares = || (1..=readings).map(|k| (f64::from(k) / f64::from(readings)).powi(1 + i as i32 % 2));
                    let profile = Profile::new(shares());
                    assert_eq!(profile.readings(), readings as usize);
                    let (along, expected) = (odometry.along(&line, &profile), odometry.with_profile(&line, shares()));
                    assert!(distance(&along, &expected) < 1e-12, "{line:?} {update:?} {readings}");
                    assert_eq!(along.pose.heading, expected.pose.heading);
                }
            }
        }
    }
}

#[test]
fn the_updates_differ_as_their_formulas_say() {
    let geometry = TickGeometry::new(0.01, 0.01, 0.5).unwrap();
    let [arc, midpoint, euler] = UPDATES.map(|update| {
        let mut track = SampledOdometry::new(geometry, update).track();
        track.read([30, 50]);
        track.read([30, 100]);
        track.pose()
    });
    // Distances 0.4 and 0.25 m, rotations 0.4 and 1 rad.
    let (c, s) = (libm::cos, libm::sin);
    assert!((euler.x - (0.4 + 0.25 * c(0.4))).abs() < 1e-15 && (euler.y - 0.25 * s(0.4)).abs() < 1e-15);
    assert!((midpoint.x - (0.4 * c(0.2) + 0.25 * c(0.9))).abs() < 1e-15);
    assert!((midpoint.y - (0.4 * s(0.2) + 0.25 * s(0.9))).abs() < 1e-15);
    // Radii 1 m and 0.25 m.
    assert!((arc.x - (s(0.4) + 0.25 * (s(1.4) - s(0.4)))).abs() < 1e-15);
    assert!((arc.y - (1.0 - c(0.4) + 0.25 * (c(0.4) - c(1.4)))).abs() < 1e-15);
}

#[test]
fn a_profile_reads_the_end_of_the_longest_line_exactly_and_survives_any_fraction() {
    let ticks = (1 << 30) as f64;
    let line = WheelLine::from_ticks([0.999_999_999, 0.0], [ticks - 0.3, -ticks + 0.7]).unwrap();
    let odometry = SampledOdometry::new(geometries()[0], Update::Arc);
    let heading = odometry.geometry().heading(line.counts());
    let motion = odometry.with_profile(&line, [f64::NAN, -1.0, 0.5, 0.2, f64::INFINITY]);
    assert_eq!(motion.pose.heading, heading);
    assert_eq!(odometry.with_profile(&line, [f64::NAN, -0.5]), Motion::IDENTITY);
    assert_eq!(odometry.from_counts([]), Motion::IDENTITY);
    assert_eq!(odometry.clone().at_constant_rate(&line, 0), Motion::IDENTITY);
    assert_eq!(odometry.clone().at_constant_rate(&line, 1).pose.heading, heading);
}

#[test]
fn blocks_give_the_same_bits_on_every_instruction_set_whatever_was_computed_before() {
    let mut source = Source(14);
    let bits = |motion: Motion| [motion.pose.x, motion.pose.y, motion.pose.heading].map(f64::to_bits);
    for update in UPDATES {
        let fresh = SampledOdometry::new(geometries()[0], update);
        let mut used =
            [Instructions::Portable, Instructions::Avx2, Instructions::Avx512].map(|i| fresh.clone().limited_to(i));
        for _ in 0..cases(400) {
            let line = source.line(20_000);
            let readings = source.below(3_000) as u32;
            let expected = bits(fresh.clone().at_constant_rate(&line, readings));
            for odometry in &mut used {
                assert_eq!(bits(odometry.at_constant_rate(&line, readings)), expected, "{line:?} {readings}");
            }
        }
    }
}
