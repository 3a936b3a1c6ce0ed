//! `score`.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Setup, ends, pair};
use crate::score::{self, CentroidInterval, Cluster, Convention};

/// The confidence ellipse of a centre of gravity.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Ellipse {
    /// Major semi-axis, in m.
    pub semi_major_m: f64,
    /// Minor semi-axis, in m.
    pub semi_minor_m: f64,
    /// Angle of the major axis, in rad.
    pub angle_rad: f64,
}

impl Ellipse {
    fn of(interval: &CentroidInterval) -> Option<Ellipse> {
        let e = interval.ellipse;
        pair(e.semi_major, e.semi_minor)?;
        Some(Ellipse { semi_major_m: e.semi_major, semi_minor_m: e.semi_minor, angle_rad: e.angle })
    }
}

/// The scores of a UMBmark test, with intervals that hold with probability `level`.
///
/// Lengths are in m, angles in rad, counter-clockwise positive; points are (x, y), intervals (low, high). A score is null if the runs do
/// not determine it, and `warnings` says why.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Score {
    /// E_max,sys: the larger distance of the two centroids from START (Eq. 4).
    pub e_max_sys_m: Option<f64>,
    /// Its interval; null with fewer than three runs in a direction.
    pub e_max_sys_interval_m: Option<[f64; 2]>,
    /// The value of E_max,sys that chance alone would reach, from the scatter of the runs.
    pub noise_band_m: Option<f64>,
    /// Standard deviation of one coordinate about its direction's centroid, n - 1, pooled over both coordinates and directions.
    pub sigma_m: Option<f64>,
    /// Its interval.
    pub sigma_interval_m: Option<[f64; 2]>,
    /// Standard deviation of the distance from the centroid.
    pub sigma_radial_m: Option<f64>,
    /// Number of clockwise runs.
    pub n_cw: usize,
    /// Centre of gravity of the clockwise runs (Eq. 2).
    pub centroid_cw_m: Option<[f64; 2]>,
    /// The intervals of its coordinates.
    pub centroid_cw_interval_m: Option<[Option<[f64; 2]>; 2]>,
    /// Its confidence ellipse.
    pub centroid_cw_ellipse: Option<Ellipse>,
    /// Mean return heading of the clockwise runs whose heading was measured (Eq. 6).
    pub return_heading_cw_rad: Option<f64>,
    /// Its interval.
    pub return_heading_cw_interval_rad: Option<[f64; 2]>,
    /// Number of counter-clockwise runs.
    pub n_ccw: usize,
    /// Centre of gravity of the counter-clockwise runs (Eq. 2).
    pub centroid_ccw_m: Option<[f64; 2]>,
    /// The intervals of its coordinates.
    pub centroid_ccw_interval_m: Option<[Option<[f64; 2]>; 2]>,
    /// Its confidence ellipse.
    pub centroid_ccw_ellipse: Option<Ellipse>,
    /// Mean return heading of the counter-clockwise runs whose heading was measured (Eq. 6).
    pub return_heading_ccw_rad: Option<f64>,
    /// Its interval.
    pub return_heading_ccw_interval_rad: Option<[f64; 2]>,
    /// Average absolute orientation error of the extended test (Eq. 5).
    pub nonsys_orientation_rad: Option<f64>,
    /// Its interval.
    pub nonsys_orientation_interval_rad: Option<[f64; 2]>,
    /// "mean" for half of Eq. 5, as used in Table II, or "sum" for Eq. 5 as printed.
    pub nonsys_convention: Option<&'static str>,
    /// Number of clockwise runs with bumps.
    pub n_bumps_cw: usize,
    /// Number of counter-clockwise runs with bumps.
    pub n_bumps_ccw: usize,
    /// Probability with which each interval holds.
    pub level: f64,
    /// Findings about the runs before they were scored: faults, jumps and wrong poses of tracks, outlying returns. Empty if return errors
    /// were given in arrays.
    pub setup: Setup,
    /// Warnings: first about the data, then what could not be computed and why, and what looks wrong.
    pub warnings: Vec<String>,
    /// Version of umbmark.
    pub version: &'static str,
}

impl Score {
    /// A score, the extended test joined by `convention`.
    pub fn new(score: &score::Score, convention: Convention) -> Score {
        let summary = &score.summary;
        let intervals = score.intervals.as_ref();
        let extended = score.extended.as_ref();
        let [cw, ccw] = [
            OfDirection::new(summary.cw, intervals.and_then(|i| i.cw)),
            OfDirection::new(summary.ccw, intervals.and_then(|i| i.ccw)),
        ];
        Score {
            e_max_sys_m: summary.e_max_sys(),
            e_max_sys_interval_m: intervals.and_then(|i| i.e_max_sys).and_then(ends),
            noise_band_m: score.noise_band,
            sigma_m: summary.sigma_axis(),
            sigma_interval_m: intervals.and_then(|i| ends(i.sigma_axis)),
            sigma_radial_m: summary.sigma_radial(),
            n_cw: cw.n,
            centroid_cw_m: cw.centroid,
            centroid_cw_interval_m: cw.centroid_interval,
            centroid_cw_ellipse: cw.ellipse,
            return_heading_cw_rad: cw.heading,
            return_heading_cw_interval_rad: cw.heading_interval,
            n_ccw: ccw.n,
            centroid_ccw_m: ccw.centroid,
            centroid_ccw_interval_m: ccw.centroid_interval,
            centroid_ccw_ellipse: ccw.ellipse,
            return_heading_ccw_rad: ccw.heading,
            return_heading_ccw_interval_rad: ccw.heading_interval,
            nonsys_orientation_rad: extended.map(|e| e.orientation(convention)),
            nonsys_orientation_interval_rad: extended.and_then(|e| e.interval(convention)).and_then(ends),
            nonsys_convention: extended.map(|_| convention.name()),
            n_bumps_cw: extended.map_or(0, |e| e.n_cw),
            n_bumps_ccw: extended.map_or(0, |e| e.n_ccw),
            level: score.level,
            setup: score.setup.as_ref().into(),
            warnings: score.warnings.clone(),
            version: crate::VERSION,
        }
    }
}

/// The scores of one direction.
struct OfDirection {
    n: usize,
    centroid: Option<[f64; 2]>,
    centroid_interval: Option<[Option<[f64; 2]>; 2]>,
    ellipse: Option<Ellipse>,
    heading: Option<f64>,
    heading_interval: Option<[f64; 2]>,
}

impl OfDirection {
    fn new(cluster: Option<Cluster>, interval: Option<CentroidInterval>) -> OfDirection {
        OfDirection {
            n: cluster.map_or(0, |c| c.n),
            centroid: cluster.and_then(|c| pair(c.x, c.y)),
            centroid_interval: interval.map(|i| [ends(i.x), ends(i.y)]),
            ellipse: interval.as_ref().and_then(Ellipse::of),
            heading: cluster.and_then(|c| c.heading),
            heading_interval: interval.and_then(|i| i.heading).and_then(ends),
        }
    }
}
