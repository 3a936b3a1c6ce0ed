//! References that tell only how the robot moved since the last measurement.
//!
//! Their poses are sums of steps, and so are the errors of these. What is observed is the motion from one block to the next, in the frame of
//! the former: with m the measured and p the predicted place, θ the measured less the predicted heading, and ' the former block,
//!
//! ```text
//! r = R(-θ') (m - m') - (p - p'),   ρ = θ - θ'
//! ```
//!
//! A heading that is wrong at the beginning of a step turns it, so a derivative c is seen as c - c' - c'_θ J (p - p').

use super::{Column, ObservedRun};
use crate::drive::Robot;
use crate::geometry::wrap;
use crate::run::TickLog;

/// Steps are added up until the robot has driven \[m\] or turned \[rad\] so much.
const APART: (f64, f64) = (0.03, 0.05);

/// Of some poses of a log, those between which the wheels rolled.
pub(super) fn apart(log: &TickLog, robot: &Robot, poses: &[usize]) -> Vec<usize> {
    let (per_tick, wheelbase) = (robot.metres_per_tick(), robot.drive.wheelbase());
    let ways = log.ways(robot);
    let (mut kept, mut way, mut turned, mut sample) = (Vec::new(), 0.0, 0.0, 0);
    for pose in poses {
        let until = log.reference[*pose].sample;
        while sample < until {
            let left = (log.left[sample + 1] - log.left[sample]) * per_tick.left;
            let right = (log.right[sample + 1] - log.right[sample]) * per_tick.right;
            way += ways[sample];
            turned += (right - left).abs() / wheelbase;
            sample += 1;
        }
        if kept.is_empty() || way >= APART.0 || turned >= APART.1 {
            kept.push(*pose);
            (way, turned) = (0.0, 0.0);
        }
    }
    kept
}

/// How many steps are added up to each of some poses; those of the first are none that is used.
pub(super) fn added_up(kept: &[usize]) -> Vec<f64> {
    let since = kept.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
    kept.first().map(|_| 1.0).into_iter().chain(since).collect()
}

impl ObservedRun {
    /// The residuals of a run as those of its steps, where its reference tells these only.
    pub(super) fn residual_steps(&self, left: Column) -> Column {
        if !self.relative {
            return left;
        }
        let of = |(k, own): (usize, &[f64; 3])| {
            if !self.has_step(k) {
                return [0.0; 3];
            }
            let before = left[k - 1];
            let [from, to] = [k - 1, k].map(|block| self.seen[self.blocks[block].first]);
            let (x, y) = (to.0 - from.0, to.1 - from.1);
            let (sine, cosine) = libm::sincos(before[2]);
            // What is predicted is what was measured less the residual.
            let (to_x, to_y) = (x - (own[0] - before[0]), y - (own[1] - before[1]));
            [cosine * x + sine * y - to_x, cosine * y - sine * x - to_y, wrap(own[2] - before[2])]
        };
        left.iter().enumerate().map(of).collect()
    }

    /// The derivatives of predicted poses as those of steps, where the reference tells these only.
    pub(super) fn slope_steps(&self, column: Column) -> Column {
        if !self.relative {
            return column;
        }
        column
            .iter()
            .enumerate()
            .map(|(k, own)| self.slope_step(k, own, k.checked_sub(1).map(|k| &column[k])))
            .collect()
    }

    /// The derivative of a step by those of the poses at its end and at its beginning.
    pub(super) fn slope_step(&self, k: usize, own: &[f64; 3], before: Option<&[f64; 3]>) -> [f64; 3] {
        let Some(before) = before.filter(|_| self.has_step(k)) else { return [0.0; 3] };
        let (from, to) = (&self.blocks[k - 1].place, &self.blocks[k].place);
        let (x, y) = (to.x - from.x, to.y - from.y);
        [own[0] - before[0] + before[2] * y, own[1] - before[1] - before[2] * x, own[2] - before[2]]
    }

    /// Whether the motion from the block before to this one was observed.
    pub(crate) fn has_step(&self, block: usize) -> bool {
        block > 0 && !self.blocks[block].afresh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Model, TestKind};
    use crate::geometry::Pose2;
    use crate::likelihood::Observed;
    use crate::likelihood::watched::watched;

    /// Runs of which only steps are told, by a sensor that turns 2 mrad too far in each: its track is soon turned by a radian.
    fn stepped(model: &Model) -> Observed {
        let mut data = watched(model, 1, 3);
        for log in data.runs.iter_mut().filter_map(|run| run.log.as_mut()) {
            let exact = log.reference.clone();
            let mut at = Pose2::new(exact[0].x, exact[0].y, exact[0].heading.unwrap());
            for (pose, pair) in log.reference.iter_mut().skip(1).zip(exact.windows(2)) {
                let [from, to] = [0, 1].map(|k| Pose2::new(pair[k].x, pair[k].y, pair[k].heading.unwrap()));
                at = at.compose(&from.between(&to)).compose(&Pose2::new(0.0, 0.0, 2e-3));
                (pose.x, pose.y, pose.heading) = (at.x, at.y, Some(at.heading));
            }
            log.relative = true;
        }
        assert!(data.runs.iter().all(|run| run.test == TestKind::Systematic));
        Observed::new(&data, model.robot()).unwrap()
    }

    #[test]
    fn derivatives_of_steps_are_those_of_finite_differences_of_their_residuals() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for effect in ["wheel_diameter_ratio", "wheelbase", "scale", "marker_offset", "marker_yaw"] {
            model.add(effect).unwrap().free = true;
        }
        let observed = stepped(&model).along(&model);
        let values: Vec<f64> = model.values().collect();
        let places: Vec<usize> = (0..values.len()).collect();
        let columns = observed.columns(&model, &places);
        for (run, columns) in observed.runs.iter().zip(&columns) {
            assert!(run.relative && run.blocks.len() > 100);
            for (place, column) in places.iter().zip(columns) {
                let at =
                    |by: f64| run.residuals(&model.with_values(&[*place], &[values[*place] + by]).unwrap().chain());
                let (high, low) = (at(1e-5), at(-1e-5));
                let (left, mut turned) = (run.residuals(&model.chain()), 1.0_f64);
                for (k, own) in column.iter().enumerate() {
                    // A heading that is wrong turns also what the step leaves, which the derivative neglects.
                    let neglected = turned.abs() * libm::hypot(left[k][0], left[k][1]);
                    turned += own[2].abs();
                    for c in 0..3 {
                        let numeric = -(high[k][c] - low[k][c]) / 2e-5;
                        assert!(
                            (own[c] - numeric).abs() < 1e-3 + neglected,
                            "value {place}, block {k}: {own:?} {numeric}"
                        );
                    }
                }
            }
        }
    }
}
