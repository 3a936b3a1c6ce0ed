//! Tests of the whole, one program: a file here is a module. `allocation.rs` counts what is allocated, and stands alone.

#![allow(clippy::unwrap_used)]

mod cross_table;
mod diagnose_real;
mod drives;
mod embedded;
mod formula;
mod monte_carlo;
mod omni_real;
mod paper;
mod references;
mod rooms;
mod steered;
mod tracks;
