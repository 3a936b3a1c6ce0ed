//! A run linearised about a model: places its blocks, and aligns its measured poses with the prediction where it starts and restarts.

use super::uneven::Uneven;
use super::walk::{Walk, velocity};
use super::{Block, ObservedRun};
use crate::effect::Chain;
use crate::geometry::{Pose2, mean_angle, wrap};
use crate::likelihood::observed::Column;
use crate::replay::Moment;

/// Without headings, poses are rotated so that this distance after a start agrees with the prediction \[m\].
const WAY: f64 = 1.0;
/// A larger heading error means that the model is far from the runs \[rad\].
const DRIFT: f64 = 0.5;

impl ObservedRun {
    /// Places the blocks, and the growth of the error between them, along the poses that a model predicts.
    pub(super) fn lay_along(&mut self, chain: &Chain<f64>) {
        let walk = Walk::new(&self.track, chain);
        self.moments = self.track.moments(chain).into();
        self.places = self.moments.iter().map(|moment| walk.at(moment)).collect();
        // A wrong heading moves the tracked point, which may be off the middle of the axle.
        let mut tracked = Vec::with_capacity(self.places.len());
        self.sighted(chain, &mut |_, pose| tracked.push(*pose));
        let uneven = Uneven::new(&self.track, &walk.places, &self.readings);
        let mut before = 0.0;
        for block in &mut self.blocks {
            let own = block.first..block.first + block.count;
            let (places, moments) = (&self.places[own.clone()], &self.moments[own.clone()]);
            let mean = |poses: &[Pose2], of: fn(&Pose2) -> f64| poses.iter().map(of).sum::<f64>() / poses.len() as f64;
            let tracked = &tracked[own];
            block.place = Pose2::new(mean(tracked, |p| p.x), mean(tracked, |p| p.y), mean(places, |p| p.heading));
            block.velocity = velocity(places, tracked, moments);
            let mean = |k: usize| moments.iter().map(|moment| uneven.at(moment)[k]).sum::<f64>() / block.count as f64;
            block.beside = [0, 1, 2].map(mean);
            [block.growth, block.growth_seen, block.growth_of_mean] =
                walk.growths(before, moments.iter().map(Moment::reached));
            before = moments.last().map_or(before, Moment::reached).max(before);
        }
        if self.gyro.is_some() {
            let from = self.blocks.iter().map(|block| block.place);
            let from: Vec<Pose2> = self.blocks.first().map(|first| first.place).into_iter().chain(from).collect();
            for (block, before) in self.blocks.iter_mut().zip(from) {
                let wander = block.wandering(&before);
                [&mut block.growth, &mut block.growth_seen, &mut block.growth_of_mean]
                    .into_iter()
                    .for_each(|growth| growth.heading_by_gyro = wander);
            }
        }
        if self.relative {
            let velocities: Vec<[f64; 3]> = self.blocks.iter().map(|block| block.velocity).collect();
            let of = |k: usize| self.slope_step(k, &velocities[k], k.checked_sub(1).map(|k| &velocities[k]));
            let steps: Vec<[f64; 3]> = (0..velocities.len()).map(of).collect();
            self.blocks.iter_mut().zip(steps).for_each(|(block, step)| block.velocity = step);
        }
        self.lay_measured(chain);
    }

    /// Aligns the measured poses with the predicted ones where the run starts, unless START is trusted, and where it restarts: if they were
    /// rotated by degrees, a linear model of the rotation would be wrong.
    pub(super) fn lay_measured(&mut self, chain: &Chain<f64>) {
        let mut predicted = Vec::with_capacity(self.places.len());
        self.sighted(chain, &mut |_, pose| predicted.push(*pose));
        let mut laid = Pose2::IDENTITY;
        let mut seen = Vec::with_capacity(self.measured.len());
        for (index, block) in self.blocks.iter().enumerate() {
            if block.afresh || (index == 0 && self.start_seen) {
                laid = self.laid_at(block, &predicted, laid);
            }
            let own = &self.measured[block.first..block.first + block.count];
            seen.extend(own.iter().map(|(x, y, heading)| {
                let pose = laid.compose(&Pose2::new(*x, *y, heading.unwrap_or(0.0)));
                (pose.x, pose.y, heading.map(|_| pose.heading))
            }));
        }
        self.seen = seen.into();
        if self.is_linearised() {
            self.linearise(chain);
        }
    }

    /// Whether its residuals lack the terms of second order in heading errors, and so are those of the model about which it is laid only.
    pub(in crate::likelihood) fn is_linearised(&self) -> bool {
        self.linear && !self.relative
    }

    /// Removes from the residuals the terms of second order in heading errors, and what lies beside the arcs of the odometry ([`Uneven`]).
    ///
    /// Where the heading is off by θ(s), the robot stands off by ∫ (R(θ) - 1) dp, dp its predicted way: to first order ∫ θ J dp, which the
    /// filter and the columns contain, and to second order -½ ∫ θ² dp, which would look like wheels that are too large. θ² is taken as the
    /// product of two blocks, whose noise is independent. The term of this one model is subtracted, so the derivatives of the residuals of
    /// nearby models remain those of their predictions.
    fn linearise(&mut self, chain: &Chain<f64>) {
        let left = self.residuals_along(chain);
        let off = self.headings_off(&left);
        let mut seen = self.seen.to_vec();
        let (mut x, mut y) = (0.0, 0.0);
        for (index, block) in self.blocks.iter().enumerate() {
            if block.afresh || index == 0 {
                (x, y) = (0.0, 0.0);
            } else {
                let square = off[index - 1] * off[index];
                let (from, to) = (self.blocks[index - 1].place, block.place);
                let [aside_x, aside_y] = [0, 1].map(|k| block.beside[k] - self.blocks[index - 1].beside[k]);
                x += 0.5 * square * (to.x - from.x) - aside_x;
                y += 0.5 * square * (to.y - from.y) - aside_y;
            }
            for place in &mut seen[block.first..block.first + block.count] {
                (place.0, place.1) = (place.0 + x, place.1 + y);
                place.2 = place.2.map(|heading| heading - block.beside[2]);
            }
        }
        self.seen = seen.into();
    }

    /// Heading error of each block: as measured, else from the direction of motion around it, else that of the previous block.
    fn headings_off(&self, left: &Column) -> Vec<f64> {
        let mut last = 0.0;
        let of = |(index, block): (usize, &Block)| {
            let own = if block.headings > 0 { Some(left[index][2]) } else { self.course_off(left, index) };
            last = own.map_or(last, |own| own.clamp(-DRIFT, DRIFT));
            last
        };
        self.blocks.iter().enumerate().map(of).collect()
    }

    /// The turn from the predicted to the measured course around a block.
    fn course_off(&self, left: &Column, index: usize) -> Option<f64> {
        let at = self.blocks[index].place;
        let near = |i: &usize| {
            let place = self.blocks[*i].place;
            libm::hypot(place.x - at.x, place.y - at.y) <= 0.5 * WAY
        };
        let begun = (0..=index).rev().find(|i| self.blocks[*i].afresh).unwrap_or(0);
        let first = (begun..=index).rev().take_while(near).last().unwrap_or(index);
        let behind = (index + 1..self.blocks.len()).take_while(|i| !self.blocks[*i].afresh && near(i));
        let pair = |i: usize| {
            let (place, [x, y, _]) = (self.blocks[i].place, left[i]);
            ([place.x, place.y], [place.x + x, place.y + y])
        };
        turn_onto((first..=index).chain(behind).map(pair))
    }

    /// The motion that aligns the measured poses of a block with the predicted ones; `before` is that of the earlier poses.
    fn laid_at(&self, block: &Block, predicted: &[Pose2], before: Pose2) -> Pose2 {
        let own = block.first..block.first + block.count;
        let turned = self.measured[own.clone()].iter().zip(&predicted[own.clone()]);
        let turned = mean_angle(turned.filter_map(|((_, _, heading), pose)| Some(wrap(pose.heading - (*heading)?))));
        let turned = turned.or_else(|| self.course_behind(block, predicted)).unwrap_or(before.heading);
        let n = block.count as f64;
        let mean = |of: &dyn Fn(usize) -> f64| own.clone().map(of).sum::<f64>() / n;
        let (x, y) = (mean(&|i| self.measured[i].0), mean(&|i| self.measured[i].1));
        let (to_x, to_y) = (mean(&|i| predicted[i].x), mean(&|i| predicted[i].y));
        let there = Pose2::new(0.0, 0.0, turned).compose(&Pose2::new(x, y, 0.0));
        Pose2::new(to_x - there.x, to_y - there.y, turned)
    }

    /// The rotation that aligns the path after a block with the predicted one.
    fn course_behind(&self, block: &Block, predicted: &[Pose2]) -> Option<f64> {
        let first = block.first;
        let from = predicted[first];
        let near = |i: &usize| libm::hypot(predicted[*i].x - from.x, predicted[*i].y - from.y) <= WAY;
        let later = self.blocks.iter().find(|other| other.first > first && other.afresh);
        let until = later.map_or(predicted.len(), |block| block.first);
        let way: Vec<usize> = (first..until).take_while(near).collect();
        let pairs = way.iter().map(|i| (&self.measured[*i], &predicted[*i]));
        turn_onto(pairs.map(|((x, y, _), pose)| ([*x, *y], [pose.x, pose.y])))
    }
}

/// The rotation that aligns points best with others (Procrustes); `None` if all points coincide.
pub(crate) fn turn_onto(pairs: impl Iterator<Item = ([f64; 2], [f64; 2])> + Clone) -> Option<f64> {
    let n = pairs.clone().count() as f64;
    let mut middle = [0.0; 4];
    for (a, b) in pairs.clone() {
        middle = [middle[0] + a[0] / n, middle[1] + a[1] / n, middle[2] + b[0] / n, middle[3] + b[1] / n];
    }
    let (mut dot, mut cross, mut spread) = (0.0, 0.0, 0.0_f64);
    for ([ax, ay], [bx, by]) in pairs {
        let (ax, ay, bx, by) = (ax - middle[0], ay - middle[1], bx - middle[2], by - middle[3]);
        (dot, cross) = (dot + ax * bx + ay * by, cross + ax * by - ay * bx);
        spread = spread.max(libm::hypot(bx, by));
    }
    (spread > 0.1).then(|| libm::atan2(cross, dot))
}
