//! Two trucks under the commands of a [`Convoy`], with the effects of a model, noise and bumps.

use super::{Leg, Truth, return_error};
use crate::dataset::ReturnError;
use crate::drive::{ClapperDrive, LinkReading, Robot, Wheel, WheelTravel};
use crate::effect::{Bump, Sight, Stretch, TestKind};
use crate::engine::{Convoy, ConvoyStep, Floor};
use crate::geometry::{Displacement2, Pose2};
use crate::path::{Direction, Path};

/// The plans of both directions.
#[derive(Clone, Debug)]
pub(super) struct Convoys {
    drive: ClapperDrive,
    plans: [Convoy; 2],
}

impl Convoys {
    /// `None` for drives that are no two trucks, and for paths that suit none.
    pub fn new(robot: &Robot, path: &Path) -> Option<Convoys> {
        let drive = *robot.drive.trucks()?;
        let plan = |direction| Convoy::new(robot, path, direction);
        Some(Convoys { drive, plans: [plan(Direction::Cw)?, plan(Direction::Ccw)?] })
    }

    /// Drives once round the path: the error of the front truck's pose.
    pub fn run(&self, truth: &mut Truth, legs: &[Leg], direction: Direction, test: TestKind) -> ReturnError {
        let plan = &self.plans[direction as usize];
        let start = truth.draw_start();
        let mut floor = Met { drive: &self.drive, truth, legs, direction, test, begun: None, bumps: Vec::new() };
        let mut trucks = plan.at_start(start, &mut floor);
        plan.steps().iter().for_each(|step| plan.step(step, &mut trucks, &mut floor));
        let last = plan.steps().last();
        let sight = Sight { time: last.map_or(0.0, |step| step.time), ..Sight::default() };
        truth.end_of_trucks(last.map_or(0.0, |step| step.contexts[0].distance + step.contexts[0].length));
        return_error(&truth.measured_of_trucks(&sight, &trucks.real[0]), &trucks.believed[0])
    }
}

/// The floor under way.
struct Met<'a> {
    drive: &'a ClapperDrive,
    truth: &'a mut Truth,
    legs: &'a [Leg],
    direction: Direction,
    test: TestKind,
    /// The move that is under way, and its bumps.
    begun: Option<usize>,
    bumps: Vec<Bump>,
}

impl Floor<f64> for Met<'_> {
    fn moved(&mut self, step: &ConvoyStep, truck: usize, believed: WheelTravel, real: &Pose2) -> Displacement2 {
        if self.begun != Some(step.index) {
            let leg = &self.legs[step.index];
            let (index, travel) = (step.index, leg.travel);
            let stretch = Stretch { index, direction: self.direction, test: self.test, travel, left: 0.0 };
            self.bumps = self.truth.bumps_of(stretch, leg);
            self.begun = Some(step.index);
        }
        // The cable lies under the front truck.
        let lost = if truck == 0 { lost_between(&self.bumps, step.shares) } else { WheelTravel::default() };
        self.truth.rolled(&step.contexts[truck], real, &believed, &lost)
    }

    fn shown(&mut self, link: LinkReading) -> LinkReading {
        self.drive.counted(self.truth.link(link))
    }
}

/// Wheel travel lost at bumps between two shares of a leg.
fn lost_between(bumps: &[Bump], [from, to]: [f64; 2]) -> WheelTravel {
    let met = bumps.iter().filter(|bump| from <= bump.at && bump.at < to);
    met.fold(WheelTravel::default(), |sum, bump| match bump.wheel {
        Wheel::Left => WheelTravel { left: sum.left - bump.lost, ..sum },
        Wheel::Right => WheelTravel { right: sum.right - bump.lost, ..sum },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Formula, Model, Target};
    use crate::engine::convoy_tests::{clapper, path};
    use crate::replay::{Track, check_on_path};
    use crate::simulate::{Odometry, Phase, Simulator};

    fn returned(robot: &Robot, values: &[(&str, &str, f64)], direction: Direction, test: TestKind) -> ReturnError {
        let mut model = Model::new(robot);
        values.iter().for_each(|(effect, parameter, value)| model.set(effect, parameter, *value).unwrap());
        let mut simulator = Simulator::new(robot, &path(), Odometry::of(robot), Phase::Random).unwrap();
        let mut truth = Truth::new(&model);
        simulator.open(&mut truth, 1, 0);
        simulator.run(&mut truth, direction, test)
    }

    #[test]
    fn without_errors_it_returns_and_without_correction_its_front_truck_errs_as_a_labmate() {
        for direction in Direction::BOTH {
            for correction in [true, false] {
                let error = returned(&clapper(correction), &[], direction, TestKind::Systematic);
                assert!(libm::hypot(error.x, error.y) < 1e-6 && error.heading.unwrap().abs() < 1e-6, "{error:?}");
            }
            let bumps = [("placed_bumps", "count", 10.0)];
            let plain = returned(&clapper(false), &bumps, direction, TestKind::Bumps).heading.unwrap();
            let expected = direction.sign() * 10.0 * crate::effect::extra_travel(0.010, 0.075, true) / 0.34;
            assert!((plain - expected).abs() < 1e-9, "{plain} {expected}");
            let corrected = returned(&clapper(true), &bumps, direction, TestKind::Bumps).heading.unwrap();
            assert!(corrected.abs() < 0.1 * plain.abs() && corrected != 0.0, "{corrected} {plain}");
        }
    }

    /// Oracle: a bump turns the front truck by δ in a period of way s, which it drives along the mean heading δ/2: the link's
    /// direction turns by δ s/2 over its length, and the correction takes it for the truck's own.
    #[test]
    fn what_a_bump_leaves_is_half_of_its_turn_over_the_way_of_a_period() {
        let bump = [("placed_bumps", "count", 1.0)];
        let turned = returned(&clapper(false), &bump, Direction::Ccw, TestKind::Bumps).heading.unwrap();
        let left = returned(&clapper(true), &bump, Direction::Ccw, TestKind::Bumps).heading.unwrap();
        let expected = turned * 0.5 * (0.45 / 25.0) / 1.0;
        // The same rules run in Python leave 0.907 of it.
        assert!((left / expected - 1.0).abs() < 0.15, "{left} {expected}");
    }

    #[test]
    fn unequal_wheels_of_the_trucks_are_corrected_too() {
        let unequal = [("wheel_diameter_ratio", "e_d", 1.002)];
        let [plain, corrected] =
            [false, true].map(|on| returned(&clapper(on), &unequal, Direction::Ccw, TestKind::Systematic));
        assert!(
            plain.heading.unwrap().abs() > 0.1 && corrected.heading.unwrap().abs() < 0.01,
            "{plain:?} {corrected:?}"
        );
    }

    /// Oracle: dx/ds = 1 + kx, so that x = (e^(ks) - 1)/k after the first leg; what the trucks believe is not changed by it.
    #[test]
    fn a_formula_of_the_place_acts_on_each_truck_where_that_one_is() {
        for (robot, k) in [(clapper(false), 0.02), (clapper(false), -0.02), (clapper(true), 1e-3)] {
            let mut model = Model::new(&robot);
            model.add_formula(Formula::new("own", Target::ForwardScale, "k * x", &["k"]).unwrap(), &[k]).unwrap();
            for direction in Direction::BOTH {
                let track = Track::with_stops(&path(), direction, &robot);
                let mut simulator = Simulator::new(&robot, &path(), Odometry::of(&robot), Phase::Random).unwrap();
                let mut truth = Truth::new(&model);
                simulator.open(&mut truth, 1, 0);
                let driven = simulator.run(&mut truth, direction, TestKind::Systematic);
                let predicted = return_error(&track.end(&model.chain()), &track.end(&Model::new(&robot).chain()));
                let gap = libm::hypot(driven.x - predicted.x, driven.y - predicted.y);
                assert!(gap < 2e-3 && libm::hypot(driven.x, driven.y) > 0.02, "{driven:?} {predicted:?}");
                if k.abs() > 0.01 {
                    let leg = track.poses(&model.chain())[0];
                    assert!((leg.x - libm::expm1(k * 7.0) / k).abs() < 1.5e-4, "{leg:?}");
                }
            }
        }
        // The rear truck begins a metre behind START, where the front one never is.
        let broken = |text: &str| {
            let mut model = Model::new(&clapper(false));
            model.add_formula(Formula::new("own", Target::ForwardScale, text, &["k"]).unwrap(), &[1e-3]).unwrap();
            check_on_path(&model, &path()).map_err(|error| error.to_string())
        };
        assert_eq!(broken("k * sqrt(x + 1.5)"), Ok(()));
        let said = broken("k * sqrt(x + 0.5)").unwrap_err();
        assert!(said.contains("\"sqrt(x + 0.5)\"") && said.contains("x = -1 m"), "{said}");
    }
}
