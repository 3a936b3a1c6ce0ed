//! The first guess of a clock: where speed and turn rate agree best.

use super::motion::Motion;

/// Offset and rate within the reach of the fit.
pub(super) struct Guess {
    /// The track's clock at the middle of the ticks \[s\].
    pub offset: f64,
    pub rate: f64,
    /// Correlation of the two motions there.
    pub agreement: f64,
}

/// Rates looked at: 1 ± 5 % in steps of 0.5 %.
const RATES: std::ops::RangeInclusive<i32> = -10..=10;
const RATE_STEP: f64 = 0.005;
/// Finest step of the grid \[s\], and the most steps over the ticks.
const STEP: f64 = 0.1;
const MAX_STEPS: f64 = 2000.0;
/// The same, and the most tries, when looking closer.
const MOST_CLOSER: f64 = 20_000.0;
const TRIES: usize = 400;

/// Speed and turn rate (times the wheels' arm) on an even grid.
struct Rates {
    forward: Vec<f64>,
    turn: Vec<f64>,
}

impl Rates {
    fn of(motion: &Motion, start: f64, step: f64, steps: usize, arm: f64, turns: bool) -> Rates {
        let poses: Vec<_> = (0..=steps).map(|i| motion.at(start + step * i as f64)).collect();
        let pairs = || poses.windows(2);
        let forward = pairs().map(|p| libm::hypot(p[1].x - p[0].x, p[1].y - p[0].y)).collect();
        let arm = if turns { arm } else { 0.0 };
        Rates { forward, turn: pairs().map(|p| arm * (p[1].heading - p[0].heading)).collect() }
    }

    fn energy(&self) -> f64 {
        self.forward.iter().chain(&self.turn).map(|value| value * value).sum()
    }

    /// Sum of products where `other` begins `lag` steps into this; outside of it nothing moves.
    fn product(&self, other: &Rates, lag: isize) -> f64 {
        let from = lag.max(0) as usize;
        let to = (lag + other.forward.len() as isize).clamp(0, self.forward.len() as isize) as usize;
        let begin = (from as isize - lag) as usize;
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        if from >= to {
            return 0.0;
        }
        sum(&self.forward[from..to], &other.forward[begin..]) + sum(&self.turn[from..to], &other.turn[begin..])
    }
}

/// Looks at every offset at which the two overlap and every rate, and then closer around the best.
pub(super) fn search(ticks: &Motion, seen: &Motion, arm: f64) -> Guess {
    let half = 0.5 * (ticks.last() - ticks.first());
    let step = STEP.max(2.0 * half / MAX_STEPS).max((seen.last() - seen.first()) / (2.0 * MAX_STEPS));
    let steps = |span: f64| ((span / step).ceil() as usize).max(1);
    let track = Rates::of(seen, seen.first(), step, steps(seen.last() - seen.first()), arm, seen.has_heading);
    let mut best = Guess { offset: 0.0, rate: 1.0, agreement: f64::NEG_INFINITY };
    for rate in RATES.map(|i| 1.0 + RATE_STEP * f64::from(i)) {
        // The ticks, slowed to the track's clock.
        let moved = Rates::of(ticks, ticks.first(), step / rate, steps(2.0 * half * rate), arm, seen.has_heading);
        let scale = (track.energy() * moved.energy()).sqrt();
        for lag in -(moved.forward.len() as isize) + 1..track.forward.len() as isize {
            let agreement = track.product(&moved, lag) / scale;
            if agreement > best.agreement {
                let offset = seen.first() + step * lag as f64 + half * rate;
                best = Guess { offset, rate, agreement };
            }
        }
    }
    closer(ticks, seen, arm, best, step)
}

/// Halves the steps around a guess until they are small beside a tick's period.
fn closer(ticks: &Motion, seen: &Motion, arm: f64, mut best: Guess, step: f64) -> Guess {
    let half = 0.5 * (ticks.last() - ticks.first());
    let fine = STEP.max(2.0 * half / MOST_CLOSER).min(step);
    let steps = ((2.0 * half / fine).ceil() as usize).max(1);
    let counted = Rates::of(ticks, ticks.first(), fine, steps, arm, seen.has_heading);
    let agreement = |offset: f64, rate: f64| {
        let track = Rates::of(seen, offset - half * rate, fine * rate, steps, arm, seen.has_heading);
        track.product(&counted, 0) / (track.energy() * counted.energy()).sqrt()
    };
    best.agreement = agreement(best.offset, best.rate);
    let (mut ahead, mut faster) = (step, RATE_STEP);
    for _ in 0..TRIES {
        if ahead <= 0.1 * ticks.period.min(0.1) {
            break;
        }
        let tried = [(ahead, 0.0), (-ahead, 0.0), (0.0, faster), (0.0, -faster)];
        let next = tried
            .map(|(a, f)| (best.offset + a, best.rate + f))
            .map(|(offset, rate)| Guess { offset, rate, agreement: agreement(offset, rate) })
            .into_iter()
            .max_by(|a, b| a.agreement.total_cmp(&b.agreement));
        match next {
            Some(next) if next.agreement > best.agreement => best = next,
            _ => (ahead, faster) = (0.5 * ahead, 0.5 * faster),
        }
    }
    best
}
