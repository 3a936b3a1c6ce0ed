//! The covariance of a pose, and how it grows.

use crate::geometry::{Displacement2, Pose2, Real};

/// Sizes of the noise of the wheels, by which the covariance of a pose grows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Growth {
    /// Heading noise per square root of way \[rad/√m\].
    pub heading_per_metre: f64,
    /// Heading noise per square root of rotation \[rad/√rad\].
    pub heading_per_radian: f64,
    /// Noise of the way forward per square root of the wheels' mean way \[m/√m\].
    pub forward_per_metre: f64,
    /// Noise to the side per square root of the wheels' mean way \[m/√m\].
    pub sideways_per_metre: f64,
}

impl Growth {
    /// Variances of a motion on which the wheels roll by their mean way `rolled` \[m\]: forward and to the side \[m²\], and of the heading
    /// \[rad²\].
    #[inline]
    pub fn of(&self, motion: &Displacement2, rolled: f64) -> [f64; 3] {
        let [per_metre, per_radian, forward, sideways] =
            [self.heading_per_metre, self.heading_per_radian, self.forward_per_metre, self.sideways_per_metre]
                .map(|sd| sd * sd);
        let heading = per_metre * motion.forward.abs() + per_radian * motion.rotation.abs();
        [forward * rolled, sideways * rolled, heading]
    }
}

/// The robot turns on the spot where the square of its chord is below this share of that of the wheels' mean way.
const SPOT: f64 = 0.01;

/// Covariance of a pose, in the frame in which the pose is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// \[m²\]
    pub xx: f64,
    /// \[m²\]
    pub xy: f64,
    /// \[m²\]
    pub yy: f64,
    /// \[m rad\]
    pub x_heading: f64,
    /// \[m rad\]
    pub y_heading: f64,
    /// \[rad²\]
    pub heading: f64,
}

impl Spread {
    /// The covariance at the end of a piece that is driven `from` one pose `to` the next, on which the wheels roll by their mean way `rolled`
    /// \[m\]: also in turns on the spot they slip, and move the axle.
    ///
    /// A heading that is off carries over by the chord (d_x, d_y): δx -= d_y δθ, δy += d_x δθ. The noise of the heading, q = σ²_m s + σ²_r |Δθ|,
    /// arises evenly along the chord, so its share is q (d_y²/3, -d_x d_y/3, d_x²/3, -d_y/2, d_x/2, 1). Noise forward and sideways lies along
    /// the chord and across it; where the axle hardly moves, along the mean heading and across it.
    #[inline]
    pub fn after(&self, from: &Pose2, motion: &Displacement2, rolled: f64, to: &Pose2, noise: &Growth) -> Spread {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let [forward, sideways, heading] = noise.of(motion, rolled);
        let chord = dx * dx + dy * dy;
        let (ahead, aside, square) = if chord > SPOT * rolled * rolled {
            (dx, dy, chord)
        } else {
            let (sine, cosine) = (from.heading + 0.5 * motion.rotation).sine_cosine();
            (cosine, sine, 1.0)
        };
        let along = (forward - sideways) / square;
        let across = sideways;
        Spread {
            xx: self.xx - 2.0 * dy * self.x_heading
                + dy * dy * (self.heading + heading / 3.0)
                + along * ahead * ahead
                + across,
            xy: self.xy + dx * self.x_heading - dy * self.y_heading - dx * dy * (self.heading + heading / 3.0)
                + along * ahead * aside,
            yy: self.yy
                + 2.0 * dx * self.y_heading
                + dx * dx * (self.heading + heading / 3.0)
                + along * aside * aside
                + across,
            x_heading: self.x_heading - dy * (self.heading + 0.5 * heading),
            y_heading: self.y_heading + dx * (self.heading + 0.5 * heading),
            heading: self.heading + heading,
        }
    }

    /// Its six numbers in the order x², xy, y², xθ, yθ, θ².
    pub fn numbers(&self) -> [f64; 6] {
        [self.xx, self.xy, self.yy, self.x_heading, self.y_heading, self.heading]
    }
}
