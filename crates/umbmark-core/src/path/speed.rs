//! How fast a move is driven.

use super::PathError;
use crate::parameter::Parameter;

/// Trapezoidal speed from rest to rest, and a pause before the next move.
///
/// `speed` and `acceleration` are those of the faster wheel, as in section 4.1 of the paper, where 0.2 m/s is both the
/// speed on the legs and the greatest wheel speed in the turns. A move too short to reach the speed is a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedProfile {
    speed: f64,
    acceleration: f64,
    pause: f64,
}

impl Default for SpeedProfile {
    /// 0.2 m/s (the paper, section 4.1), 0.2 m/s² and a pause of 1 s (assumed).
    fn default() -> Self {
        SpeedProfile { speed: 0.2, acceleration: 0.2, pause: 1.0 }
    }
}

impl SpeedProfile {
    /// The numbers of a profile, in the order of [`SpeedProfile::new`].
    pub const PARAMETERS: [Parameter; 3] = [
        Parameter::shape("speed_m_s", "speed", "m/s", 0.2, (1e-4, 100.0), "greatest speed of the faster wheel"),
        Parameter::shape(
            "acceleration_m_s2",
            "acceleration",
            "m/s^2",
            0.2,
            (1e-4, 1000.0),
            "acceleration of the faster wheel",
        ),
        Parameter::shape("pause_s", "pause", "s", 1.0, (0.0, 3600.0), "rest between two moves"),
    ];

    /// A profile from speed \[m/s\], acceleration \[m/s²\] and pause \[s\].
    pub fn new(speed: f64, acceleration: f64, pause: f64) -> Result<Self, PathError> {
        for (parameter, value) in Self::PARAMETERS.iter().zip([speed, acceleration, pause]) {
            parameter.check(value)?;
        }
        Ok(SpeedProfile { speed, acceleration, pause })
    }

    /// Speed, acceleration and pause \[m/s, m/s², s\].
    pub fn values(&self) -> [f64; 3] {
        [self.speed, self.acceleration, self.pause]
    }

    /// Rest between two moves \[s\].
    pub fn pause(&self) -> f64 {
        self.pause
    }

    /// The profile of a move in which the faster wheel rolls `travel` \[m\] (sign ignored).
    pub fn over(&self, travel: f64) -> Trapezoid {
        let travel = travel.abs();
        let ramp = (self.speed / self.acceleration).min((travel / self.acceleration).sqrt());
        let top = ramp * self.acceleration;
        let cruise = if top > 0.0 { (travel - top * ramp) / top } else { 0.0 };
        Trapezoid { ramp, cruise: cruise.max(0.0), part: None }
    }
}

/// A part of a longer move that is driven through.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    /// Share of the whole travel done when it begins.
    from: f64,
    /// Share of the whole travel that it is.
    span: f64,
    /// When it begins \[s\], and how long it takes \[s\].
    begins: f64,
    lasts: f64,
}

/// Fraction of a move's travel done as a function of time: quadratic, linear, quadratic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    /// Duration of each ramp \[s\].
    pub ramp: f64,
    /// Duration at constant speed \[s\].
    pub cruise: f64,
    /// Which part of such a move it is, where it is not all of it: it then does not begin and end at rest.
    part: Option<Part>,
}

impl Trapezoid {
    /// The part of a whole move from one share of its travel to another.
    pub fn between(self, from: f64, to: f64) -> Trapezoid {
        let [begins, ends] = [from, to].map(|share| self.time_of_whole(share));
        Trapezoid { part: Some(Part { from, span: to - from, begins, lasts: ends - begins }), ..self }
    }

    /// \[s\]
    pub fn duration(&self) -> f64 {
        self.part.map_or(self.whole(), |part| part.lasts)
    }

    fn whole(&self) -> f64 {
        2.0 * self.ramp + self.cruise
    }

    /// Share of the travel done at `time` \[s\] after the start: 0 before it, 1 after the end.
    pub fn fraction(&self, time: f64) -> f64 {
        match self.part {
            None => self.fraction_of_whole(time),
            Some(part) if time >= part.lasts => 1.0,
            Some(part) => ((self.fraction_of_whole(part.begins + time) - part.from) / part.span).clamp(0.0, 1.0),
        }
    }

    fn fraction_of_whole(&self, time: f64) -> f64 {
        let total = self.ramp + self.cruise;
        if time <= 0.0 {
            0.0
        } else if time >= self.whole() {
            1.0
        } else if time < self.ramp {
            0.5 * time * time / self.ramp / total
        } else if time <= total {
            (time - 0.5 * self.ramp) / total
        } else {
            let left = self.whole() - time;
            1.0 - 0.5 * left * left / self.ramp / total
        }
    }

    /// When a share of the travel in [0, 1] is done \[s\]: the inverse of [`Trapezoid::fraction`].
    pub fn time(&self, fraction: f64) -> f64 {
        match self.part {
            None => self.time_of_whole(fraction),
            Some(part) => self.time_of_whole(part.from + part.span * fraction) - part.begins,
        }
    }

    fn time_of_whole(&self, fraction: f64) -> f64 {
        let total = self.ramp + self.cruise;
        let (fraction, mirrored) = if fraction > 0.5 { (1.0 - fraction, true) } else { (fraction, false) };
        let done = fraction * total;
        let time = if done < 0.5 * self.ramp { (2.0 * done * self.ramp).sqrt() } else { done + 0.5 * self.ramp };
        if mirrored { self.whole() - time } else { time }
    }

    /// Share of the travel made per second at `time` \[1/s\].
    pub fn rate(&self, time: f64) -> f64 {
        match self.part {
            None => self.rate_of_whole(time),
            Some(part) => self.rate_of_whole(part.begins + time) / part.span,
        }
    }

    fn rate_of_whole(&self, time: f64) -> f64 {
        let edge = time.min(self.whole() - time).max(0.0);
        let ramped = if self.ramp > 0.0 { (edge / self.ramp).min(1.0) } else { 0.0 };
        let total = self.ramp + self.cruise;
        if total > 0.0 { ramped / total } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_covers_the_travel_with_the_given_speed_and_acceleration() {
        let profile = SpeedProfile::new(0.5, 0.25, 1.0).unwrap();
        for travel in [4.0, 1.0, 0.3, -4.0] {
            let t = profile.over(travel);
            let step = 1e-4;
            let (mut fastest, mut before, mut steepest) = (0.0_f64, 0.0, 0.0_f64);
            let mut speed_before = 0.0;
            for i in 1..=(t.duration() / step) as usize {
                let position = t.fraction(i as f64 * step) * travel.abs();
                let speed = (position - before) / step;
                fastest = fastest.max(speed);
                steepest = steepest.max((speed - speed_before).abs() / step);
                (before, speed_before) = (position, speed);
            }
            assert!((before - travel.abs()).abs() < 1e-4, "{travel}: {before}");
            let expected = 0.5_f64.min((travel.abs() * 0.25).sqrt());
            assert!((fastest - expected).abs() < 1e-4 && steepest < 0.25 + 1e-3, "{travel}: {fastest} {steepest}");
        }
    }

    #[test]
    fn time_undoes_fraction_and_rate_is_its_slope_on_trapezoids_and_triangles() {
        for travel in [4.0, 0.3] {
            let t = SpeedProfile::new(0.5, 0.25, 1.0).unwrap().over(travel);
            for k in 0..=100 {
                let fraction = f64::from(k) / 100.0;
                let time = t.time(fraction);
                assert!((t.fraction(time) - fraction).abs() < 1e-12, "{travel} {fraction}");
                let slope = (t.fraction(time + 1e-6) - t.fraction(time - 1e-6)) / 2e-6;
                assert!(
                    (0.0..=t.duration()).contains(&time) && (t.rate(time) - slope).abs() < 1e-5,
                    "{travel} {fraction}"
                );
            }
        }
    }

    #[test]
    fn parts_of_a_move_follow_each_other_at_its_speed() {
        let whole = SpeedProfile::new(0.5, 0.25, 1.0).unwrap().over(4.0);
        let (mut begins, shares) = (0.0, [0.0, 0.05, 0.3, 0.8, 1.0]);
        for pair in shares.windows(2) {
            let (part, span) = (whole.between(pair[0], pair[1]), pair[1] - pair[0]);
            for k in 0..=20 {
                let time = part.duration() * f64::from(k) / 20.0;
                let expected = (whole.fraction(begins + time) - pair[0]) / span;
                assert!((part.fraction(time) - expected).abs() < 1e-12, "{pair:?} {time}");
                assert!((part.rate(time) * span - whole.rate(begins + time)).abs() < 1e-12, "{pair:?} {time}");
                assert!((part.time(part.fraction(time)) - time).abs() < 1e-9, "{pair:?} {time}");
            }
            assert_eq!((part.fraction(-1.0), part.fraction(part.duration() + 1.0)), (0.0, 1.0));
            begins += part.duration();
        }
        assert!((begins - whole.duration()).abs() < 1e-12);
    }

    #[test]
    fn no_travel_takes_no_time_and_is_done_at_once() {
        let t = SpeedProfile::default().over(0.0);
        assert_eq!((t.duration(), t.fraction(0.0), t.fraction(1.0)), (0.0, 0.0, 1.0));
    }
}
