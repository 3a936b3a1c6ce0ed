//! A low-pass filter of the first order.

/// What it shows of some numbers that change steadily from one time to the next: of the first, these themselves.
///
/// ```text
/// d behind / dt = d now / dt - behind / τ,   shown = now - behind
/// ```
pub(super) struct LowPass<const N: usize> {
    /// τ \[s\]
    time_constant: f64,
    behind: [f64; N],
    last: Option<(f64, [f64; N])>,
}

impl<const N: usize> LowPass<N> {
    pub fn new(time_constant: f64) -> LowPass<N> {
        LowPass { time_constant, behind: [0.0; N], last: None }
    }

    /// What it shows at the next time \[s\].
    pub fn follow(&mut self, time: f64, now: [f64; N]) -> [f64; N] {
        if let Some((before, from)) = self.last {
            let share = (time - before) / self.time_constant;
            // Of a steady change, (1 - exp(-share)) / share is left behind.
            let (kept, added) = (libm::exp(-share), if share > 0.0 { -libm::expm1(-share) / share } else { 1.0 });
            for (k, behind) in self.behind.iter_mut().enumerate() {
                *behind = kept * *behind + added * (now[k] - from[k]);
            }
        }
        self.last = Some((time, now));
        std::array::from_fn(|k| now[k] - self.behind[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_shown_late_by_the_time_constant_and_a_step_fades_by_it() {
        let (mut ramp, mut step) = (LowPass::<1>::new(0.2), LowPass::<1>::new(0.2));
        for k in 0..200 {
            let time = 0.03 * f64::from(k);
            let shown = ramp.follow(time, [time])[0];
            let expected = time - 0.2 * (1.0 - libm::exp(-time / 0.2));
            assert!((shown - expected).abs() < 1e-12, "{time}: {shown}");
        }
        step.follow(0.0, [0.0]);
        step.follow(1e-9, [1.0]);
        let shown = step.follow(0.2, [1.0])[0];
        assert!((shown - (1.0 - libm::exp(-1.0))).abs() < 1e-6, "{shown}");
    }
}
