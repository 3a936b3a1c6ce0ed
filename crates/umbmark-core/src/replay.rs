//! From wheel travel to poses: the measurements that a model predicts for an absolute reference.
//!
//! ```text
//! recorded ticks --+
//!                  +--> believed wheel travel -> [wheels] -> kinematics -> [body] -> predicted pose
//! commanded moves -+
//! ```
//!
//! The effects are those of [`effect`](crate::effect), the same that simulate. With `f64` a replay gives poses; with
//! [`Dual`](crate::geometry::Dual) it gives poses and columns of their Jacobian, [`LANES`](crate::geometry::LANES) at once. Each
//! sample is an exact arc.

mod behind;
mod error;
mod formulas;
mod making;
mod moment;
mod pace;
mod prediction;
mod track;

pub use error::ReplayError;
pub use formulas::check_on_path;
pub use moment::Moment;
pub use track::Track;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::{ReferencePose, TickLog};
    use crate::drive::{Robot, WheelTravel};
    use crate::effect::{Formula, Model, Target};
    use crate::geometry::seeded;
    use crate::path::{Direction, Path};
    use std::f64::consts::{FRAC_PI_2, PI};

    /// 1 m wheel circumference, 1000 ticks a turn: a millimetre a tick; wheelbase 0.5 m.
    fn robot() -> Robot {
        use crate::drive::{DifferentialDrive, Encoder};
        let drive = DifferentialDrive::new(0.5, 1.0 / PI, 1.0 / PI).unwrap().into();
        Robot { name: "round numbers".into(), drive, encoder: Encoder::new(1000.0, None, None).unwrap() }
    }

    fn seen(sample: usize) -> ReferencePose {
        ReferencePose { sample, x: 0.0, y: 0.0, heading: None }
    }

    fn log(left: &[f64], right: &[f64], reference: Vec<ReferencePose>) -> TickLog {
        let time = (0..left.len()).map(|i| i as f64).collect();
        TickLog { time, left: left.to_vec(), right: right.to_vec(), reference, ..TickLog::default() }
    }

    /// Straight 2 m, a quarter turn to the left on the spot, straight 1 m; still samples between.
    fn corner() -> TickLog {
        let quarter = 1000.0 * 0.5 * FRAC_PI_2 / 2.0;
        log(
            &[0.0, 2000.0, 2000.0, 2000.0 - quarter, 2000.0 - quarter, 3000.0 - quarter],
            &[0.0, 2000.0, 2000.0, 2000.0 + quarter, 2000.0 + quarter, 3000.0 + quarter],
            [0, 1, 2, 2, 4, 5].map(seen).to_vec(),
        )
    }

    #[test]
    fn poses_belong_to_the_samples_of_their_references_through_standstill_and_repeats() {
        let track = Track::from_log(&corner(), &robot()).unwrap();
        let poses = track.poses(&Model::new(&robot()).chain());
        let expected = [
            (0.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (2.0, 0.0, FRAC_PI_2),
            (2.0, 1.0, FRAC_PI_2),
        ];
        assert_eq!(poses.len(), expected.len());
        for (pose, (x, y, heading)) in poses.iter().zip(expected) {
            assert!((pose.x - x).abs() < 1e-12 && (pose.y - y).abs() < 1e-12 && (pose.heading - heading).abs() < 1e-12);
        }
        assert_eq!(track.travel().iter().filter(|t| **t != WheelTravel::default()).count(), 3);
        assert!((track.length() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn one_sample_of_an_arc_is_exact_to_the_right_as_to_the_left() {
        for sign in [1.0, -1.0] {
            // Half a circle of radius 1 m: wheels at 0.75 and 1.25 m from its centre.
            let (inner, outer) = (1000.0 * 0.75 * PI, 1000.0 * 1.25 * PI);
            let (left, right) = if sign > 0.0 { (inner, outer) } else { (outer, inner) };
            let track = Track::from_log(&log(&[left], &[right], vec![seen(0)]), &robot()).unwrap();
            let end = track.end(&Model::new(&robot()).chain());
            assert!(end.x.abs() < 1e-12 && (end.y - sign * 2.0).abs() < 1e-12, "{end:?}");
        }
    }

    #[test]
    fn the_jacobian_is_that_of_finite_differences_at_every_observation() {
        let robot = robot();
        let mut model = Model::new(&robot);
        for (effect, parameter, value) in
            [("wheel_diameter_ratio", "e_d", 1.01), ("wheelbase", "e_b", 0.98), ("scale", "e_s", 1.02)]
        {
            model.set(effect, parameter, value).unwrap();
        }
        let values: Vec<f64> = model.values().collect();
        for track in [
            Track::from_log(&corner(), &robot).unwrap(),
            Track::from_path(&Path::umbmark(), Direction::Cw, &robot),
            Track::from_path(&Path::umbmark(), Direction::Ccw, &robot),
        ] {
            for i in 0..values.len() {
                let exact = track.poses(&model.chain_with(&seeded(values.iter().copied(), &[i])));
                let at = |step: f64| {
                    let mut moved = values.clone();
                    moved[i] += step;
                    track.poses(&model.chain_with(&moved))
                };
                let h = 1e-5;
                for (k, (high, low)) in at(h).iter().zip(at(-h)).enumerate() {
                    let numeric = [high.x - low.x, high.y - low.y, high.heading - low.heading].map(|d| d / (2.0 * h));
                    let column = [exact[k].x, exact[k].y, exact[k].heading].map(|d| d.eps[0]);
                    for (c, n) in column.iter().zip(numeric) {
                        assert!((c - n).abs() < 1e-6 * (1.0 + n.abs()), "parameter {i}, observation {k}: {c} {n}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_replay_of_duals_has_the_same_bits_in_registers_of_every_width() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        for effect in ["wheel_diameter_ratio", "wheel_eccentricity_left", "crab", "caster_kick", "floor_slope_yaw"] {
            model.add(effect).unwrap();
        }
        let formula = Formula::new("own", Target::ForwardScale, "k * sin(x / l) * y", &["k", "l"]).unwrap();
        model.add_formula(formula, &[0.01, 2.0]).unwrap();
        let chain = model.chains(&[0, 1, 2, 3, 4, 5, 6, 7]).next().unwrap().0;
        for direction in Direction::BOTH {
            let track = Track::in_pieces(&Path::umbmark(), direction, &robot);
            let all = || (chain.start(), 0..track.travel.len());
            let ((from, pieces), (start, same)) = (all(), all());
            assert_eq!(track.drive(&chain, from, pieces), track.drive_plainly(&chain, start, same));
        }
    }

    #[test]
    fn impossible_logs_are_refused_with_the_offending_value() {
        let refuse = |log: &TickLog| Track::from_log(log, &robot()).unwrap_err().to_string();
        assert!(refuse(&log(&[0.0, 1.0], &[0.0], vec![])).contains("got 2, 2 and 1"));
        assert!(refuse(&log(&[0.0, f64::NAN], &[0.0, 1.0], vec![])).contains("sample 1 must be finite, got left NaN"));
        assert!(refuse(&log(&[0.0], &[0.0], vec![seen(1)])).contains("reference pose 0 belongs to sample 1"));
        assert!(refuse(&log(&[0.0, 1.0], &[0.0, 1.0], vec![seen(1), seen(0)])).contains("reference pose 1"));
    }
}
