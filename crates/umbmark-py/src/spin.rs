//! `spin`.

use pyo3::prelude::*;
use umbmark_core::result::Spin;

use crate::robot::Robot;
use crate::typed;

/// Find what a whole turn on the spot takes.
///
/// Parameters
/// ----------
/// robot : Robot
///     The nominal robot.
///
/// Returns
/// -------
/// umbmark.results.Spin
///
/// Examples
/// --------
/// >>> import umbmark
/// >>> robot = umbmark.Robot(wheelbase_m=0.34, wheel_diameter_m=0.15, ticks_per_revolution=2000)
/// >>> round(umbmark.spin(robot).travel_m, 3)
/// 1.068
#[pyfunction]
pub fn spin<'py>(py: Python<'py>, robot: &Robot) -> PyResult<Bound<'py, PyAny>> {
    typed(py, "Spin", &Spin::new(&robot.0))
}
