//! The scatter that evenly noisy wheels give the front one of two trucks, through its steering and the correction by its link.

use crate::drive::{DifferentialDrive, LinkReading, WheelTravel};
use crate::engine::{Convoy, ConvoyStep, Floor, Trucks};
use crate::geometry::{Displacement2, Dual, LANES, Pose2, Real};
use nalgebra::{Matrix3, SMatrix, Vector3};
use std::ops::Range;

/// Believed and real poses of both trucks.
const STATE: usize = 12;

/// Derivative of the front truck's error with respect to the state.
type Influence = SMatrix<f64, 3, STATE>;

/// Covariance of the front truck's return error after some steps for white noise of unit variance per metre on each of the eight
/// wheels during them, to first order, along the plan.
///
/// It works backwards from the end: the influence of a step's state is that of the next step's state times the derivative of the step.
pub(crate) fn gathered(convoy: &Convoy, truck: &DifferentialDrive, steps: Range<usize>) -> Matrix3<f64> {
    let mut influence = Influence::zeros();
    for i in 0..3 {
        influence[(i, i)] = -1.0;
        influence[(i, 6 + i)] = 1.0;
    }
    let (mut sum, turn) = (Matrix3::zeros(), 1.0 / truck.wheelbase());
    let mut floor = Even { truck };
    for made in steps.rev() {
        let (step, after) = (&convoy.steps()[made], convoy.meant(made + 1));
        if convoy.corrects() {
            influence *= derivative(&after, |trucks| convoy.correct(trucks, &mut floor));
        }
        for (which, (pose, travel)) in after.iter().zip(&step.travel).enumerate() {
            let (sine, cosine) = libm::sincos(pose.heading);
            for (side, rolled) in [(-1.0, travel.left), (1.0, travel.right)] {
                let push = Vector3::new(0.5 * cosine, 0.5 * sine, side * turn);
                let shift = influence.fixed_columns::<3>(6 + 3 * which) * push;
                sum += shift * shift.transpose() * rolled.abs();
            }
        }
        influence *= derivative(&convoy.meant(made), |trucks| convoy.roll(step, trucks, &mut floor));
    }
    sum
}

/// Derivative of the state after a change with respect to the state before it, with both trucks at their planned poses.
fn derivative(meant: &[Pose2; 2], mut change: impl FnMut(&mut Trucks<Dual>)) -> SMatrix<f64, STATE, STATE> {
    let mut by_state = SMatrix::<f64, STATE, STATE>::zeros();
    for first in (0..STATE).step_by(LANES) {
        let seeded = |block: usize| {
            [0, 1].map(|truck: usize| {
                let own = |i: usize, re: f64| {
                    let place = block + 3 * truck + i;
                    Dual { re, eps: std::array::from_fn(|lane| f64::from(u8::from(first + lane == place))) }
                };
                let pose = meant[truck];
                Pose2::new(own(0, pose.x), own(1, pose.y), own(2, pose.heading))
            })
        };
        let mut trucks = Trucks { believed: seeded(0), real: seeded(6) };
        change(&mut trucks);
        for (k, pose) in trucks.believed.iter().chain(&trucks.real).enumerate() {
            for lane in 0..LANES.min(STATE - first) {
                let slope = pose.slope(lane);
                let column = [slope.x, slope.y, slope.heading];
                by_state.fixed_view_mut::<3, 1>(3 * k, first + lane).copy_from_slice(&column);
            }
        }
    }
    by_state
}

/// A floor on which true motion and odometry agree.
struct Even<'a> {
    truck: &'a DifferentialDrive,
}

impl<T: Real> Floor<T> for Even<'_> {
    fn moved(
        &mut self,
        _step: &ConvoyStep,
        _truck: usize,
        believed: WheelTravel<T>,
        _real: &Pose2<T>,
    ) -> Displacement2<T> {
        self.truck.displacement(&believed)
    }

    fn shown(&mut self, link: LinkReading<T>) -> LinkReading<T> {
        link
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{ClapperDrive, Robot};
    use crate::effect::{Model, TestKind};
    use crate::evidence::noise_shape::end_covariance;
    use crate::path::{Direction, Path, SQUARE, SpeedProfile};
    use crate::preset::Preset;
    use crate::replay::Track;
    use crate::simulate::{Odometry, Phase, Simulator, Truth};

    fn clapper(correction: bool) -> Robot {
        let robot = Preset::find("clapper").unwrap().robot();
        let drive = ClapperDrive::new(*robot.drive, 1.0, 1e9, correction).unwrap();
        Robot { drive: drive.into(), ..robot }
    }

    /// Oracle: 1000 simulated runs; seed 3. Standard deviations within 8 %, correlations within 0.1; alpha below 1e-3.
    #[test]
    fn the_front_truck_scatters_as_simulated_with_the_correction_on_and_off() {
        let path = Path::new(&SQUARE, &[1.0], SpeedProfile::new(0.3, 0.3, 0.0).unwrap()).unwrap();
        for correction in [true, false] {
            let robot = clapper(correction);
            let expected = end_covariance(&Track::from_path(&path, Direction::Ccw, &robot), &robot.drive);
            let (k, runs) = (5e-4, 1000);
            let mut model = Model::new(&robot);
            model.set("wheel_noise", "k_sqrt_m", k).unwrap();
            let mut simulator = Simulator::new(&robot, &path, Odometry::of(&robot), Phase::Edge).unwrap();
            let mut truth = Truth::new(&model);
            simulator.open(&mut truth, 3, 0);
            let mut sum = Matrix3::zeros();
            for _ in 0..runs {
                let error = simulator.run(&mut truth, Direction::Ccw, TestKind::Systematic);
                let error = Vector3::new(error.x, error.y, error.heading.unwrap());
                sum += error * error.transpose() / (k * k * f64::from(runs));
            }
            for i in 0..3 {
                let ratio = (sum[(i, i)] / expected[(i, i)]).sqrt();
                assert!((ratio - 1.0).abs() < 0.08, "{correction} {i}: {ratio}");
                for j in 0..i {
                    let correlation = |m: &Matrix3<f64>| m[(i, j)] / (m[(i, i)] * m[(j, j)]).sqrt();
                    assert!((correlation(&sum) - correlation(&expected)).abs() < 0.1, "{correction} {i} {j}");
                }
            }
        }
    }
}
