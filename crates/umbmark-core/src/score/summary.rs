//! Centroids, their distances, and the spread about them, without allocation.

use crate::dataset::ReturnError;
use crate::geometry::{mean_angle, wrap};

/// Return errors, one by one, from whatever they are written down as.
#[inline]
pub(super) fn each<E: Copy + Into<ReturnError>>(errors: &[E]) -> impl Iterator<Item = ReturnError> {
    errors.iter().map(|error| (*error).into())
}

/// The return errors of one direction in short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Number of runs.
    pub n: usize,
    /// x of the centre of gravity \[m\] (Eq. 2).
    pub x: f64,
    /// y of the centre of gravity \[m\] (Eq. 2).
    pub y: f64,
    /// Mean return heading error \[rad\] in (-π, π] over the runs whose heading was measured (Eq. 6).
    ///
    /// The arithmetic mean of the headings as seen from the first one, so that the cut at ±π does no harm while the runs
    /// of a direction differ by less than half a turn.
    pub heading: Option<f64>,
    squares_x: f64,
    squares_y: f64,
}

impl Cluster {
    /// The cluster of some return errors; `None` for no runs.
    #[inline]
    pub fn of<E: Copy + Into<ReturnError>>(errors: &[E]) -> Option<Cluster> {
        if errors.is_empty() {
            return None;
        }
        let per_run = 1.0 / errors.len() as f64;
        let (mut x, mut y) = (0.0, 0.0);
        for error in each(errors) {
            x += error.x;
            y += error.y;
        }
        let (x, y) = (x * per_run, y * per_run);
        let (mut squares_x, mut squares_y) = (0.0, 0.0);
        for error in each(errors) {
            squares_x += (error.x - x) * (error.x - x);
            squares_y += (error.y - y) * (error.y - y);
        }
        Some(Cluster { n: errors.len(), x, y, heading: mean_heading(errors), squares_x, squares_y })
    }

    /// r_c.g. \[m\]: distance of the centre of gravity from START (Eq. 3).
    #[inline]
    pub fn distance(&self) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt()
    }

    /// Standard deviation of x \[m\], with n - 1; `None` for one run.
    pub fn std_dev_x(&self) -> Option<f64> {
        self.std_dev(self.squares_x)
    }

    /// Standard deviation of y \[m\], with n - 1; `None` for one run.
    pub fn std_dev_y(&self) -> Option<f64> {
        self.std_dev(self.squares_y)
    }

    /// Standard deviation of one coordinate \[m\]: √((s_x² + s_y²)/2); `None` for one run.
    pub fn sigma_axis(&self) -> Option<f64> {
        self.std_dev(0.5 * (self.squares_x + self.squares_y))
    }

    /// Standard deviation of the position \[m\]: √(s_x² + s_y²), √2 times that of one coordinate; `None` for one run.
    pub fn sigma_radial(&self) -> Option<f64> {
        self.std_dev(self.squares_x + self.squares_y)
    }

    fn std_dev(&self, squares: f64) -> Option<f64> {
        (self.n > 1).then(|| (squares / (self.n - 1) as f64).sqrt())
    }
}

#[inline]
fn mean_heading<E: Copy + Into<ReturnError>>(errors: &[E]) -> Option<f64> {
    mean_angle(each(errors).filter_map(|error| error.heading)).map(wrap)
}

/// One UMBmark test in short: both clusters, E_max,sys and the spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Clockwise runs; `None` for an empty set.
    pub cw: Option<Cluster>,
    /// Counter-clockwise runs; `None` for an empty set.
    pub ccw: Option<Cluster>,
}

impl Summary {
    /// E_max,sys \[m\]: the larger distance of the two centres of gravity from START (Eq. 4).
    ///
    /// `None` where a direction is missing: in one direction E_d and E_b can cancel (section 3.1 of the paper), so the
    /// number of one direction is no measure of accuracy.
    #[inline]
    pub fn e_max_sys(&self) -> Option<f64> {
        Some(self.cw?.distance().max(self.ccw?.distance()))
    }

    /// σ \[m\] as printed by `umbmark`: standard deviation of one coordinate about its direction's centre of gravity,
    /// pooled over both coordinates and both directions with n - 1 each,
    ///
    /// σ² = Σ_directions (Σ_i (x_i - x_c.g.)² + (y_i - y_c.g.)²) / (2 Σ_directions (n - 1)).
    ///
    /// The paper does not say which σ its Table I lists. `None` where no direction has two runs.
    #[inline]
    pub fn sigma_axis(&self) -> Option<f64> {
        let (squares, freedom) = [self.cw, self.ccw]
            .iter()
            .flatten()
            .fold((0.0, 0usize), |(s, f), c| (s + c.squares_x + c.squares_y, f + c.n - 1));
        (freedom > 0).then(|| (squares / (2 * freedom) as f64).sqrt())
    }

    /// The same spread as a radius \[m\]: √2 times [`Summary::sigma_axis`].
    pub fn sigma_radial(&self) -> Option<f64> {
        self.sigma_axis().map(|sigma| sigma * std::f64::consts::SQRT_2)
    }
}

/// The summary of one test from the return errors of each direction (Eqs. 2 to 4 and 6), for any number of runs.
///
/// It allocates nothing and costs some tens of nanoseconds, for use inside Monte Carlo.
///
/// ```
/// use umbmark_core::{dataset::ReturnError, score::summarise};
/// let at = |x, y| ReturnError { x, y, heading: None };
/// let test = summarise(&[at(-0.3, -0.1), at(-0.3, -0.3)], &[at(0.1, 0.0), at(0.0, 0.1)]);
/// assert!((test.e_max_sys().unwrap() - 0.13_f64.sqrt()).abs() < 1e-15);
/// assert_eq!(summarise(&[at(-0.3, -0.1)], &[]).e_max_sys(), None);
/// ```
#[inline]
pub fn summarise<E: Copy + Into<ReturnError>>(cw: &[E], ccw: &[E]) -> Summary {
    Summary { cw: Cluster::of(cw), ccw: Cluster::of(ccw) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn at(x: f64, y: f64, heading: f64) -> ReturnError {
        ReturnError { x, y, heading: Some(heading) }
    }

    /// Oracle: worked by hand from Eqs. 2 to 4.
    #[test]
    fn centroids_distances_and_e_max_sys_follow_the_paper() {
        let cw = [at(1.0, 2.0, 0.1), at(3.0, 6.0, 0.3), at(5.0, 1.0, 0.2)];
        let ccw = [at(-1.0, 0.0, 0.0), at(-3.0, 4.0, 0.1)];
        let s = summarise(&cw, &ccw);
        let (c, cc) = (s.cw.unwrap(), s.ccw.unwrap());
        assert_eq!((c.n, c.x, c.y, cc.n, cc.x, cc.y), (3, 3.0, 3.0, 2, -2.0, 2.0));
        assert!((s.e_max_sys().unwrap() - 18.0_f64.sqrt()).abs() < 1e-15);
        assert!((cc.distance() - 8.0_f64.sqrt()).abs() < 1e-15);
        assert!((c.heading.unwrap() - 0.2).abs() < 1e-15);
    }

    /// Oracle: sums of squares by hand: cw x 8, y 14; ccw x 2, y 8.
    #[test]
    fn sigma_uses_n_minus_one_per_axis_per_direction_and_pooled() {
        let s = summarise(
            &[at(1.0, 2.0, 0.0), at(3.0, 6.0, 0.0), at(5.0, 1.0, 0.0)],
            &[at(-1.0, 0.0, 0.0), at(-3.0, 4.0, 0.0)],
        );
        let close = |a: Option<f64>, b: f64| assert!((a.unwrap() - b.sqrt()).abs() < 1e-14, "{a:?} {}", b.sqrt());
        close(s.cw.unwrap().std_dev_x(), 8.0 / 2.0);
        close(s.cw.unwrap().std_dev_y(), 14.0 / 2.0);
        close(s.cw.unwrap().sigma_axis(), 22.0 / 4.0);
        close(s.cw.unwrap().sigma_radial(), 22.0 / 2.0);
        close(s.sigma_axis(), 32.0 / 6.0);
        close(s.sigma_radial(), 32.0 / 3.0);
    }

    #[test]
    fn one_run_has_a_centroid_and_no_sigma_and_no_run_has_neither() {
        let s = summarise(&[at(0.1, 0.2, 0.3)], &[]);
        assert_eq!((s.cw.unwrap().x, s.cw.unwrap().sigma_axis(), s.sigma_axis()), (0.1, None, None));
        assert_eq!((s.ccw, s.e_max_sys()), (None, None));
    }

    #[test]
    fn headings_astride_the_cut_average_at_the_cut_and_missing_ones_are_left_out() {
        let missing = ReturnError { x: 0.0, y: 0.0, heading: None };
        let mean = |errors: &[ReturnError]| Cluster::of(errors).unwrap().heading;
        let astride = mean(&[at(0.0, 0.0, PI - 0.1), missing, at(0.0, 0.0, -PI + 0.3)]).unwrap();
        assert!((astride - (-PI + 0.1)).abs() < 1e-12, "{astride}");
        assert_eq!(mean(&[missing, missing]), None);
    }
}
