//! Travel of the axle's two wheels, and the motion of the body that it makes.

use crate::geometry::{Displacement2, Real};

/// Distance rolled by each wheel \[m\], forward positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelTravel<T = f64> {
    /// \[m\]
    pub left: T,
    /// \[m\]
    pub right: T,
}

impl<T: Real> WheelTravel<T> {
    /// Both wheels' travel times a number.
    #[inline]
    pub fn scaled(&self, factor: f64) -> WheelTravel<T> {
        WheelTravel { left: self.left * factor, right: self.right * factor }
    }

    /// Body motion of the middle of an axle with this wheelbase b \[m\], at constant ratio of the wheel speeds.
    ///
    /// forward = (s_R + s_L)/2, rotation = (s_R - s_L)/b: Crowley & Reignier (1992), as used by Borenstein & Feng (1995).
    #[inline(always)]
    pub fn displacement(&self, wheelbase: f64) -> Displacement2<T> {
        Displacement2 {
            forward: (self.right + self.left) * 0.5,
            sideways: T::from(0.0),
            rotation: (self.right - self.left) / wheelbase,
        }
    }
}

impl WheelTravel {
    /// Mean way of both wheels \[m\], ahead or back.
    #[inline]
    pub fn rolled(&self) -> f64 {
        0.5 * (self.left.abs() + self.right.abs())
    }

    /// Way of the faster wheel \[m\], ahead or back.
    #[inline]
    pub fn farthest(&self) -> f64 {
        self.left.abs().max(self.right.abs())
    }

    /// Travel that makes the middle of an axle with this wheelbase \[m\] advance `forward` \[m\] while the body turns by `rotation`
    /// \[rad\].
    #[inline]
    pub fn of(forward: f64, rotation: f64, wheelbase: f64) -> WheelTravel {
        let half = 0.5 * wheelbase * rotation;
        WheelTravel { left: forward - half, right: forward + half }
    }
}
