//! The ordered product of all ticks of a segment in O(log ticks) operations.
//!
//! In the plane of the wheel angles a segment is a straight line, a left tick (L) the crossing of a vertical grid line, a
//! right tick (R) the crossing of a horizontal one. With y(k) right ticks at or before the k-th left one, the word is
//!
//! ```text
//! R^y(1) L · W · R^after,   W = Π_{k=2..n} U^(y(k)-y(k-1)) X,   X = L, U = R,   y(k) - y(1) = floor((P (k-1) + r) / Q)
//! ```
//!
//! and W is computed by Euclid's algorithm on its slope P/Q, with words for numbers:
//!
//! * *shear*, P >= Q: every X is preceded by at least k = floor(P/Q) U's, so U^k X becomes the new X and P the remainder;
//! * *swap*, P < Q: now the X's come in groups, one before each U. Those before the first U and after the last one are
//!   split off to the front and the back, and X and U change their roles.
//!
//! Carrying the residual at the last letter (`last`) beside that at the first one (`first`) keeps every number below Q;
//! from the length alone it would have to be recomputed in twice the width. Each level costs three divisions by the same
//! number and three powers of the same element. The depth is that of the continued fraction of the speed ratio, cut off
//! at the number of ticks.
//!
//! The recursion is known in competitive programming as the universal Euclidean algorithm, or floor sum over a monoid.

use super::digital_line::DigitalLine;
use super::{Monoid, WheelLine};

/// A letter of the word of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Letter {
    /// The left counter ticks.
    Left,
    /// The right counter ticks.
    Right,
    /// Both counters tick at the same instant.
    Joint,
}

/// The product of the elements of `alphabet` in the order in which the counters tick along `line`.
///
/// Ticks of a wheel that turns backward ([`WheelLine::backward`]) are the same letters; it is for `alphabet` to return
/// the inverse. [`Letter::Joint`] is asked for only if the line can pass through a lattice point: exactly simultaneous
/// ticks are one letter, because an order between them would turn a robot that drives straight.
pub fn word_product<M: Monoid>(line: &WheelLine, alphabet: impl Fn(Letter) -> M) -> M {
    product(&DigitalLine::new(line), alphabet)
}

#[inline(always)]
pub(super) fn product<M: Monoid>(line: &DigitalLine, alphabet: impl Fn(Letter) -> M) -> M {
    if line.left == 0 {
        alphabet(Letter::Right).power(line.right)
    } else if line.right == 0 {
        alphabet(Letter::Left).power(line.left)
    } else if line.ties {
        product_with_ties(line, alphabet)
    } else {
        product_without_ties(line, alphabet)
    }
}

/// Left factor times right factor, where either may be missing.
#[inline(always)]
fn joined<M: Monoid>(head: M, tail: Option<M>) -> M {
    match tail {
        Some(tail) => head.then(&tail),
        None => head,
    }
}

#[inline(always)]
fn product_without_ties<M: Monoid>(line: &DigitalLine, alphabet: impl Fn(Letter) -> M) -> M {
    let (left, right) = (alphabet(Letter::Left), alphabet(Letter::Right));
    let right_root = right.root();
    let mut front = match line.before {
        0 => left.clone(),
        n => right.power_from(right_root, n).then(&left),
    };
    let mut back = (line.after > 0).then(|| right.power_from(right_root, line.after));

    let (mut x, mut u) = (left, right);
    let (mut p, mut q) = (line.rise, line.run);
    let (mut first, mut last) = (line.first, line.last);
    let (mut x_count, mut u_count) = (line.left - 1, line.between);
    if p >= q && x_count > 0 {
        let k = p / q;
        p -= k * q;
        u_count -= k * x_count;
        x = u.power_from(right_root, k).then(&x);
    }
    // Here and at the start of each round P < Q, and W holds x_count X's and u_count U's.
    while u_count > 0 {
        let to_first = q - first - 1;
        let (head, tail, k) = (to_first / p, last / p + 1, q / p);
        let root = x.root();
        if head > 0 {
            front = front.then(&x.power_from(root, head));
        }
        front = front.then(&u);
        back = Some(joined(x.power_from(root, tail), back));

        first = to_first - head * p;
        last = tail * p - 1 - last;
        let groups = u_count - 1;
        (x_count, u_count) = (groups, x_count - head - tail - k * groups);
        (p, q) = (q - k * p, p);
        if groups > 0 {
            (x, u) = (x.power_from(root, k).then(&u), x);
        }
    }
    if x_count > 0 {
        front = front.then(&x.power(x_count));
    }
    joined(front, back)
}

/// As [`product_without_ties`], with a third letter: D stands for a U and an X that fall together.
///
/// A group of U's before an X ends in D instead of U X where its residual is 0. Under the shear D becomes U^k D. Under
/// the swap it stays, with the tie now ending a group of X's.
#[inline(never)]
fn product_with_ties<M: Monoid>(line: &DigitalLine, alphabet: impl Fn(Letter) -> M) -> M {
    let (mut x, mut u, mut d) = (alphabet(Letter::Left), alphabet(Letter::Right), alphabet(Letter::Joint));
    // U^n X, or U^(n-1) D where the last U falls together with the X.
    let group = |x: &M, u: &M, d: &M, n: u64, tie: bool| match n {
        0 => x.clone(),
        n if tie => u.power(n - 1).then(d),
        n => u.power(n).then(x),
    };
    let (mut p, mut q) = (line.rise, line.run);
    let (mut first, mut last) = (line.first, line.last);
    let (mut x_count, mut u_count) = (line.left - 1, line.between);
    let mut front = group(&x, &u, &d, line.before, first == 0);
    let mut back = u.power(line.after);
    loop {
        if x_count == 0 {
            return front.then(&back);
        }
        let k = p / q;
        p -= k * q;
        u_count -= k * x_count;
        if p == 0 {
            // The slope is used up: all groups that remain are alike.
            return front.then(&group(&x, &u, &d, k, first == 0).power(x_count)).then(&back);
        }
        let drag = u.power(k);
        (x, d) = (drag.then(&x), drag.then(&d));
        if u_count == 0 {
            return front.then(&x.power(x_count)).then(&back);
        }
        // X's at or before the first U; X's strictly after the last U.
        let to_first = q - first;
        let (head, tail) = (to_first / p, last.div_ceil(p));
        first = to_first - head * p;
        last = tail * p - last;
        front = front.then(&group(&u, &x, &d, head, first == 0));
        back = x.power(tail).then(&back);
        (x_count, u_count) = (u_count - 1, x_count - head - tail);
        (x, u) = (u, x);
        (p, q) = (q, p);
    }
}

#[cfg(test)]
mod tests;
