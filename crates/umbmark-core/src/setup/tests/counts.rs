//! Counts that are a factor off: of all wheels, of one, or of one run.

use super::*;

#[test]
fn counts_that_are_a_factor_off_are_named_with_the_line_that_mends_them() {
    // Ticks per revolution that are written, for wheels with 20 000.
    let looked = |written: f64| {
        let robot = Robot { encoder: Encoder::new(written, None, None).unwrap(), ..robot() };
        Setup::of(&clean().runs(), &robot, None)
    };
    for written in [80_000.0, 5_000.0, 200_000.0, 2_000.0] {
        let found = looked(written);
        let [Fault::Counts(factor)] = &found.faults[..] else { panic!("{written}: {:?}", found.faults) };
        assert!((factor.ratio * 20_000.0 / written - 1.0).abs() < 0.01, "{factor:?}");
        let line = format!("write ticks_per_revolution = 20000 under [robot] in robot.toml instead of {written} ");
        assert!(found.faults[0].remedy().starts_with(&line), "{}", found.faults[0].remedy());
    }
    for written in [40_000.0, 10_000.0] {
        let found = looked(written);
        assert!(found.is_sound() && found.mounting.is_some());
        let [doubt @ Suspicion::Doubled(_)] = &found.doubts[..] else { panic!("{written}: {:?}", found.doubts) };
        assert!(doubt.sentence().contains("ticks_per_revolution = 20000 ") && doubt.forbids_writing());
        assert!(found.notices().iter().any(|notice| *notice == doubt.sentence()));
    }
    let found = looked(20_000_000.0).faults;
    assert!(matches!(found[..], [Fault::Standing { rolled, moved }] if rolled < 0.1 && moved > 0.3), "{found:?}");
    // No usual factor: about so many.
    let found = looked(70_000.0).faults;
    assert!(matches!(&found[..], [fault @ Fault::Counts(_)] if fault.remedy().contains("about 20")), "{found:?}");
    for written in [20_000.0, 17_000.0, 25_000.0] {
        let found = looked(written);
        assert_eq!((&found.faults[..], &found.doubts[..]), (&[][..], &[][..]));
    }
}

/// The counts of runs, those of the left and of the right wheel multiplied.
fn multiplied(mut runs: Vec<Run>, which: impl Fn(usize) -> bool, factors: [f64; 2]) -> Vec<Run> {
    for (_, run) in runs.iter_mut().enumerate().filter(|(index, _)| which(*index)) {
        let log = run.log.as_mut().unwrap();
        log.left.iter_mut().for_each(|count| *count = (*count * factors[0]).round());
        log.right.iter_mut().for_each(|count| *count = (*count * factors[1]).round());
    }
    runs
}

/// Runs of one decoder setting are one kind, whatever their own errors are.
#[test]
fn a_run_is_off_by_a_power_of_two_beside_the_others_or_not_at_all() {
    let factor = |ratio| CountsFactor { ratio, nominal: 20_000.0 };
    let beside = |ratio| factor(ratio).beside(&factor(1.01)).map(|own| own.ratio);
    assert_eq!([0.498, 0.51, 4.1].map(beside), [Some(0.5), Some(0.5), Some(4.0)]);
    assert_eq!([0.95, 1.3, 0.56].map(beside), [None; 3]);
}

/// Free drives and drives after points, seeds 320 and 321.
#[test]
fn one_counter_of_two_that_is_a_factor_off_is_named_with_what_it_has_to_be_multiplied_by() {
    for (seed, driven) in
        (320..322).flat_map(|seed| [(seed, driven::free as fn(f64, &mut Stream) -> _), (seed, driven::pursuing)])
    {
        let runs = Drive { seed, driven, ..clean() }.runs();
        for counted in [0.25, 0.5, 2.0, 4.0] {
            for (wheel, name) in ["left", "right"].into_iter().enumerate() {
                let factors = [0, 1].map(|k| if k == wheel { counted } else { 1.0 });
                let found = Setup::of(&multiplied(runs.clone(), |_| true, factors), &robot(), None).faults;
                assert_eq!(found, [Fault::OneCounter { name, factor: 1.0 / counted }], "{seed} {factors:?}");
                assert!(found[0].remedy().starts_with(&format!("multiply ticks_{name} by {}", 1.0 / counted)));
            }
        }
    }
}

/// However many runs they are: those that most runs agree with are right, and among equally many, those that agree with robot.toml.
#[test]
fn counts_of_some_runs_that_are_a_factor_off_are_named_with_the_runs() {
    let runs = Drive { runs: 6, ..clean() }.runs();
    for wrong in [&[1][..], &[1, 4], &[0, 2, 5]] {
        for (factor, line) in
            [(2.0, "multiply all counts by 0.5"), (0.5, "multiply all counts by 2"), (0.25, "multiply all counts by 4")]
        {
            let mixed = multiplied(runs.clone(), |index| wrong.contains(&index), [factor; 2]);
            let found = Setup::of(&mixed, &robot(), None).faults;
            let [fault @ Fault::InRuns { runs: named, .. }] = &found[..] else {
                panic!("{wrong:?} times {factor}: {found:?}")
            };
            assert_eq!(named, &wrong.iter().map(|index| runs[*index].name.clone()).collect::<Vec<_>>());
            assert!(fault.remedy().contains(line), "{}", fault.remedy());
        }
    }
}
