//! Rigid motions in the form that makes their powers cheap.

use super::lane::Lane;
use super::trigonometry::{alternating_sign, any_large, folded_to_half_turn, sinc_cos, sinc_cos_near_zero};
use super::{Letter, Monoid, TickGeometry};

/// A rigid motion of the plane with its translation seen from halfway through its turn.
///
/// With the half rotation h and c + i s = e^(ih), the translation z in the start frame is z = e^(ih) (x + i y). A motion
/// with constant twist has y = 0, and in this frame a power only scales the translation by a real number:
///
/// ```text
/// g1 g2:  m = e^(-i h2) m1 + e^(i h1) m2        g^k:  m_k = m sin(k h) / sin(h) = m k sinc(k h) / sinc(h)
/// ```
///
/// The quotient of sincs has no 0/0 at h = 0, the most common rotation of all: a left and a right tick together.
#[derive(Clone, Copy, Debug)]
pub(super) struct MidHeading<T> {
    /// Half the rotation \[rad\], full turns included.
    pub half: T,
    /// cos(half)
    pub c: T,
    /// sin(half)
    pub s: T,
    /// Translation along the mid heading \[m\].
    pub x: T,
    /// Translation to the left of the mid heading \[m\].
    pub y: T,
}

/// What the powers of a motion share: its half rotation folded to \[-π/2, π/2\], and 1 / sinc of that.
///
/// Folding matters where a motion is close to whole turns: sin(k h) / sin(h) is then 0/0 in its rounding errors, the same
/// quotient of the folded angle is not.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root<T> {
    half: T,
    inverse_sinc: T,
    /// Half turns folded away; `None` if no lane has any.
    half_turns: Option<T>,
}

impl<T: Lane> MidHeading<T> {
    #[inline(always)]
    pub fn product(&self, next: &Self) -> Self {
        MidHeading {
            half: self.half + next.half,
            c: self.c * next.c - self.s * next.s,
            s: self.c * next.s + self.s * next.c,
            x: (next.c * self.x + next.s * self.y) + (self.c * next.x - self.s * next.y),
            y: (next.c * self.y - next.s * self.x) + (self.c * next.y + self.s * next.x),
        }
    }

    /// \[x, y, cosine, sine\]: the end in the start frame and the direction of its heading. No zero has a minus sign, so that a factor left
    /// out and an identity factor give the same bits.
    #[inline(always)]
    pub fn end(&self) -> [T; 4] {
        let zero = self.half.splat(0.0);
        [
            self.c * self.x - self.s * self.y + zero,
            self.s * self.x + self.c * self.y + zero,
            self.c * self.c - self.s * self.s,
            self.half.splat(2.0) * self.c * self.s + zero,
        ]
    }

    #[inline(always)]
    pub fn root_in_lanes(&self) -> Root<T> {
        if any_large(self.half) {
            let (half, half_turns) = folded_to_half_turn(self.half);
            Root { half, inverse_sinc: half.splat(1.0) / sinc_cos(half).0, half_turns: Some(half_turns) }
        } else {
            self.root_near_zero()
        }
    }

    /// The root, if no |half| is past π/4.
    #[inline(always)]
    pub fn root_near_zero(&self) -> Root<T> {
        let inverse_sinc = self.half.splat(1.0) / sinc_cos_near_zero(self.half).0;
        Root { half: self.half, inverse_sinc, half_turns: None }
    }

    /// The closed form of the k-th power, for a whole number k.
    #[inline(always)]
    pub fn closed_power(&self, root: &Root<T>, k: T) -> Self {
        let angle = k * root.half;
        let (sinc, cosine) = sinc_cos(angle);
        let power = self.power_of_angle(root, k, angle, sinc, cosine);
        match root.half_turns {
            None => power,
            Some(half_turns) => {
                // e^(i k (h' + j π)) = (-1)^(k j) e^(i k h'), and the quotient of sines has one sign less.
                let sign = alternating_sign(k * half_turns);
                let scale = sign * alternating_sign(half_turns);
                let MidHeading { c, s, x, y, .. } = power;
                MidHeading { half: k * self.half, c: sign * c, s: sign * s, x: scale * x, y: scale * y }
            }
        }
    }

    /// The closed form of the k-th power, if no |half| and no |k half| is past π/4.
    #[inline(always)]
    pub fn closed_power_near_zero(&self, root: &Root<T>, k: T) -> Self {
        let angle = k * root.half;
        let (sinc, cosine) = sinc_cos_near_zero(angle);
        self.power_of_angle(root, k, angle, sinc, cosine)
    }

    #[inline(always)]
    fn power_of_angle(&self, root: &Root<T>, k: T, angle: T, sinc: T, cosine: T) -> Self {
        let scale = k * sinc * root.inverse_sinc;
        MidHeading { half: angle, c: cosine, s: sinc * angle, x: scale * self.x, y: scale * self.y }
    }
}

impl MidHeading<f64> {
    const IDENTITY: MidHeading<f64> = MidHeading { half: 0.0, c: 1.0, s: 0.0, x: 0.0, y: 0.0 };

    /// The motion along a circular arc of the given length \[m\] and rotation \[rad\].
    pub fn arc(length: f64, rotation: f64) -> MidHeading<f64> {
        let half = 0.5 * rotation;
        let (sinc, c) = sinc_cos(half);
        MidHeading { half, c, s: sinc * half, x: length * sinc, y: 0.0 }
    }

    /// What a tick does: one wheel turns about the contact point of the other, or both roll together.
    pub fn of_letter(geometry: &TickGeometry, letter: Letter, backward: [bool; 2]) -> MidHeading<f64> {
        let step = backward.map(|backward| if backward { -1 } else { 1 });
        let counts = match letter {
            Letter::Left => [step[0], 0],
            Letter::Right => [0, step[1]],
            Letter::Joint => step,
        };
        // The angles of both ticks, each rounded by itself, so that both together err as they do one after the other.
        let rotation = geometry.heading([counts[0], 0]) + geometry.heading([0, counts[1]]);
        MidHeading::arc(geometry.distance(counts), rotation)
    }

    /// The same arc driven backward, if `backward`.
    #[inline(always)]
    pub fn reversed_if(self, backward: bool) -> MidHeading<f64> {
        let sign = if backward { -1.0 } else { 1.0 };
        MidHeading { half: sign * self.half, s: sign * self.s, x: sign * self.x, ..self }
    }
}

impl Monoid for MidHeading<f64> {
    type Root = Root<f64>;

    #[inline(always)]
    fn identity() -> Self {
        MidHeading::IDENTITY
    }

    #[inline(always)]
    fn then(&self, next: &Self) -> Self {
        self.product(next)
    }

    #[inline(always)]
    fn root(&self) -> Root<f64> {
        self.root_in_lanes()
    }

    #[inline(always)]
    fn power_from(&self, root: Root<f64>, exponent: u64) -> Self {
        match exponent {
            0 => MidHeading::IDENTITY,
            1 => *self,
            k => self.closed_power(&root, k as f64),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both signs, zero, near and at half turns and whole turns.
    const ROTATIONS: [f64; 13] = [
        -7.0,
        -std::f64::consts::TAU,
        -3.2,
        -std::f64::consts::PI,
        -0.8,
        -1e-3,
        0.0,
        1e-9,
        0.5,
        1.6,
        3.1,
        std::f64::consts::TAU,
        12.566_370_614_359_172,
    ];

    #[test]
    fn a_power_is_that_many_products_for_every_rotation_near_whole_turns_too() {
        for rotation in ROTATIONS {
            let bent = MidHeading::arc(0.3, 0.4).then(&MidHeading::arc(-0.2, rotation - 0.4));
            let mut product = MidHeading::identity();
            for k in 0..60 {
                let power = bent.power(k);
                let error =
                    [(power.c - product.c), (power.s - product.s), (power.x - product.x), (power.y - product.y)];
                assert!(error.iter().all(|e| e.abs() < 3e-13), "{rotation}^{k}: {error:?}");
                assert!((power.half - product.half).abs() < 1e-12);
                product = product.then(&bent);
            }
        }
    }

    #[test]
    fn no_zero_of_an_end_has_a_minus_sign() {
        let signs = [0.0, -0.0];
        for (half, s) in signs.iter().flat_map(|half| signs.map(|s| (*half, s))) {
            for (x, y) in signs.iter().flat_map(|x| signs.map(|y| (*x, y))) {
                let end = MidHeading { half, c: 1.0, s, x, y }.end();
                assert_eq!(end.map(f64::to_bits), [0.0, 0.0, 1.0, 0.0_f64].map(f64::to_bits), "{half} {s} {x} {y}");
            }
            let across = MidHeading { half, c: s, s: 1.0, x: half, y: half }.end();
            assert!(across.iter().all(|v| *v != 0.0 || v.is_sign_positive()), "{across:?}");
        }
    }

    #[test]
    fn a_tick_turns_the_robot_about_the_other_wheel() {
        let geometry = TickGeometry::new(0.002, 0.003, 0.5).unwrap();
        for (letter, backward, side) in [(Letter::Left, false, -0.25), (Letter::Right, true, 0.25)] {
            let tick = MidHeading::of_letter(&geometry, letter, [backward; 2]);
            let (sine, cosine) = libm::sincos(2.0 * tick.half);
            let (x, y) = (tick.c * tick.x - tick.s * tick.y, tick.s * tick.x + tick.c * tick.y);
            // The contact point of the wheel that stands still, before and after.
            assert!((x - sine * side).abs() < 1e-15 && (y + cosine * side - side).abs() < 1e-15, "{letter:?}");
            assert!(tick.half < 0.0);
        }
    }
}
