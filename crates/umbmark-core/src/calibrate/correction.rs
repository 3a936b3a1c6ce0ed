//! The three ratios of a calibration, and the corrected robot.

use crate::drive::{DriveError, Robot};
use crate::effect::{Model, ModelError, find};

/// One of the ratios.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ratio {
    /// E_d, of the wheel diameters.
    Diameters,
    /// E_b, of the wheelbase.
    Wheelbase,
    /// E_s, of the mean wheel diameter.
    Scale,
}

impl Ratio {
    /// All, in the order of every vector and matrix here: E_d, E_b, E_s.
    pub const ALL: [Ratio; 3] = [Ratio::Diameters, Ratio::Wheelbase, Ratio::Scale];

    /// "e_d", "e_b" or "e_s", as in files.
    pub fn name(self) -> &'static str {
        match self {
            Ratio::Diameters => "e_d",
            Ratio::Wheelbase => "e_b",
            Ratio::Scale => "e_s",
        }
    }
}

/// How the true robot differs from the nominal one: the correction of its odometry.
///
/// With nominal wheelbase b and wheel diameters D_L, D_R:
///
/// ```text
/// true wheelbase     b E_b
/// true left wheel    D_L E_s 2/(1 + E_d)
/// true right wheel   D_R E_s 2 E_d/(1 + E_d)
/// ```
///
/// Lengths in metres are known only if E_s is: return poses of a closed path show E_b/E_s, and E_s = 1 is then assumed, which is the
/// paper's own precondition (section 2: E_s is measured by tape and corrected first).
///
/// Of a robot with another drive, the three are the values of its own [first effects](crate::drive::Drive::first_effects).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// E_d: true over nominal D_R/D_L.
    pub e_d: f64,
    /// E_b: true over nominal wheelbase.
    pub e_b: f64,
    /// E_s: true over nominal mean wheel diameter.
    pub e_s: f64,
}

impl Correction {
    /// No correction.
    pub const NONE: Correction = Correction { e_d: 1.0, e_b: 1.0, e_s: 1.0 };

    /// E_d, E_b, E_s.
    pub fn values(&self) -> [f64; 3] {
        [self.e_d, self.e_b, self.e_s]
    }

    /// From E_d, E_b, E_s.
    pub fn from_values([e_d, e_b, e_s]: [f64; 3]) -> Correction {
        Correction { e_d, e_b, e_s }
    }

    /// What a model says of the numbers of its robot: the values of its first effects, each as it does nothing where the model lacks
    /// it.
    ///
    /// ```
    /// use umbmark_core::{calibrate::Correction, drive::Robot, effect::Model};
    /// let mut model = Model::new(&Robot::labmate());
    /// model.set("wheelbase", "e_b", 0.99)?;
    /// model.set("crab", "angle_rad", 0.01)?;
    /// assert_eq!(Correction::of(&model), Correction { e_b: 0.99, ..Correction::NONE });
    /// # Ok::<(), umbmark_core::effect::ModelError>(())
    /// ```
    pub fn of(model: &Model) -> Correction {
        let value = |effect: &'static str| {
            let first = find(effect).ok().and_then(|entry| entry.about.parameters.first())?;
            Some(model.get(effect, first.name).unwrap_or_else(|| first.default.resolve(model.robot())))
        };
        Correction::from_values(model.robot().drive.first_effects().map(|effect| value(effect).unwrap_or(1.0)))
    }

    /// Factors of the left and right wheel diameter: 2 E_s/(1 + E_d) and 2 E_s E_d/(1 + E_d).
    pub fn wheel_factors(&self) -> (f64, f64) {
        let left = 2.0 * self.e_s / (1.0 + self.e_d);
        (left, left * self.e_d)
    }

    /// The robot with its odometry corrected: true wheelbase and wheel diameters as its nominal ones.
    ///
    /// ```
    /// use umbmark_core::{calibrate::Correction, drive::Robot};
    /// let correction = Correction { e_d: 1.00121, e_b: 337.2 / 340.0, e_s: 1.0 };
    /// let corrected = correction.apply(&Robot::labmate())?;
    /// assert!((corrected.drive.wheelbase() - 0.3372).abs() < 1e-15);
    /// let ratio = corrected.drive.wheel_diameter_right() / corrected.drive.wheel_diameter_left();
    /// assert!((ratio - 1.00121).abs() < 1e-15);
    /// # Ok::<(), umbmark_core::drive::DriveError>(())
    /// ```
    pub fn apply(&self, robot: &Robot) -> Result<Robot, DriveError> {
        Ok(Robot { drive: robot.drive.corrected(self.values())?, ..robot.clone() })
    }

    /// The model in which the robot truly differs from nominal by this correction.
    pub fn model(&self, robot: &Robot) -> Result<Model, ModelError> {
        let mut model = Model::new(robot);
        model.set("wheel_diameter_ratio", "e_d", self.e_d)?;
        model.set("wheelbase", "e_b", self.e_b)?;
        model.set("scale", "e_s", self.e_s)?;
        Ok(model)
    }

    /// What is left of this (true) correction once another is applied: relative to the robot so corrected.
    pub fn after(&self, applied: &Correction) -> Correction {
        let ((left, right), (done_left, done_right)) = (self.wheel_factors(), applied.wheel_factors());
        let (left, right) = (left / done_left, right / done_right);
        Correction { e_d: right / left, e_b: self.e_b / applied.e_b, e_s: 0.5 * (left + right) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DifferentialDrive;

    #[test]
    fn what_is_left_after_a_correction_completes_it() {
        let robot = Robot::labmate();
        let truth = Correction { e_d: 1.02, e_b: 0.97, e_s: 1.01 };
        let applied = Correction { e_d: 0.995, e_b: 1.03, e_s: 0.98 };
        let at_once = truth.apply(&robot).unwrap().drive;
        let in_two = truth.after(&applied).apply(&applied.apply(&robot).unwrap()).unwrap().drive;
        for of in [
            DifferentialDrive::wheelbase,
            DifferentialDrive::wheel_diameter_left,
            DifferentialDrive::wheel_diameter_right,
        ] {
            assert!((of(&at_once) - of(&in_two)).abs() < 1e-15);
        }
        let nothing = truth.after(&truth);
        assert!(nothing.values().iter().all(|v| (v - 1.0).abs() < 1e-15), "{nothing:?}");
    }

    /// Oracle: travel over ground of a robot whose true lengths are those of the corrected one.
    #[test]
    fn the_model_moves_as_a_robot_with_the_corrected_lengths() {
        let robot = Robot::labmate();
        let correction = Correction { e_d: 1.02, e_b: 0.97, e_s: 1.01 };
        let corrected = correction.apply(&robot).unwrap();
        let believed = crate::drive::WheelTravel { left: 0.3, right: 0.5 };
        let rolled = crate::drive::WheelTravel {
            left: believed.left * corrected.drive.wheel_diameter_left() / robot.drive.wheel_diameter_left(),
            right: believed.right * corrected.drive.wheel_diameter_right() / robot.drive.wheel_diameter_right(),
        };
        let (model, oracle) = (
            correction
                .model(&robot)
                .unwrap()
                .chain()
                .displacement(&crate::effect::Context::default().as_believed(), &believed),
            corrected.drive.displacement(&rolled),
        );
        assert!((model.forward - oracle.forward).abs() < 1e-15 && (model.rotation - oracle.rotation).abs() < 1e-15);
    }
}
