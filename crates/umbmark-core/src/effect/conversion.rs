//! A model of one nominal robot converted to another nominal robot: the true robot stays the same.

use super::{Changes, Law, Model, ModelError};
use crate::drive::Robot;

/// Nominal numbers are equal if they differ by no more than this share.
const SAME: f64 = 1e-9;
/// If nominal lengths differ by more than this share, only E_d, E_b and E_s can be converted: other effects that depend on speed or
/// distance would be wrong by this share.
const NEAR: f64 = 0.05;
/// The effects that are converted.
pub const CONVERTED: [&str; 3] = ["wheel_diameter_ratio", "wheelbase", "scale"];

/// What was done to a model of another nominal robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    /// Each nominal number that differs: its key in robot.toml, the value that the model was made for, and the value here.
    pub differs: Vec<(&'static str, f64, f64)>,
    /// E_d, E_b and E_s there, and here.
    pub ratios: [[f64; 3]; 2],
    /// Other effects that depend on the robot's motion and were not converted.
    pub kept: Vec<&'static str>,
}

impl std::fmt::Display for Conversion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers: Vec<String> =
            self.differs.iter().map(|(key, there, here)| format!("{key} = {there}, which is {here} here")).collect();
        let [[d, b, s], [e_d, e_b, e_s]] = self.ratios;
        write!(
            f,
            "was made for a robot with {}; converted: E_d {d:.6} is now {e_d:.6}, E_b {b:.6} is {e_b:.6} and E_s {s:.6} is {e_s:.6}",
            numbers.join(" and ")
        )?;
        if self.kept.is_empty() {
            return Ok(());
        }
        let share = self.differs.iter().map(|(_, there, here)| (here / there - 1.0).abs()).fold(0.0, f64::max);
        write!(f, "; {} stayed as before, right to {:.1} %", self.kept.join(", "), 100.0 * share)
    }
}

impl Model {
    /// Refuses a nominal robot that is not the model's own.
    pub fn check_robot(&self, robot: &Robot) -> Result<(), ModelError> {
        match differences(self.robot(), robot) {
            Some(differs) if differs.is_empty() => Ok(()),
            _ => Err(ModelError::OtherRobot {
                own: described(self.robot()),
                other: described(robot),
                why: "convert it first",
            }),
        }
    }

    /// The same true robot as effects of another nominal one, and what that changed; nothing where both have the same numbers.
    ///
    /// ```text
    /// factor of a wheel ← factor · D/D',   E_d = right/left,   E_s = (left + right)/2,   E_b ← E_b b/b'
    /// ```
    ///
    /// with the travel per tick D of a wheel and the wheelbase b that the model was made for, D' and b' those of `robot`.
    ///
    /// # Errors
    /// [`ModelError::OtherRobot`] for another kind of drive, for a drive that is not differential, and where effects that depend on
    /// speed, way or wheel angle would be off by more than a few per cent.
    pub fn converted(&self, robot: &Robot) -> Result<(Model, Option<Conversion>), ModelError> {
        let own = self.robot();
        let refuse = |why| Err(ModelError::OtherRobot { own: described(own), other: described(robot), why });
        let Some(differs) = differences(own, robot) else { return refuse("learn the effects of this drive anew") };
        if differs.is_empty() {
            return Ok((self.clone().of(robot), None));
        }
        if !own.drive.kind().has_axle_wheels() {
            return refuse("only models of differential drives are converted; learn it anew");
        }
        let [there, here] = [own, robot].map(Robot::metres_per_tick);
        let [left, right] = [there.left / here.left, there.right / here.right];
        let wheelbase = own.drive.wheelbase() / robot.drive.wheelbase();
        let is_near = [left, right, wheelbase].iter().all(|ratio| (ratio - 1.0).abs() <= NEAR);
        let counts = own.encoder.ticks_per_revolution() / robot.encoder.ticks_per_revolution();
        let sees_motion = |law: &Law| law.changes().include(Changes::WHEELS.and(Changes::BODY));
        let others = || self.parts().iter().filter(|part| !CONVERTED.contains(&part.effect.name()));
        let kept: Vec<&'static str> =
            others().filter(|part| sees_motion(&part.effect)).map(|p| p.effect.name()).collect();
        if !kept.is_empty() && (!is_near || (counts - 1.0).abs() > SAME) {
            return refuse("its effects depend on speed, way or wheel angle, which differ too much; learn it anew");
        }
        let of = |effect, parameter| self.get(effect, parameter).unwrap_or(1.0);
        let ratios = [of("wheel_diameter_ratio", "e_d"), of("wheelbase", "e_b"), of("scale", "e_s")];
        let [e_d, e_b, e_s] = ratios;
        let left = left * 2.0 * e_s / (1.0 + e_d);
        let right = right * 2.0 * e_s * e_d / (1.0 + e_d);
        let converted = [right / left, e_b * wheelbase, 0.5 * (left + right)];
        let mut model = self.clone().of(robot);
        for ((effect, parameter), (before, after)) in
            CONVERTED.iter().zip(["e_d", "e_b", "e_s"]).zip(ratios.into_iter().zip(converted))
        {
            if before != after {
                model.set(effect, parameter, after)?;
            }
        }
        Ok((model, Some(Conversion { differs, ratios: [ratios, converted], kept })))
    }
}

/// The nominal numbers that differ, by key; `None` where the drives are of different kinds.
pub(crate) fn differences(own: &Robot, other: &Robot) -> Option<Vec<(&'static str, f64, f64)>> {
    let kind = own.drive.kind();
    if kind != other.drive.kind() {
        return None;
    }
    let numbers = |robot: &Robot| {
        let mut numbers = robot.drive.values();
        numbers.push(robot.encoder.ticks_per_revolution());
        numbers
    };
    let keys = kind.parameters().iter().map(|parameter| parameter.name).chain(["ticks_per_revolution"]);
    let both = keys.zip(numbers(own).into_iter().zip(numbers(other)));
    let differs = both.filter(|(_, (a, b))| (a - b).abs() > SAME * a.abs().max(b.abs()));
    Some(differs.map(|(key, (own, other))| (key, own, other)).collect())
}

/// The numbers of a nominal robot, for people.
fn described(robot: &Robot) -> String {
    let kind = robot.drive.kind();
    let numbers = kind
        .parameters()
        .iter()
        .zip(robot.drive.values())
        .map(|(parameter, value)| format!("{} {value}", parameter.name));
    format!(
        "{} {}, ticks_per_revolution {}",
        kind.name(),
        numbers.collect::<Vec<_>>().join(", "),
        robot.encoder.ticks_per_revolution()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{DifferentialDrive, Encoder, WheelTravel};
    use crate::effect::Context;
    use crate::random::Stream;

    /// A robot of random numbers within a factor of two.
    fn drawn(stream: &mut Stream) -> Robot {
        let mut near = |value: f64| value * (0.7 * (2.0 * stream.uniform() - 1.0)).exp();
        let drive = DifferentialDrive::new(near(0.34), near(0.15), near(0.15)).unwrap();
        Robot { name: String::new(), drive: drive.into(), encoder: Encoder::new(near(2000.0), None, None).unwrap() }
    }

    #[test]
    fn the_same_counts_are_the_same_motion_before_and_after() {
        let mut stream = Stream::new(7, 1, 0);
        for _ in 0..50 {
            let (there, here) = (drawn(&mut stream), drawn(&mut stream));
            let mut model = Model::new(&there);
            for (effect, parameter) in CONVERTED.iter().zip(["e_d", "e_b", "e_s"]) {
                model.set(effect, parameter, 0.9 + 0.2 * stream.uniform()).unwrap();
            }
            model.add("marker_offset").unwrap();
            let Ok((converted, conversion)) = model.converted(&here) else { continue };
            assert!(conversion.unwrap().kept.is_empty());
            let counts = [0, 1].map(|_| 100.0 * stream.uniform());
            let moved = |model: &Model| {
                let per_tick = model.robot().metres_per_tick();
                let believed = WheelTravel { left: counts[0] * per_tick.left, right: counts[1] * per_tick.right };
                model.chain().displacement(&Context::default().as_believed(), &believed)
            };
            let (before, after) = (moved(&model), moved(&converted));
            assert!((before.forward - after.forward).abs() < 1e-12, "{before:?} {after:?}");
            assert!((before.rotation - after.rotation).abs() < 1e-12, "{before:?} {after:?}");
            let (back, _) = converted.converted(&there).unwrap();
            let values = back.values().zip(model.values());
            assert!(values.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn models_of_other_drives_stay_with_their_robot() {
        use crate::preset::Preset;
        let synchro = Preset::find("k2a").unwrap().robot();
        let model = Model::new(&synchro);
        assert!(model.check_robot(&synchro).is_ok() && model.converted(&synchro).unwrap().1.is_none());
        assert!(model.check_robot(&Robot::labmate()).is_err() && model.converted(&Robot::labmate()).is_err());
        let mut values = synchro.drive.values();
        values[0] *= 1.01;
        let other =
            Robot { drive: crate::drive::Drive::from_values(synchro.drive.kind(), &values).unwrap(), ..synchro };
        let error = model.converted(&other).unwrap_err().to_string();
        assert!(error.contains("only models of differential drives are converted; learn it anew"), "{error}");
    }
}
