//! Colours by meaning, on white and on black, distinct also for people with colour-blindness (after Okabe and Ito).

use serde::{Deserialize, Serialize};

/// What a colour stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Tone {
    /// Clockwise runs.
    Cw,
    /// Counter-clockwise runs.
    Ccw,
    /// What was measured.
    Measured,
    /// What the robot computed.
    Computed,
    /// What a model says.
    Model,
    /// A limit, an interval, a verdict.
    Limit,
    /// What only guides the eye.
    Quiet,
}

impl Tone {
    /// All of them.
    pub const ALL: [Tone; 7] =
        [Tone::Cw, Tone::Ccw, Tone::Measured, Tone::Computed, Tone::Model, Tone::Limit, Tone::Quiet];

    /// Its name in documents.
    pub fn name(self) -> &'static str {
        match self {
            Tone::Cw => "cw",
            Tone::Ccw => "ccw",
            Tone::Measured => "measured",
            Tone::Computed => "computed",
            Tone::Model => "model",
            Tone::Limit => "limit",
            Tone::Quiet => "quiet",
        }
    }

    /// On white.
    pub fn on_white(self) -> &'static str {
        match self {
            Tone::Cw => "#0072b2",
            Tone::Ccw => "#c8500a",
            Tone::Measured => "#1b1f24",
            Tone::Computed => "#808890",
            Tone::Model => "#00805e",
            Tone::Limit => "#a3447c",
            Tone::Quiet => "#a9b0b7",
        }
    }

    /// On black.
    pub fn on_black(self) -> &'static str {
        match self {
            Tone::Cw => "#56b4e9",
            Tone::Ccw => "#ff9a57",
            Tone::Measured => "#eceff2",
            Tone::Computed => "#98a1aa",
            Tone::Model => "#33d6a6",
            Tone::Limit => "#e79cc8",
            Tone::Quiet => "#626a73",
        }
    }

    /// Whether it is what a model says: its places are diamonds, all others are round.
    pub fn is_modelled(self) -> bool {
        self == Tone::Model
    }

    /// As the number of a terminal's colour.
    pub fn ansi(self) -> u8 {
        match self {
            Tone::Cw => 34,
            Tone::Ccw => 33,
            Tone::Measured => 39,
            Tone::Computed | Tone::Quiet => 90,
            Tone::Model => 32,
            Tone::Limit => 35,
        }
    }

    /// The tone of a direction of driving.
    pub fn of(direction: umbmark_core::path::Direction) -> Tone {
        match direction {
            umbmark_core::path::Direction::Cw => Tone::Cw,
            umbmark_core::path::Direction::Ccw => Tone::Ccw,
        }
    }
}

/// The shade of a cell of value -1 to 1: white (or black) at zero, blue below and green above.
pub fn shade(value: f64, dark: bool) -> String {
    let (nothing, most) = match (dark, value < 0.0) {
        (false, false) => ([247.0, 248.0, 249.0], [0.0, 104.0, 76.0]),
        (false, true) => ([247.0, 248.0, 249.0], [0.0, 80.0, 140.0]),
        (true, false) => ([30.0, 34.0, 39.0], [60.0, 225.0, 175.0]),
        (true, true) => ([30.0, 34.0, 39.0], [100.0, 185.0, 240.0]),
    };
    let share = value.abs().min(1.0);
    let mix = |i: usize| (nothing[i] + share * (most[i] - nothing[i])) as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}
