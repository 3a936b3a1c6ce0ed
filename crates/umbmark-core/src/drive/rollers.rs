//! Bases on wheels with rollers, which also move sideways: any number of wheels, anywhere, pointing anywhere.
//!
//! A roller rolls freely across its own axis and carries the wheel along it. With the unit vector n along the axis of the roller that touches
//! the floor, the direction e in which the wheel rolls and the velocity p of the body where the wheel stands, the rim moves by u with
//!
//! ```text
//! n · p = u (n · e),   p = (v_x - ω y, v_y + ω x)
//! ```
//!
//! An omni wheel has n = e; the rollers of a mecanum wheel stand at 45 degrees. One row for each wheel makes the matrix A of
//! u = A (v_x, v_y, ω); the motion for some ways of the wheels is that of least squares, (AᵀA)⁻¹ Aᵀ u. Four wheels have one direction
//! left in which no motion of the body turns them: what they do along it is slip, which shows without any reference. Source: Muir & Neuman
//! (1987), Campion, Bastin & D'Andréa-Novel (1996).

use crate::geometry::Displacement2;
use nalgebra::{Matrix3, Vector3};

/// A wheel of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollerWheel {
    /// Where it stands: ahead of the centre of the base and to its left \[m\].
    pub at: [f64; 2],
    /// The direction in which it rolls where its counter counts up, from straight ahead \[rad\].
    pub rolls: f64,
    /// The direction of the axis of its lowest roller, from the direction in which the wheel rolls \[rad\].
    pub roller: f64,
    /// Its diameter \[m\].
    pub diameter: f64,
}

/// The largest number of wheels.
pub const MOST_WHEELS: usize = 4;

/// The wheels of a base, and what their ways mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Rollers {
    wheels: Vec<RollerWheel>,
    /// Way of each wheel for a metre ahead, a metre to the left, and a radian.
    rows: Vec<[f64; 3]>,
    /// Motion for a metre of each wheel.
    columns: Vec<[f64; 3]>,
    /// The direction in which no motion turns the wheels, of unit mean square; zero where there is none.
    idle: Vec<f64>,
}

impl Rollers {
    /// A base of three or four wheels; `None` where they do not determine its motion.
    pub fn new(wheels: Vec<RollerWheel>) -> Option<Rollers> {
        if !(3..=MOST_WHEELS).contains(&wheels.len()) {
            return None;
        }
        let row = |wheel: &RollerWheel| {
            let (sine, cosine) = libm::sincos(wheel.rolls + wheel.roller);
            let along = libm::cos(wheel.roller);
            let [x, y] = wheel.at;
            [cosine / along, sine / along, (x * sine - y * cosine) / along]
        };
        let rows: Vec<[f64; 3]> = wheels.iter().map(row).collect();
        let products = rows.iter().map(|row| Vector3::from(*row)).map(|row| row * row.transpose());
        let products: Matrix3<f64> = products.sum();
        let inverse = products.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()))?;
        let columns = rows.iter().map(|row| (inverse * Vector3::from(*row)).into()).collect();
        let mut rollers = Rollers { idle: vec![0.0; wheels.len()], wheels, rows, columns };
        rollers.idle = rollers.direction_left();
        Some(rollers)
    }

    /// What the first wheel's way leaves of itself beside the motion that it makes, scaled.
    fn direction_left(&self) -> Vec<f64> {
        let count = self.wheels.len();
        if count == 3 {
            return vec![0.0; count];
        }
        let mut alone = vec![0.0; count];
        alone[0] = 1.0;
        let made = self.ways_of(&self.motion(&alone));
        let left: Vec<f64> = alone.iter().zip(&made).map(|(way, made)| way - made).collect();
        let size = (left.iter().map(|value| value * value).sum::<f64>() / count as f64).sqrt();
        if size > 1e-9 { left.into_iter().map(|value| value / size).collect() } else { vec![0.0; count] }
    }

    /// Its wheels, in the order of their counters.
    pub fn wheels(&self) -> &[RollerWheel] {
        &self.wheels
    }

    /// Way of each wheel per count \[m\], for so many counts per revolution.
    pub fn metres_per_count(&self, per_revolution: f64) -> Vec<f64> {
        self.wheels.iter().map(|wheel| std::f64::consts::PI * wheel.diameter / per_revolution).collect()
    }

    /// The motion of the base that fits these ways of its wheels best \[m\].
    pub fn motion(&self, ways: &[f64]) -> Displacement2 {
        let sum = |k: usize| self.columns.iter().zip(ways).map(|(column, way)| column[k] * way).sum();
        Displacement2 { forward: sum(0), sideways: sum(1), rotation: sum(2) }
    }

    /// What no motion explains of these ways, root mean square over the wheels and with a sign \[m\].
    pub fn disagreement(&self, ways: &[f64]) -> f64 {
        self.idle.iter().zip(ways).map(|(idle, way)| idle * way).sum::<f64>() / self.wheels.len() as f64
    }

    /// The ways of its wheels in a motion in which they agree \[m\].
    pub fn ways_of(&self, motion: &Displacement2) -> Vec<f64> {
        let of = |row: &[f64; 3]| row[0] * motion.forward + row[1] * motion.sideways + row[2] * motion.rotation;
        self.rows.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    fn moved(forward: f64, sideways: f64, rotation: f64) -> Displacement2 {
        Displacement2 { forward, sideways, rotation }
    }

    /// Any four wheels: odd places, odd directions, rollers at any angle but a right one.
    fn odd(count: usize) -> Rollers {
        let wheel = |k: usize| RollerWheel {
            at: [0.2 - 0.13 * k as f64, 0.1 + 0.07 * (k * k) as f64 - 0.11 * k as f64],
            rolls: 0.3 + 1.1 * k as f64,
            roller: [0.0, 0.5, -0.7, 0.9][k],
            diameter: 0.1 + 0.01 * k as f64,
        };
        Rollers::new((0..count).map(wheel).collect()).unwrap()
    }

    /// Oracle: the velocity of the place of the wheel less that of its rim has no part along the axis of the roller.
    #[test]
    fn rollers_roll_only_across_their_axes() {
        for motion in [moved(0.3, -0.2, 0.7), moved(-1.0, 0.4, -0.1)] {
            let rollers = odd(4);
            for (wheel, way) in rollers.wheels().iter().zip(rollers.ways_of(&motion)) {
                let [x, y] = wheel.at;
                let place = [motion.forward - motion.rotation * y, motion.sideways + motion.rotation * x];
                let rim = [way * wheel.rolls.cos(), way * wheel.rolls.sin()];
                let axis = wheel.rolls + wheel.roller;
                let slip = (place[0] - rim[0]) * axis.cos() + (place[1] - rim[1]) * axis.sin();
                assert!(slip.abs() < 1e-15, "{wheel:?} {slip}");
            }
        }
    }

    #[test]
    fn ways_of_a_motion_mean_that_motion_and_wheels_that_agree_do_not_disagree() {
        for count in [3, 4] {
            let rollers = odd(count);
            for motion in [moved(0.3, -0.2, 0.7), moved(0.0, 1.0, 0.0), moved(0.0, 0.0, -2.0)] {
                let ways = rollers.ways_of(&motion);
                let again = rollers.motion(&ways);
                let off = (again.forward - motion.forward).abs()
                    + (again.sideways - motion.sideways).abs()
                    + (again.rotation - motion.rotation).abs();
                assert!(off < 1e-12, "{again:?} {motion:?}");
                assert!(rollers.disagreement(&ways).abs() < 1e-13);
            }
        }
    }

    /// Oracle: what wheels do beside the motion that fits them best, by its definition.
    #[test]
    fn the_disagreement_is_what_the_best_motion_leaves_of_the_ways() {
        let rollers = odd(4);
        for ways in [[0.1, 0.0, 0.0, 0.0], [0.02, -0.3, 0.4, 0.1], [-1.0, 1.0, 1.0, 1.0]] {
            let made = rollers.ways_of(&rollers.motion(&ways));
            let left = ways.iter().zip(&made).map(|(way, made)| (way - made).powi(2)).sum::<f64>() / 4.0;
            assert!((rollers.disagreement(&ways).abs() - left.sqrt()).abs() < 1e-13 && left > 1e-6, "{left}");
        }
        assert_eq!(odd(3).disagreement(&[0.1, 0.2, -0.3]), 0.0);
    }

    #[test]
    fn wheels_that_cannot_tell_a_motion_are_no_base() {
        // All roll ahead and have rollers across: nothing holds the base sideways.
        let wheel = |y: f64| RollerWheel { at: [0.0, y], rolls: 0.0, roller: 0.0, diameter: 0.1 };
        assert!(Rollers::new([0.2, -0.2, 0.1].map(wheel).to_vec()).is_none());
        assert!(Rollers::new(vec![wheel(0.1)]).is_none());
        // Directions of three wheels on a circle, all pointing round it, tell everything.
        let round = |k: f64| RollerWheel {
            at: [0.2 * k.cos(), 0.2 * k.sin()],
            rolls: k + FRAC_PI_2,
            roller: 0.0,
            diameter: 0.1,
        };
        assert!(Rollers::new([0.0, 2.0 * PI / 3.0, 4.0 * PI / 3.0].map(round).to_vec()).is_some());
        let across = |k: f64| RollerWheel { roller: FRAC_PI_4, ..round(k) };
        assert!(Rollers::new([0.0, 1.0, 2.5].map(across).to_vec()).is_some());
    }
}
