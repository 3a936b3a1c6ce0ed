//! A CLAPPER under way: two trucks that steer by their odometry, and the link that corrects it.
//!
//! On legs the trucks drive one behind the other; in a corner both turn across the link, drive it round about its middle, and turn back.
//! The rule of the correction (our reconstruction of Borenstein's internal position error correction): a bump turns a truck at once, while
//! its position goes wrong only slowly, as it drives on. So for a short time the direction from truck to truck, by both odometries, is
//! reliable, and each truck's heading is that direction minus the angle of its rotary encoder to the link. Of a heading error δ, only the
//! sideways step δ · (distance per period)/2 over the link length remains.
//!
//! The linear encoder of the link corrects the distance between both odometries. Without it, a relative length error a, which a bump can
//! cause, would rotate the believed direction by a · φ in a corner of φ: 2πa per round.
//!
//! The same loop simulates (values, noise, bumps, whole counts) and predicts (values or derivatives, without noise): only the [`Floor`]
//! differs.

use crate::drive::{ClapperDrive, LinkReading, Robot, WheelTravel};
use crate::effect::{Chain, Context, Evaluate, Progress, RunContext};
use crate::geometry::{Displacement2, Pose2, Real, direction, wrap};
use crate::path::{Direction, Move, Path, SpeedProfile, Trapezoid};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Default rate at which odometry and link are read \[Hz\].
const RATE: f64 = 25.0;
/// Share of a heading error that is steered away in a period.
const HEADING_GAIN: f64 = 0.2;
/// Look-ahead distance of a truck that is beside its path \[m\].
const LOOK_AHEAD: f64 = 0.5;

/// The commands of both trucks for a period, the front one first.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvoyStep {
    /// Number of the move of the path.
    pub index: usize,
    /// Share of that move's own way done before and at the end of it.
    pub shares: [f64; 2],
    /// Time since START at its end \[s\].
    pub time: f64,
    /// Context of the commanded motion of each truck.
    pub contexts: [Context; 2],
    /// Commanded wheel travel of each truck.
    pub travel: [WheelTravel; 2],
    /// Speeds of each truck's wheels at its end \[m/s\].
    pub speeds: [[f64; 2]; 2],
    motion: [Displacement2; 2],
    /// Their planned poses at its end.
    target: [Pose2; 2],
}

/// Believed and true poses of both trucks.
#[derive(Clone, Copy, Debug)]
pub struct Trucks<T = f64> {
    /// By their own odometry.
    pub believed: [Pose2<T>; 2],
    /// Really.
    pub real: [Pose2<T>; 2],
}

/// Turns believed travel into true motion, and the link into readings.
pub trait Floor<T: Real> {
    /// True motion of a truck with this believed travel and true pose.
    fn moved(&mut self, step: &ConvoyStep, truck: usize, believed: WheelTravel<T>, real: &Pose2<T>)
    -> Displacement2<T>;

    /// The reading of the link's encoders.
    fn shown(&mut self, link: LinkReading<T>) -> LinkReading<T>;
}

/// The predicted floor: a model without noise, applied to the travel of the trucks and to their link.
#[derive(Debug)]
pub struct Predicted<'a, T: Evaluate> {
    chain: &'a Chain<T>,
}

impl<'a, T: Evaluate> Predicted<'a, T> {
    /// By the model of this chain.
    pub fn by(chain: &'a Chain<T>) -> Predicted<'a, T> {
        Predicted { chain }
    }
}

impl<T: Evaluate> Floor<T> for Predicted<'_, T> {
    #[inline]
    fn moved(
        &mut self,
        step: &ConvoyStep,
        truck: usize,
        believed: WheelTravel<T>,
        real: &Pose2<T>,
    ) -> Displacement2<T> {
        let at = step.contexts[truck].at_pose(real);
        self.chain.body(&at, &self.chain.rolled(&at, believed))
    }

    #[inline]
    fn shown(&mut self, link: LinkReading<T>) -> LinkReading<T> {
        self.chain.link(link)
    }
}

/// The plan of one direction of driving.
#[derive(Clone, Debug, PartialEq)]
pub struct Convoy {
    drive: ClapperDrive,
    steps: Vec<ConvoyStep>,
    /// Number of steps completed at the end of each move of the path.
    stops: Vec<usize>,
}

impl Convoy {
    /// The plan of a CLAPPER; `None` for other drives, and for paths with arcs.
    pub fn new(robot: &Robot, path: &Path, direction: Direction) -> Option<Convoy> {
        let drive = *robot.drive.trucks()?;
        let place = RunContext { direction: Some(direction), ..RunContext::default() };
        let mut planner = Planner {
            drive,
            speed: path.speed,
            period: 1.0 / robot.encoder.rate().unwrap_or(RATE),
            progress: [0, 1].map(|_| place.progress(robot, false)),
            target: at_start(drive.link()),
            steps: Vec::new(),
        };
        let mut stops = Vec::new();
        for (index, one) in path.moves(direction).into_iter().enumerate() {
            for motion in maneuvers(one, drive.link())? {
                planner.cut(index, motion);
            }
            planner.rest();
            stops.push(planner.steps.len());
        }
        Some(Convoy { drive, steps: planner.steps, stops })
    }

    /// What the trucks do, period by period.
    pub fn steps(&self) -> &[ConvoyStep] {
        &self.steps
    }

    /// Number of steps completed at the end of each move of the path.
    pub fn stops(&self) -> &[usize] {
        &self.stops
    }

    /// Planned poses of both trucks after `made` steps.
    pub fn meant(&self, made: usize) -> [Pose2; 2] {
        made.checked_sub(1).map_or_else(|| at_start(self.drive.link()), |last| self.steps[last].target)
    }

    /// Whether the link corrects the headings.
    pub fn corrects(&self) -> bool {
        self.drive.corrects()
    }

    /// Both trucks at START: the true pose of the front one is `start`, and the rear one is behind it by the true length of the link, for
    /// which the linear encoder shows the nominal length.
    pub fn at_start<T: Real>(&self, start: Pose2<T>, floor: &mut impl Floor<T>) -> Trucks<T> {
        let link = T::from(self.drive.link());
        let shown = floor.shown(LinkReading { length: link, angles: [T::from(0.0); 2] }).length;
        let rear = Pose2::new(-(link * link / shown), T::from(0.0), T::from(0.0));
        let believed = at_start(self.drive.link()).map(|pose| pose.lift());
        Trucks { believed, real: [start, start.compose(&rear)] }
    }

    /// Drives a period.
    #[inline]
    pub fn step<T: Real>(&self, step: &ConvoyStep, trucks: &mut Trucks<T>, floor: &mut impl Floor<T>) {
        self.roll(step, trucks, floor);
        if self.drive.corrects() {
            self.correct(trucks, floor);
        }
    }

    /// Both trucks roll, each by its own odometry.
    #[inline]
    pub(crate) fn roll<T: Real>(&self, step: &ConvoyStep, trucks: &mut Trucks<T>, floor: &mut impl Floor<T>) {
        for truck in 0..2 {
            let (motion, travel) = self.steered(&trucks.believed[truck], step, truck);
            let moved = floor.moved(step, truck, travel, &trucks.real[truck]);
            trucks.real[truck] = trucks.real[truck].moved(&moved);
            trucks.believed[truck] = trucks.believed[truck].moved(&motion);
        }
    }

    /// The commanded motion of a truck, the planned one plus a correction towards the plan, and its wheel travel.
    #[inline]
    fn steered<T: Real>(
        &self,
        believed: &Pose2<T>,
        step: &ConvoyStep,
        truck: usize,
    ) -> (Displacement2<T>, WheelTravel<T>) {
        let (planned, target) = (&step.motion[truck], &step.target[truck].lift());
        let ahead = believed.between(target);
        let (mut forward, mut off) = (T::from(0.0), wrapped(ahead.heading - planned.rotation));
        if planned.forward != 0.0 {
            forward = ahead.x;
            off += ahead.y * (planned.forward.signum() / LOOK_AHEAD);
        }
        let rotation = off * HEADING_GAIN + planned.rotation;
        let half = rotation * (0.5 * self.drive.truck().wheelbase());
        let motion = Displacement2 { forward, sideways: T::from(0.0), rotation };
        (motion, WheelTravel { left: forward - half, right: forward + half })
    }

    /// Sets the distance of the trucks to the measured length of the link, half of the difference each, and gives each the heading that
    /// follows from its angle to the link.
    #[inline]
    pub(crate) fn correct<T: Real>(&self, trucks: &mut Trucks<T>, floor: &mut impl Floor<T>) {
        let (along, across) = from_rear(&trucks.real);
        let there = direction(across, along);
        let link = LinkReading {
            length: root(along * along + across * across),
            angles: trucks.real.map(|truck| wrapped(there - truck.heading)),
        };
        let seen = self.drive.reckoned(floor.shown(link));
        let (along, across) = from_rear(&trucks.believed);
        let expected = direction(across, along);
        let share = (-(seen.length / root(along * along + across * across)) + 1.0) * 0.5;
        let [front, rear] = &mut trucks.believed;
        front.x -= along * share;
        front.y -= across * share;
        rear.x += along * share;
        rear.y += across * share;
        for (truck, angle) in trucks.believed.iter_mut().zip(seen.angles) {
            truck.heading += wrapped(expected - angle - truck.heading);
        }
    }
}

/// The root of a number above 0.
#[inline]
fn root<T: Real>(square: T) -> T {
    let value = square.value().sqrt();
    square.mapped(value, 0.5 / value)
}

/// An angle with a whole number of turns taken off, so that it lies within half a turn of zero.
#[inline]
fn wrapped<T: Real>(angle: T) -> T {
    let value = angle.value();
    if value.abs() <= PI { angle } else { angle - ((value - wrap(value)) / TAU).round() * TAU }
}

/// The front truck's place as seen from the rear one's, in the axes of the room.
#[inline]
fn from_rear<T: Real>([front, rear]: &[Pose2<T>; 2]) -> (T, T) {
    (front.x - rear.x, front.y - rear.y)
}

/// Both trucks at START, the front one at the origin.
fn at_start(link: f64) -> [Pose2; 2] {
    [Pose2::IDENTITY, Pose2::new(-link, 0.0, 0.0)]
}

/// What both trucks do for a move of the vehicle, one after the other; `None` for arcs and for moves to the side.
fn maneuvers(one: Move, link: f64) -> Option<Vec<[Displacement2; 2]>> {
    let motion = |forward: f64, rotation: f64| Displacement2 { forward, sideways: 0.0, rotation };
    match one {
        Move::Straight { length } => Some(vec![[motion(length, 0.0); 2]]),
        Move::Turn { angle } => {
            let across = FRAC_PI_2.copysign(angle);
            let round = motion(0.5 * link * angle.abs(), angle);
            Some(vec![
                [motion(0.0, across), motion(0.0, -across)],
                [round; 2],
                [motion(0.0, -across), motion(0.0, across)],
            ])
        }
        Move::Arc { .. } | Move::Slide { .. } => None,
    }
}

/// A plan as it is made.
struct Planner {
    drive: ClapperDrive,
    speed: SpeedProfile,
    period: f64,
    progress: [Progress; 2],
    target: [Pose2; 2],
    steps: Vec<ConvoyStep>,
}

impl Planner {
    /// Cuts a maneuver into periods, from rest to rest.
    fn cut(&mut self, index: usize, motion: [Displacement2; 2]) {
        let whole = motion.map(|m| self.drive.truck().wheel_travel(m.forward, m.rotation));
        let most = whole.iter().map(|travel| travel.left.abs().max(travel.right.abs())).fold(0.0, f64::max);
        let profile = self.speed.over(most);
        let periods = (profile.duration() / self.period).ceil().max(1.0) as usize;
        let mut done = 0.0;
        for k in 1..=periods {
            let share = if k == periods { 1.0 } else { profile.fraction(k as f64 * self.period) };
            self.step(index, [done, share], motion, whole, &profile, k);
            done = share;
        }
    }

    fn step(
        &mut self,
        index: usize,
        shares: [f64; 2],
        motion: [Displacement2; 2],
        whole: [WheelTravel; 2],
        profile: &Trapezoid,
        k: usize,
    ) {
        let part = shares[1] - shares[0];
        let motion =
            motion.map(|m| Displacement2 { forward: m.forward * part, sideways: 0.0, rotation: m.rotation * part });
        self.target = [0, 1].map(|truck| self.target[truck].moved(&motion[truck]));
        let travel = whole.map(|travel| travel.scaled(part));
        let [from, to] = [k - 1, k].map(|k| {
            let rate = profile.rate(k as f64 * self.period);
            whole.map(|travel| [travel.left * rate, travel.right * rate])
        });
        let contexts = [0, 1].map(|truck| {
            let at = self.progress[truck].piece(&travel[truck], self.period, from[truck], to[truck]);
            Context { truck: truck as f64, ..at }
        });
        let time = self.progress[0].time();
        self.steps.push(ConvoyStep { index, shares, time, contexts, travel, speeds: to, motion, target: self.target });
    }

    /// The pause after a move.
    fn rest(&mut self) {
        for progress in &mut self.progress {
            progress.piece(&WheelTravel::default(), self.speed.pause(), [0.0; 2], [0.0; 2]);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::drive::{DifferentialDrive, Encoder};
    use crate::path::{CIRCLE, RECTANGLE};

    /// The CLAPPER with exact angles.
    pub(crate) fn clapper(correction: bool) -> Robot {
        let truck = DifferentialDrive::new(0.34, 0.15, 0.15).unwrap();
        let drive = ClapperDrive::new(truck, 1.0, 1e9, correction).unwrap();
        let encoder = Encoder::new(2000.0, Some(25.0), None).unwrap();
        Robot { name: "CLAPPER".into(), drive: drive.into(), encoder }
    }

    /// The way that it was tested on.
    pub(crate) fn path() -> Path {
        Path::new(&RECTANGLE, &[7.0, 4.0], SpeedProfile::new(0.45, 0.45, 0.0).unwrap()).unwrap()
    }

    #[test]
    fn the_plan_closes_and_keeps_the_link_straight_on_legs_and_at_its_length_in_corners() {
        for direction in Direction::BOTH {
            let convoy = Convoy::new(&clapper(true), &path(), direction).unwrap();
            let [front, rear] = convoy.steps.last().unwrap().target;
            assert!(front.x.abs() < 1e-9 && front.y.abs() < 1e-9 && (rear.x + 1.0).abs() < 1e-9 && rear.y.abs() < 1e-9);
            for step in &convoy.steps {
                let (along, across) = from_rear(&step.target);
                assert!((libm::hypot(along, across) - 1.0).abs() < 1e-9, "{step:?}");
            }
            assert_eq!(convoy.stops.len(), 8);
            assert!((convoy.meant(convoy.stops[0])[0].x - 7.0).abs() < 1e-9);
        }
    }

    #[test]
    fn arcs_and_other_drives_have_no_plan() {
        let circle = Path::new(&CIRCLE, &[2.0, 1.0], SpeedProfile::default()).unwrap();
        assert!(Convoy::new(&clapper(true), &circle, Direction::Ccw).is_none() && !circle.suits(&clapper(true)));
        assert!(Convoy::new(&Robot::labmate(), &path(), Direction::Ccw).is_none() && path().suits(&clapper(true)));
    }

    /// A floor on which true motion and odometry agree.
    struct Even;

    impl Floor<f64> for Even {
        fn moved(&mut self, _: &ConvoyStep, _: usize, believed: WheelTravel, _: &Pose2) -> Displacement2 {
            let truck = DifferentialDrive::new(0.34, 0.15, 0.15).unwrap();
            truck.displacement(&believed)
        }

        fn shown(&mut self, link: LinkReading) -> LinkReading {
            link
        }
    }

    fn gap(a: &Pose2, b: &Pose2) -> f64 {
        libm::hypot(a.x - b.x, a.y - b.y).max(wrap(a.heading - b.heading).abs())
    }

    /// Round a corner each truck steers along the chords of its arc, a fraction of a millimetre inside.
    #[test]
    fn on_an_even_floor_both_trucks_are_where_they_believe_and_where_the_plan_says() {
        for (correction, direction) in [(true, Direction::Ccw), (true, Direction::Cw), (false, Direction::Ccw)] {
            let convoy = Convoy::new(&clapper(correction), &path(), direction).unwrap();
            assert_eq!(convoy.corrects(), correction);
            let mut trucks = convoy.at_start(Pose2::IDENTITY, &mut Even);
            for (made, step) in convoy.steps().iter().enumerate() {
                convoy.step(step, &mut trucks, &mut Even);
                let most = if made < convoy.stops()[0] { 1e-9 } else { 2e-3 };
                for (meant, (believed, real)) in
                    convoy.meant(made + 1).iter().zip(trucks.believed.iter().zip(&trucks.real))
                {
                    assert!(gap(believed, real) < 1e-9, "{correction} {made}: {believed:?} {real:?}");
                    assert!(gap(meant, real) < most, "{correction} {made}: {meant:?} {real:?}");
                }
            }
        }
    }

    /// Oracle: beside its way a truck heads for it half a metre ahead, so its distance falls by e in as much.
    #[test]
    fn a_truck_beside_its_way_comes_back_to_it_within_metres_and_a_wrong_heading_in_periods() {
        let convoy = Convoy::new(&clapper(false), &path(), Direction::Ccw).unwrap();
        for (sideways, heading) in [(0.05, 0.0), (-0.05, 0.0), (0.0, 0.1), (0.02, -0.1)] {
            let mut trucks = convoy.at_start(Pose2::IDENTITY, &mut Even);
            for truck in 0..2 {
                trucks.believed[truck].y += sideways;
                trucks.believed[truck].heading += heading;
                trucks.real[truck] = trucks.believed[truck];
            }
            let leg = convoy.stops()[0];
            let mut worst = [0.0_f64; 2];
            for (made, step) in convoy.steps()[..leg].iter().enumerate() {
                convoy.step(step, &mut trucks, &mut Even);
                for (meant, believed) in convoy.meant(made + 1).iter().zip(&trucks.believed) {
                    let way = meant.x - convoy.meant(0)[0].x;
                    worst[usize::from(way > 3.0)] = worst[usize::from(way > 3.0)].max((believed.y - meant.y).abs());
                }
            }
            assert!(worst[0] < 0.07 && worst[1] < 0.05 * worst[0], "{sideways} {heading}: {worst:?}");
            for (meant, believed) in convoy.meant(leg).iter().zip(&trucks.believed) {
                assert!(gap(meant, believed) < 1e-3, "{sideways} {heading}: {meant:?} {believed:?}");
            }
        }
    }

    /// What the link shows of two trucks, by trigonometry.
    fn seen([front, rear]: &[Pose2; 2]) -> (f64, [f64; 2]) {
        let (along, across) = (front.x - rear.x, front.y - rear.y);
        let there = libm::atan2(across, along);
        (libm::hypot(along, across), [front, rear].map(|truck| wrap(there - truck.heading)))
    }

    #[test]
    fn the_correction_believes_what_the_link_shows_about_the_middle_and_the_direction_believed_before() {
        let convoy = Convoy::new(&clapper(true), &path(), Direction::Ccw).unwrap();
        for [x, y, front, rear, turn] in
            [[0.02, 0.3, 0.1, -0.2, 0.0], [-0.04, -0.7, 3.0, 2.0, 1.0], [0.0, 0.1, -2.0, 0.4, 40.0]]
        {
            let believed = [Pose2::new(1.0 + x, 2.0 + y, front + turn), Pose2::new(x, 1.7, rear + turn)];
            let real = [Pose2::new(1.1, 2.0 - y, front - 0.3), Pose2::new(0.1, 1.8, rear + 0.2)];
            let mut trucks = Trucks { believed, real };
            convoy.correct(&mut trucks, &mut Even);
            let ((length, angles), (shown, shown_angles)) = (seen(&trucks.believed), seen(&real));
            assert!((length - shown).abs() < 1e-12, "{length} {shown}");
            assert!(
                angles.iter().zip(shown_angles).all(|(a, b)| wrap(a - b).abs() < 1e-12),
                "{angles:?} {shown_angles:?}"
            );
            let middle = |[a, b]: &[Pose2; 2]| [0.5 * (a.x + b.x), 0.5 * (a.y + b.y)];
            let there = |[a, b]: &[Pose2; 2]| libm::atan2(a.y - b.y, a.x - b.x);
            assert!(middle(&believed).iter().zip(middle(&trucks.believed)).all(|(a, b)| (a - b).abs() < 1e-12));
            assert!(wrap(there(&believed) - there(&trucks.believed)).abs() < 1e-12);
            // Headings count turns on: none jumps by more than half of one.
            assert!(trucks.believed.iter().zip(&believed).all(|(a, b)| (a.heading - b.heading).abs() <= PI));
            assert_eq!((trucks.real[0], trucks.real[1]), (real[0], real[1]));
        }
    }

    #[test]
    fn a_turn_more_or_less_is_taken_off_and_the_rest_stays() {
        for turns in -3..=3 {
            for angle in [-3.0, -0.1, 0.0, 0.1, 3.0] {
                let there = wrapped(angle + f64::from(turns) * TAU);
                assert!((there - angle).abs() < 1e-12, "{turns} {angle}: {there}");
            }
        }
    }
}
