//! What is computed of a trial.

/// A number that a test gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// E_max,sys, Eq. (4) \[m\].
    EMaxSys,
    /// Scatter of the return positions, see [`score`](crate::score) \[m\].
    Sigma,
    /// Centre of gravity of the cw returns, Eq. (2) \[m\].
    CentroidCwX,
    /// See [`Metric::CentroidCwX`].
    CentroidCwY,
    /// Centre of gravity of the ccw returns, Eq. (2) \[m\].
    CentroidCcwX,
    /// See [`Metric::CentroidCcwX`].
    CentroidCcwY,
    /// Mean return heading error of the cw runs, Eq. (6) \[rad\].
    ReturnHeadingCw,
    /// Mean return heading error of the ccw runs, Eq. (6) \[rad\].
    ReturnHeadingCcw,
    /// Average absolute orientation error of the extended test, half of Eq. (5) \[rad\].
    NonsysOrientation,
}

/// A name that no metric has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no metric \"{name}\"; there are {}", Metric::ALL.map(Metric::name).join(", "))]
pub struct UnknownMetric {
    /// The name.
    pub name: String,
}

impl Metric {
    /// How many there are.
    pub const COUNT: usize = 9;

    /// All of them, in the order of a row.
    pub const ALL: [Metric; Metric::COUNT] = [
        Metric::EMaxSys,
        Metric::Sigma,
        Metric::CentroidCwX,
        Metric::CentroidCwY,
        Metric::CentroidCcwX,
        Metric::CentroidCcwY,
        Metric::ReturnHeadingCw,
        Metric::ReturnHeadingCcw,
        Metric::NonsysOrientation,
    ];

    /// Its name in files, with its unit.
    pub fn name(self) -> &'static str {
        match self {
            Metric::EMaxSys => "e_max_sys_m",
            Metric::Sigma => "sigma_m",
            Metric::CentroidCwX => "centroid_cw_x_m",
            Metric::CentroidCwY => "centroid_cw_y_m",
            Metric::CentroidCcwX => "centroid_ccw_x_m",
            Metric::CentroidCcwY => "centroid_ccw_y_m",
            Metric::ReturnHeadingCw => "return_heading_cw_rad",
            Metric::ReturnHeadingCcw => "return_heading_ccw_rad",
            Metric::NonsysOrientation => "nonsys_orientation_rad",
        }
    }

    /// The metric of a name in files.
    pub fn named(name: &str) -> Result<Metric, UnknownMetric> {
        let found = Metric::ALL.into_iter().find(|metric| metric.name() == name);
        found.ok_or_else(|| UnknownMetric { name: name.to_owned() })
    }

    /// Whether it is an angle \[rad\]; the others are lengths \[m\].
    pub fn is_angle(self) -> bool {
        matches!(self, Metric::ReturnHeadingCw | Metric::ReturnHeadingCcw | Metric::NonsysOrientation)
    }

    /// Whether a test with these runs \[cw, ccw\] has it.
    pub(super) fn exists(self, [cw, ccw]: [usize; 2], extended: bool) -> bool {
        match self {
            Metric::EMaxSys => cw > 0 && ccw > 0,
            Metric::Sigma => cw > 1 || ccw > 1,
            Metric::CentroidCwX | Metric::CentroidCwY | Metric::ReturnHeadingCw => cw > 0,
            Metric::CentroidCcwX | Metric::CentroidCcwY | Metric::ReturnHeadingCcw => ccw > 0,
            Metric::NonsysOrientation => extended && cw > 0 && ccw > 0,
        }
    }
}
