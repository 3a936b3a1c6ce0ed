//! Which of its methods an effect has.

/// What an effect changes: the methods of [`Effect`](super::Effect) that it overrides, so that the others need not be
/// called for every piece of every run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Changes(u16);

impl Changes {
    /// [`Effect::wheels`](super::Effect::wheels).
    pub const WHEELS: Changes = Changes(1);
    /// [`Effect::body`](super::Effect::body).
    pub const BODY: Changes = Changes(1 << 1);
    /// [`Effect::seen`](super::Effect::seen).
    pub const SEEN: Changes = Changes(1 << 2);
    /// [`Effect::diffusion`](super::Effect::diffusion).
    pub const DIFFUSION: Changes = Changes(1 << 3);
    /// [`Effect::bumps`](super::Effect::bumps).
    pub const BUMPS: Changes = Changes(1 << 4);
    /// [`Effect::start`](super::Effect::start).
    pub const START: Changes = Changes(1 << 5);
    /// [`Effect::start_scatter`](super::Effect::start_scatter).
    pub const START_SCATTER: Changes = Changes(1 << 6);
    /// [`Effect::measured`](super::Effect::measured).
    pub const MEASURED: Changes = Changes(1 << 7);
    /// [`Effect::link`](super::Effect::link).
    pub const LINK: Changes = Changes(1 << 8);
    /// [`Effect::late`](super::Effect::late).
    pub const CLOCK: Changes = Changes(1 << 9);
    /// What moves the mean of where a robot is.
    pub const MOTION: Changes = Changes::WHEELS.and(Changes::BODY).and(Changes::START).and(Changes::LINK);
    /// What moves the mean of what is observed.
    pub const MEAN: Changes = Changes::MOTION.and(Changes::SEEN).and(Changes::CLOCK);
    /// All of these: always right, if slower.
    pub const ALL: Changes = Changes(u16::MAX);

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
