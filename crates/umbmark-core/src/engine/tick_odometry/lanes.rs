//! The word product of several lines side by side.
//!
//! The algorithm of [`word`](crate::engine::word) with its integers as exact whole numbers in `f64`: all stay below 2^53 for lines of less
//! than 2^20 ticks. A line that is finished before the others continues with exponents of 0, and the power 0 is the identity to the last
//! bit. So each line gets the same operations as alone, in the same order.

use crate::engine::lane::Lane;
use crate::engine::mid_heading::{MidHeading, Root};
use crate::engine::trigonometry::LARGE;
use crate::engine::{TickGeometry, UNITS_PER_TICK, WheelLine};

/// Lines whose wheels travel less than this far \[units\] can go side by side.
pub(super) const TRAVEL_LIMIT: i64 = 1 << 52;

/// N lines, wheel by wheel: start and travel of the left and the right wheel \[units\], whole numbers.
///
/// Aligned to a cache line, so that no register straddles two.
#[repr(align(64))]
pub(super) struct Block<const N: usize> {
    pub start: [[f64; N]; 2],
    pub travel: [[f64; N]; 2],
}

impl<const N: usize> Block<N> {
    /// The lines of a block; one that is too long, or missing, is replaced by no motion.
    #[inline(always)]
    pub fn new<L: AsRef<WheelLine>>(lines: &[L]) -> Block<N> {
        let mut block = Block { start: [[0.0; N]; 2], travel: [[0.0; N]; 2] };
        for (i, line) in lines.iter().map(AsRef::as_ref).enumerate().take(N) {
            if fits(line) {
                for wheel in 0..2 {
                    block.start[wheel][i] = line.start()[wheel] as f64;
                    block.travel[wheel][i] = line.travel()[wheel] as f64;
                }
            }
        }
        block
    }
}

/// Whether a line is short enough for whole numbers in `f64`.
#[inline(always)]
pub(super) fn fits(line: &WheelLine) -> bool {
    line.travel().iter().all(|travel| travel.abs() < TRAVEL_LIMIT)
}

/// What is computed of each line: x, y, heading, cosine, sine of its motion, and 1 where the line may have simultaneous
/// ticks and must be done alone.
pub(super) const RESULTS: usize = 6;

/// 1/divisor, low enough that no quotient estimated with it is too large.
#[inline(always)]
fn reciprocal<T: Lane>(divisor: T) -> T {
    divisor.splat(1.0 - 2.0 * f64::EPSILON) / divisor
}

/// The results of N lines, aligned as [`Block`].
#[repr(align(64))]
pub(super) struct Results<const N: usize>(pub [[f64; N]; RESULTS]);

/// Quotient and remainder of whole numbers, the quotient rounded down, given the divisor's [`reciprocal`].
///
/// The estimate is right or one too small, for quotients up to 2^48.
#[inline(always)]
fn divided<T: Lane>(number: T, divisor: T, reciprocal: T) -> (T, T) {
    let quotient = (number * reciprocal).floor();
    let rest = number - quotient * divisor;
    let enough = rest.less(divisor);
    (T::select(enough, quotient, quotient + number.splat(1.0)), T::select(enough, rest, rest - divisor))
}

/// floor((b a' - a b') / 2^32) for whole numbers below 2^32, and whether there is no remainder (1 or 0).
///
/// The products have 64 bits; multiplied in halves, each fits.
#[inline(always)]
fn scaled_cross<T: Lane>(a: T, b: T, a_end: T, b_end: T) -> (T, T) {
    let (half, inverse) = (a.splat(65536.0), a.splat(1.0 / 65536.0));
    let (a_high, b_high) = ((a_end * inverse).floor(), (b_end * inverse).floor());
    let (a_low, b_low) = (a_end - a_high * half, b_end - b_high * half);
    let low = b * a_low - a * b_low;
    let carried = (low * inverse).floor();
    let high = (b * a_high - a * b_high) + carried;
    let cross = (high * inverse).floor();
    let rest = (low - carried * half) + (high - cross * half);
    (cross, T::select(rest.equal(a.splat(0.0)), a.splat(1.0), a.splat(0.0)))
}

#[inline(always)]
fn select_motion<T: Lane>(mask: T::Mask, yes: MidHeading<T>, no: MidHeading<T>) -> MidHeading<T> {
    MidHeading {
        half: T::select(mask, yes.half, no.half),
        c: T::select(mask, yes.c, no.c),
        s: T::select(mask, yes.s, no.s),
        x: T::select(mask, yes.x, no.x),
        y: T::select(mask, yes.y, no.y),
    }
}

/// What `closed` is of an exponent above 1; 0 and 1 give the identity and the motion itself to the last bit.
#[inline(always)]
fn power<T: Lane>(motion: &MidHeading<T>, exponent: T, closed: MidHeading<T>) -> MidHeading<T> {
    select_motion(exponent.equal(exponent.splat(1.0)), *motion, closed)
}

/// A power that is rarely above the first.
#[inline(always)]
fn small_power<T: Lane>(motion: &MidHeading<T>, exponent: T) -> MidHeading<T> {
    let (zero, one) = (exponent.splat(0.0), exponent.splat(1.0));
    let closed = if T::any(one.less(exponent)) {
        motion.closed_power(&motion.root_in_lanes(), exponent)
    } else {
        MidHeading { half: zero, c: one, s: zero, x: zero, y: zero }
    };
    power(motion, exponent, closed)
}

/// Powers of one motion. The usual case, all angles near zero, is decided once for all.
struct Powers<T> {
    motion: MidHeading<T>,
    root: Root<T>,
    near_zero: bool,
}

impl<T: Lane> Powers<T> {
    /// For exponents up to `largest`, lane by lane.
    #[inline(always)]
    fn new(motion: MidHeading<T>, largest: T) -> Powers<T> {
        let angle = largest.max(largest.splat(1.0)) * motion.half.abs();
        let near_zero = !T::any(angle.splat(LARGE).less(angle));
        let root = if near_zero { motion.root_near_zero() } else { motion.root_in_lanes() };
        Powers { motion, root, near_zero }
    }

    #[inline(always)]
    fn of(&self, exponent: T) -> MidHeading<T> {
        let closed = if self.near_zero {
            self.motion.closed_power_near_zero(&self.root, exponent)
        } else {
            self.motion.closed_power(&self.root, exponent)
        };
        power(&self.motion, exponent, closed)
    }
}

/// A forward tick in every lane, or its reverse where `sign` is -1.
#[inline(always)]
fn tick<T: Lane>(tick: &MidHeading<f64>, sign: T) -> MidHeading<T> {
    MidHeading {
        half: sign * sign.splat(tick.half),
        c: sign.splat(tick.c),
        s: sign * sign.splat(tick.s),
        x: sign * sign.splat(tick.x),
        y: sign.splat(0.0),
    }
}

/// The results of the lines with these starts and travels (left, right) for the given forward ticks.
#[inline(always)]
pub(super) fn results<T: Lane>(
    geometry: &TickGeometry,
    ticks: [&MidHeading<f64>; 2],
    start: [T; 2],
    travel: [T; 2],
) -> [T; RESULTS] {
    let zero = start[0].splat(0.0);
    let one = zero.splat(1.0);
    let unit = zero.splat(UNITS_PER_TICK as f64);
    let per_unit = zero.splat(1.0 / UNITS_PER_TICK as f64);

    // Both wheels mirrored forward.
    let (left_back, right_back) = (travel[0].less(zero), travel[1].less(zero));
    let left_sign = T::select(left_back, zero - one, one);
    let right_sign = T::select(right_back, zero - one, one);
    let a = T::select(left_back, (unit - one) - start[0], start[0]);
    let b = T::select(right_back, (unit - one) - start[1], start[1]);
    let (run, rise) = (travel[0].abs(), travel[1].abs());
    let left = ((a + run) * per_unit).floor();
    let right = ((b + rise) * per_unit).floor();
    let (a_end, b_end) = ((a + run) - left * unit, (b + rise) - right * unit);

    // The digital line, as in `DigitalLine`; nothing but counts where a wheel does not tick.
    let (left_still, right_still) = (left.equal(zero), right.equal(zero));
    let one_wheel = T::either(left_still, right_still);
    let (cross, no_rest) = scaled_cross(a, b, a_end, b_end);
    let ties = T::select(one_wheel, zero, no_rest);
    let start_offset = (b * left - a * right) + cross;
    let end_offset = (start_offset - right * (a_end - a)) + left * (b_end - b);
    let per_run = reciprocal(run);
    let (before, mut first) = divided(rise + start_offset, run, per_run);
    let (minus_after, mut last) = divided(end_offset, run, per_run);
    let before = T::select(one_wheel, zero, before);
    let after = T::select(one_wheel, T::select(left_still, right, zero), zero - minus_after);
    let mut u_count = T::select(one_wheel, zero, (right - before) - after);
    let mut x_count = T::select(left_still, zero, T::select(right_still, left, left - one));

    let (left_tick, right_tick) = (tick(ticks[0], left_sign), tick(ticks[1], right_sign));
    let identity = MidHeading { half: zero, c: one, s: zero, x: zero, y: zero };
    let mut front = small_power(&right_tick, before).product(&left_tick);
    front = select_motion(one_wheel, identity, front);
    let mut back = small_power(&right_tick, after);

    let (mut p, mut q) = (rise, run);
    let (k, rest) = divided(p, q, per_run);
    let k = T::select(T::either(one_wheel, x_count.equal(zero)), zero, k);
    p = rest;
    u_count = u_count - k * x_count;
    let (mut x, mut u) = (small_power(&right_tick, k).product(&left_tick), right_tick);

    loop {
        let active = zero.less(u_count);
        if !T::any(active) {
            break;
        }
        let per_p = reciprocal(p);
        let to_first = q - first - one;
        let (head, head_rest) = divided(to_first, p, per_p);
        let (tail, tail_rest) = divided(last, p, per_p);
        let (k, k_rest) = divided(q, p, per_p);
        let groups = u_count - one;
        let more = zero.less(groups);
        let head = T::select(active, head, zero);
        let tail = T::select(active, tail + one, zero);
        let k = T::select(more, k, zero);

        // Lines that are done must not send the others down the path of large angles.
        let base = MidHeading { half: T::select(active, x.half, zero), ..x };
        let powers = Powers::new(base, head.max(tail).max(k));
        let front_more = front.product(&powers.of(head)).product(&u);
        front = select_motion(active, front_more, front);
        back = powers.of(tail).product(&back);
        // With the last U a line has no X's left, and needs neither again.
        if T::any(more) {
            let x_more = powers.of(k).product(&u);
            u = select_motion(active, x, u);
            x = select_motion(active, x_more, x);
        }

        first = head_rest;
        last = (p - one) - tail_rest;
        (p, q) = (k_rest, p);
        let x_left = (x_count - head - tail) - k * groups;
        x_count = T::select(active, groups, x_count);
        u_count = T::select(active, x_left, zero);
    }
    let product = front.product(&small_power(&x, x_count)).product(&back);
    let [x, y, cosine, sine] = product.end();
    let turned = right * right_sign * zero.splat(geometry.right()) - left * left_sign * zero.splat(geometry.left());
    [x, y, turned / zero.splat(geometry.wheelbase()) + zero, cosine, sine, ties]
}
