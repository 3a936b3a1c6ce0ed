//! What is varied, and how.

use nalgebra::DMatrix;

use super::{SensitivityError, SobolPoints};
use crate::monte_carlo::Distribution;
use crate::stats::{normal_quantile, standard_normal_share};

/// One input: its name, its distribution and the bounds that cut it off.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Its name.
    pub name: String,
    /// How its values are distributed.
    pub distribution: Distribution,
    /// Smallest and largest value allowed.
    pub bounds: (f64, f64),
    /// Whether its values are rounded to whole numbers.
    pub whole: bool,
}

impl Input {
    /// The value below which a share `u` of its draws lies.
    pub fn quantile(&self, u: f64) -> f64 {
        let value = self.distribution.quantile(u, self.bounds);
        if self.whole { value.round() } else { value }
    }
}

/// A correlation of two inputs, by their places: that of their normal scores, the parameter of a Gaussian copula.
///
/// For two normal inputs it is their correlation; for others their rank correlation is (6/π) asin(value/2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlation {
    /// The two inputs.
    pub of: [usize; 2],
    /// Its value, in (-1, 1).
    pub value: f64,
}

/// All inputs of a response and how they hang together.
///
/// A row of a design is a list of *coordinates*, one an input: where the inputs are independent, shares u in (0, 1) of their
/// distributions; under a copula, normal scores.
#[derive(Clone, Debug)]
pub struct Inputs {
    inputs: Vec<Input>,
    copula: Option<Copula>,
}

/// A Gaussian copula: correlation matrix R of the normal scores, its Cholesky factor and its inverse.
#[derive(Clone, Debug)]
struct Copula {
    correlation: DMatrix<f64>,
    factor: DMatrix<f64>,
    precision: DMatrix<f64>,
}

impl Inputs {
    /// The most inputs that there are points for.
    pub const MAX_INPUTS: usize = SobolPoints::MOST_DIMENSIONS / 2;

    /// Some inputs, joined by correlations where they are listed.
    pub fn new(inputs: Vec<Input>, correlations: &[Correlation]) -> Result<Inputs, SensitivityError> {
        if inputs.is_empty() || inputs.len() > Self::MAX_INPUTS {
            return Err(SensitivityError::Inputs { most: Self::MAX_INPUTS, got: inputs.len() });
        }
        let again = |(place, input): (usize, &Input)| inputs[..place].iter().any(|i| i.name == input.name);
        if let Some((_, input)) = inputs.iter().enumerate().find(|one| again(*one)) {
            return Err(SensitivityError::Twice { name: input.name.clone() });
        }
        let mut matrix = DMatrix::identity(inputs.len(), inputs.len());
        for Correlation { of: [one, two], value } in correlations {
            if one == two || !(value.abs() < 1.0) {
                let name = |place: usize| inputs[place].name.clone();
                return Err(SensitivityError::Correlation { one: name(*one), two: name(*two), value: *value });
            }
            matrix[(*one, *two)] = *value;
            matrix[(*two, *one)] = *value;
        }
        let joined = correlations.iter().any(|c| c.value != 0.0);
        let copula = if joined { Some(Copula::new(matrix)?) } else { None };
        Ok(Inputs { inputs, copula })
    }

    /// The inputs, in order.
    pub fn all(&self) -> &[Input] {
        &self.inputs
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.inputs.len()
    }

    /// Whether they are independent of each other.
    pub fn are_independent(&self) -> bool {
        self.copula.is_none()
    }

    /// Turns independent uniform numbers into the coordinates of a row.
    pub(super) fn coordinates(&self, uniform: &mut [f64]) {
        let Some(copula) = &self.copula else { return };
        uniform.iter_mut().for_each(|u| *u = normal_quantile(*u));
        for row in (0..uniform.len()).rev() {
            uniform[row] = (0..=row).map(|column| copula.factor[(row, column)] * uniform[column]).sum();
        }
    }

    /// The values at some coordinates.
    pub(super) fn values(&self, coordinates: &[f64], values: &mut [f64]) {
        for ((input, coordinate), value) in self.inputs.iter().zip(coordinates).zip(values) {
            let share = if self.copula.is_some() { standard_normal_share(*coordinate) } else { *coordinate };
            *value = input.quantile(share);
        }
    }

    /// Coordinates that share all inputs but `which` with `here`; that one is drawn anew, given the others, with what is
    /// its own in `there`.
    pub(super) fn with_one_anew(&self, here: &[f64], there: &[f64], which: usize, row: &mut [f64]) {
        row.copy_from_slice(here);
        row[which] = match &self.copula {
            None => there[which],
            Some(copula) => copula.expected(here, which) + there[which] - copula.expected(there, which),
        };
    }

    /// Coordinates that share the input `which` with `there`; all others are drawn anew, given that one, with what is their
    /// own in `here`.
    ///
    /// For independent inputs the same as [`Inputs::with_one_anew`].
    pub(super) fn with_one_shared(&self, here: &[f64], there: &[f64], which: usize, row: &mut [f64]) {
        row.copy_from_slice(here);
        let change = there[which] - here[which];
        if let Some(copula) = &self.copula {
            for (coordinate, correlation) in row.iter_mut().zip(copula.correlation.column(which).iter()) {
                *coordinate += correlation * change;
            }
        }
        row[which] = there[which];
    }

    /// Whether the two kinds of rows differ for an input.
    pub(super) fn is_joined(&self, which: usize) -> bool {
        let others = |copula: &Copula| (0..self.count()).any(|j| j != which && copula.correlation[(which, j)] != 0.0);
        self.copula.as_ref().is_some_and(others)
    }
}

impl Copula {
    fn new(correlation: DMatrix<f64>) -> Result<Copula, SensitivityError> {
        let cholesky = correlation.clone().cholesky().ok_or(SensitivityError::Contradiction)?;
        Ok(Copula { factor: cholesky.l(), precision: cholesky.inverse(), correlation })
    }

    /// The mean of a score given all others.
    fn expected(&self, scores: &[f64], which: usize) -> f64 {
        let others = (0..scores.len()).filter(|j| *j != which);
        let sum: f64 = others.map(|j| self.precision[(which, j)] * scores[j]).sum();
        -sum / self.precision[(which, which)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn normal(name: &str) -> Input {
        let distribution = Distribution::Normal { mean: 0.0, sd: 1.0 };
        Input { name: name.to_owned(), distribution, bounds: (f64::NEG_INFINITY, f64::INFINITY), whole: false }
    }

    fn three() -> Inputs {
        let correlations = [Correlation { of: [0, 1], value: 0.6 }, Correlation { of: [1, 2], value: -0.5 }];
        Inputs::new(["a", "b", "c"].map(normal).to_vec(), &correlations).unwrap()
    }

    /// Correlations of `rows`, n = 20 000, seed 6: their standard error is at most 0.007.
    #[test]
    fn rows_have_the_correlations_asked_for_and_so_have_those_with_one_input_anew_or_shared() {
        let inputs = three();
        let mut stream = Stream::new(6, 0, 0);
        let n = 20_000;
        let mut sums = [[0.0; 8]; 2];
        for _ in 0..n {
            let [mut a, mut b] = [[0.0; 3]; 2].map(|row: [f64; 3]| row.map(|_| stream.uniform()));
            inputs.coordinates(&mut a);
            inputs.coordinates(&mut b);
            let [mut anew, mut shared] = [[0.0; 3]; 2];
            inputs.with_one_anew(&a, &b, 1, &mut anew);
            inputs.with_one_shared(&a, &b, 1, &mut shared);
            assert!(anew[0] == a[0] && anew[2] == a[2] && shared[1] == b[1]);
            for (row, sums) in [anew, shared].iter().zip(&mut sums) {
                let products = [row[0] * row[1], row[1] * row[2], row[0] * row[2], row[0] * row[0], row[1] * row[1]];
                products.into_iter().zip(&mut *sums).for_each(|(p, sum)| *sum += p / n as f64);
            }
            // What is anew is independent of what was there given the rest; what is not shared, of the other row.
            sums[0][5] += anew[1] * a[1] / n as f64;
            sums[1][5] += shared[0] * b[0] / n as f64;
            sums[1][6] += shared[0] * b[1] / n as f64;
        }
        for sums in &sums {
            for (found, expected) in sums.iter().zip([0.6, -0.5, 0.0, 1.0, 1.0]) {
                assert!((found - expected).abs() < 0.04, "{sums:?}");
            }
        }
        // The mean of the second given the others explains 1 - 1/P_22 of its variance: P_22 = 1/(1 - 0.36 - 0.25).
        assert!((sums[0][5] - 0.61).abs() < 0.04, "{}", sums[0][5]);
        assert!((sums[1][5] - 0.36).abs() < 0.04 && (sums[1][6] - 0.6).abs() < 0.04, "{:?}", sums[1]);
    }

    #[test]
    fn independent_inputs_are_exchanged_one_for_one() {
        let inputs = Inputs::new(["a", "b"].map(normal).to_vec(), &[]).unwrap();
        let (a, b) = ([0.25, 0.5], [0.75, 0.125]);
        let [mut anew, mut shared] = [[0.0; 2]; 2];
        inputs.with_one_anew(&a, &b, 0, &mut anew);
        inputs.with_one_shared(&a, &b, 0, &mut shared);
        assert_eq!((anew, shared), ([0.75, 0.5], [0.75, 0.5]));
        assert!(!inputs.is_joined(0) && three().is_joined(2));
    }

    #[test]
    fn impossible_inputs_are_refused() {
        let refuse = |names: &[&str], correlations: &[Correlation]| {
            let inputs = names.iter().copied().map(normal).collect();
            Inputs::new(inputs, correlations).unwrap_err().to_string()
        };
        assert!(refuse(&[], &[]).starts_with("between 1 and 64 parameters"));
        assert!(refuse(&["a", "a"], &[]).starts_with("a is varied twice"));
        assert!(refuse(&["a", "b"], &[Correlation { of: [0, 1], value: 1.0 }]).contains("got 1 of a and b"));
        let all = [[0, 1], [1, 2], [0, 2]].map(|of| Correlation { of, value: -0.9 });
        assert!(refuse(&["a", "b", "c"], &all).contains("contradict each other"));
    }
}
