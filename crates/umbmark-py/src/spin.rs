//! `spin`.

use pyo3::prelude::*;
use umbmark_core::result::Spin;

use crate::json;
use crate::robot::Robot;

/// What a turn on the spot takes.
#[pyfunction]
pub fn spin(robot: &Robot) -> PyResult<String> {
    json(&Spin::new(&robot.0))
}
