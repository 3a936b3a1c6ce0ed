use super::*;
use crate::drive::Robot;
use crate::likelihood::Observed;
use crate::likelihood::watched::watched;
use crate::random::Stream;

/// A robot with six effects that act on motion, two of them placed in the room.
fn model_of_six(robot: &Robot) -> Model {
    let mut model = Model::new(robot);
    for (effect, parameter, value) in [
        ("wheel_diameter_ratio", "e_d", 1.002),
        ("wheelbase", "e_b", 0.99),
        ("scale", "e_s", 1.003),
        ("crab", "angle_rad", 0.004),
        ("turn_slip", "share", 0.01),
        ("floor_slope", "drift_x", 0.004),
    ] {
        model.set(effect, parameter, value).unwrap();
    }
    model
}

#[test]
fn corrected_poses_are_those_that_compare_predicts_to_the_last_bit() {
    let robot = Robot::labmate();
    let model = model_of_six(&robot);
    let data = watched(&model, 2, 5);
    let observed = Observed::new(&data, &robot).unwrap().along(&model);
    let corrected = apply_to_all(&data, &model, None, Pose2::IDENTITY).unwrap();
    assert_eq!((observed.runs.len(), corrected.len()), (4, 4));
    for ((run, corrected), seen) in corrected.iter().zip(&observed.runs) {
        let log = run.log.as_ref().unwrap();
        let ours: Vec<Pose2> = log.reference.iter().map(|pose| corrected.poses[pose.sample]).collect();
        assert!(ours.len() > 100);
        assert_eq!(ours, seen.track.poses(&model.chain()));
        assert_eq!(ours, seen.places[..]);
    }
}

#[test]
fn what_belongs_to_the_reference_does_nothing_and_start_turns_and_moves_the_way() {
    let robot = Robot::labmate();
    let data = watched(&Model::new(&robot), 1, 5);
    let log = data.runs[0].log.as_ref().unwrap();
    let model = model_of_six(&robot);
    let plain = apply(log, &model, None, Pose2::IDENTITY, RunContext::default()).unwrap();
    let mut seen = model.clone();
    for (effect, parameter, value) in
        [("reference_delay", "delay_s", 0.1), ("marker_offset", "left_m", 0.1), ("marker_yaw", "yaw_rad", 0.1)]
    {
        seen.set(effect, parameter, value).unwrap();
    }
    assert_eq!(apply(log, &seen, None, Pose2::IDENTITY, RunContext::default()).unwrap(), plain);
    let mut flat = Model::new(&robot);
    flat.set("scale", "e_s", 1.003).unwrap();
    let start = Pose2::new(1.0, -2.0, 0.5);
    let here = apply(log, &flat, None, Pose2::IDENTITY, RunContext::default()).unwrap();
    let there = apply(log, &flat, None, start, RunContext::default()).unwrap();
    for (here, there) in here.poses.iter().zip(&there.poses) {
        let moved = start.compose(here);
        assert!((moved.x - there.x).abs() < 1e-9 && (moved.y - there.y).abs() < 1e-9, "{moved:?} {there:?}");
    }
    // A slope stays where it is in the room while START turns.
    let turned = apply(log, &model, None, start, RunContext::default()).unwrap();
    let (slid, end) = (start.compose(plain.poses.last().unwrap()), turned.poses.last().unwrap());
    assert!((slid.x - end.x).hypot(slid.y - end.y) > 1e-3);
}

/// Oracle: 4000 drives whose heading and way wander by the noise; seed 3. A covariance within 8 % of what they show.
#[test]
fn the_covariance_is_that_of_drives_with_the_noise() {
    let robot = Robot::labmate();
    let data = watched(&Model::new(&robot), 1, 5);
    let log = data.runs[0].log.as_ref().unwrap();
    let noise = Noise {
        heading_per_metre: 2e-3,
        heading_per_radian: 1e-3,
        forward_per_metre: 1e-3,
        sideways_per_metre: 5e-4,
        ..Noise::silent()
    };
    let model = Model::new(&robot);
    let corrected = apply(log, &model, Some(&noise), Pose2::IDENTITY, RunContext::default()).unwrap();
    let track = Track::from_log(log, &robot).unwrap();
    let chain = model.chain();
    let (draws, end) = (4000, *corrected.poses.last().unwrap());
    let mut sums = [0.0; 6];
    for draw in 0..draws {
        let mut stream = Stream::new(3, 0, draw);
        let mut pose = Pose2::IDENTITY;
        for (travel, at) in track.travel().iter().zip(track.contexts()) {
            let mut motion = chain.displacement(&at.as_believed(), travel);
            let (way, turned, rolled) = (motion.forward.abs(), motion.rotation.abs(), travel.rolled());
            motion.forward += noise.forward_per_metre * rolled.sqrt() * stream.normal();
            motion.sideways += noise.sideways_per_metre * rolled.sqrt() * stream.normal();
            motion.rotation += noise.heading_per_metre * way.sqrt() * stream.normal()
                + noise.heading_per_radian * turned.sqrt() * stream.normal();
            pose.advance(&motion);
        }
        let [x, y, h] = [pose.x - end.x, pose.y - end.y, pose.heading - end.heading];
        for (sum, product) in sums.iter_mut().zip([x * x, x * y, y * y, x * h, y * h, h * h]) {
            *sum += product / draws as f64;
        }
    }
    let found = corrected.spread.unwrap().last().unwrap().numbers();
    let scale = [
        found[0],
        (found[0] * found[2]).sqrt(),
        found[2],
        (found[0] * found[5]).sqrt(),
        (found[2] * found[5]).sqrt(),
        found[5],
    ];
    for ((found, sum), scale) in found.iter().zip(sums).zip(scale) {
        assert!((found - sum).abs() < 0.08 * scale, "{found} {sum}");
    }
}
