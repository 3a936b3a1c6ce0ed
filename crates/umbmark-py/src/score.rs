//! `umbmark.score` and its result.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use umbmark_core::dataset::{ReturnError, Run};
use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;
use umbmark_core::score::{self as core, Convention};
use umbmark_core::stats::Interval;

use crate::arrays::return_errors;
use crate::{detached, refused};

/// Score the return errors of a UMBmark test.
///
/// Equations 1 to 6 of Borenstein and Feng (1995), "UMBmark: A Benchmark Test for Measuring Odometry Errors in Mobile
/// Robots", for any number of runs, with intervals that hold for few of them.
///
/// Parameters
/// ----------
/// cw, ccw : ndarray of float64, shape (n, 3) or (n, 2)
///     Return errors of the clockwise and of the counter-clockwise runs, one row per run: x in m, y in m, heading in
///     rad, each absolute minus computed (Eq. 1), in the frame of START, headings counter-clockwise positive. A
///     heading that is NaN, or a missing third column, was not measured. Without any run of a direction, shape (0, 3),
///     the other direction's centroid is still given.
/// bumps_cw, bumps_ccw : ndarray of float64, shape (n, 3) or (n, 2), optional
///     The same of the extended test, driven over bumps.
/// level : float, default 0.95
///     Probability with which each interval holds the true value.
///
/// Returns
/// -------
/// Score
///     Whatever could not be computed is None, and ``Score.warnings`` says why.
///
/// Raises
/// ------
/// TypeError
///     If an argument is no plain NumPy array of float64.
/// ValueError
///     If an array has another shape, a position is not finite, a heading is infinite, the level does not lie between
///     0 and 1, or there is no run at all.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import umbmark
/// >>> cw = np.array([[-0.21, -0.19, -0.05], [-0.19, -0.21, -0.06], [-0.20, -0.23, -0.04]])
/// >>> ccw = np.array([[0.02, 0.01, 0.01], [0.01, -0.02, 0.02], [0.00, -0.02, 0.00]])
/// >>> result = umbmark.score(cw, ccw)
/// >>> low, high = result.e_max_sys_interval_m
/// >>> print(f"E_max,sys {result.e_max_sys_m:.3f} m, between {low:.3f} and {high:.3f} m")
/// E_max,sys 0.290 m, between 0.270 and 0.307 m
/// >>> print(f"by the runs' scatter alone it would stay below {result.noise_band_m:.3f} m")
/// by the runs' scatter alone it would stay below 0.023 m
#[pyfunction]
#[pyo3(signature = (cw, ccw, *, bumps_cw=None, bumps_ccw=None, level=0.95))]
pub fn score(
    cw: &Bound<'_, PyAny>,
    ccw: &Bound<'_, PyAny>,
    bumps_cw: Option<&Bound<'_, PyAny>>,
    bumps_ccw: Option<&Bound<'_, PyAny>>,
    level: f64,
) -> PyResult<Score> {
    let groups = [
        ("cw", Some(cw), TestKind::Systematic, Direction::Cw),
        ("ccw", Some(ccw), TestKind::Systematic, Direction::Ccw),
        ("bumps_cw", bumps_cw, TestKind::Bumps, Direction::Cw),
        ("bumps_ccw", bumps_ccw, TestKind::Bumps, Direction::Ccw),
    ];
    let mut runs = Vec::new();
    for (name, array, test, direction) in groups {
        if let Some(array) = array {
            let errors = return_errors(name, array)?;
            runs.extend(errors.into_iter().enumerate().map(|(row, error)| run(name, row, test, direction, error)));
        }
    }
    detached(cw.py(), || core::score(&runs, level))?.map(Score).map_err(refused)
}

/// The run of a row, named as Python would index it.
fn run(array: &str, row: usize, test: TestKind, direction: Direction, returned: ReturnError) -> Run {
    Run {
        name: format!("{array}[{row}]"),
        number: u32::try_from(row + 1).unwrap_or(u32::MAX),
        direction: Some(direction),
        test,
        log: None,
        returned: Some(returned),
    }
}

/// The scores of a UMBmark test, with the intervals that hold with probability ``level``.
///
/// Lengths are in m, angles in rad, counter-clockwise positive; points are (x, y), intervals (low, high). An attribute
/// is None where the runs do not give it, and ``warnings`` says why. Scores compare equal where all of their values are.
#[pyclass(frozen, eq, module = "umbmark")]
#[derive(PartialEq)]
pub struct Score(core::Score);

#[pymethods]
impl Score {
    /// E_max,sys in m: the larger distance of the two centroids from START (Eq. 4); None with one direction alone.
    #[getter]
    fn e_max_sys_m(&self) -> Option<f64> {
        self.0.summary.e_max_sys()
    }

    /// Interval of E_max,sys in m; None with fewer than three runs in a direction.
    #[getter]
    fn e_max_sys_interval_m(&self) -> Option<(f64, f64)> {
        self.0.intervals?.e_max_sys.map(ends)
    }

    /// E_max,sys in m that a robot without systematic error stays below, by the scatter of its runs alone.
    #[getter]
    fn noise_band_m(&self) -> Option<f64> {
        self.0.noise_band
    }

    /// Centre of gravity of the clockwise runs, (x, y) in m (Eq. 2).
    #[getter]
    fn centroid_cw_m(&self) -> Option<(f64, f64)> {
        self.0.summary.cw.map(|cluster| (cluster.x, cluster.y))
    }

    /// Centre of gravity of the counter-clockwise runs, (x, y) in m (Eq. 2).
    #[getter]
    fn centroid_ccw_m(&self) -> Option<(f64, f64)> {
        self.0.summary.ccw.map(|cluster| (cluster.x, cluster.y))
    }

    /// Standard deviation in m of one coordinate about its direction's centroid, n - 1, pooled over both coordinates and
    /// both directions; the radial one is the square root of 2 times it. None where no direction has two runs.
    #[getter]
    fn sigma_m(&self) -> Option<f64> {
        self.0.summary.sigma_axis()
    }

    /// Interval of sigma in m; None with fewer than three runs in a direction.
    #[getter]
    fn sigma_interval_m(&self) -> Option<(f64, f64)> {
        self.0.intervals.map(|intervals| ends(intervals.sigma_axis))
    }

    /// Mean return heading error of the clockwise runs in rad (Eq. 6), over those whose heading was measured.
    #[getter]
    fn return_heading_cw_rad(&self) -> Option<f64> {
        self.0.summary.cw?.heading
    }

    /// Mean return heading error of the counter-clockwise runs in rad (Eq. 6), over those whose heading was measured.
    #[getter]
    fn return_heading_ccw_rad(&self) -> Option<f64> {
        self.0.summary.ccw?.heading
    }

    /// Average absolute orientation error of the extended test in rad: half of Eq. 5, the mean over both directions,
    /// which Table II of the paper lists. None without headings of both directions, with bumps and without.
    #[getter]
    fn nonsys_orientation_rad(&self) -> Option<f64> {
        self.orientation(Convention::Mean)
    }

    /// Interval of ``nonsys_orientation_rad`` in rad; None with fewer than two headings in a group.
    #[getter]
    fn nonsys_orientation_interval_rad(&self) -> Option<(f64, f64)> {
        self.0.extended.as_ref()?.interval(Convention::Mean).map(ends)
    }

    /// The same orientation error in rad as Eq. 5 is printed: the sum over both directions, twice the mean.
    #[getter]
    fn nonsys_orientation_sum_rad(&self) -> Option<f64> {
        self.orientation(Convention::Sum)
    }

    /// Number of clockwise runs of the regular test.
    #[getter]
    fn n_cw(&self) -> usize {
        self.0.summary.cw.map_or(0, |cluster| cluster.n)
    }

    /// Number of counter-clockwise runs of the regular test.
    #[getter]
    fn n_ccw(&self) -> usize {
        self.0.summary.ccw.map_or(0, |cluster| cluster.n)
    }

    /// Probability with which each interval holds the true value.
    #[getter]
    fn level(&self) -> f64 {
        self.0.level
    }

    /// What could not be computed and why, and what looks wrong: one sentence or more each.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.warnings)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let attributes = [
            ("e_max_sys_m", self.e_max_sys_m().map(number)),
            ("e_max_sys_interval_m", self.e_max_sys_interval_m().map(pair)),
            ("noise_band_m", self.noise_band_m().map(number)),
            ("centroid_cw_m", self.centroid_cw_m().map(pair)),
            ("centroid_ccw_m", self.centroid_ccw_m().map(pair)),
            ("sigma_m", self.sigma_m().map(number)),
            ("sigma_interval_m", self.sigma_interval_m().map(pair)),
            ("return_heading_cw_rad", self.return_heading_cw_rad().map(number)),
            ("return_heading_ccw_rad", self.return_heading_ccw_rad().map(number)),
            ("nonsys_orientation_rad", self.nonsys_orientation_rad().map(number)),
            ("nonsys_orientation_interval_rad", self.nonsys_orientation_interval_rad().map(pair)),
            ("nonsys_orientation_sum_rad", self.nonsys_orientation_sum_rad().map(number)),
            ("n_cw", Some(self.n_cw().to_string())),
            ("n_ccw", Some(self.n_ccw().to_string())),
            ("level", Some(number(self.level()))),
            ("warnings", Some(self.warnings(py)?.repr()?.to_string())),
        ];
        let known = attributes.into_iter().filter_map(|(name, text)| Some(format!("    {name}={},\n", text?)));
        Ok(format!("Score(\n{})", known.collect::<String>()))
    }
}

impl Score {
    fn orientation(&self, convention: Convention) -> Option<f64> {
        self.0.extended.as_ref().map(|extended| extended.orientation(convention))
    }
}

fn ends(interval: Interval) -> (f64, f64) {
    (interval.low, interval.high)
}

/// Six significant digits.
fn number(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().map_or_else(|_| value.to_string(), |rounded| format!("{rounded:?}"))
}

fn pair((first, second): (f64, f64)) -> String {
    format!("({}, {})", number(first), number(second))
}
