//! The effects of a model, applied: from believed to true motion, and to its measurement.

use super::{Changes, Evaluate, Filter, Formula, Here, MAX_PARAMETERS, MeanLaws, Sight};
use crate::drive::{DifferentialDrive, LinkReading, WheelTravel};
use crate::geometry::{Displacement2, Pose2};
use std::sync::Arc;

/// The deterministic effects of a model, ready to turn believed into true motion.
#[derive(Clone, Debug)]
pub struct Chain<T: Evaluate> {
    pub(super) drive: DifferentialDrive,
    pub(super) effects: Vec<Acting<T>>,
    pub(super) reads_place: bool,
}

/// One effect of a chain, with its values.
#[derive(Clone, Debug)]
pub(super) struct Acting<T: Evaluate> {
    pub laws: ActingLaws<T>,
    pub changes: Changes,
    pub count: usize,
    pub values: [T; MAX_PARAMETERS],
}

/// The law of an effect: the functions of an entry of the catalogue, or a formula.
#[derive(Clone, Debug)]
pub(super) enum ActingLaws<T: Evaluate> {
    Entry(MeanLaws<T>),
    Formula(Arc<Formula>),
}

impl<T: Evaluate> Chain<T> {
    /// Its effects that change this.
    #[inline(always)]
    fn acting(&self, change: Changes) -> impl Iterator<Item = &Acting<T>> {
        self.effects.iter().filter(move |acting| acting.changes.include(change))
    }

    /// Replaces all values, in the order of [`Model::values`](super::Model::values).
    ///
    /// # Panics
    /// Where there are fewer values than parameters.
    pub fn set_values(&mut self, values: &[T]) {
        let mut rest = values;
        for acting in &mut self.effects {
            let own;
            (own, rest) = rest.split_at(acting.count);
            acting.values[..acting.count].copy_from_slice(own);
        }
    }

    /// Whether some of its effects may depend on [`Here::x`] and [`Here::y`].
    #[inline]
    pub(crate) fn reads_place(&self) -> bool {
        self.reads_place
    }

    /// Mean true pose at START, relative to the believed one.
    pub fn start(&self) -> Pose2<T> {
        let start = Pose2::IDENTITY.lift();
        self.acting(Changes::START).fold(start, |pose, acting| match &acting.laws {
            ActingLaws::Entry(laws) => pose.compose(&(laws.start)(&acting.values)),
            ActingLaws::Formula(_) => pose,
        })
    }

    /// True wheel travel for a believed one.
    #[inline(always)]
    pub fn wheel_travel(&self, at: &Here<T>, believed: &WheelTravel) -> WheelTravel<T> {
        self.rolled(at, WheelTravel { left: T::from(believed.left), right: T::from(believed.right) })
    }

    /// The same for a believed travel that itself has a derivative: that of a robot whose steering reacts to the effects.
    #[inline(always)]
    pub fn rolled(&self, at: &Here<T>, believed: WheelTravel<T>) -> WheelTravel<T> {
        let mut travel = [believed];
        self.change_wheels(at, &mut travel);
        let [travel] = travel;
        travel
    }

    /// The reading of a link's encoders.
    #[inline]
    pub fn link(&self, reading: LinkReading<T>) -> LinkReading<T> {
        self.acting(Changes::LINK).fold(reading, |mut shown, acting| {
            if let ActingLaws::Entry(laws) = &acting.laws {
                (laws.link)(&acting.values, &mut shown);
            }
            shown
        })
    }

    /// Turns believed wheel travels into true ones in place, effect after effect, so that no travel waits for another.
    #[inline(always)]
    pub(crate) fn change_wheels(&self, at: &Here<T>, travels: &mut [WheelTravel<T>]) {
        for acting in self.acting(Changes::WHEELS) {
            for travel in &mut *travels {
                match &acting.laws {
                    ActingLaws::Entry(laws) => (laws.wheels)(&acting.values, at, travel),
                    ActingLaws::Formula(formula) => formula.wheels(&acting.values, at, &self.drive, travel),
                }
            }
        }
    }

    /// Body motion from a true wheel travel.
    #[inline(always)]
    pub fn body(&self, at: &Here<T>, travel: &WheelTravel<T>) -> Displacement2<T> {
        let mut motion = [Displacement2 { sideways: T::from(at.aside.way), ..self.drive.displacement(travel) }];
        self.change_bodies(at, &mut motion);
        let [motion] = motion;
        motion
    }

    /// Body motions from true wheel travels, at one context, written into `motions`.
    pub(crate) fn bodies(&self, at: &Here<T>, travels: &[WheelTravel<T>], motions: &mut Vec<Displacement2<T>>) {
        motions.clear();
        let sideways = T::from(at.aside.way);
        motions.extend(travels.iter().map(|travel| Displacement2 { sideways, ..self.drive.displacement(travel) }));
        self.change_bodies(at, motions);
    }

    #[inline(always)]
    fn change_bodies(&self, at: &Here<T>, motions: &mut [Displacement2<T>]) {
        for acting in self.acting(Changes::BODY) {
            for motion in &mut *motions {
                match &acting.laws {
                    ActingLaws::Entry(laws) => (laws.body)(&acting.values, at, motion),
                    ActingLaws::Formula(formula) => formula.body(&acting.values, at, motion),
                }
            }
        }
    }

    /// Body motion for a believed wheel travel at constant ratio of the wheel speeds.
    #[inline(always)]
    pub fn displacement(&self, at: &Here<T>, believed: &WheelTravel) -> Displacement2<T> {
        self.body(at, &self.wheel_travel(at, believed))
    }

    /// Whether measurements may be delayed relative to their time stamps.
    #[inline]
    pub fn has_clock(&self) -> bool {
        self.acting(Changes::CLOCK).next().is_some()
    }

    /// The filter that measurements go through.
    #[inline]
    pub fn filter(&self) -> Option<Filter<T>> {
        self.acting(Changes::FILTER).find_map(|acting| {
            let ActingLaws::Entry(laws) = &acting.laws else { return None };
            let mut filter = Filter { share: T::from(0.0), time_constant: T::from(1.0) };
            (laws.filter)(&acting.values, &mut filter);
            Some(filter)
        })
    }

    /// Age \[s\] of a measurement whose time stamp is `time` after the run began.
    #[inline]
    pub fn late(&self, time: f64) -> T {
        self.acting(Changes::CLOCK).fold(T::from(0.0), |mut late, acting| {
            if let ActingLaws::Entry(laws) = &acting.laws {
                (laws.late)(&acting.values, time, &mut late);
            }
            late
        })
    }

    /// A measurement without noise of a true pose, taken `at.late` before its time stamp. Any further delay is small, so the robot is
    /// assumed to keep its velocity.
    #[inline]
    pub fn seen(&self, at: &Sight, pose: &Pose2<T>) -> Pose2<T> {
        let mut seen = *pose;
        if self.has_clock() {
            let further = self.late(at.time) - at.late;
            let back = [-at.speed, -at.turn_rate].map(|rate| further * rate);
            let sideways = if at.speed_aside == 0.0 { T::from(0.0) } else { further * -at.speed_aside };
            seen.advance(&Displacement2 { forward: back[0], sideways, rotation: back[1] });
        }
        for acting in self.acting(Changes::SEEN) {
            if let ActingLaws::Entry(laws) = &acting.laws {
                (laws.seen)(&acting.values, at, &mut seen);
            }
        }
        seen
    }
}
