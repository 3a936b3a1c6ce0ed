//! The numbers and claims of Borenstein & Feng (1995), from general code.

use umbmark_core::dataset::ReturnError;
use umbmark_core::drive::{Robot, Wheel};
use umbmark_core::effect::{Bump, Model, Stretch, TestKind};
use umbmark_core::geometry::{Displacement2, Pose2};
use umbmark_core::path::{Direction, FIGURE_EIGHT, Path, RECTANGLE, SQUARE, SpeedProfile};
use umbmark_core::simulate::{Course, Odometry, Phase, Simulator, Truth};

const LABMATE_WHEELBASE: f64 = 0.340;

fn model(values: &[(&str, &str, f64)]) -> Model {
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in values {
        model.set(effect, parameter, *value).unwrap();
    }
    model
}

/// Return error without quantisation.
fn returned(model: &Model, path: &Path, direction: Direction, test: TestKind) -> ReturnError {
    let mut simulator = Simulator::new(model.robot(), path, Odometry::Continuous, Phase::Edge).unwrap();
    let mut truth = Truth::new(model);
    simulator.open(&mut truth, 1, 0);
    simulator.run(&mut truth, direction, test)
}

fn distance(error: &ReturnError) -> f64 {
    error.x.hypot(error.y)
}

/// Section 2.1 of the theory: side-periodic errors turn the end about the centre of the path by the heading error.
/// ε = φ (2L, ∓2L, 4) for a square, with φ per side.
#[test]
fn side_periodic_effects_turn_the_end_point_about_the_centre_of_the_square() {
    let side = 4.0;
    let path = Path::umbmark();
    // One part in a million: second-order terms are then far below the 1e-3 that is asked.
    for (effect, parameter) in [("wheel_diameter_ratio", "e_d"), ("wheelbase", "e_b"), ("scale", "e_s")] {
        for departure in [1e-6, -1e-6] {
            let m = model(&[(effect, parameter, 1.0 + departure)]);
            for direction in Direction::BOTH {
                let error = returned(&m, &path, direction, TestKind::Systematic);
                let phi = error.heading.unwrap() / 4.0;
                let expected = (2.0 * side * phi * direction.sign(), -2.0 * side * phi);
                let gap = (error.x - expected.0).hypot(error.y - expected.1) / distance(&error);
                assert!(gap < 1e-3, "{effect} {departure} {direction:?}: {gap:e}");
            }
        }
    }
}

#[test]
fn the_theorem_holds_for_the_clappers_rectangle_too() {
    let path = Path::new(&RECTANGLE, &[7.0, 4.0], SpeedProfile::default()).unwrap();
    let m = model(&[("wheelbase", "e_b", 1.0 + 1e-6), ("wheel_diameter_ratio", "e_d", 1.0 + 2e-6)]);
    let error = returned(&m, &path, Direction::Ccw, TestKind::Systematic);
    // Rotation of START about the centre (3.5, 2) by the heading error, seen from START.
    let turn = error.heading.unwrap();
    let gap = (error.x - turn * 2.0).hypot(error.y + turn * 3.5) / distance(&error);
    assert!(gap < 1e-3, "{gap:e}");
}

/// An effect of a body-fixed displacement per side cancels: the robot is moved by hand through the square.
#[test]
fn a_displacement_that_repeats_on_every_side_closes() {
    let mut pose = Pose2::IDENTITY;
    for _ in 0..4 {
        pose = pose.moved(&Displacement2 { forward: 4.0, sideways: 0.03, rotation: 0.0 });
        pose = pose.moved(&Displacement2 { forward: 0.0, sideways: 0.0, rotation: std::f64::consts::FRAC_PI_2 });
    }
    assert!(pose.x.abs() < 1e-12 && pose.y.abs() < 1e-12);
}

/// The claim that the figure-eight has the shortcomings of the uni-directional square needs a qualifier: E_d hides in the
/// position, to first order, but stands in the heading; E_b the other way round.
#[test]
fn the_figure_eight_shows_e_d_by_heading_and_e_b_by_position() {
    let radius = 2.0;
    let path = Path::new(&FIGURE_EIGHT, &[radius], SpeedProfile::default()).unwrap();
    let d = 1e-5;
    let of = |effect, parameter| {
        returned(&model(&[(effect, parameter, 1.0 + d)]), &path, Direction::Ccw, TestKind::Systematic)
    };
    let (e_d, e_b) = (of("wheel_diameter_ratio", "e_d"), of("wheelbase", "e_b"));
    let length = 4.0 * std::f64::consts::PI * radius;
    assert!((e_d.heading.unwrap() / d - length / LABMATE_WHEELBASE).abs() < 0.01, "{}", e_d.heading.unwrap() / d);
    assert!(distance(&e_d) / d < 0.05, "{}", distance(&e_d) / d);
    assert!(e_b.heading.unwrap().abs() / d < 1e-3);
    assert!((e_b.x / d + 4.0 * std::f64::consts::PI * radius).abs() < 0.01 && e_b.y.abs() / d < 0.01, "{e_b:?}");
}

/// Fig. 6: where the bumps lie matters for the return position and not for the return heading.
#[test]
fn bumps_early_or_late_on_the_leg_change_the_return_position_and_not_the_heading() {
    let m = model(&[]);
    let lost = 3.4e-3;
    let end = |at: f64| {
        let mut truth = Truth::new(&m);
        truth.start(Direction::Ccw);
        let course = Course::new(m.robot(), &Path::umbmark(), Direction::Ccw).unwrap();
        for (index, leg) in course.legs.iter().enumerate() {
            let stretch =
                Stretch { index, direction: Direction::Ccw, test: TestKind::Systematic, travel: leg.travel, left: 0.0 };
            truth.begin(stretch, leg);
            if index == 0 {
                truth.place(Bump { at, wheel: Wheel::Left, lost });
            }
            truth.advance(1.0);
        }
        truth.pose()
    };
    let (early, late) = (end(0.05), end(0.95));
    assert!((early.heading - late.heading).abs() < 1e-12);
    let turned = lost / LABMATE_WHEELBASE;
    // A bump after a distance s turns the rest of the path about that place: the end moves by -turn · s sideways.
    assert!((early.y + turned * 0.05 * 4.0).abs() < 2e-3 && (late.y + turned * 0.95 * 4.0).abs() < 2e-3);
    assert!((late.y - early.y).abs() > 0.03);
}

/// Table I, rows 1 and 2, tick by tick with the counters of the robot.
#[test]
fn table_one_by_encoder_ticks() {
    for (b, e_d, exact) in [(337.2, 1.00121, 305.6), (337.1, 1.00203, 417.0)] {
        let m = model(&[("wheel_diameter_ratio", "e_d", e_d), ("wheelbase", "e_b", b / 340.0)]);
        let path = Path::new(&SQUARE, &[4.0], SpeedProfile::default()).unwrap();
        let worst = Direction::BOTH
            .map(|direction| distance(&returned(&m, &path, direction, TestKind::Systematic)) * 1e3)
            .into_iter()
            .fold(0.0, f64::max);
        assert!((worst - exact).abs() < 0.05, "{worst}");
    }
}
