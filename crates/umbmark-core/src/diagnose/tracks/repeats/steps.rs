//! Short parts of runs, with the means of what the robot does in them.

use crate::effect::Chain;
use crate::geometry::{Displacement2, Pose2};
use crate::likelihood::ObservedRun;

/// What a law is in proportion to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Time, driving or not.
    Second,
    /// Way driven, ahead or back.
    Metre,
    /// Way ahead, and back against it.
    Ahead,
    /// Rotation, either way.
    Radian,
    /// Rotation to the left, and to the right against it.
    Turned,
    /// What the left wheel rolls, ahead or back.
    LeftWheel,
    /// What the right wheel rolls.
    RightWheel,
}

impl Per {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Per::Second => "second",
            Per::Metre => "metre",
            Per::Ahead => "metre ahead or back, against each other",
            Per::Radian => "radian turned",
            Per::Turned => "radian turned (left less right)",
            Per::LeftWheel | Per::RightWheel => "metre that it rolls",
        }
    }

    /// How much of it there is in a step, of a robot with this wheelbase \[m\].
    pub fn of(self, step: &TrackStep, wheelbase: f64) -> f64 {
        match self {
            Per::Second => step.duration,
            Per::Metre => step.way,
            Per::Ahead => step.way * step.speed.signum(),
            Per::Radian => step.rotation.abs(),
            Per::Turned => step.rotation,
            Per::LeftWheel => step.way * step.speed.signum() - 0.5 * wheelbase * step.rotation,
            Per::RightWheel => step.way * step.speed.signum() + 0.5 * wheelbase * step.rotation,
        }
    }
}

/// A short part of a run, with means over it.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackStep {
    /// The block that it belongs to.
    pub block: usize,
    /// Where the robot is in the middle of it, and how it stands.
    pub middle: Pose2,
    /// \[s\]
    pub duration: f64,
    /// Way driven, ahead or back \[m\]; nothing where the wheels roll against each other nearly alike: what is left then is made of
    /// single counts, which a law would take for motion.
    pub way: f64,
    /// \[rad\]; nothing where both wheels roll nearly alike: what is left then is made of single counts.
    pub rotation: f64,
    /// Since the run began \[s\] and \[m\], in its middle.
    pub time: f64,
    pub distance: f64,
    /// \[m/s\], ahead positive; nothing as above.
    pub speed: f64,
    /// \[rad/s\]; nothing where both wheels roll nearly alike.
    pub turn_rate: f64,
    /// \[m/s²\] and \[rad/s²\]
    pub acceleration: f64,
    pub turn_acceleration: f64,
    /// Of the left and the right wheel \[rad\].
    pub wheel_angle: [f64; 2],
    /// Way since the last turn \[m\], and its sense.
    pub since_turn: f64,
    pub last_turn: f64,
}

/// A step ends after so much way \[m\], rotation \[rad\] or time \[s\].
const STEP: (f64, f64, f64) = (0.02, 0.05, 0.1);
/// Wheels roll alike where they, or their sizes, differ by less than this share.
const ALIKE: f64 = 0.05;

/// The steps of a run along a model.
pub fn steps(run: &ObservedRun, chain: &Chain<f64>) -> Vec<TrackStep> {
    let track = &run.track;
    let (mut pose, mut made, mut steps) = (track.start(chain), 0.0_f64, Vec::new());
    for (block, own) in run.blocks.iter().enumerate() {
        let until = run.made_at(own).max(made);
        let (mut step, mut wheels, mut change) = (TrackStep::default(), [0.0; 2], [0.0; 2]);
        let mut begin = pose;
        let pieces = made as usize..(until.ceil() as usize).min(track.travel().len());
        let last = pieces.clone().rev().find(|piece| !track.contexts()[*piece].stands());
        for piece in pieces.clone() {
            // A block may begin or end within a piece.
            let (begun, ended) = ((made - piece as f64).max(0.0), (until - piece as f64).min(1.0));
            let share = (ended - begun).max(0.0);
            let (travel, at) = (&track.travel()[piece].scaled(share), &track.contexts()[piece].part(share));
            if at.stands() {
                pose = pose.moved(&chain.displacement(&at.at_pose(&pose), travel));
                continue;
            }
            if step.duration == 0.0 {
                begin = pose;
                step = TrackStep {
                    block,
                    time: at.time + begun * at.duration,
                    distance: at.distance,
                    wheel_angle: at.wheel_angle,
                    since_turn: at.since_turn,
                    last_turn: at.last_turn,
                    ..TrackStep::default()
                };
                (wheels, change) = ([0.0; 2], [0.0; 2]);
            }
            let motion = chain.displacement(&at.at_pose(&pose), travel);
            pose = pose.moved(&motion);
            let duration = share * at.duration;
            step.duration += duration;
            step.way += share * at.length.abs();
            step.speed += at.speed * duration;
            step.rotation += motion.rotation;
            wheels = [wheels[0] + travel.left, wheels[1] + travel.right];
            change = [change[0] + at.acceleration() * duration, change[1] + at.turn_acceleration() * duration];
            let full = step.way >= STEP.0 || step.rotation.abs() >= STEP.1 || step.duration >= STEP.2;
            if (full || Some(piece) == last) && step.duration > 0.0 {
                let TrackStep { duration, way, .. } = step;
                let between = begin.between(&pose);
                step.middle = begin.moved(&Displacement2 {
                    forward: 0.5 * between.x,
                    sideways: 0.5 * between.y,
                    rotation: 0.5 * step.rotation,
                });
                step.speed /= duration;
                let little = ALIKE * wheels[0].abs().max(wheels[1].abs());
                if (wheels[1] - wheels[0]).abs() < little {
                    step.rotation = 0.0;
                } else if (wheels[1] + wheels[0]).abs() < little {
                    (step.way, step.speed) = (0.0, 0.0);
                }
                step.turn_rate = step.rotation / duration;
                (step.acceleration, step.turn_acceleration) = (change[0] / duration, change[1] / duration);
                (step.time, step.distance) = (step.time + 0.5 * duration, step.distance + 0.5 * way);
                (0..2).for_each(|wheel| {
                    step.wheel_angle[wheel] +=
                        0.5 * (at.wheel_angle[wheel] + at.wheel_rotation[wheel] - step.wheel_angle[wheel]);
                });
                step.since_turn += 0.5 * way;
                steps.push(step);
                step.duration = 0.0;
            }
        }
        made = until;
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::likelihood::Observed;
    use crate::likelihood::watched::watched;

    #[test]
    fn turns_on_the_spot_have_no_way_and_legs_no_rotation_that_single_counts_make() {
        let model = Model::new(&Robot::labmate());
        let observed = Observed::new(&watched(&model, 1, 3), &Robot::labmate()).unwrap();
        for run in &observed.runs {
            let steps = steps(run, &model.chain());
            let (turns, legs): (Vec<TrackStep>, Vec<TrackStep>) =
                steps.iter().partition(|step| step.rotation.abs() >= STEP.1);
            assert!(turns.len() > 20 && legs.len() > 200, "{} {}", turns.len(), legs.len());
            assert!(turns.iter().all(|step| (step.way, step.speed) == (0.0, 0.0)));
            assert!(legs.iter().filter(|step| step.way >= STEP.0).all(|step| step.rotation == 0.0));
        }
    }
}
