//! A model as a table of constants, for odometry on the robot.

use crate::drive::Robot;
use crate::effect::{Changes, Law, Model, Part};
use crate::geometry::Pose2;
use crate::likelihood::Noise;
use umbmark_odometry::law;
use umbmark_odometry::table::{Columns, MAX_LAWS, Step, Table, TableError};

/// Why a model cannot be compiled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompileError {
    /// A drive whose pose does not follow from two counters.
    #[error(
        "a robot with drive = \"{drive}\" cannot be compiled: its trucks steer by their own odometry, so its pose does not follow \
         from two counters; drives with two wheels, a steered wheel or synchro can"
    )]
    Drive {
        /// Kind of the drive.
        drive: &'static str,
    },
    /// A drive on wheels with rollers.
    #[error(
        "a robot with drive = \"{drive}\" cannot be compiled: it has a counter for each wheel, and the library on the robot reads two; \
         correct its logs on a computer"
    )]
    Rollers {
        /// Its kind.
        drive: &'static str,
    },
    /// A formula.
    #[error(
        "{effect} is a formula, and only effects of the catalogue that act on motion can be compiled ({}); take it out and learn or fit the \
         others anew, or correct its logs on a computer",
        compilable()
    )]
    Formula {
        /// The effect.
        effect: &'static str,
    },
    /// An effect whose law the library on the robot does not know.
    #[error(
        "{effect} cannot be compiled: the library on the robot does not have its law ({}); take it out and learn or fit the others anew",
        compilable()
    )]
    Unknown {
        /// The effect.
        effect: &'static str,
    },
    /// More effects than a table holds.
    #[error("the model has {laws} effects that act on motion, and a table holds at most {MAX_LAWS}")]
    TooMany {
        /// How many.
        laws: usize,
    },
    /// Numbers that no table can have.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// The names of the effects that can be compiled.
fn compilable() -> String {
    law::LAWS.iter().map(|law| law.name).collect::<Vec<_>>().join(", ")
}

/// The model as a [table](umbmark_odometry::table) for [`Odometer`](umbmark_odometry::Odometer): each number, and what it means.
///
/// Effects of a reference and of START do nothing on the robot and are left out, as in [`apply`](super::apply).
///
/// ```
/// use umbmark_core::{apply::compiled, drive::Robot, effect::Model, geometry::Pose2};
/// use umbmark_odometry::{Odometer, Table};
/// let mut model = Model::new(&Robot::labmate());
/// model.set("scale", "e_s", 1.01)?;
/// let numbers: Vec<f64> = compiled(&model, None, Pose2::IDENTITY)?.iter().map(|(_, number)| *number).collect();
/// let table = Table::read(&numbers)?;
/// let mut odometer = Odometer::<2>::begin(&table);
/// odometer.update(0.0, [0.0, 0.0])?;
/// assert!((odometer.update(1.0, [4244.0, 4244.0])?.pose.x - 1.01).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compiled(model: &Model, noise: Option<&Noise>, start: Pose2) -> Result<Vec<(&'static str, f64)>, CompileError> {
    let robot = model.robot();
    if robot.drive.trucks().is_some() {
        return Err(CompileError::Drive { drive: robot.drive.kind().name() });
    }
    if robot.drive.kind().moves_sideways() {
        return Err(CompileError::Rollers { drive: robot.drive.kind().name() });
    }
    let steps = model.parts().iter().filter_map(|part| step(part).transpose()).collect::<Result<Vec<_>, _>>()?;
    if steps.len() > MAX_LAWS {
        return Err(CompileError::TooMany { laws: steps.len() });
    }
    let mut table = Table::new(robot.nominal(), robot.gearing()).with_steps(steps)?;
    table.counts_per_turn = counts_per_turn(robot);
    table.counter_bits = robot.encoder.counter_bits();
    let wiring = robot.encoder.wiring();
    table.columns = Columns { exchanged: wiring.exchanged, backward: wiring.backward };
    table.start = start;
    table.growth = noise.map(Noise::of_wheels);
    let mut numbers = Vec::new();
    table.write(|meaning, number| numbers.push((meaning, number)));
    let plain: Vec<f64> = numbers.iter().map(|(_, number)| *number).collect();
    Table::read(&plain)?;
    Ok(numbers)
}

/// The law of a part with its values; nothing where it does not act on motion.
fn step(part: &Part) -> Result<Option<Step<'_>>, CompileError> {
    let effect = part.effect.name();
    let Law::Entry(entry) = &part.effect else { return Err(CompileError::Formula { effect }) };
    if !entry.changes.include(Changes::WHEELS.and(Changes::BODY)) {
        return Ok(None);
    }
    let unknown = CompileError::Unknown { effect };
    if part.effect.is_of_program() {
        return Err(unknown);
    }
    let law = law::Law::named(effect).ok_or(unknown)?;
    Ok(Some(Step { law, values: &part.values }))
}

fn counts_per_turn(robot: &Robot) -> [f64; 2] {
    let drive = robot.encoder.ticks_per_revolution();
    [drive, robot.drive.number("steering_ticks_per_revolution").unwrap_or(drive)]
}
