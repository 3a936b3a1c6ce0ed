//! Absolute poses with a clock of their own, as a tracking system writes them.

/// Poses of a tracked body in the frame of a room, in the order of their own clock.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceTrack {
    /// Time of each pose \[s\], increasing, by the clock of the tracking system.
    pub time: Vec<f64>,
    /// \[m\]
    pub x: Vec<f64>,
    /// \[m\]
    pub y: Vec<f64>,
    /// Headings \[rad\], full turns counted, where they were measured: in every pose, or none.
    pub heading: Option<Vec<f64>>,
}
