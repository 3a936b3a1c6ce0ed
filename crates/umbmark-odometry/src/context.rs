//! Where and how a robot drives: the variables that laws may depend on.

use crate::geometry::{Pose2, Real};
use crate::travel::WheelTravel;
use core::ops::Deref;

/// The robot's numbers that the variables of laws are computed with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// Distance of the axle's wheels \[m\].
    pub wheelbase: f64,
    /// Radius of the left and the right wheel of the axle \[m\].
    pub wheel_radius: [f64; 2],
    /// Travel of each wheel of the axle per tick \[m\].
    pub metres_per_tick: WheelTravel,
    /// Distance of the steered wheel from the axle \[m\]; for a drive without one, that of a wheel which would steer it as far before the
    /// axle as its wheels are apart.
    pub axle_distance: f64,
    /// How wheels with rollers stand, where laws have to know: of four omni wheels, cosine and sine of twice the direction of the first
    /// from straight ahead; of tracking wheels, how far the one across stands ahead, over half the distance of the other two, and zero;
    /// zeros of other drives.
    pub wheel_layout: [f64; 2],
}

/// Where a run stands in its session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Its number in the session, from 0.
    pub run: f64,
    /// Path length driven in the session before it \[m\].
    pub session_distance: f64,
    /// Its sense: +1 counter-clockwise, -1 clockwise, 0 where it has none.
    pub direction: f64,
}

/// Time constants of the lags of [`Context::falls_behind`] \[s\], each twice the one before.
pub const TIME_CONSTANTS: [f64; 6] = [0.02, 0.04, 0.08, 0.16, 0.32, 0.64];

/// What wheels with rollers do in a piece beside the motion that the wheels of an axle would make too.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aside {
    /// Motion of the body to the left, as the odometry believes it \[m\].
    pub way: f64,
    /// How far the wheels disagree, where more of them are counted than a motion has parts: root mean square over the wheels of what no motion
    /// explains, with a sign \[m\].
    pub disagreement: f64,
    /// Mean speed to the left \[m/s\].
    pub speed: f64,
}

impl Aside {
    /// Nothing.
    pub const NONE: Aside = Aside { way: 0.0, disagreement: 0.0, speed: 0.0 };
}

/// One piece of a run, in the terms of the robot's own odometry.
///
/// Cumulative quantities have their value at the beginning of the piece, rates their mean over it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Context {
    /// Duration of the piece \[s\].
    pub duration: f64,
    /// Speed of the axle's centre \[m/s\], forward positive.
    pub speed: f64,
    /// \[rad/s\], counter-clockwise positive.
    pub turn_rate: f64,
    /// Speeds of the left and the right wheel \[m/s\].
    pub wheel_speed: [f64; 2],
    /// Change of the speeds of the left and the right wheel during the piece \[m/s\].
    pub speed_change: [f64; 2],
    /// Change of the turn rate during the piece \[rad/s\].
    pub turn_rate_change: f64,
    /// Angles of the left and the right wheel since START \[rad\].
    pub wheel_angle: [f64; 2],
    /// Rotation of each wheel during the piece \[rad\].
    pub wheel_rotation: [f64; 2],
    /// Travel of each wheel during the piece \[m\], as the odometry believes it.
    pub wheel_travel: [f64; 2],
    /// Of a drive that also moves sideways, see [`Aside`]; else zero.
    pub aside: Aside,
    /// How much further the left and the right wheel fall behind their counts during the piece \[m\], if they follow the counted speed as
    /// first-order lags with the [`TIME_CONSTANTS`]; 0 in a run that is not [recorded](Context::recorded).
    pub falls_behind: [[f64; TIME_CONSTANTS.len()]; 2],
    /// +1 or -1 if the left or the right wheel has just reversed to forward or backward.
    pub reversed: [f64; 2],
    /// Path length driven in this run \[m\].
    pub distance: f64,
    /// Time since the run began \[s\].
    pub time: f64,
    /// Path length driven in all runs of the session so far \[m\].
    pub session_distance: f64,
    /// Path length since the last turn \[m\], or since START before the first turn.
    pub since_turn: f64,
    /// Path length since the robot drove off \[m\]: after a turn on the spot, after it stood still or changed between ahead and back, or from
    /// START.
    pub since_stop: f64,
    /// Path length of the piece \[m\]; negative if its counts are opposite to the direction of driving, as single counts can be.
    pub length: f64,
    /// Sense of the last turn: +1 to the left, -1 to the right, 0 before the first.
    pub last_turn: f64,
    /// Heading that the odometry believes at the beginning of the piece \[rad\], 0 at START; of a synchro drive, how far its wheels
    /// are steered from there.
    pub believed_heading: f64,
    /// Which of two trucks: 0 for the front one, whose pose is measured, and for a robot with a single body; 1 for the rear one.
    pub truck: f64,
    /// Distance of the axle's wheels \[m\].
    pub wheelbase: f64,
    /// Distance of the steered wheel from the axle \[m\]; see [`Nominal::axle_distance`].
    pub axle_distance: f64,
    /// How wheels with rollers stand; see [`Nominal::wheel_layout`].
    pub wheel_layout: [f64; 2],
    /// Number of the run in the session, from 0.
    pub run: f64,
    /// Sense of the run: +1 counter-clockwise, -1 clockwise, 0 where it has none.
    pub direction: f64,
    /// By which share the run took longer by the reference's clock than by the log's, where both wrote down when it began and ended; else 0.
    pub clock_excess: f64,
    /// Whether the wheel travel was recorded by encoders; otherwise it is the commanded one.
    pub recorded: bool,
}

/// Where the robot is at the beginning of a piece, values or duals, and the piece, whose variables are read as if they were its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Here<'a, T = f64> {
    /// Heading in the room \[rad\], counter-clockwise from the heading at START.
    pub heading: T,
    /// Place of the robot in the room \[m\] along the heading at START.
    pub x: T,
    /// The same to the left of it \[m\].
    pub y: T,
    at: &'a Context,
}

impl<T: Real> Here<'_, T> {
    /// Where the robot is.
    #[inline(always)]
    pub fn pose(&self) -> Pose2<T> {
        Pose2::new(self.x, self.y, self.heading)
    }
}

impl<T> Deref for Here<'_, T> {
    type Target = Context;

    #[inline(always)]
    fn deref(&self) -> &Context {
        self.at
    }
}

impl Context {
    /// The piece with the robot at this pose in the room at its beginning.
    #[inline(always)]
    pub fn at_pose<T: Real>(&self, pose: &Pose2<T>) -> Here<'_, T> {
        Here { heading: pose.heading, x: pose.x, y: pose.y, at: self }
    }

    /// The piece with the robot at START, heading as the odometry believes.
    #[inline(always)]
    pub fn as_believed(&self) -> Here<'_> {
        Here { heading: self.believed_heading, x: 0.0, y: 0.0, at: self }
    }

    /// Whether the robot turns about a point within a wheelbase of its axle's centre: |v_R - v_L| > |v|.
    pub fn turns_on_the_spot(&self) -> bool {
        let [left, right] = self.wheel_speed;
        (right - left).abs() > self.speed.abs().max(self.aside.speed.abs())
    }

    /// The same piece of which only a share is driven.
    pub fn part(self, share: f64) -> Context {
        let Aside { way, disagreement, speed } = self.aside;
        Context { aside: Aside { way: share * way, disagreement: share * disagreement, speed }, ..self }
    }

    /// Whether the wheels stand throughout the piece, by their counts.
    pub fn stands(&self) -> bool {
        self.wheel_travel == [0.0; 2] && self.speed_change == [0.0; 2] && self.aside == Aside::NONE
    }

    /// Whether something may move the robot in the piece: its counts, or wheels that follow them late.
    pub fn moves(&self) -> bool {
        !self.stands() || self.falls_behind != [[0.0; TIME_CONSTANTS.len()]; 2]
    }

    /// Mean acceleration of the axle's centre \[m/s²\].
    pub fn acceleration(&self) -> f64 {
        if self.duration > 0.0 { 0.5 * (self.speed_change[0] + self.speed_change[1]) / self.duration } else { 0.0 }
    }

    /// Mean change of the turn rate \[rad/s²\], counter-clockwise positive.
    pub fn turn_acceleration(&self) -> f64 {
        if self.duration > 0.0 { self.turn_rate_change / self.duration } else { 0.0 }
    }
}

/// Wheels that follow late do not move while their counters stand where none would move further than this in a piece \[m\].
const LEAST_MOVE: f64 = 1e-6;
/// A turn is rotation by more than this \[rad\] about a point within a wheelbase of the axle's centre.
const LEAST_TURN: f64 = 0.35;
/// A turn ends when the robot has moved this far \[m\].
const AWAY_FROM_TURN: f64 = 0.01;
/// A wheel has reversed if it has rolled back by more than this \[m\] from its farthest point.
const LEAST_REVERSAL: f64 = 0.5e-3;

/// A turn is one on the spot where the axle's centre moves by less than this share of what the wheels roll against each other.
const ON_THE_SPOT: f64 = 0.1;

/// A robot has stopped where no wheel has rolled for so long \[s\].
const STOOD: f64 = 0.2;

/// Follows a run piece by piece and tracks the variables of effects, except the place in the room.
#[derive(Clone, Debug)]
pub struct Progress {
    now: Context,
    radius: [f64; 2],
    least_reversal: [f64; 2],
    /// Rotation of the present turn \[rad\], and distance since the last rotation \[m\].
    turned: f64,
    gone: f64,
    /// How far the axle's centre moved in the present turn, ahead and aside \[m\].
    turn_way: [f64; 2],
    /// Rolling direction of each wheel, and its distance behind its farthest point \[m\].
    sense: [f64; 2],
    behind: [f64; 2],
    /// The same of the axle's centre, and how long no wheel has rolled \[s\].
    way_sense: f64,
    way_behind: f64,
    stood: f64,
    lag: Lag,
}

/// How far the wheels are behind their counts, if they follow them as first-order lags.
#[derive(Clone, Copy, Debug, Default)]
struct Lag {
    /// How far the left and the right wheel are behind, with each of the [`TIME_CONSTANTS`] \[m\].
    behind: [[f64; TIME_CONSTANTS.len()]; 2],
    /// The last duration \[s\], and the share of each distance that is left after it.
    duration: f64,
    left: [f64; TIME_CONSTANTS.len()],
}

impl Lag {
    /// Follows a piece of these travels \[m\] at constant speed: how much further the wheels fall behind.
    #[inline]
    fn follow(&mut self, travel: [f64; 2], duration: f64) -> [[f64; TIME_CONSTANTS.len()]; 2] {
        if duration <= 0.0 {
            // What is counted in no time is all still to be driven.
            self.behind = [0, 1].map(|w| self.behind[w].map(|behind| behind + travel[w]));
            return [0, 1].map(|w| [travel[w]; TIME_CONSTANTS.len()]);
        }
        if duration != self.duration {
            // Half the time constant squares the share.
            let mut left = libm::exp(-duration / TIME_CONSTANTS[TIME_CONSTANTS.len() - 1]);
            for share in self.left.iter_mut().rev() {
                *share = left;
                left *= left;
            }
            self.duration = duration;
        }
        let mut further = [[0.0; TIME_CONSTANTS.len()]; 2];
        for wheel in 0..2 {
            let speed = travel[wheel] / duration;
            for (k, time) in TIME_CONSTANTS.iter().enumerate() {
                let behind = &mut self.behind[wheel][k];
                further[wheel][k] = (1.0 - self.left[k]) * (speed * time - *behind);
                *behind += further[wheel][k];
            }
        }
        further
    }
}

impl Progress {
    /// A run that begins at START.
    pub fn new(nominal: &Nominal, place: &Place, recorded: bool) -> Progress {
        let per_tick = nominal.metres_per_tick;
        let now = Context {
            session_distance: place.session_distance,
            run: place.run,
            direction: place.direction,
            recorded,
            wheelbase: nominal.wheelbase,
            axle_distance: nominal.axle_distance,
            wheel_layout: nominal.wheel_layout,
            ..Context::default()
        };
        Progress {
            now,
            radius: nominal.wheel_radius,
            least_reversal: [per_tick.left, per_tick.right].map(|tick| LEAST_REVERSAL.max(2.0 * tick)),
            turned: 0.0,
            gone: 0.0,
            turn_way: [0.0; 2],
            sense: [0.0; 2],
            behind: [0.0; 2],
            way_sense: 0.0,
            way_behind: 0.0,
            stood: 0.0,
            lag: Lag::default(),
        }
    }

    /// The same run, which took longer by this share by the reference's clock than by the log's.
    pub fn with_clock_excess(mut self, excess: f64) -> Progress {
        self.set_clock_excess(excess);
        self
    }

    /// That share from the next piece on.
    #[inline]
    pub fn set_clock_excess(&mut self, excess: f64) {
        self.now.clock_excess = excess;
    }

    /// The next piece: its believed wheel travel \[m\], how long it takes \[s\], and the speeds of the left and the right
    /// wheel at its beginning and end \[m/s\].
    #[inline]
    pub fn piece(&mut self, travel: &WheelTravel, duration: f64, from: [f64; 2], to: [f64; 2]) -> Context {
        self.piece_aside(travel, Aside::NONE, duration, from, to)
    }

    /// The same of a drive that also moves sideways.
    #[inline(always)]
    pub fn piece_aside(
        &mut self,
        travel: &WheelTravel,
        aside: Aside,
        duration: f64,
        from: [f64; 2],
        to: [f64; 2],
    ) -> Context {
        let wheels = [travel.left, travel.right];
        let forward = 0.5 * (travel.left + travel.right);
        let rotation = (travel.right - travel.left) / self.now.wheelbase;
        self.follow_turn([forward, aside.way], rotation);
        let mean = [0, 1].map(|w| 0.5 * (from[w] + to[w]));
        let now = &mut self.now;
        now.duration = duration;
        now.speed = 0.5 * (mean[0] + mean[1]);
        now.turn_rate = (mean[1] - mean[0]) / now.wheelbase;
        now.wheel_speed = mean;
        now.speed_change = [to[0] - from[0], to[1] - from[1]];
        now.turn_rate_change = (now.speed_change[1] - now.speed_change[0]) / now.wheelbase;
        now.wheel_travel = wheels;
        now.wheel_rotation = [0, 1].map(|w| wheels[w] / self.radius[w]);
        // Counters that oscillate about zero, as in a turn on the spot, add no path length.
        now.length = if now.speed == 0.0 { forward.abs() } else { forward * now.speed.signum() };
        now.aside = aside;
        if aside != Aside::NONE {
            now.length = libm::hypot(forward, aside.way);
        }
        now.reversed =
            [0, 1].map(|w| reversal(&mut self.sense[w], &mut self.behind[w], wheels[w], self.least_reversal[w]));
        if now.recorded {
            let further = self.lag.follow(wheels, duration);
            let moves = wheels != [0.0; 2] || further.iter().flatten().any(|further| further.abs() > LEAST_MOVE);
            now.falls_behind = if moves { further } else { [[0.0; TIME_CONSTANTS.len()]; 2] };
        }
        self.stood = if wheels == [0.0; 2] && aside == Aside::NONE { self.stood + duration } else { 0.0 };
        if self.stood >= STOOD {
            (now.since_stop, self.way_sense) = (0.0, 0.0);
        }
        // Counts that tremble in a turn are no way back.
        let least = self.least_reversal[0].max(self.least_reversal[1]);
        let rolls = rotation.abs() * now.wheelbase <= forward.abs();
        if rolls && reversal(&mut self.way_sense, &mut self.way_behind, forward, least) != 0.0 {
            now.since_stop = 0.0;
        }
        let piece = *now;
        now.believed_heading += rotation;
        now.wheel_angle = [0, 1].map(|w| now.wheel_angle[w] + now.wheel_rotation[w]);
        now.distance += now.length;
        now.session_distance += now.length;
        now.since_turn += now.length;
        now.since_stop += now.length;
        now.time += duration;
        piece
    }

    /// Time since the run began \[s\].
    #[inline]
    pub fn time(&self) -> f64 {
        self.now.time
    }

    /// Path length driven in all runs of the session so far \[m\].
    #[inline]
    pub fn session_distance(&self) -> f64 {
        self.now.session_distance
    }

    #[inline]
    fn follow_turn(&mut self, [forward, aside]: [f64; 2], rotation: f64) {
        let way = forward.abs().max(aside.abs());
        if rotation.abs() * self.now.wheelbase > way {
            self.turned += rotation;
            self.turn_way = [self.turn_way[0] + forward, self.turn_way[1] + aside];
            self.gone = 0.0;
        } else {
            self.gone += way;
            if self.gone > AWAY_FROM_TURN {
                (self.turned, self.turn_way) = (0.0, [0.0; 2]);
            }
        }
        if self.turned.abs() > LEAST_TURN && self.gone == 0.0 {
            self.now.last_turn = self.turned.signum();
            self.now.since_turn = 0.0;
            let moved = self.turn_way[0].abs().max(self.turn_way[1].abs());
            if moved < ON_THE_SPOT * self.turned.abs() * self.now.wheelbase {
                (self.now.since_stop, self.way_sense) = (0.0, 0.0);
            }
        }
    }
}

/// The new sense of a wheel where it reverses in this piece, else 0.
#[inline]
fn reversal(sense: &mut f64, behind: &mut f64, travel: f64, least: f64) -> f64 {
    if *sense == 0.0 {
        *sense = if travel == 0.0 { 0.0 } else { travel.signum() };
        return 0.0;
    }
    *behind = (*behind - *sense * travel).max(0.0);
    if *behind <= least {
        return 0.0;
    }
    *sense = -*sense;
    *behind = 0.0;
    *sense
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Wheels of 0.15 m, 0.34 m apart, of 2000 ticks a turn.
    fn labmate() -> Nominal {
        let tick = core::f64::consts::PI * 0.15 / 2000.0;
        Nominal {
            wheelbase: 0.34,
            wheel_radius: [0.075; 2],
            metres_per_tick: WheelTravel { left: tick, right: tick },
            axle_distance: 0.34,
            wheel_layout: [0.0; 2],
        }
    }

    fn drive(pieces: &[(f64, f64)]) -> Vec<Context> {
        let mut progress = Progress::new(&labmate(), &Place::default(), true);
        let travel = |(left, right): &(f64, f64)| WheelTravel { left: *left, right: *right };
        pieces.iter().map(|p| progress.piece(&travel(p), 0.1, [0.0; 2], [0.1; 2])).collect()
    }

    #[test]
    fn a_turn_on_the_spot_is_remembered_with_its_sense_and_the_way_since() {
        let quarter = 0.5 * 0.34 * std::f64::consts::FRAC_PI_2 / 10.0;
        let mut pieces = vec![(0.1, 0.1); 3];
        pieces.extend([(quarter, -quarter); 10]);
        pieces.extend([(0.1, 0.1); 2]);
        let seen = drive(&pieces);
        assert_eq!((seen[2].last_turn, seen[12].last_turn, seen[14].last_turn), (0.0, -1.0, -1.0));
        assert!((seen[2].since_turn - 0.2).abs() < 1e-12 && (seen[14].since_turn - 0.1).abs() < 1e-12);
        assert!((seen[14].believed_heading + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((seen[14].distance - 0.4).abs() < 1e-12 && (seen[14].time - 1.4).abs() < 1e-12);
    }

    /// Ticks that come slowly are no stop; a stop of 0.2 s, a turn and a way back are.
    #[test]
    fn the_way_since_the_robot_drove_off_begins_anew_after_a_stop_and_on_the_way_back() {
        let (on, off, back) = ((0.1, 0.1), (0.0, 0.0), (-0.1, -0.1));
        let mut progress = Progress::new(&labmate(), &Place::default(), true);
        let mut piece = |(left, right): (f64, f64)| {
            let speeds = [10.0 * left, 10.0 * right];
            progress.piece(&WheelTravel { left, right }, 0.1, speeds, speeds)
        };
        let seen = [on, on, off, on, on, off, off, on, on, back, back].map(&mut piece);
        let ways: Vec<f64> = seen.iter().map(|at| (10.0 * at.since_stop).round()).collect();
        assert_eq!(ways, [0.0, 1.0, 2.0, 2.0, 3.0, 4.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
        assert!((seen[8].since_turn - 0.5).abs() < 1e-12);
        let quarter = 0.5 * 0.34 * std::f64::consts::FRAC_PI_2 / 10.0;
        let turned = drive(&[&[on; 3][..], &[(quarter, -quarter); 10], &[on; 2]].concat());
        assert!((turned[14].since_stop - 0.1).abs() < 1e-12);
        // A tight bend that the robot rolls through is a turn, and no stop.
        let bent = drive(&[&[on; 3][..], &[(0.005, 0.04); 20], &[on; 2]].concat());
        assert!(bent[24].since_turn < 0.13 && bent[24].since_stop > 0.7);
    }

    #[test]
    fn counters_that_tremble_in_a_turn_make_no_way_and_driving_backward_does() {
        let mut progress = Progress::new(&labmate(), &Place::default(), true);
        let mut piece = |left: f64, right: f64, speeds: [f64; 2]| {
            progress.piece(&WheelTravel { left, right }, 0.01, speeds, speeds);
            progress.session_distance()
        };
        // Nine ticks against eight and eight against nine, at a mean speed that is not quite zero.
        for _ in 0..50 {
            piece(-9e-4, 8e-4, [-0.2, 0.2001]);
            piece(-8e-4, 9e-4, [-0.2, 0.2001]);
        }
        assert!(piece(0.0, 0.0, [0.0; 2]).abs() < 1e-12);
        assert!((piece(-0.01, -0.01, [-0.2; 2]) - 0.01).abs() < 1e-12);
        assert!((piece(-0.01, -0.01, [0.0; 2]) - 0.02).abs() < 1e-12);
    }

    #[test]
    fn a_correction_of_the_heading_is_no_turn() {
        let seen = drive(&[(0.1, 0.1), (0.01, -0.01), (0.1, 0.1)]);
        assert_eq!(seen[2].last_turn, 0.0);
        assert!((seen[2].since_turn - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_wheel_that_trembles_has_not_reversed_and_one_that_rolls_back_has_once() {
        let tremble = [(1e-4, 1e-4), (-1e-4, 1e-4), (1e-4, 1e-4), (-1e-4, 1e-4)];
        assert!(drive(&tremble).iter().all(|c| c.reversed == [0.0; 2]));
        let back = [(0.01, 0.01), (-4e-4, 0.01), (-4e-4, 0.01), (-0.01, 0.01), (0.01, 0.01)];
        let reversed: Vec<f64> = drive(&back).iter().map(|c| c.reversed[0]).collect();
        assert_eq!(reversed, [0.0, 0.0, -1.0, 0.0, 1.0]);
    }

    /// Oracle: 0.2 m/s for 1 s, then rest; the distance behind is v τ (1 - e^(-t/τ)), and fades.
    #[test]
    fn wheels_that_follow_late_are_behind_by_speed_times_time_constant_and_catch_up_at_rest() {
        for steps in [1, 10, 137] {
            let mut progress = Progress::new(&labmate(), &Place::default(), true);
            let step = 1.0 / f64::from(steps);
            let travel = WheelTravel { left: 0.2 * step, right: -0.1 * step };
            let mut behind = [[0.0; 6]; 2];
            let mut drive = |travel: &WheelTravel, seconds: f64| {
                let piece = progress.piece(travel, seconds, [0.0; 2], [0.0; 2]);
                for (behind, further) in behind.iter_mut().flatten().zip(piece.falls_behind.iter().flatten()) {
                    *behind += further;
                }
                behind
            };
            let cruising = (0..steps).map(|_| drive(&travel, step)).last().unwrap();
            let resting = drive(&WheelTravel::default(), 0.3);
            for (wheel, speed) in [0.2, -0.1].into_iter().enumerate() {
                for (k, time) in TIME_CONSTANTS.into_iter().enumerate() {
                    let expected = speed * time * (1.0 - libm::exp(-1.0 / time));
                    assert!((cruising[wheel][k] - expected).abs() < 1e-12, "{steps} {wheel} {k}");
                    let faded = expected * libm::exp(-0.3 / time);
                    assert!((resting[wheel][k] - faded).abs() < 1e-12, "{steps} {wheel} {k}");
                }
            }
        }
    }

    #[test]
    fn rates_are_means_and_acceleration_is_the_change_over_the_duration() {
        let piece = drive(&[(0.005, 0.005)])[0];
        assert!((piece.speed - 0.05).abs() < 1e-15 && (piece.acceleration() - 1.0).abs() < 1e-12);
        assert_eq!(Context::default().acceleration(), 0.0);
        let mut progress = Progress::new(&labmate(), &Place::default(), true);
        let turn = progress.piece(&WheelTravel::default(), 0.5, [0.0; 2], [-0.034, 0.034]);
        assert!((turn.turn_acceleration() - 0.4).abs() < 1e-12, "{}", turn.turn_acceleration());
    }
}
