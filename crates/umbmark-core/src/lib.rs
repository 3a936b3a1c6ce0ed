//! The science of wheeled-robot odometry error.
//!
//! A *model* is a nominal robot plus a chain of effects ([`effect`]). One chain serves both ways: forward, it turns a
//! [`path`] into wheel motion, encoder ticks and the true pose ([`simulate`], [`monte_carlo`]); backward, it turns
//! recorded ticks into the predicted pose ([`replay`]), from which robots are scored and calibrated ([`score`],
//! [`calibrate`]), and what a model is missing is found ([`compare`], [`diagnose`], [`learn`]). [`sensitivity`] says which
//! number drives which result; what a test would show before it is driven says [`plan`].
//!
//! Inside, everything is SI: metres, radians, seconds, ticks. Headings and rotations are counter-clockwise positive.
//! A text boundary (file column, TOML key, JSON key, flag) carries the unit in its name.
//!
//! Nothing here reads or writes files, prints, parses flags or knows Python.

pub mod action;
pub mod apply;
pub mod calibrate;
pub mod changed;
pub mod compare;
pub mod conditions;
pub mod dataset;
pub mod diagnose;
pub mod drift;
pub mod drive;
pub mod effect;
pub mod engine;
pub mod evidence;
pub mod fit;
pub mod geometry;
pub mod inspect;
pub mod joined;
pub mod learn;
pub mod likelihood;
pub mod monte_carlo;
pub mod paper;
pub mod parameter;
pub mod path;
pub mod plan;
pub mod preset;
pub mod prose;
pub mod random;
pub mod reference;
mod register;
pub mod remedy;
pub mod replay;
pub mod result;
pub mod run;
pub mod score;
pub mod sensitivity;
pub mod setup;
pub mod simulate;
pub mod solve;
pub mod stats;
pub mod survey;
pub mod synchronise;
pub mod watch;

/// The version of this crate, printed beside every result.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
