//! Rigid motions of the plane and their logarithms.

use super::{Dual, Real, wrap};

/// A pose of a body in the plane, `world_from_body`.
///
/// The heading is kept as given, so full turns are remembered; every operation depends on it only through its sine and
/// cosine, except that [`compose`](Pose2::compose) adds headings and [`inverse`](Pose2::inverse) negates them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose2<T = f64> {
    /// \[m\]
    pub x: T,
    /// \[m\]
    pub y: T,
    /// \[rad\], counter-clockwise from the x axis.
    pub heading: T,
}

/// A motion in the body's own frame: twist times time, the element of se(2) that [`Pose2::exp`] integrates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement2<T = f64> {
    /// \[m\], along the heading.
    pub forward: T,
    /// \[m\], to the left.
    pub sideways: T,
    /// \[rad\], counter-clockwise.
    pub rotation: T,
}

impl Displacement2 {
    /// No motion.
    pub const NONE: Displacement2 = Displacement2 { forward: 0.0, sideways: 0.0, rotation: 0.0 };
}

impl Default for Pose2 {
    fn default() -> Self {
        Pose2::IDENTITY
    }
}

impl Pose2 {
    /// The origin, heading along the x axis.
    pub const IDENTITY: Pose2 = Pose2 { x: 0.0, y: 0.0, heading: 0.0 };

    /// The displacement whose [`exp`](Pose2::exp) is this pose, with the rotation wrapped into (-π, π].
    ///
    /// ξ = (e^(-ih) (x + iy) / sinc h, θ) with h = θ/2: one motion along a circular arc. A rigid motion does not know how
    /// many full turns it took; the shortest is returned, and it exists for every pose.
    pub fn log(&self) -> Displacement2 {
        let rotation = wrap(self.heading);
        let half = 0.5 * rotation;
        let (sinc, cosine) = half.sinc_cos();
        let sine = sinc * half;
        Displacement2 {
            forward: (cosine * self.x + sine * self.y) / sinc,
            sideways: (cosine * self.y - sine * self.x) / sinc,
            rotation,
        }
    }

    /// The pose on the way to `to`, with constant twist, where a share of it is made.
    pub fn toward(&self, to: &Pose2, share: f64) -> Pose2 {
        if share == 0.0 {
            return *self;
        }
        let whole = self.between(to).log();
        self.moved(&Displacement2 {
            forward: share * whole.forward,
            sideways: share * whole.sideways,
            rotation: share * whole.rotation,
        })
    }

    /// This pose with derivatives of zero, as a [`Real`] of another kind.
    pub fn lift<T: Real>(&self) -> Pose2<T> {
        Pose2 { x: T::from(self.x), y: T::from(self.y), heading: T::from(self.heading) }
    }
}

impl<T: Real> Pose2<T> {
    /// A pose from its components \[m, m, rad\].
    pub const fn new(x: T, y: T, heading: T) -> Self {
        Pose2 { x, y, heading }
    }

    /// `world_from_b` from `world_from_a` (self) and `a_from_b`.
    #[inline]
    pub fn compose(&self, a_from_b: &Pose2<T>) -> Pose2<T> {
        let (sine, cosine) = self.heading.sine_cosine();
        Pose2 {
            x: self.x + cosine * a_from_b.x - sine * a_from_b.y,
            y: self.y + sine * a_from_b.x + cosine * a_from_b.y,
            heading: self.heading + a_from_b.heading,
        }
    }

    /// `body_from_world`.
    #[inline]
    pub fn inverse(&self) -> Pose2<T> {
        let (sine, cosine) = self.heading.sine_cosine();
        Pose2 { x: -(cosine * self.x + sine * self.y), y: sine * self.x - cosine * self.y, heading: -self.heading }
    }

    /// `other` as seen from this pose: `inverse(self) * other`, without cancelling large world coordinates.
    #[inline]
    pub fn between(&self, other: &Pose2<T>) -> Pose2<T> {
        let (sine, cosine) = self.heading.sine_cosine();
        let (dx, dy) = (other.x - self.x, other.y - self.y);
        Pose2 { x: cosine * dx + sine * dy, y: cosine * dy - sine * dx, heading: other.heading - self.heading }
    }

    /// The end of a motion with constant twist: a circular arc, a straight line or a turn on the spot.
    ///
    /// x + iy = sinc(h) e^(ih) (forward + i sideways) with h = rotation/2. Exact for every rotation, both signs, zero and
    /// full turns, without a division by the rotation.
    #[inline]
    pub fn exp(displacement: &Displacement2<T>) -> Pose2<T> {
        let half = displacement.rotation * 0.5;
        let (sinc, cosine) = half.sinc_cos();
        let sine = sinc * half;
        let (forward, sideways) = (sinc * displacement.forward, sinc * displacement.sideways);
        Pose2 {
            x: cosine * forward - sine * sideways,
            y: sine * forward + cosine * sideways,
            heading: displacement.rotation,
        }
    }

    /// This pose moved by a constant-twist motion in its own frame.
    #[inline]
    pub fn moved(&self, displacement: &Displacement2<T>) -> Pose2<T> {
        let mut pose = *self;
        pose.advance(displacement);
        pose
    }

    /// Moves this pose by a constant-twist motion in its own frame.
    #[inline(always)]
    pub fn advance(&mut self, displacement: &Displacement2<T>) {
        let half = displacement.rotation * 0.5;
        let (sinc, _) = half.sinc_cos();
        let (sine, cosine) = (self.heading + half).sine_cosine();
        let (forward, sideways) = (sinc * displacement.forward, sinc * displacement.sideways);
        self.x = self.x + cosine * forward - sine * sideways;
        self.y = self.y + sine * forward + cosine * sideways;
        self.heading += displacement.rotation;
    }

    /// The pose without its derivatives.
    pub fn value(&self) -> Pose2 {
        Pose2 { x: self.x.value(), y: self.y.value(), heading: self.heading.value() }
    }
}

impl Pose2<Dual> {
    /// The derivative that a lane carries: of x, y and heading.
    pub fn slope(&self, lane: usize) -> Pose2 {
        Pose2 { x: self.x.eps[lane], y: self.y.eps[lane], heading: self.heading.eps[lane] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI, TAU};
    use nalgebra::{Matrix3, Vector3};

    const ROTATIONS: [f64; 17] =
        [-TAU, -4.0, -PI, -FRAC_PI_2, -1.0, -1e-3, -1e-9, -0.0, 0.0, 1e-300, 1e-9, 1e-3, 0.8, FRAC_PI_2, PI, 5.0, TAU];

    /// The 3 x 3 matrix of a pose: an oracle that shares no code with the formulas under test.
    fn matrix(p: &Pose2) -> Matrix3<f64> {
        let (s, c) = libm::sincos(p.heading);
        Matrix3::new(c, -s, p.x, s, c, p.y, 0.0, 0.0, 1.0)
    }

    /// exp by its definition: the power series of the 3 x 3 matrix, halved until small and squared back.
    fn exp_series(d: &Displacement2) -> Matrix3<f64> {
        let m = Matrix3::new(0.0, -d.rotation, d.forward, d.rotation, 0.0, d.sideways, 0.0, 0.0, 0.0) / 1024.0;
        let (mut sum, mut term) = (Matrix3::identity(), Matrix3::identity());
        for k in 1..12 {
            term = term * m / f64::from(k);
            sum += term;
        }
        (0..10).fold(sum, |p, _| p * p)
    }

    fn displacements() -> impl Iterator<Item = Displacement2> {
        ROTATIONS.into_iter().flat_map(|rotation| {
            [(0.0, 0.0), (4.0, 0.0), (-4.0, 0.0), (0.0, 1.5), (0.3, -0.2), (-1e-9, 1e-9)]
                .map(|(forward, sideways)| Displacement2 { forward, sideways, rotation })
        })
    }

    #[test]
    fn exp_is_the_matrix_exponential_for_both_signs_zero_and_full_turns() {
        for d in displacements() {
            let error = (matrix(&Pose2::exp(&d)) - exp_series(&d)).abs().max();
            assert!(error < 2e-12, "{d:?}: {error:e}");
            assert_eq!(Pose2::exp(&d).heading, d.rotation);
        }
    }

    #[test]
    fn log_is_the_shortest_displacement_that_exp_takes_to_the_same_place() {
        for d in displacements() {
            let pose = Pose2::exp(&d);
            let log = pose.log();
            assert!(log.rotation > -PI && log.rotation <= PI);
            let error = (matrix(&Pose2::exp(&log)) - matrix(&pose)).abs().max();
            assert!(error < 1e-14, "{d:?}: {error:e}");
            if d.rotation.abs() < PI {
                assert!(
                    (log.forward - d.forward).abs() < 1e-13 && (log.sideways - d.sideways).abs() < 1e-13,
                    "{d:?} {log:?}"
                );
            }
        }
    }

    #[test]
    fn compose_inverse_and_between_are_matrix_products() {
        for (i, a) in displacements().enumerate() {
            for b in displacements().skip(i % 5).step_by(5) {
                let (p, q) = (Pose2::exp(&a), Pose2::exp(&b));
                let (mp, mq) = (matrix(&p), matrix(&q));
                let inverse = mp.try_inverse().unwrap();
                assert!((matrix(&p.compose(&q)) - mp * mq).abs().max() < 1e-14);
                assert!((matrix(&p.inverse()) - inverse).abs().max() < 1e-14);
                assert!((matrix(&p.between(&q)) - inverse * mq).abs().max() < 2e-14);
                let moved = matrix(&p.moved(&b)) * Vector3::new(0.7, -0.4, 1.0);
                assert!((moved - mp * mq * Vector3::new(0.7, -0.4, 1.0)).abs().max() < 2e-14);
            }
        }
    }

    #[test]
    fn a_quarter_turn_on_a_circle_to_the_right_ends_at_the_circle_and_a_full_one_closes() {
        let quarter = Pose2::exp(&Displacement2 { forward: FRAC_PI_2, sideways: 0.0, rotation: -FRAC_PI_2 });
        assert!((quarter.x - 1.0).abs() < 1e-15 && (quarter.y + 1.0).abs() < 1e-15, "{quarter:?}");
        let full = Pose2::exp(&Displacement2 { forward: TAU, sideways: 0.0, rotation: -TAU });
        assert!(full.x.abs() < 1e-15 && full.y.abs() < 1e-15 && full.heading == -TAU, "{full:?}");
    }
}
