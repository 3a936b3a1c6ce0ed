//! Functions whose Sobol indices are known in closed form.

use super::{Evaluator, Input, Response, SensitivityError};
use crate::monte_carlo::Distribution;

/// A function of the inputs alone.
pub(super) struct Function(pub fn(&[f64]) -> f64);

impl Response for Function {
    fn outputs(&self) -> usize {
        1
    }

    fn is_noisy(&self) -> bool {
        false
    }

    fn evaluator(&self) -> Result<Evaluator<'_>, SensitivityError> {
        Ok(Box::new(|values, _, outputs| {
            outputs[0] = self.0(values);
            Ok(())
        }))
    }
}

/// Inputs that are uniform between the same ends.
pub(super) fn uniform(count: usize, min: f64, max: f64) -> Vec<Input> {
    let distribution = Distribution::Uniform { min, max };
    let input = |i| Input { name: format!("x{i}"), distribution, bounds: (min, max), whole: false };
    (1..=count).map(input).collect()
}

/// Ishigami & Homma (1990) with a = 7, b = 0.1, inputs uniform on (-π, π).
pub(super) const ISHIGAMI: Function = Function(|x| {
    let (sine, square) = (libm::sin(x[1]), x[2] * x[2]);
    libm::sin(x[0]) * (1.0 + 0.1 * square * square) + 7.0 * sine * sine
});

/// Its S, T and S_13: V = a²/8 + bπ⁴/5 + b²π⁸/18 + 1/2.
pub(super) fn ishigami_indices() -> ([f64; 3], [f64; 3], f64) {
    let (a, b) = (7.0, 0.1);
    let fourth = libm::pow(std::f64::consts::PI, 4.0);
    let one = 0.5 * (1.0 + b * fourth / 5.0) * (1.0 + b * fourth / 5.0);
    let two = a * a / 8.0;
    let both = b * b * fourth * fourth * (1.0 / 18.0 - 1.0 / 50.0);
    let all = one + two + both;
    ([one / all, two / all, 0.0], [(one + both) / all, two / all, both / all], both / all)
}

/// Sobol's g, Π (|4 x_i - 2| + a_i) / (1 + a_i), inputs uniform on (0, 1).
pub(super) const SOBOL_G: Function =
    Function(|x| x.iter().zip(G).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product());

/// The a_i of [`SOBOL_G`].
pub(super) const G: [f64; 8] = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];

/// Its S and T: V_i = 1/(3 (1 + a_i)²), V = Π (1 + V_i) - 1, T_i = V_i Π_{j≠i} (1 + V_j) / V.
pub(super) fn sobol_g_indices() -> ([f64; 8], [f64; 8]) {
    let own = G.map(|a| 1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
    let product: f64 = own.iter().map(|v| 1.0 + v).product();
    let all = product - 1.0;
    (own.map(|v| v / all), own.map(|v| v * product / (1.0 + v) / all))
}
