//! How well the motion measured by the reference agrees with the motion of the wheels, window by window.
//!
//! In a window the tracked body moves by u, seen from where it was at the beginning, and turns by α; the wheels roll by l and r. With
//! D = (l + r)/2 and β = (r - l)/b,
//!
//! ```text
//! u = (c e^(-iδ)) (D sinc(α/2) + i g A) e^(iα/2) + (e^(iα) - 1) m,     α = g β + k D,     A = ½ ∫ (r dl - l dr) / b
//! ```
//!
//! where c is the scale of the way, δ the yaw of the tracked body on the robot, m its lever arm turned by -δ, g the gain of
//! turns and k the drift of the heading per metre. The term of A is what the window differs from an arc, to first order: a robot that turns
//! early in it and drives late comes out beside the arc, and a lever arm would otherwise stand in for that. Rotations are fitted first;
//! with g from there, both equations are linear in what is sought.

use super::faults::DOUBTFUL;
use super::windows::{Rolling, Window};
use crate::geometry::Real;
use crate::stats::robust::{self, Line};

/// Minimum total rotation \[rad\] and distance \[m\] of all windows: less determines nothing.
const LEAST_TURN: f64 = 0.5;
const LEAST_WAY: f64 = 0.1;

/// Distance or rotation contradicts the reference only where it makes this share of the wheels' motion: what wheels of unequal diameter and
/// noise add up to in straight drives, or in turns on the spot, says nothing.
const MAIN: f64 = 0.05;

/// The wheels clearly turn the robot if by more than this in a window \[rad\].
const CLEAR_TURN: f64 = 0.05;
/// A reference that turns by less than this share of what the wheels turn hardly turns.
const HARDLY: f64 = 0.25;

/// The misfit of distance and of rotation must be below this.
const CREDIBLE: f64 = 0.7;

/// How columns and headings are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Reading {
    /// Whether the first counter is taken with the opposite sign.
    pub opposed: bool,
    /// Whether measured headings are taken with the opposite sign.
    pub clockwise: bool,
}

/// A window, and how the wheels rolled in it.
pub(super) type Beside = (Window, Rolling);

/// The best agreement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Agreement {
    /// c e^(-iδ): its real and its imaginary part.
    pub way: [f64; 2],
    /// m \[m\].
    pub lever: [f64; 2],
    /// g, and k \[rad/m\].
    pub turn: [f64; 2],
    /// Which way most windows are driven along their course: +1 ahead, -1 back.
    pub ahead: f64,
    /// Standard deviation of the residuals of a coordinate \[m\] and of a rotation \[rad\].
    pub left: [f64; 2],
    /// Misfit of distance, of rotation and of both, as a share: 0 for perfect agreement, about 1 for none.
    pub misfits: [f64; 2],
    pub misfit: f64,
    /// Whether the windows determine distance, and rotation.
    pub shown: [bool; 2],
    /// Whether distance, and rotation, are more than a small part of the wheels' motion.
    pub is_main: [bool; 2],
}

/// A window as it is read.
#[derive(Clone, Copy)]
struct Told {
    /// u \[m\], and α \[rad\].
    moved: [f64; 2],
    turned: f64,
    /// D \[m\], and β \[rad\].
    way: f64,
    turn: f64,
    /// Motion to the left by the wheels \[m\].
    aside: f64,
    /// A \[m rad\]; 0 where the headings are those of the course, which is itself that of an arc.
    area: f64,
    /// Whether a heading was measured; else it is that of the course.
    with_heading: bool,
}

/// Most windows are driven backward if the way of all of them is below this share of their ways.
const BACKWARD: f64 = -0.5;

impl Reading {
    fn told(self, (window, rolled): &Beside, wheelbase: f64) -> Told {
        let sign = if self.clockwise { -1.0 } else { 1.0 };
        let (sine, cosine) = libm::sincos(sign * window.heading);
        let [x, y] = window.moved;
        let [left, right] = rolled.travel;
        let (left, area) = if self.opposed { (-left, -rolled.area) } else { (left, rolled.area) };
        let told = Told {
            moved: [cosine * x + sine * y, cosine * y - sine * x],
            turned: sign * window.turned,
            way: 0.5 * (left + right),
            turn: (right - left) / wheelbase,
            aside: rolled.aside,
            area: if window.with_heading && !window.headings_only { area / wheelbase } else { 0.0 },
            with_heading: window.with_heading,
        };
        if window.headings_only { told.along_headings() } else { told }
    }
}

impl Told {
    /// Where nothing but headings was measured, the body moves as the wheels do along them: neither agrees nor disagrees.
    fn along_headings(self) -> Told {
        let (sinc, half) = (0.5 * self.turned).sinc_cos();
        let ahead = self.way * sinc;
        Told { moved: [ahead * half, ahead * 0.5 * self.turned * sinc], ..self }
    }

    /// Where only the course is known, it points back in a window that is driven against most others.
    fn along(self, ahead: f64) -> Told {
        let against = !self.with_heading && self.way * ahead < 0.0;
        if against { Told { moved: self.moved.map(|moved| -moved), ..self } } else { self }
    }

    /// How far the wheels moved the body \[m\].
    fn gone(&self) -> f64 {
        if self.aside == 0.0 { self.way.abs() } else { libm::hypot(self.way, self.aside) }
    }

    /// The equation of α, without the drift where that is 0.
    fn turn_row(&self, drift: f64) -> ([f64; 2], f64) {
        ([self.turn, drift * self.way], self.turned)
    }

    /// The equations of both coordinates of u, for this gain of the rotations.
    fn way_rows(&self, gain: f64) -> [([f64; 4], f64); 2] {
        let (sinc, half) = (0.5 * self.turned).sinc_cos();
        let (ahead, aside) = (self.way * sinc, gain * self.area + self.aside * sinc);
        // sin(α/2) is α/2 sinc(α/2).
        let rise = 0.5 * self.turned * sinc;
        let (real, imaginary) = (ahead * half - aside * rise, ahead * rise + aside * half);
        let (sine, cosine) = libm::sincos(self.turned);
        [
            ([real, -imaginary, cosine - 1.0, -sine], self.moved[0]),
            ([imaginary, real, sine, cosine - 1.0], self.moved[1]),
        ]
    }
}

/// What a row leaves with these values.
fn left<const K: usize>((row, y): &([f64; K], f64), values: &[f64; K]) -> f64 {
    y - row.iter().zip(values).map(|(x, v)| x * v).sum::<f64>()
}

impl Agreement {
    /// Fits all windows under a reading.
    pub fn of(windows: &[Beside], reading: Reading, wheelbase: f64) -> Agreement {
        Agreement::fitted(windows, reading, wheelbase, true)
    }

    /// The same for wheels of equal diameter: without the drift, which could mimic a counter that is read wrongly.
    pub fn without_drift(windows: &[Beside], reading: Reading, wheelbase: f64) -> Agreement {
        Agreement::fitted(windows, reading, wheelbase, false)
    }

    fn fitted(windows: &[Beside], reading: Reading, wheelbase: f64, with_drift: bool) -> Agreement {
        let arm = 0.5 * wheelbase;
        let drift = if with_drift { 1.0 } else { 0.0 };
        let told: Vec<Told> = windows.iter().map(|beside| reading.told(beside, wheelbase)).collect();
        let [along, ways] =
            [told.iter().map(|told| told.way).sum::<f64>(), told.iter().map(|told| told.way.abs()).sum()];
        let ahead = if along < BACKWARD * ways { -1.0 } else { 1.0 };
        let told: Vec<Told> = told.into_iter().map(|told| told.along(ahead)).collect();
        let turns: Vec<([f64; 2], f64)> = told.iter().map(|told| told.turn_row(drift)).collect();
        // A robot that mostly drives straight, seen by a quiet gyro, turns by hardly anything in most windows.
        let headings_only = windows.iter().any(|(window, _)| window.headings_only);
        let turn: Line<2> = robust::fit_above(&turns, if headings_only { robust::LARGE_SCATTER } else { 0.0 });
        let ways: Vec<([f64; 4], f64)> = told.iter().flat_map(|told| told.way_rows(turn.values[0])).collect();
        // Headings alone say nothing of the way.
        let way: Line<4> = match headings_only {
            true => Line { values: [1.0, 0.0, 0.0, 0.0], scale: 0.0 },
            false => robust::fit(&ways),
        };
        // Limits the weight of a window to the largest wheel travel in any window.
        let most = told.iter().map(|told| told.gone() + arm * told.turn.abs()).fold(0.0, f64::max);
        let stretch = libm::hypot(way.values[0], way.values[1]).max(1.0);
        let (mut off, mut whole) = ([0.0; 2], [0.0; 2]);
        for (row, pair) in turns.iter().zip(ways.chunks_exact(2)) {
            let moved = libm::hypot(left(&pair[0], &way.values), left(&pair[1], &way.values));
            let cut = |value: f64, stretch: f64| (value / stretch).min(most);
            off[0] += cut(moved, stretch);
            off[1] += cut(arm * left(row, &turn.values).abs(), 1.0);
            whole[0] += cut(libm::hypot(pair[0].1, pair[1].1), stretch);
            whole[1] += cut(arm * row.1.abs(), 1.0);
        }
        let share = |off: f64, whole: f64| if whole > 0.0 { off / whole } else { 1.0 };
        let sum = |of: fn(&Told) -> f64| told.iter().map(of).sum::<f64>();
        let (driven, turned) = (sum(Told::gone), sum(|told| told.turn.abs()));
        let least = MAIN * (driven + arm * turned);
        Agreement {
            way: [way.values[0], way.values[1]],
            lever: [way.values[2], way.values[3]],
            turn: turn.values,
            ahead,
            left: [way.scale, turn.scale],
            misfits: [share(off[0], whole[0]), share(off[1], whole[1])],
            misfit: share(off[0] + off[1], whole[0] + whole[1]),
            shown: [driven > LEAST_WAY, turned > LEAST_TURN],
            is_main: [driven > least, arm * turned > least],
        }
    }

    /// Whether the agreement is reliable: something moves, and most of the motion agrees.
    pub fn is_credible(&self) -> bool {
        self.shown.contains(&true) && !self.is_vague()
    }

    /// Whether something moves, and yet most of the motion disagrees.
    pub fn is_vague(&self) -> bool {
        (0..2).any(|k| self.shown[k] && self.is_main[k] && self.misfits[k] >= CREDIBLE)
    }

    /// Whether the rotations agree, where there are some.
    pub fn turns_are_credible(&self) -> bool {
        !self.shown[1] || self.misfits[1] < CREDIBLE
    }

    /// Way by the reference over way by the wheels.
    pub fn scale(&self) -> f64 {
        libm::hypot(self.way[0], self.way[1])
    }

    /// δ \[rad\].
    pub fn yaw(&self) -> f64 {
        -libm::atan2(self.way[1], self.way[0])
    }

    /// The lever arm on the robot: ahead and to the left of the axle's centre \[m\].
    pub fn lever_on_robot(&self) -> [f64; 2] {
        let (sine, cosine) = libm::sincos(self.yaw());
        let [x, y] = self.lever;
        [cosine * x - sine * y, sine * x + cosine * y]
    }

    /// Misfit of distance and of rotation in some windows, as a share; 0 if they determine none.
    pub fn misfits_of(&self, windows: &[Beside], reading: Reading, wheelbase: f64) -> [f64; 2] {
        let (mut off, mut whole, mut shown) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        for beside in windows {
            let told = reading.told(beside, wheelbase).along(self.ahead);
            let [x, y, left] = self.residual_of(&told);
            let most = told.gone() + 0.5 * wheelbase * told.turn.abs();
            whole[0] += libm::hypot(told.moved[0], told.moved[1]);
            whole[1] += told.turned.abs();
            // A single wrong pose must not look like another wiring.
            off[0] += libm::hypot(x, y).min(2.0 * most);
            off[1] += left.abs().min(2.0 * most / (0.5 * wheelbase));
            shown = [shown[0] + told.gone(), shown[1] + told.turn.abs()];
        }
        let least = [LEAST_WAY, LEAST_TURN];
        [0, 1].map(|k| if shown[k] > least[k] && whole[k] > 0.0 { off[k] / whole[k] } else { 0.0 })
    }

    /// Misfit of rotation in those windows of a run in which the wheels clearly turn the robot, as a share of their rotation: near 1 where the
    /// reference turns at other times; 0 if there are too few.
    pub fn misfit_of_turns(&self, windows: &[Beside], reading: Reading, wheelbase: f64) -> f64 {
        let (mut off, mut whole) = (0.0, 0.0);
        for told in
            windows.iter().map(|beside| reading.told(beside, wheelbase)).filter(|told| told.turn.abs() > CLEAR_TURN)
        {
            let [_, _, left] = self.residual_of(&told);
            off += left.abs().min(2.0 * told.turn.abs());
            whole += told.turn.abs();
        }
        if whole > 2.0 * LEAST_TURN { off / whole } else { 0.0 }
    }

    /// Whether the reference drives as far as the wheels roll, and turns hardly where the wheels turn: a wheel spun on the spot, and ticks and
    /// poses are of one drive all the same.
    pub fn only_wheels_turn(&self, windows: &[Beside], reading: Reading, wheelbase: f64) -> bool {
        let told = || windows.iter().map(|beside| reading.told(beside, wheelbase));
        let clear = |turn: f64| if turn.abs() > CLEAR_TURN { turn.abs() } else { 0.0 };
        let [wheels, seen] =
            told().fold([0.0; 2], |[wheels, seen], t| [wheels + clear(t.turn), seen + clear(t.turned)]);
        seen < HARDLY * wheels && self.misfits_of(windows, reading, wheelbase)[0] < DOUBTFUL
    }

    /// Residuals of a window: both coordinates \[m\] and the rotation \[rad\].
    pub fn residual(&self, reading: Reading, beside: &Beside, wheelbase: f64) -> [f64; 3] {
        self.residual_of(&reading.told(beside, wheelbase).along(self.ahead))
    }

    fn residual_of(&self, told: &Told) -> [f64; 3] {
        let [x, y] = told.way_rows(self.turn[0]);
        let way = [self.way[0], self.way[1], self.lever[0], self.lever[1]];
        [left(&x, &way), left(&y, &way), left(&told.turn_row(1.0), &self.turn)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Displacement2, Pose2};
    use crate::random::Stream;

    /// 300 windows of random motion of a robot with wheelbase 0.4 m, whose tracked body sits at `body`, seed 9.
    fn made(body: Pose2, scale: f64, gain: f64) -> Vec<Beside> {
        let mut stream = Stream::new(9, 0, 0);
        let mut pose = Pose2::IDENTITY;
        (0..300)
            .map(|_| {
                let (way, turn) = (0.1 * stream.normal(), 0.2 * stream.normal());
                let before = pose.compose(&body);
                pose = pose.moved(&Displacement2 { forward: scale * way, sideways: 0.0, rotation: gain * turn });
                let after = pose.compose(&body);
                let moved = [after.x - before.x, after.y - before.y];
                let turned = after.heading - before.heading;
                let heading = before.heading;
                let window = Window {
                    moved,
                    heading,
                    turned,
                    raw_turn: turned,
                    with_heading: true,
                    to: 0.4,
                    ..Window::default()
                };
                (window, Rolling { travel: [way - 0.2 * turn, way + 0.2 * turn], aside: 0.0, area: 0.0 })
            })
            .collect()
    }

    #[test]
    fn scale_gain_lever_arm_and_yaw_are_found_exactly_where_nothing_disturbs() {
        for yaw in [0.0, 0.4, -2.9] {
            let windows = made(Pose2::new(0.12, -0.05, yaw), 1.03, 0.96);
            let found = Agreement::of(&windows, Reading::default(), 0.4);
            let [ahead, left] = found.lever_on_robot();
            assert!((found.scale() - 1.03).abs() < 1e-9 && (found.turn[0] - 0.96).abs() < 1e-9, "{found:?}");
            assert!((found.yaw() - yaw).abs() < 1e-9 && (ahead - 0.12).abs() < 1e-9 && (left + 0.05).abs() < 1e-9);
            assert!(found.misfit < 1e-9 && found.turn[1].abs() < 1e-9);
            assert!(windows.iter().all(|w| found.residual(Reading::default(), w, 0.4).iter().all(|r| r.abs() < 1e-9)));
        }
    }

    #[test]
    fn what_is_read_wrongly_does_not_agree() {
        let windows = made(Pose2::new(0.02, 0.0, 0.1), 1.0, 1.0);
        for (opposed, clockwise) in [(true, false), (false, true), (true, true)] {
            let found = Agreement::of(&windows, Reading { opposed, clockwise }, 0.4);
            assert!(found.misfit > 0.4, "{opposed} {clockwise} {found:?}");
        }
    }
}
