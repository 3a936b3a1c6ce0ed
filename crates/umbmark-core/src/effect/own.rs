//! What a model says of its robot's own numbers.

use super::{Model, find};
use crate::drive::{DriveError, Robot};

impl Model {
    /// The values of the [own effects](crate::drive::Drive::own_effects) of its robot's drive, each as it does nothing where the model lacks it.
    pub fn own_values(&self) -> Vec<f64> {
        let value = |effect: &'static str| {
            let first = find(effect).ok().and_then(|entry| entry.about.parameters.first())?;
            Some(self.get(effect, first.name).unwrap_or_else(|| first.default.resolve(self.robot())))
        };
        self.robot().drive.own_effects().into_iter().map(|effect| value(effect).unwrap_or(1.0)).collect()
    }

    /// Its robot with the numbers that the odometry should have.
    ///
    /// ```
    /// use umbmark_core::{drive::{DriveKind, Robot}, effect::Model};
    /// let mut model = Model::new(&Robot { drive: DriveKind::Mecanum.usual(), ..Robot::labmate() });
    /// model.set("axle_diameter_ratio", "ratio", 1.01)?;
    /// let drive = model.corrected_robot()?.drive;
    /// let of = |key| drive.number(key).unwrap();
    /// assert!((of("wheel_diameter_1_m") / of("wheel_diameter_3_m") - 1.01).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn corrected_robot(&self) -> Result<Robot, DriveError> {
        let robot = self.robot();
        Ok(Robot { drive: robot.drive.with_own(&self.own_values())?, ..robot.clone() })
    }
}
