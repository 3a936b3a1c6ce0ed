//! A run as its odometry reports it, in small pieces.

use crate::drive::WheelTravel;
use crate::effect::{Chain, Context, Evaluate, Sight};
use crate::engine::Convoy;
use crate::geometry::Pose2;
use std::sync::Arc;

/// The believed wheel travel of one run in small pieces, each with its [`Context`], and the moments of observation.
///
/// Pieces in which nothing moves are dropped. The robot starts at START with the misplacement of the effects.
///
/// ```
/// use umbmark_core::{drive::Robot, effect::Model, path::{Direction, Path}, replay::Track};
/// let robot = Robot::labmate();
/// let track = Track::from_path(&Path::umbmark(), Direction::Ccw, &robot);
/// let mut model = Model::new(&robot);
/// model.set("wheelbase", "e_b", 337.2 / 340.0)?;
/// model.set("wheel_diameter_ratio", "e_d", 1.00121)?;
/// let end = track.end(&model.chain());
/// assert!((end.x.hypot(end.y) - 0.3056).abs() < 1e-4); // the paper's Table I publishes 310 mm
/// # Ok::<(), umbmark_core::effect::ModelError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    pub(super) travel: Vec<WheelTravel>,
    pub(super) contexts: Vec<Context>,
    /// Number of pieces completed at each observation, never decreasing.
    pub(super) seen_after: Vec<usize>,
    pub(super) sights: Vec<Sight>,
    /// From the first sample of a log to the last \[s\].
    pub(super) duration: f64,
    /// The pose of START in the room.
    pub(super) origin: Pose2,
    /// Whether it begins at START and not somewhere on the path.
    pub(super) begins: bool,
    /// Of two trucks with a link, whose pieces are the periods of their odometry.
    pub(super) convoy: Option<Arc<Convoy>>,
}

impl Track {
    pub(super) fn empty() -> Track {
        let (travel, contexts, seen_after, sights) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (duration, origin) = (f64::INFINITY, Pose2::IDENTITY);
        Track { travel, contexts, seen_after, sights, duration, origin, begins: true, convoy: None }
    }

    pub(super) fn push(&mut self, travel: WheelTravel, at: Context) {
        if at.moves() {
            self.travel.push(travel);
            self.contexts.push(at);
        }
    }

    pub(super) fn observe(&mut self, sight: Sight) {
        self.seen_after.push(self.travel.len());
        self.sights.push(sight);
    }

    /// The travel up to the last observation (all of it without observations), observed at its end only.
    pub fn cut_at_last(mut self) -> Track {
        let end = self.seen_after.last().copied().unwrap_or(self.travel.len());
        self.travel.truncate(end);
        self.contexts.truncate(end);
        self.seen_after = vec![end];
        self.sights = vec![Sight { room: None, ..self.sights.last().copied().unwrap_or_default() }];
        self
    }

    /// The same run with its START elsewhere in the room.
    pub fn beginning_at(self, origin: Pose2) -> Track {
        Track { origin, ..self }
    }

    /// The same run, measured by a reference whose own frame has the track's frame here.
    pub fn seen_in(mut self, room: Pose2) -> Track {
        self.sights.iter_mut().for_each(|sight| sight.room = Some(room));
        self
    }

    /// Some of the observations, with the travel between them and what is driven within `margin` \[s\] before and after.
    pub fn part(&self, observations: std::ops::Range<usize>, margin: f64) -> Track {
        let sights = self.sights[observations.clone()].to_vec();
        let [first, last] = [sights.first(), sights.last()].map(|sight| sight.map_or(0.0, |sight| sight.time));
        let from = self.contexts.partition_point(|at| at.time + at.duration < first - margin);
        let to = self.contexts.partition_point(|at| at.time <= last + margin).max(from);
        let seen_after = self.seen_after[observations].iter().map(|after| after - from).collect();
        Track {
            travel: self.travel[from..to].to_vec(),
            contexts: self.contexts[from..to].to_vec(),
            seen_after,
            sights,
            duration: self.duration,
            origin: self.origin,
            begins: self.begins && from == 0,
            convoy: None,
        }
    }

    /// Where the robot stands at the beginning.
    #[inline]
    pub fn start<T: Evaluate>(&self, chain: &Chain<T>) -> Pose2<T> {
        let start = if self.begins { chain.start() } else { Pose2::IDENTITY.lift() };
        if self.origin == Pose2::IDENTITY { start } else { self.origin.lift().compose(&start) }
    }

    /// How far the wheels have rolled before each piece, and at the end, on average and whatever way, or how far the robot was moved aside
    /// where that is more \[m\].
    pub fn rolled(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let after = self.travel.iter().zip(&self.contexts).map(|(travel, at)| {
            sum += travel.rolled().max(at.aside.way.abs());
            sum
        });
        std::iter::once(0.0).chain(after).collect()
    }

    /// Believed wheel travel of each piece \[m\].
    pub fn travel(&self) -> &[WheelTravel] {
        &self.travel
    }

    /// Where and how each piece is driven.
    pub fn contexts(&self) -> &[Context] {
        &self.contexts
    }

    /// Number of completed elements of [`Track::travel`] at each observation, never decreasing.
    pub fn seen_after(&self) -> &[usize] {
        &self.seen_after
    }

    /// The moment of each observation.
    pub fn sights(&self) -> &[Sight] {
        &self.sights
    }

    /// Unsigned length of the path of the axle's centre by odometry \[m\].
    pub fn length(&self) -> f64 {
        let way = |(travel, at): (&WheelTravel, &Context)| {
            let ahead = 0.5 * (travel.left + travel.right).abs();
            if at.aside.way == 0.0 { ahead } else { libm::hypot(ahead, at.aside.way) }
        };
        self.travel.iter().zip(&self.contexts).map(way).sum()
    }

    /// Unsigned length of the path of the axle's centre by odometry after `made` pieces \[m\].
    pub fn way_before(&self, made: usize) -> f64 {
        self.contexts.get(made).map_or_else(|| self.length(), |at| at.distance)
    }

    /// The plan of two trucks with a link.
    pub(crate) fn convoy(&self) -> Option<&Convoy> {
        self.convoy.as_deref()
    }
}
