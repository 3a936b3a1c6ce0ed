//! Likelihood ratios of a change between any two runs.
//!
//! Runs after a change by δ lie J δ from where the earlier ones are, J by direction. Where τ runs of a direction precede the change, and n ≥ τ
//! runs precede a run after it, the prediction of that run has moved by all but the share τ/n of the change, so its scores z have the mean
//! W J δ τ/n with W = dz/dy. With
//!
//! ```text
//! s = Σ_i (τ/n_i) JᵀW_iᵀz_i,    G = Σ_i (τ/n_i)² JᵀW_iᵀW_iJ
//! ```
//!
//! over the runs after it, ½ sᵀG⁻¹s is the logarithm of the likelihood ratio of the best δ. Three kinds are asked: J of the robot's numbers; J = 1, any
//! change of the mean of either direction; and for v = Σ |z|² of m scores, the scatter, ½ (v - m - m ln(v/m)) for v > m.
//!
//! Source: Siegmund & Venkatraman (1995), Annals of Statistics 23, 255, for the likelihood ratio over all change points.

use super::scores::{COMPONENTS, Matrix, Scored, Vector, cholesky, inverse};

/// What can change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The numbers of the robot.
    Numbers,
    /// The mean return pose of either direction, in any way.
    Place,
    /// The scatter of the runs.
    Scatter,
}

impl Kind {
    /// All, in the order of arrays here.
    pub const ALL: [Kind; 3] = [Kind::Numbers, Kind::Place, Kind::Scatter];

    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Numbers => "numbers",
            Kind::Place => "place",
            Kind::Scatter => "scatter",
        }
    }
}

/// Runs after a change at least: one run alone is outlying, and no change.
const AFTER: usize = 2;

/// How much each number of the robot, of which there are at most three, moves the components, by direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signature {
    /// Components that are measured.
    pub components: usize,
    /// Numbers of the robot.
    pub numbers: usize,
    /// d component / d number, by direction: clockwise first.
    pub slopes: [Matrix; 2],
}

/// A scored run in its place among all.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Its place among all runs.
    place: usize,
    direction: usize,
    /// Runs of either direction before it.
    before: [usize; 2],
    /// Wᵀz/n.
    pull: Vector,
    /// WᵀW/n².
    weight: Matrix,
    square: f64,
}

/// The largest likelihood ratio of a kind, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Logarithm of the likelihood ratio.
    pub height: f64,
    /// Place of the first run after the change.
    pub place: usize,
}

/// All scored runs so far.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    signature: Signature,
    points: Vec<Point>,
    counts: [usize; 2],
    places: usize,
}

/// Sums over the runs after a change, by direction.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    pull: [Vector; 2],
    weight: [Matrix; 2],
    square: f64,
    runs: usize,
}

impl Scan {
    pub fn new(signature: &Signature) -> Scan {
        Scan { signature: *signature, points: Vec::new(), counts: [0; 2], places: 0 }
    }

    /// Adds a run; `None` is one that is not scored.
    #[expect(clippy::needless_range_loop, reason = "indices as in the equation")]
    pub fn add(&mut self, direction: usize, scored: Option<&Scored>) {
        if let Some(scored) = scored {
            let (q, n) = (self.signature.components, scored.earlier as f64);
            let (mut pull, mut weight) = ([0.0; COMPONENTS], [[0.0; COMPONENTS]; COMPONENTS]);
            for i in 0..q {
                pull[i] = (i..q).map(|k| scored.slopes[k][i] * scored.scores[k]).sum::<f64>() / n;
                for j in 0..=i {
                    weight[i][j] = (i..q).map(|k| scored.slopes[k][i] * scored.slopes[k][j]).sum::<f64>() / (n * n);
                    weight[j][i] = weight[i][j];
                }
            }
            let square = scored.scores.iter().map(|z| z * z).sum();
            self.points.push(Point { place: self.places, direction, before: self.counts, pull, weight, square });
        }
        self.counts[direction] += 1;
        self.places += 1;
    }

    /// Number of scored runs.
    pub fn scored(&self) -> usize {
        self.points.len()
    }

    /// The same with the last so many scored runs only.
    pub fn recent(&self, points: usize) -> Scan {
        let first = self.points.len().saturating_sub(points);
        Scan { points: self.points[first..].to_vec(), ..self.clone() }
    }

    /// The largest likelihood ratio of each kind.
    pub fn peaks(&self) -> [Peak; 3] {
        let mut peaks = [Peak::default(); 3];
        self.each(|place, heights| {
            for (peak, height) in peaks.iter_mut().zip(heights) {
                if height > peak.height {
                    *peak = Peak { height, place };
                }
            }
        });
        peaks
    }

    /// Visits each place that can be the first after a change, the last one first, with the likelihood ratio of each kind.
    pub fn each(&self, mut visit: impl FnMut(usize, [f64; 3])) {
        let q = self.signature.components;
        let mut sums = Sums::default();
        for point in self.points.iter().rev() {
            let d = point.direction;
            for i in 0..q {
                sums.pull[d][i] += point.pull[i];
                for j in 0..q {
                    sums.weight[d][i][j] += point.weight[i][j];
                }
            }
            sums.square += point.square;
            sums.runs += 1;
            if sums.runs >= AFTER {
                visit(point.place, [self.numbers(&sums, point.before), self.anywhere(&sums), self.scatter(&sums)]);
            }
        }
    }

    fn numbers(&self, sums: &Sums, before: [usize; 2]) -> f64 {
        let Signature { components: q, numbers: p, slopes } = &self.signature;
        let (mut pull, mut weight) = ([0.0; COMPONENTS], [[0.0; COMPONENTS]; COMPONENTS]);
        for d in 0..2 {
            let share = before[d] as f64;
            for a in 0..*p {
                pull[a] += share * (0..*q).map(|k| slopes[d][k][a] * sums.pull[d][k]).sum::<f64>();
                for k in 0..*q {
                    let row: f64 = (0..*q).map(|j| slopes[d][j][a] * sums.weight[d][j][k]).sum();
                    for b in 0..=a {
                        weight[a][b] += share * share * row * slopes[d][k][b];
                    }
                }
            }
        }
        half_square(&weight, &pull, *p)
    }

    fn anywhere(&self, sums: &Sums) -> f64 {
        (0..2).map(|d| half_square(&sums.weight[d], &sums.pull[d], self.signature.components)).sum()
    }

    fn scatter(&self, sums: &Sums) -> f64 {
        let m = (sums.runs * self.signature.components) as f64;
        let v = sums.square;
        if v > m { 0.5 * (v - m - m * libm::log(v / m)) } else { 0.0 }
    }
}

/// ½ sᵀG⁻¹s; 0 where G has no inverse.
fn half_square(weight: &Matrix, pull: &Vector, count: usize) -> f64 {
    let Some(factor) = cholesky(weight, count) else { return 0.0 };
    let inverse = inverse(&factor, count);
    0.5 * (0..count).map(|i| (0..=i).map(|j| inverse[i][j] * pull[j]).sum::<f64>().powi(2)).sum::<f64>()
}
