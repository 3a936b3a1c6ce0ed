//! Kinds of reference: what a measurement from outside tells of where the robot is, and what it cannot tell.
//!
//! Most robots have no motion capture. A tracked marker tells positions and no headings; a mark on the floor tells only that the robot has come
//! back. Each kind is described in a file of its own, which says which components of a pose it tells, and in which sense.
//! [`Kind::of`] says of which kind the reference of a run is.

use crate::register;
use crate::run::Run;

register! {
    /// Every kind there is.
    pub KINDS: Kind = KIND in
    pose,
    position,
    heading,
    motion,
    gyro,
    mark,
}

/// In which sense a component of the pose is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// It is not measured.
    Nothing,
    /// In the room, all along the way or at stops on it.
    InRoom,
    /// From each measurement to the next.
    Steps,
    /// In the room, at the ends of a drive only.
    AtEnds,
}

/// A kind of reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Its name, as in texts.
    pub name: &'static str,
    /// What measures it.
    pub about: &'static str,
    /// In which sense it tells x and y.
    pub position: Told,
    /// In which sense it tells the heading.
    pub heading: Told,
    /// What is fitted with it, and what it can and cannot determine: a sentence without a full stop.
    pub shows: &'static str,
}

impl Kind {
    /// Whether nothing is told of the way, only of where it ended.
    pub fn is_at_ends(&self) -> bool {
        self.position == Told::AtEnds
    }

    /// The kind of a run's reference; `None` of a run that was not measured.
    pub fn of(run: &Run) -> Option<&'static Kind> {
        let log = run.log.as_ref();
        let poses = log.map(|log| &log.reference[..]).filter(|poses| !poses.is_empty());
        let (position, heading) = match (poses, run.returned) {
            (Some(_), _) if log.is_some_and(|log| log.headings_only) => {
                (Told::Nothing, if log.is_some_and(|log| log.relative) { Told::Steps } else { Told::InRoom })
            }
            (Some(_), _) if log.is_some_and(|log| log.relative) => (Told::Steps, Told::Steps),
            (Some(poses), _) if poses.iter().any(|pose| pose.heading.is_some()) => (Told::InRoom, Told::InRoom),
            (Some(_), _) => (Told::InRoom, Told::Nothing),
            (None, Some(_)) => (Told::AtEnds, Told::AtEnds),
            (None, None) => return None,
        };
        KINDS.iter().copied().find(|kind| (kind.position, kind.heading) == (position, heading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::TestKind;
    use crate::run::{ReferencePose, ReturnError, TickLog};

    #[test]
    fn each_kind_is_recognised_by_what_was_measured() {
        let run = |headings: &[Option<f64>], returned: bool| {
            let pose =
                |(sample, heading): (usize, &Option<f64>)| ReferencePose { sample, x: 0.0, y: 0.0, heading: *heading };
            let reference = headings.iter().enumerate().map(pose).collect();
            Run {
                name: "run".into(),
                number: 1,
                direction: None,
                test: TestKind::Systematic,
                log: Some(TickLog { reference, ..TickLog::default() }),
                returned: returned.then(ReturnError::default),
            }
        };
        let name = |run: &Run| Kind::of(run).map(|kind| kind.name);
        assert_eq!(name(&run(&[None, Some(0.0)], true)), Some("pose"));
        assert_eq!(name(&run(&[None, None], true)), Some("position"));
        assert_eq!(name(&run(&[], true)), Some("mark"));
        assert_eq!(name(&run(&[], false)), None);
        let mut steps = run(&[Some(0.0)], false);
        steps.log.as_mut().unwrap().relative = true;
        assert_eq!(name(&steps), Some("motion"));
        steps.log.as_mut().unwrap().headings_only = true;
        assert_eq!(name(&steps), Some("gyro"));
        steps.log.as_mut().unwrap().relative = false;
        assert_eq!(name(&steps), Some("heading"));
    }

    #[test]
    fn names_and_senses_are_those_of_one_kind_each() {
        for (index, kind) in KINDS.iter().enumerate() {
            for other in &KINDS[..index] {
                assert_ne!(kind.name, other.name);
                assert_ne!((kind.position, kind.heading), (other.position, other.heading));
            }
        }
    }
}
