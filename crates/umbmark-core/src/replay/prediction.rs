//! The poses that a model predicts along a track.

use super::behind::Behind;
use super::moment::Moments;
use super::track::Track;
use crate::effect::{Chain, Evaluate, Sight};
use crate::engine::{Convoy, Predicted};
use crate::geometry::{Displacement2, Instructions, Pose2, by_width};

impl Track {
    /// The pose predicted for the end of the travel.
    pub fn end<T: Evaluate>(&self, chain: &Chain<T>) -> Pose2<T> {
        if self.convoy.is_some() {
            return self.poses(chain).pop().unwrap_or_else(|| chain.start());
        }
        let end = self.drive(chain, self.start(chain), 0..self.travel.len());
        chain.seen(&self.sights.last().copied().unwrap_or_default(), &end)
    }

    /// The poses predicted for all observations.
    pub fn poses<T: Evaluate>(&self, chain: &Chain<T>) -> Vec<Pose2<T>> {
        let mut poses = Vec::with_capacity(self.seen_after.len());
        self.replay(chain, |_, pose| poses.push(*pose));
        poses
    }

    /// Calls `seen` with the number of each observation and the pose predicted for it. It allocates nothing.
    #[inline]
    pub fn replay<T: Evaluate>(&self, chain: &Chain<T>, mut seen: impl FnMut(usize, &Pose2<T>)) {
        if let Some(convoy) = &self.convoy {
            return self.replay_trucks(convoy, chain, &Pose2::IDENTITY.lift(), seen);
        }
        if chain.has_clock() || chain.filter().is_some() {
            return self.replay_late(
                (chain, chain),
                self.start(chain),
                |pose| *pose,
                |observation, pose, sight| {
                    seen(observation, &chain.seen(sight, pose));
                },
            );
        }
        let mut pose = self.start(chain);
        let mut made = 0;
        for (observation, (after, sight)) in self.seen_after.iter().zip(&self.sights).enumerate() {
            pose = self.drive(chain, pose, made..*after);
            made = *after;
            seen(observation, &chain.seen(sight, &pose));
        }
    }

    /// The same by two chains: the robot is driven by the first, which carries no derivatives, and seen by the second, whose derivatives are
    /// those of the measurement only.
    pub(crate) fn replay_sight<T: Evaluate>(
        &self,
        driven: &Chain<f64>,
        chain: &Chain<T>,
        mut seen: impl FnMut(usize, &Pose2<T>),
    ) {
        if self.convoy.is_some() {
            return self.replay(chain, seen);
        }
        self.replay_late((driven, chain), self.start(driven), Pose2::lift, |observation, pose, sight| {
            seen(observation, &chain.seen(sight, pose));
        });
    }

    /// The same by a reference that is late or filtered: calls `seen` with the true pose at the moment that each measurement shows. The robot is
    /// driven by one chain and seen by another.
    fn replay_late<D: Evaluate, T: Evaluate>(
        &self,
        (driven, chain): (&Chain<D>, &Chain<T>),
        from: Pose2<D>,
        lift: impl Fn(&Pose2<D>) -> Pose2<T>,
        mut seen: impl FnMut(usize, &Pose2<T>, &Sight),
    ) {
        let (mut pose, mut made, mut moments) = (from, 0, Moments::new(self));
        let mut behind = chain.filter().map(Behind::new);
        for (observation, sight) in self.sights.iter().enumerate() {
            let moment = moments.next(sight, chain.late(sight.time).value());
            // Beyond the end of a log, its last piece continues.
            let whole = moment.made.max(made);
            pose = match &mut behind {
                Some(behind) => self.drive_before(driven, pose, made..whole, (&lift, behind)),
                None => self.drive(driven, pose, made..whole),
            };
            made = whole;
            let mut there = pose;
            if moment.share != 0.0 {
                let (travel, at) = (&self.travel[moment.made], &self.contexts[moment.made]);
                let motion = driven.displacement(&at.at_pose(&pose), travel);
                let share = moment.share - (whole - moment.made) as f64;
                there.advance(&Displacement2 {
                    forward: motion.forward * share,
                    sideways: motion.sideways * share,
                    rotation: motion.rotation * share,
                });
            }
            if let Some(mut behind) = behind {
                let time = moment.sight.time - moment.sight.late;
                if moment.share != 0.0 {
                    behind.goes(&self.contexts[moment.made], (&lift(&pose), &lift(&there)), time);
                }
                behind.rest(time);
                seen(observation, &behind.seen(&lift(&there)), &moment.sight);
                continue;
            }
            seen(observation, &lift(&there), &moment.sight);
        }
    }

    /// The poses predicted for all observations, as seen from START, where the robot at START heads `turned` \[rad\] in the room.
    pub(crate) fn poses_turned<T: Evaluate>(&self, chain: &Chain<T>, turned: f64) -> Vec<Pose2<T>> {
        let room: Pose2<T> = Pose2::new(0.0, 0.0, turned).lift();
        let mut poses = Vec::with_capacity(self.seen_after.len());
        if let Some(convoy) = &self.convoy {
            self.replay_trucks(convoy, chain, &room, |_, pose| poses.push(*pose));
            return poses;
        }
        if chain.has_clock() || chain.filter().is_some() {
            self.replay_late(
                (chain, chain),
                room.compose(&chain.start()),
                |pose| *pose,
                |_, pose, sight| {
                    poses.push(room.inverse().compose(&chain.seen(sight, pose)));
                },
            );
            return poses;
        }
        let mut pose = room.compose(&chain.start());
        let mut made = 0;
        for (after, sight) in self.seen_after.iter().zip(&self.sights) {
            pose = self.drive(chain, pose, made..*after);
            made = *after;
            poses.push(room.inverse().compose(&chain.seen(sight, &pose)));
        }
        poses
    }

    /// Calls `seen` for a front truck. Its odometry steers it, so the prediction is the linearised error of its pose, added to the
    /// commanded pose.
    fn replay_trucks<T: Evaluate>(
        &self,
        convoy: &Convoy,
        chain: &Chain<T>,
        room: &Pose2<T>,
        mut seen: impl FnMut(usize, &Pose2<T>),
    ) {
        let mut floor = Predicted::by(chain);
        let mut trucks = convoy.at_start(room.compose(&chain.start()), &mut floor);
        let mut made = 0;
        for (observation, (after, sight)) in self.seen_after.iter().zip(&self.sights).enumerate() {
            convoy.steps()[made..*after].iter().for_each(|step| convoy.step(step, &mut trucks, &mut floor));
            made = *after;
            let (real, told) = (chain.seen(sight, &trucks.real[0]), convoy.meant(made)[0]);
            let (real, believed) = (room.inverse().compose(&real), &trucks.believed[0]);
            let pose = Pose2 {
                x: real.x - believed.x + told.x,
                y: real.y - believed.y + told.y,
                heading: real.heading - believed.heading + told.heading,
            };
            seen(observation, &pose);
        }
    }

    /// The same as [`Track::drive`], before a filtered measurement.
    fn drive_before<D: Evaluate, T: Evaluate>(
        &self,
        chain: &Chain<D>,
        from: Pose2<D>,
        pieces: std::ops::Range<usize>,
        (lift, behind): (impl Fn(&Pose2<D>) -> Pose2<T>, &mut Behind<T>),
    ) -> Pose2<D> {
        let mut pose = from;
        for piece in pieces {
            let (to, at) = (self.drive(chain, pose, piece..piece + 1), &self.contexts[piece]);
            behind.goes(at, (&lift(&pose), &lift(&to)), at.time + at.duration);
            pose = to;
        }
        pose
    }

    #[inline]
    pub(super) fn drive<T: Evaluate>(
        &self,
        chain: &Chain<T>,
        from: Pose2<T>,
        pieces: std::ops::Range<usize>,
    ) -> Pose2<T> {
        let track = self;
        let instructions = if T::WIDE { Instructions::best() } else { Instructions::Portable };
        by_width!(
            instructions,
            [T: Evaluate] |track: &Track, chain: &Chain<T>, from: Pose2<T>, pieces: std::ops::Range<usize>| -> Pose2<T> {
                track.drive_plainly(chain, from, pieces)
            }
        )
    }

    #[inline(always)]
    pub(super) fn drive_plainly<T: Evaluate>(
        &self,
        chain: &Chain<T>,
        from: Pose2<T>,
        pieces: std::ops::Range<usize>,
    ) -> Pose2<T> {
        if chain.reads_place() {
            self.drive_seeing::<T, true>(chain, from, pieces)
        } else {
            self.drive_seeing::<T, false>(chain, from, pieces)
        }
    }

    /// Without `PLACE`, effects get the place of the first piece: updating it piece by piece takes 10 % longer.
    #[inline(always)]
    fn drive_seeing<T: Evaluate, const PLACE: bool>(
        &self,
        chain: &Chain<T>,
        from: Pose2<T>,
        pieces: std::ops::Range<usize>,
    ) -> Pose2<T> {
        let pieces = self.travel[pieces.clone()].iter().zip(&self.contexts[pieces]);
        let mut pose = from;
        for (travel, at) in pieces {
            let there = if PLACE { pose } else { Pose2 { heading: pose.heading, ..from } };
            pose.advance(&chain.displacement(&at.at_pose(&there), travel));
        }
        pose
    }
}
