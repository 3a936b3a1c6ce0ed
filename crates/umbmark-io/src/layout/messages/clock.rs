//! When a message was measured, and when it was written down.

/// The two times of a message \[ns\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) struct Times {
    /// When the recorder got it.
    pub logged: i64,
    /// What its header says; zero where it says nothing.
    pub stamped: i64,
}

impl Times {
    pub fn new(logged: u64, stamp: Option<i64>) -> Times {
        Times { logged: i64::try_from(logged).unwrap_or(i64::MAX), stamped: stamp.unwrap_or(0) }
    }
}

/// The clock of a log: which of the two times, counted from where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::layout) struct Clock {
    stamps: bool,
    zero: i64,
}

/// Times beyond it \[ns\] are of a calendar, and counted from the first reading of the wheels: seconds since 1970 leave a
/// double no better than 0.2 µs.
const CALENDAR: i64 = 1 << 52;

/// Whether a time \[ns\] is of a calendar.
pub(in crate::layout) fn is_calendar(nanoseconds: i64) -> bool {
    nanoseconds.saturating_abs() > CALENDAR
}

impl Clock {
    /// Stamps where both topics have them, else the recorder's time for both: one clock, not two.
    pub fn of<'t>(
        wheels: impl Iterator<Item = &'t Times> + Clone,
        reference: impl Iterator<Item = &'t Times>,
    ) -> Clock {
        let mut reference = reference.peekable();
        let stamped = |times: &Times| times.stamped != 0;
        let stamps = wheels.clone().any(stamped) && (reference.peek().is_none() || reference.any(stamped));
        let mut clock = Clock { stamps, zero: 0 };
        let nanoseconds = |times: &Times| if stamps { times.stamped } else { times.logged };
        if wheels.clone().any(|times| is_calendar(nanoseconds(times))) {
            clock.zero = wheels.map(nanoseconds).next().unwrap_or(0);
        }
        clock
    }

    /// Time of a message \[s\].
    pub fn seconds(&self, times: &Times) -> f64 {
        let nanoseconds = if self.stamps { times.stamped } else { times.logged };
        nanoseconds.saturating_sub(self.zero) as f64 / 1e9
    }

    /// The time of the recorder from which it counts \[ns\].
    pub fn zero(&self) -> i64 {
        self.zero
    }

    /// What the time is called.
    pub fn name(&self) -> &'static str {
        if self.stamps { "stamp" } else { "log time" }
    }
}
