//! How high a likelihood ratio must be for an alarm.
//!
//! While nothing changes, scores are standard normal whatever the robot is, so the probability with which a run is the first to exceed a limit can be
//! simulated once and for all. It falls nearly as e^(-b h) with the limit h:
//!
//! ```text
//! ln P(first above h at this run | never before) = a - b h
//! ```
//!
//! with a and b for each kind of change, number of components, number of directions, and number of scored runs so far (`BINS`). The tests
//! of `simulated` make the `TABLE`.

#[cfg(test)]
pub(super) mod simulated;

use super::scores::COMPONENTS;
use super::statistic::Signature;

/// Shares of the false-alarm rate: numbers of the robot, place, scatter.
pub const SHARES: [f64; 3] = [0.6, 0.2, 0.2];

/// The last of the scored runs of each bin; those after the last bin are as in it.
const BINS: [usize; 6] = [4, 8, 16, 32, 64, 128];

/// Intercept and slope, for each bin and kind.
type Lines = [[[f64; 2]; 3]; BINS.len()];

/// The limit of each kind for a run that is one of so many scored so far, at this probability of a false alarm with each run.
pub(super) fn limits(signature: &Signature, directions: usize, scored: usize, per_run: f64) -> [f64; 3] {
    let bin = BINS.iter().position(|last| scored <= *last).unwrap_or(BINS.len() - 1);
    let layout = 2 * (signature.components.clamp(2, COMPONENTS) - 2) + directions.clamp(1, 2) - 1;
    std::array::from_fn(|kind| {
        let [a, b] = TABLE[layout][bin][kind];
        (a - libm::log(SHARES[kind] * per_run)) / b
    })
}

/// Made by `simulated::lines`: two components in one direction, in two, three in one, and so on; 400 000 robots each
/// and 40 000 of the last, seed 27.
#[expect(clippy::approx_constant, reason = "simulated")]
const TABLE: [Lines; 6] = [
    // 2 components, one direction.
    [
        [[2.109, 1.3165], [2.109, 1.3165], [-2.149, 1.2998]],
        [[2.185, 1.14], [2.185, 1.14], [-1.835, 1.2043]],
        [[1.244, 0.9631], [1.244, 0.9631], [-1.859, 1.1691]],
        [[0.659, 0.8887], [0.659, 0.8887], [-2.068, 1.0995]],
        [[0.467, 0.878], [0.467, 0.878], [-2.06, 1.0973]],
        [[0.545, 0.8954], [0.545, 0.8954], [-2.067, 1.0893]],
    ],
    // 2 components, both directions.
    [
        [[2.111, 1.1724], [2.792, 1.1283], [-1.709, 1.473]],
        [[2.521, 1.0728], [3.652, 1.0559], [-1.862, 1.2192]],
        [[1.717, 0.9357], [2.972, 0.9214], [-2.047, 1.1306]],
        [[0.565, 0.8133], [1.93, 0.8018], [-2.123, 1.0938]],
        [[0.211, 0.8086], [1.641, 0.7855], [-2.12, 1.0821]],
        [[0.474, 0.8644], [1.805, 0.814], [-2.108, 1.0802]],
    ],
    // 3 components, one direction.
    [
        [[2.269, 1.1106], [2.619, 1.1008], [-1.872, 1.33]],
        [[2.532, 1.0081], [2.967, 1.0017], [-1.667, 1.2063]],
        [[0.954, 0.8221], [1.817, 0.8488], [-1.867, 1.1249]],
        [[0.44, 0.7994], [1.326, 0.8084], [-1.986, 1.075]],
        [[0.381, 0.8293], [1.223, 0.8181], [-2.046, 1.0527]],
        [[0.447, 0.8601], [1.336, 0.8424], [-1.877, 1.0834]],
    ],
    // 3 components, both directions.
    [
        [[2.443, 1.0129], [3.665, 0.9589], [-1.586, 1.4472]],
        [[2.327, 0.8823], [3.943, 0.8421], [-1.638, 1.2294]],
        [[1.23, 0.7635], [3.632, 0.7709], [-1.867, 1.1264]],
        [[0.358, 0.717], [2.993, 0.7172], [-1.802, 1.1213]],
        [[0.15, 0.7531], [2.635, 0.7095], [-1.97, 1.0715]],
        [[0.285, 0.8138], [2.697, 0.7336], [-1.995, 1.0618]],
    ],
    // 4 components, one direction.
    [
        [[3.042, 1.0123], [3.551, 1.0222], [-1.831, 1.321]],
        [[2.826, 0.8802], [3.552, 0.9014], [-1.537, 1.2062]],
        [[1.563, 0.7594], [2.488, 0.7872], [-1.732, 1.1198]],
        [[1.003, 0.7403], [1.779, 0.7443], [-1.788, 1.0904]],
        [[1.156, 0.7879], [1.85, 0.7736], [-1.77, 1.0855]],
        [[1.339, 0.8288], [2.083, 0.8117], [-1.855, 1.0609]],
    ],
    // 4 components, both directions.
    [
        [[2.353, 0.8389], [4.216, 0.8415], [-1.677, 1.4031]],
        [[2.166, 0.7199], [4.014, 0.7003], [-1.808, 1.1421]],
        [[1.828, 0.6903], [3.793, 0.6509], [-1.517, 1.1762]],
        [[0.652, 0.6277], [2.94, 0.5954], [-1.805, 1.0944]],
        [[0.737, 0.6904], [3.013, 0.6223], [-1.793, 1.0712]],
        [[0.86, 0.7449], [3.026, 0.6484], [-1.824, 1.0707]],
    ],
];
