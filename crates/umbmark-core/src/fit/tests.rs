use super::*;
use crate::random::Stream;
use nalgebra::{DMatrix, DVector};
use std::cell::Cell;
use std::ops::Range;

/// Rosenbrock's valley as residuals (1 - x, 10 (y - x²)): the classic that undamped steps overshoot.
struct Valley;

impl Problem for Valley {
    fn residuals(&self, p: &[f64]) -> DVector<f64> {
        DVector::from_vec(vec![1.0 - p[0], 10.0 * (p[1] - p[0] * p[0])])
    }

    fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &[-1.0, 0.0, -20.0 * p[0], 10.0])
    }
}

/// A straight line a + b x through points with standard deviations of their own.
struct Line {
    x: Vec<f64>,
    y: Vec<f64>,
    sd: Vec<f64>,
}

impl Problem for Line {
    fn residuals(&self, p: &[f64]) -> DVector<f64> {
        DVector::from_fn(self.x.len(), |i, _| (self.y[i] - p[0] - p[1] * self.x[i]) / self.sd[i])
    }

    fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.x.len(), 2, |i, j| -if j == 0 { 1.0 } else { self.x[i] } / self.sd[i])
    }
}

#[test]
fn the_bottom_of_rosenbrocks_valley_is_found_from_the_usual_start() {
    let fit = least_squares(&Valley, &[-1.2, 1.0], &Options::default());
    assert!(fit.termination.converged(), "{:?}", fit.termination);
    assert!((fit.values[0] - 1.0).abs() < 1e-12 && (fit.values[1] - 1.0).abs() < 1e-12, "{:?}", fit.values);
}

/// Oracle: the closed formulas of weighted straight-line regression.
#[test]
fn a_weighted_line_has_the_estimates_and_covariance_of_the_textbook() {
    let line = Line { x: vec![0.0, 1.0, 2.0, 4.0], y: vec![1.1, 2.9, 5.2, 9.0], sd: vec![0.1, 0.2, 0.1, 0.4] };
    let fit = least_squares(&line, &[0.0, 0.0], &Options::default());
    let w: Vec<f64> = line.sd.iter().map(|s| 1.0 / (s * s)).collect();
    let sum = |f: &dyn Fn(usize) -> f64| (0..4).map(|i| w[i] * f(i)).sum::<f64>();
    let (s, sx, sxx) = (sum(&|_| 1.0), sum(&|i| line.x[i]), sum(&|i| line.x[i] * line.x[i]));
    let (sy, sxy) = (sum(&|i| line.y[i]), sum(&|i| line.x[i] * line.y[i]));
    let determinant = s * sxx - sx * sx;
    assert!((fit.values[0] - (sxx * sy - sx * sxy) / determinant).abs() < 1e-11);
    assert!((fit.values[1] - (s * sxy - sx * sy) / determinant).abs() < 1e-11);
    let covariance = fit.covariance().unwrap();
    let expected = DMatrix::from_row_slice(2, 2, &[sxx, -sx, -sx, s]) / determinant;
    assert!((covariance - expected).abs().max() < 1e-14);
    assert!((fit.residual_variance().unwrap() - fit.cost() / 2.0).abs() < 1e-15);
}

/// A circle fitted to points far from any circle: the residuals at the minimum are large and strongly curved.
struct Circle {
    evaluated: Cell<usize>,
}

impl Circle {
    const POINTS: [[f64; 2]; 6] = [[0.0, 0.0], [3.0, 0.5], [1.0, 2.0], [-1.0, 1.5], [0.4, -1.5], [2.0, -0.6]];

    /// How many points a fit with these options evaluates, and where it ends.
    fn fitted(options: &Options) -> (usize, Fit) {
        let circle = Circle { evaluated: Cell::new(0) };
        let fit = least_squares(&circle, &[1.0, 0.2, 1.5], options);
        (circle.evaluated.get(), fit)
    }
}

impl Problem for Circle {
    fn residuals(&self, p: &[f64]) -> DVector<f64> {
        self.evaluated.update(|count| count + 1);
        DVector::from_fn(6, |i, _| (Self::POINTS[i][0] - p[0]).hypot(Self::POINTS[i][1] - p[1]) - p[2])
    }

    fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(6, 3, |i, j| {
            let away = [Self::POINTS[i][0] - p[0], Self::POINTS[i][1] - p[1]];
            if j == 2 { -1.0 } else { -away[j] / away[0].hypot(away[1]) }
        })
    }
}

#[test]
fn a_frugal_fit_ends_at_the_same_place_after_fewer_points() {
    let tolerance = Options { decrease_tolerance: 1e-12, ..Options::default() };
    let (plainly, all) = Circle::fitted(&tolerance);
    let (frugally, few) = Circle::fitted(&Options { frugal: true, ..tolerance });
    assert!(all.termination.converged() && few.termination.converged());
    for (a, b) in all.values.iter().zip(&few.values) {
        assert!((a - b).abs() < 1e-5, "{:?} {:?}", all.values, few.values);
    }
    assert!(4 * frugally <= 3 * plainly, "{frugally} of {plainly}");
    let valley = least_squares(&Valley, &[-1.2, 1.0], &Options { frugal: true, ..Options::default() });
    assert!((valley.values[0] - 1.0).abs() < 1e-6 && (valley.values[1] - 1.0).abs() < 1e-6, "{:?}", valley.values);
}

#[test]
fn a_combination_that_the_data_does_not_show_is_named_and_left_where_it_started() {
    struct Sum;
    impl Problem for Sum {
        fn residuals(&self, p: &[f64]) -> DVector<f64> {
            DVector::from_fn(3, |i, _| (i as f64 + 1.0) * (7.0 - p[0] - 2.0 * p[1]))
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::from_fn(3, 3, |i, j| [-1.0, -2.0, 0.0][j] * (i as f64 + 1.0))
        }
    }
    let fit = least_squares(&Sum, &[1.0, 1.0, 5.0], &Options::default());
    assert!(fit.termination.converged());
    assert!((fit.values[0] + 2.0 * fit.values[1] - 7.0).abs() < 1e-9);
    assert_eq!(fit.values[2], 5.0);
    let null = fit.null_directions();
    assert_eq!(null.len(), 2);
    for direction in &null {
        assert!((&fit.jacobian * direction).norm() < 1e-9);
    }
    assert_eq!(fit.covariance(), None);
    assert_eq!(fit.residual_variance(), None);
}

#[test]
fn a_parameter_whose_derivative_is_rounding_stays_where_it_is() {
    struct Rounding;
    impl Problem for Rounding {
        fn residuals(&self, p: &[f64]) -> DVector<f64> {
            DVector::from_vec(vec![3.0 - p[0], 0.1])
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::from_row_slice(2, 2, &[-1.0, 0.0, 0.0, 1e-16])
        }
    }
    let fit = least_squares(&Rounding, &[1.0, 1.0], &Options::default());
    assert_eq!(fit.values, [3.0, 1.0]);
    assert_eq!(fit.null_directions().len(), 1);
}

#[test]
fn nothing_to_fit_is_fitted_at_once() {
    struct Fixed;
    impl Problem for Fixed {
        fn residuals(&self, _: &[f64]) -> DVector<f64> {
            DVector::from_vec(vec![1.0])
        }
        fn jacobian(&self, _: &[f64]) -> DMatrix<f64> {
            DMatrix::zeros(1, 0)
        }
    }
    let fit = least_squares(&Fixed, &[], &Options::default());
    assert!(fit.termination.converged() && fit.cost() == 1.0 && fit.null_directions().is_empty());
}

#[test]
fn fewer_residuals_than_parameters_leave_directions_open() {
    let line = Line { x: vec![1.0], y: vec![3.0], sd: vec![1.0] };
    let fit = least_squares(&line, &[0.0, 0.0], &Options::default());
    assert!(fit.cost() < 1e-20 && fit.null_directions().len() == 1);
}

#[test]
fn a_hopeless_start_and_a_limit_of_steps_are_reports_and_not_errors() {
    let fit = least_squares(&Valley, &[f64::NAN, 0.0], &Options::default());
    assert_eq!((fit.termination, fit.iterations), (Termination::NotFinite, 0));
    let fit = least_squares(&Valley, &[-1.2, 1.0], &Options { iterations: 3, ..Options::default() });
    assert_eq!((fit.termination, fit.iterations), (Termination::IterationLimit, 3));
    assert!(fit.cost() < 24.2);
}

/// 4000 draws, seed 9, of eight groups of five residuals that share an error. True slope variance from the draws
/// themselves; the covariance for independent residuals is wrong by a factor that the jackknife must not miss.
#[test]
fn leaving_out_groups_sees_the_correlation_within_them() {
    let x: Vec<f64> = (0..40).map(|i| f64::from(i / 5) + 0.01 * f64::from(i % 5)).collect();
    let groups: Vec<Range<usize>> = (0..8).map(|g| 5 * g..5 * g + 5).collect();
    let (mut squares, mut jackknife, mut independent) = (0.0, 0.0, 0.0);
    let draws = 4000;
    for draw in 0..draws {
        let mut stream = Stream::new(9, 0, draw);
        let shared: Vec<f64> = (0..8).map(|_| stream.normal()).collect();
        let y = (0..40).map(|i| shared[i / 5] + 0.1 * stream.normal()).collect();
        let line = Line { x: x.clone(), y, sd: vec![1.0; 40] };
        let fit = least_squares(&line, &[0.0, 0.0], &Options::default());
        squares += fit.values[1] * fit.values[1];
        jackknife += jackknife_covariance(&fit.jacobian, &fit.residuals, &groups).unwrap()[(1, 1)];
        independent += fit.covariance().unwrap()[(1, 1)] * fit.residual_variance().unwrap();
    }
    assert!((1.0..1.8).contains(&(jackknife / squares)), "{}", jackknife / squares);
    assert!(independent / squares < 0.3, "{}", independent / squares);
}

#[test]
fn groups_that_alone_show_a_parameter_leave_the_jackknife_without_an_answer() {
    let jacobian = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let residuals = DVector::from_element(3, 0.1);
    assert_eq!(jackknife_covariance(&jacobian, &residuals, &[0..1, 1..2, 2..3]), None);
    assert_eq!(jackknife_covariance(&jacobian, &residuals, &[]), None);
}

/// A line with bounds and an earlier measurement.
struct Informed {
    line: Line,
    known: Vec<Known>,
}

impl Problem for Informed {
    fn residuals(&self, p: &[f64]) -> DVector<f64> {
        self.line.residuals(p)
    }

    fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
        self.line.jacobian(p)
    }

    fn known(&self) -> Vec<Known> {
        self.known.clone()
    }
}

fn line() -> Line {
    Line { x: vec![0.0, 1.0, 2.0, 4.0], y: vec![1.1, 2.9, 5.2, 9.0], sd: vec![0.1, 0.2, 0.1, 0.4] }
}

/// Oracle: the mean of Gaussian measurements weighted by their information.
#[test]
fn an_earlier_measurement_counts_by_its_information() {
    let free = least_squares(&line(), &[0.0, 0.0], &Options::default());
    let prior = Prior { mean: 2.3, sd: 0.05 };
    let known = vec![Known::default(), Known { prior: Some(prior), ..Known::default() }];
    let fit = least_squares(&Informed { line: line(), known }, &[0.0, 0.0], &Options::default());
    let mut information = free.covariance().unwrap().try_inverse().unwrap();
    let mut right = &information * DVector::from_column_slice(&free.values);
    information[(1, 1)] += 1.0 / (prior.sd * prior.sd);
    right[1] += prior.mean / (prior.sd * prior.sd);
    let covariance = information.try_inverse().unwrap();
    let expected = &covariance * right;
    assert!((DVector::from_column_slice(&fit.values) - expected).abs().max() < 1e-10, "{:?}", fit.values);
    assert!((fit.covariance().unwrap() - covariance).abs().max() < 1e-12);
}

/// Oracle: the closed formula of a line whose slope is given.
#[test]
fn a_fit_ends_at_a_bound_that_it_would_exceed_and_nowhere_near_one_that_it_would_not() {
    let free = least_squares(&line(), &[0.0, 0.0], &Options::default());
    for (low, high, held) in [(-1e3, 1.8, true), (2.4, 1e3, true), (1.0, 3.0, false)] {
        let known = vec![Known::default(), Known { low, high, prior: None }];
        for start in [[0.0, 0.0], [5.0, 2.0], [0.0, 9.0]] {
            let fit = least_squares(&Informed { line: line(), known: known.clone() }, &start, &Options::default());
            assert_eq!((fit.termination.converged(), &fit.held[..]), (true, &[false, held][..]), "{start:?}");
            let slope = free.values[1].clamp(low, high);
            let own = line();
            let weights = own.sd.iter().map(|sd| 1.0 / (sd * sd));
            let terms = weights.clone().zip(own.y.iter().zip(&own.x)).map(|(w, (y, x))| w * (y - slope * x));
            let expected = [terms.sum::<f64>() / weights.clone().sum::<f64>(), slope];
            assert!((0..2).all(|k| (fit.values[k] - expected[k]).abs() < 1e-9), "{:?} {expected:?}", fit.values);
            let covariance = fit.covariance().unwrap();
            if held {
                assert_eq!((covariance[(0, 1)], covariance[(1, 1)]), (0.0, 0.0));
                assert!((covariance[(0, 0)] - 1.0 / weights.sum::<f64>()).abs() < 1e-12);
            } else {
                assert!((covariance - free.covariance().unwrap()).abs().max() < 1e-12);
            }
        }
    }
}

/// The minimum of the valley within x ≤ 0.5 is at its edge, 0.25 high; steps along the valley end at the edge many times.
#[test]
fn a_curved_valley_is_walked_to_the_edge_of_the_allowed_range() {
    struct Within;
    impl Problem for Within {
        fn residuals(&self, p: &[f64]) -> DVector<f64> {
            Valley.residuals(p)
        }
        fn jacobian(&self, p: &[f64]) -> DMatrix<f64> {
            Valley.jacobian(p)
        }
        fn known(&self) -> Vec<Known> {
            vec![Known { high: 0.5, ..Known::default() }]
        }
    }
    for frugal in [false, true] {
        let fit = least_squares(&Within, &[-1.2, 1.0], &Options { frugal, ..Options::default() });
        assert!(fit.termination.converged() && fit.held[0] && !fit.held[1], "{:?}", fit.termination);
        assert!((fit.values[0] - 0.5).abs() < 1e-12 && (fit.values[1] - 0.25).abs() < 1e-9, "{:?}", fit.values);
    }
}
