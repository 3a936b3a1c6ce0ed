//! Which laws an effect has.

/// What an effect changes: the laws that its [`Entry`](super::Entry) lists. Other laws are not called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Changes(u16);

impl Changes {
    /// [`WheelLaw::wheels`](super::WheelLaw::wheels).
    pub const WHEELS: Changes = Changes(1);
    /// [`BodyLaw::body`](super::BodyLaw::body).
    pub const BODY: Changes = Changes(1 << 1);
    /// [`SightLaw::seen`](super::SightLaw::seen).
    pub const SEEN: Changes = Changes(1 << 2);
    /// [`DiffusionLaw::diffusion`](super::DiffusionLaw::diffusion).
    pub const DIFFUSION: Changes = Changes(1 << 3);
    /// [`BumpLaw::bumps`](super::BumpLaw::bumps).
    pub const BUMPS: Changes = Changes(1 << 4);
    /// [`StartLaw::start`](super::StartLaw::start).
    pub const START: Changes = Changes(1 << 5);
    /// [`StartLaw::start_scatter`](super::StartLaw::start_scatter).
    pub const START_SCATTER: Changes = Changes(1 << 6);
    /// [`MeasurementLaw::measured`](super::MeasurementLaw::measured).
    pub const MEASURED: Changes = Changes(1 << 7);
    /// [`LinkLaw::link`](super::LinkLaw::link).
    pub const LINK: Changes = Changes(1 << 8);
    /// [`ClockLaw::late`](super::ClockLaw::late).
    pub const CLOCK: Changes = Changes(1 << 9);
    /// [`FilterLaw::filter`](super::FilterLaw::filter).
    pub const FILTER: Changes = Changes(1 << 10);
    /// What relates measurements to other moments than that of their time stamp.
    pub const MOMENT: Changes = Changes::CLOCK.and(Changes::FILTER);
    /// Changes of the mean pose of a robot.
    pub const MOTION: Changes = Changes::WHEELS.and(Changes::BODY).and(Changes::START).and(Changes::LINK);
    /// Changes of the mean of observations.
    pub const MEAN: Changes = Changes::MOTION.and(Changes::SEEN).and(Changes::MOMENT);
    /// Nothing.
    pub const NOTHING: Changes = Changes(0);

    /// These and others.
    pub const fn and(self, others: Changes) -> Changes {
        Changes(self.0 | others.0)
    }

    /// Whether some of `others` are among these.
    #[inline]
    pub const fn include(self, others: Changes) -> bool {
        self.0 & others.0 != 0
    }
}
