//! Corrected wheel odometry on the robot: the model that `umbmark` has learnt, at work where the counts are made.
//!
//! No allocation, no standard library, no unsafe code. A model becomes a table of constants (`umbmark export model.toml --to embedded`);
//! each reading of the counters becomes a pose with its covariance.
//!
//! ```text
//! counts -> [gearing] -> wheel travel -> [wheel laws] -> kinematics -> [body laws] -> motion -> pose, covariance
//! ```
//!
//! The arithmetic is that of `umbmark-core`, which is built on this crate: `umbmark apply` on the log of a drive gives the same poses to
//! the last bit. The same [`law`]s serve simulation, fits and derivatives there.
//!
//! ```
//! use umbmark_odometry::{Odometer, Table, example::TABLE};
//! let table = Table::read(&TABLE)?;
//! let mut odometer = Odometer::<16>::begin(&table);
//! odometer.update(0.00, [0.0, 0.0])?;
//! let now = odometer.update(0.02, [21.0, 20.0])?;
//! assert!(now.pose.x > 0.004 && now.pose.heading < 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod context;
pub mod example;
pub mod gearing;
pub mod geometry;
pub mod law;
mod odometer;
pub mod pace;
pub mod spread;
pub mod table;
pub mod travel;

pub use odometer::{Estimate, Odometer, UpdateError};
pub use table::{Table, TableError};
