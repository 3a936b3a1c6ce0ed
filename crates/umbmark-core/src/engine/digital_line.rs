//! A wheel line reduced to the small integers that fix the order of its ticks.

use super::WheelLine;

/// The ticks of a line with both wheels mirrored forward, counted as right ticks between left ones.
///
/// With travels Q (left) and P (right) and start phases a, b, the right ticks at or before the k-th left tick number y(k) = floor((P k + ρ)
/// / Q), ρ = floor((b Q - a P) / 2^32). The residual (P k + ρ) mod Q at the first left tick and at the last one, together with the number
/// of ticks between them, determine the word in between.
#[derive(Clone, Copy, Debug)]
pub(super) struct DigitalLine {
    /// Ticks of the left wheel.
    pub left: u64,
    /// Ticks of the right wheel.
    pub right: u64,
    /// Right ticks at or before the first left tick. This and all that follows is 0 unless both wheels tick.
    pub before: u64,
    /// Right ticks between the first left tick and the last one, the latter's included.
    pub between: u64,
    /// Right ticks after the last left tick.
    pub after: u64,
    /// Travel of the right wheel, P.
    pub rise: u64,
    /// Travel of the left wheel, Q.
    pub run: u64,
    /// Residual at the first left tick, in \[0, Q).
    pub first: u64,
    /// Residual at the last left tick, in \[0, Q).
    pub last: u64,
    /// The line may pass through lattice points: both counters may tick at once.
    pub ties: bool,
}

impl DigitalLine {
    #[inline(always)]
    pub fn new(line: &WheelLine) -> DigitalLine {
        let forward = line.mirrored_forward();
        let ([a, b], [run, rise]) = (forward.start(), forward.travel());
        let [left, right] = forward.counts();
        let only = DigitalLine {
            left: left as u64,
            right: right as u64,
            before: 0,
            between: 0,
            after: 0,
            rise: rise as u64,
            run: run as u64,
            first: 0,
            last: 0,
            ties: false,
        };
        if left == 0 || right == 0 {
            return only;
        }
        let [a_end, b_end] = forward.end_phases();
        // b Q - a P = 2^32 (b n_L - a n_R) + (b a' - a b') with the end phases a', b': the wide part is one 64-bit
        // product pair.
        let fine = i128::from(b) * i128::from(a_end) - i128::from(a) * i128::from(b_end);
        let start_offset = b * left - a * right + (fine >> 32) as i64;
        // The offset of the line from the lattice point at its end; the true value is less than Q + P in size.
        let end_offset = start_offset - right * (a_end - a) + left * (b_end - b);
        let to_first = (rise + start_offset) as u64;
        let before = to_first / only.run;
        // floor(end_offset / Q) = -after
        let after = if end_offset < 0 { (-(end_offset + 1)) as u64 / only.run + 1 } else { 0 };
        DigitalLine {
            before,
            between: only.right - before - after,
            after,
            first: to_first - before * only.run,
            last: (end_offset + (after * only.run) as i64) as u64,
            ties: fine as u32 == 0,
            ..only
        }
    }
}
