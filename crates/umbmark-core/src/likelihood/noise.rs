//! The sizes of the noise, and how they are found.

mod written;

use super::descent::Descent;
use super::observed::{Column, Growth, Observed, ObservedRun};
use super::products::{gram, solver};
use crate::effect::Chain;
use crate::geometry::{EIGHT, Eight, Scalar};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Standard deviations of everything random in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise<T = f64> {
    /// Heading noise per square root of way \[rad/√m\].
    pub heading_per_metre: T,
    /// Heading noise per square root of rotation \[rad/√rad\].
    pub heading_per_radian: T,
    /// Noise of the way forward per square root of the wheels' mean way \[m/√m\].
    pub forward_per_metre: T,
    /// Noise to the side per square root of the wheels' mean way \[m/√m\].
    pub sideways_per_metre: T,
    /// Reference noise that a block of poses shares, each coordinate \[m\].
    pub reference_position: T,
    /// The same of the heading \[rad\].
    pub reference_heading: T,
    /// Jitter of the reference's time stamps \[s\]; it shows only while the robot moves.
    pub reference_time: T,
    /// Scatter of the delay of the reference from run to run \[s\].
    pub reference_delay: T,
    /// Reference noise from pose to pose within a block, each coordinate \[m\].
    pub within_position: T,
    /// The same of the heading \[rad\].
    pub within_heading: T,
    /// Scatter of START where it was not measured, each coordinate \[m\].
    pub start_position: T,
    /// The same of the heading \[rad\].
    pub start_heading: T,
}

impl Noise {
    /// The noise of the wheels, by which the covariance of a pose grows.
    pub fn of_wheels(&self) -> umbmark_odometry::spread::Growth {
        umbmark_odometry::spread::Growth {
            heading_per_metre: self.heading_per_metre,
            heading_per_radian: self.heading_per_radian,
            forward_per_metre: self.forward_per_metre,
            sideways_per_metre: self.sideways_per_metre,
        }
    }
}

impl Default for Noise {
    /// Usual sizes: wheels on a smooth floor, motion capture, START marked on the floor.
    fn default() -> Self {
        Noise {
            heading_per_metre: 1.5e-3,
            heading_per_radian: 1e-3,
            forward_per_metre: 3e-4,
            sideways_per_metre: 1e-4,
            reference_position: 5e-4,
            reference_heading: 5e-4,
            reference_time: 5e-4,
            reference_delay: 1e-3,
            within_position: 0.0,
            within_heading: 0.0,
            start_position: 2e-3,
            start_heading: 3e-3,
        }
    }
}

/// Range of each size, as multiples of its usual value.
const RANGE: (f64, f64) = (1e-2, 1e3);
/// The scatter of delays may be this multiple of the one that the motion of the runs shows.
const BY_MOTION: f64 = 2.0;
/// Number of rounds with the columns projected out once per round; after these they are projected out for every noise that is tried.
const ROUNDS: usize = 2;

impl Noise {
    /// How many sizes are estimated.
    pub const SIZES: usize = 8;

    /// No noise at all.
    pub fn silent() -> Noise {
        Noise {
            heading_per_metre: 0.0,
            heading_per_radian: 0.0,
            forward_per_metre: 0.0,
            sideways_per_metre: 0.0,
            reference_position: 0.0,
            reference_heading: 0.0,
            reference_time: 0.0,
            reference_delay: 0.0,
            within_position: 0.0,
            within_heading: 0.0,
            start_position: 0.0,
            start_heading: 0.0,
        }
    }

    /// The largest sizes that are searched.
    pub fn largest() -> Noise {
        let usual = Noise::default();
        let most = RANGE.1;
        Noise {
            heading_per_metre: most * usual.heading_per_metre,
            heading_per_radian: most * usual.heading_per_radian,
            forward_per_metre: most * usual.forward_per_metre,
            sideways_per_metre: most * usual.sideways_per_metre,
            reference_position: most * usual.reference_position,
            reference_heading: most * usual.reference_heading,
            reference_time: most * usual.reference_time,
            reference_delay: most * usual.reference_delay,
            ..usual
        }
    }

    /// The sizes under which the residuals of a model are likeliest, by restricted maximum likelihood:
    ///
    /// -2 l = Σ log|S| + log|AᵀΣ⁻¹A| + r̂ᵀΣ⁻¹r̂, with the columns A fitted out.
    ///
    /// Noise within blocks is taken from successive differences, less what wheels and counters add between them. `columns` holds, run by
    /// run, the columns of the model and last the residuals.
    pub fn estimate(observed: &Observed, chain: &Chain<f64>, columns: &[Vec<Column>], from: &Noise) -> Noise {
        let within = Within::of(observed, chain);
        let longest = longest_delay(observed);
        let sizes = |x: &[f64; Noise::SIZES]| {
            let usual = Noise::default();
            let at = |i: usize, usual: f64| usual * libm::exp(x[i].clamp(libm::log(RANGE.0), libm::log(RANGE.1)));
            let noise = Noise {
                heading_per_metre: at(0, usual.heading_per_metre),
                heading_per_radian: at(1, usual.heading_per_radian),
                forward_per_metre: at(2, usual.forward_per_metre),
                sideways_per_metre: at(3, usual.sideways_per_metre),
                reference_position: at(4, usual.reference_position),
                reference_heading: at(5, usual.reference_heading),
                reference_time: at(6, usual.reference_time),
                reference_delay: at(7, usual.reference_delay).min(longest),
                ..*from
            };
            let [within_position, within_heading] = within.less_wheels(&noise);
            Noise { within_position, within_heading, ..noise }
        };
        let usual = Noise::default();
        let first = [
            libm::log(from.heading_per_metre / usual.heading_per_metre),
            libm::log(from.heading_per_radian / usual.heading_per_radian),
            libm::log(from.forward_per_metre / usual.forward_per_metre),
            libm::log(from.sideways_per_metre / usual.sideways_per_metre),
            libm::log(from.reference_position / usual.reference_position),
            libm::log(from.reference_heading / usual.reference_heading),
            libm::log(from.reference_time / usual.reference_time),
            libm::log(from.reference_delay / usual.reference_delay),
        ];
        let cost = |points: &[[f64; Noise::SIZES]; EIGHT], columns: &[Vec<Column>]| {
            let deviances = Noise::deviances(&points.map(|x| sizes(&x)), &observed.runs, columns);
            // A weak prior for the usual sizes: sizes that the data does not determine stay there.
            let pull = |x: &[f64; Noise::SIZES]| x.iter().map(|v| 0.02 * v * v).sum::<f64>();
            std::array::from_fn(|lane| deviances[lane] + pull(&points[lane]))
        };
        let mut descent = Descent::from(first);
        // Most of the descent uses columns that were projected out beforehand: their values hardly change during a round, and the cost
        // hardly depends on them.
        for _ in 0..ROUNDS {
            let left = sizes(&descent.here()).less_fitted(&observed.runs, columns);
            descent.descend(|points| cost(points, &left));
        }
        descent.descend(|points| cost(points, columns));
        sizes(&descent.here())
    }

    /// The last column of each run less what the others explain of it under this noise.
    fn less_fitted(&self, runs: &[ObservedRun], columns: &[Vec<Column>]) -> Vec<Vec<Column>> {
        let width = columns.first().map_or(0, Vec::len);
        let of_run = |(run, columns): (&ObservedRun, &Vec<Column>)| {
            gram(&self.whiten(run, &columns.iter().map(Vec::as_slice).collect::<Vec<_>>()).values, width)
        };
        let parts: Vec<DMatrix<f64>> = runs.par_iter().zip(columns).map(of_run).collect();
        let products = parts.iter().fold(DMatrix::zeros(width, width), |sum, part| sum + part);
        let others: Vec<usize> = (0..width - 1).collect();
        let cross = products.view((0, width - 1), (width - 1, 1)).into_owned();
        let values = solver(&products, &others).map(|solver| solver.solve(&cross));
        let less = |columns: &Vec<Column>| {
            let mut left = columns[width - 1].clone();
            for (column, value) in columns.iter().zip(values.iter().flatten()) {
                left.iter_mut().zip(column).for_each(|(l, c)| (0..3).for_each(|k| l[k] -= value * c[k]));
            }
            vec![left]
        };
        columns.iter().map(less).collect()
    }

    /// -2 log of the restricted likelihood under each of some sizes, up to a constant. The last column of each run is its residuals.
    pub fn deviances(noises: &[Noise; EIGHT], runs: &[ObservedRun], columns: &[Vec<Column>]) -> [f64; EIGHT] {
        let noise = Noise::side_by_side(noises);
        let of_run = |(run, columns): (&ObservedRun, &Vec<Column>)| {
            noise.products(run, &columns.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        let parts: Vec<(Vec<Eight>, Eight)> = runs.par_iter().zip(columns).map(of_run).collect();
        let width = columns.first().map_or(0, Vec::len);
        std::array::from_fn(|lane| {
            let mut sum = DMatrix::zeros(width, width);
            let mut log_scale = 0.0;
            for (products, scale) in &parts {
                for (index, product) in products.iter().enumerate() {
                    sum[(index / width, index % width)] += product.0[lane];
                }
                log_scale += scale.0[lane];
            }
            deviance(&sum, log_scale)
        })
    }
}

/// How neighbouring poses within blocks differ, per difference.
struct Within {
    /// Half the mean square, of a coordinate \[m²\] and of the heading \[rad²\].
    half: [f64; 2],
    /// Mean way \[m\], mean way of both wheels \[m\] and rotation \[rad\] between them.
    way: f64,
    rolled: f64,
    turned: f64,
}

impl Within {
    fn of(observed: &Observed, chain: &Chain<f64>) -> Within {
        let scatter: Vec<_> = observed.runs.par_iter().map(|run| run.scatter_within_blocks(chain)).collect();
        let half = [0, 1].map(|which| {
            let (sum, count) = scatter.iter().fold((0.0, 0), |(s, n), run| (s + run[which].0, n + run[which].1));
            if count > 0 { sum / count as f64 } else { 0.0 }
        });
        let blocks = || observed.runs.iter().flat_map(|run| &run.blocks);
        let count = blocks().map(|block| block.count - 1).sum::<usize>().max(1) as f64;
        // On average, half the observations see what is added between two of them.
        let mean = |of: fn(&Growth) -> f64| {
            blocks().map(|block| 2.0 * (of(&block.growth) - of(&block.growth_seen))).sum::<f64>() / count
        };
        Within { half, way: mean(|g| g.way), rolled: mean(|g| g.rolled), turned: mean(|g| g.heading_per_radian[5]) }
    }

    /// Standard deviation of a single pose \[m, rad\], less what this noise of the wheels adds between two of them.
    fn less_wheels(&self, noise: &Noise) -> [f64; 2] {
        let plane = noise.forward_per_metre.powi(2) + noise.sideways_per_metre.powi(2);
        let turning = noise.heading_per_metre.powi(2) * self.way + noise.heading_per_radian.powi(2) * self.turned;
        let left = [self.half[0] - 0.25 * plane * self.rolled, self.half[1] - 0.5 * turning];
        left.map(|left| left.max(0.0).sqrt())
    }
}

/// -2 log of the restricted likelihood, up to a constant, by products of whitened columns, the last of them the residuals, and the
/// logarithm of what they were divided by.
fn deviance(products: &DMatrix<f64>, log_scale: f64) -> f64 {
    let p = products.nrows() - 1;
    let deviance = 2.0 * log_scale + products[(p, p)];
    let Some(solver) = solver(products, &(0..p).collect::<Vec<_>>()) else { return deviance };
    let cross = products.view((0, p), (p, 1)).into_owned();
    deviance + solver.log_determinant() - solver.half(&cross).norm_squared()
}

/// The largest scatter of the delay from run to run that the motion allows \[s\], where no heading was measured: a late run then looks like
/// one that began with another heading and turns by other angles, and the poses alone hardly tell these apart.
fn longest_delay(observed: &Observed) -> f64 {
    if observed.has_headings() {
        return f64::INFINITY;
    }
    let delays: Vec<_> = observed.setup.runs.iter().filter_map(|run| run.delay).collect();
    let n = delays.len() as f64;
    let mean = delays.iter().map(|delay| delay.value).sum::<f64>() / n;
    let squares = delays.iter().map(|delay| (delay.value - mean).powi(2) + delay.std_error.powi(2)).sum::<f64>() / n;
    let longest = BY_MOTION * squares.sqrt();
    if longest.is_finite() && n > 1.0 { longest.max(Noise::default().reference_delay) } else { f64::INFINITY }
}

impl Noise<Eight> {
    /// Eight noises as one.
    pub(super) fn side_by_side(noises: &[Noise; EIGHT]) -> Noise<Eight> {
        let of = |size: fn(&Noise) -> f64| Eight(std::array::from_fn(|lane| size(&noises[lane])));
        Noise {
            heading_per_metre: of(|noise| noise.heading_per_metre),
            heading_per_radian: of(|noise| noise.heading_per_radian),
            forward_per_metre: of(|noise| noise.forward_per_metre),
            sideways_per_metre: of(|noise| noise.sideways_per_metre),
            reference_position: of(|noise| noise.reference_position),
            reference_heading: of(|noise| noise.reference_heading),
            reference_time: of(|noise| noise.reference_time),
            reference_delay: of(|noise| noise.reference_delay),
            within_position: of(|noise| noise.within_position),
            within_heading: of(|noise| noise.within_heading),
            start_position: of(|noise| noise.start_position),
            start_heading: of(|noise| noise.start_heading),
        }
    }
}

impl<T: Scalar> Noise<T> {
    /// Covariance added from one block to the next, in error coordinates.
    #[inline(always)]
    pub(crate) fn growth(&self, growth: &Growth) -> [[T; 3]; 3] {
        let metre = self.heading_per_metre * self.heading_per_metre;
        let radian = self.heading_per_radian * self.heading_per_radian;
        let sideways = self.sideways_per_metre * self.sideways_per_metre;
        let along = self.forward_per_metre * self.forward_per_metre - sideways;
        let mut turned = [T::from(0.0); 6];
        for (k, sum) in turned.iter_mut().enumerate() {
            *sum = metre * T::from(growth.heading_per_metre[k]) + radian * T::from(growth.heading_per_radian[k]);
        }
        if growth.heading_by_gyro[5] > 0.0 {
            turned.iter_mut().zip(growth.heading_by_gyro).for_each(|(sum, own)| *sum += T::from(own));
        }
        let [xx, xy, yy, x, y, own] = turned;
        let [forward_xx, forward_xy, forward_yy] = growth.forward;
        let across = sideways * T::from(growth.rolled);
        let xy = xy + along * T::from(forward_xy);
        let (xx, yy) = (xx + along * T::from(forward_xx) + across, yy + along * T::from(forward_yy) + across);
        [[xx, xy, x], [xy, yy, y], [x, y, own]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::watched::watched;
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;

    /// Seed 11, 6 + 6 runs: sizes within a quarter of the truth, parameters within four standard errors.
    #[test]
    fn the_noise_of_the_wheels_and_of_the_reference_is_found_and_intervals_follow() {
        let robot = Robot::labmate();
        let mut model = Model::new(&robot);
        let truth = [("wheel_diameter_ratio", "e_d", 1.002), ("wheelbase", "e_b", 0.99), ("scale", "e_s", 1.003)];
        for (effect, parameter, value) in truth {
            model.set(effect, parameter, value).unwrap();
        }
        let k = 6e-4;
        model.set("wheel_noise", "k_sqrt_m", k).unwrap();
        model.set("reference_noise", "position_sd_m", 8e-4).unwrap();
        model.set("reference_noise", "heading_sd_rad", 1e-3).unwrap();
        let observed = Observed::new(&watched(&model, 6, 11), &robot).unwrap();
        let mut asked = Model::new(&robot);
        for (effect, ..) in truth {
            asked.add(effect).unwrap().free = true;
        }
        let fitted = observed.fit(&asked, &Noise::default(), &[]).unwrap();
        let noise = &fitted.noise;
        for (found, put_in) in [
            (noise.heading_per_metre, k * 2f64.sqrt() / 0.34),
            (noise.forward_per_metre, k / 2f64.sqrt()),
            (noise.within_position, 8e-4),
            (noise.within_heading, 1e-3),
        ] {
            assert!((found / put_in - 1.0).abs() < 0.25, "{found} {put_in}");
        }
        let covariance = fitted.covariance.unwrap();
        for (i, (_, parameter, value)) in truth.into_iter().enumerate() {
            let found = fitted.model.values().nth(fitted.free[i]).unwrap();
            let sd = covariance[(i, i)].sqrt();
            assert!((found - value).abs() < 4.0 * sd && sd < 3e-4, "{parameter}: {found} {value} {sd}");
        }
    }
}
