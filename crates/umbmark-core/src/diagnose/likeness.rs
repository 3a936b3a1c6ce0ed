//! How alike effects look in a dataset.

use nalgebra::DMatrix;

/// How similar effects look: |cos| of the angle between their responses, in units of the noise and with the model's free parameters
/// projected out. At 1 they are indistinguishable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Likeness {
    /// The effects that can be seen, each by the size that shows most.
    pub effects: Vec<&'static str>,
    /// For each of them, its likeness to every one.
    pub values: Vec<Vec<f64>>,
}

impl Likeness {
    /// From products of the responses to usual sizes, one column per size; for each effect, the strongest response counts.
    pub(super) fn new(names: &[&'static str], products: &DMatrix<f64>) -> Likeness {
        let strength = |column: usize| products[(column, column)];
        let mut strongest: Vec<usize> = Vec::new();
        for column in (0..names.len()).filter(|column| strength(*column) > 0.0) {
            match strongest.iter_mut().find(|known| names[**known] == names[column]) {
                Some(known) if strength(*known) >= strength(column) => {}
                Some(known) => *known = column,
                None => strongest.push(column),
            }
        }
        let likeness = |a: usize, b: usize| (products[(a, b)].abs() / (strength(a) * strength(b)).sqrt()).min(1.0);
        Likeness {
            effects: strongest.iter().map(|column| names[*column]).collect(),
            values: strongest.iter().map(|a| strongest.iter().map(|b| likeness(*a, *b)).collect()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    #[test]
    fn an_effect_stands_for_its_strongest_size_and_signs_do_not_matter() {
        let columns = [
            DVector::from_vec(vec![0.0, 1.0]),
            DVector::from_vec(vec![3.0, 0.0]),
            DVector::from_vec(vec![-1.0, 1.0]),
            DVector::from_vec(vec![0.0, 0.0]),
        ];
        let products = DMatrix::from_fn(4, 4, |i, j| columns[i].dot(&columns[j]));
        let likeness = Likeness::new(&["a", "a", "b", "absorbed"], &products);
        assert_eq!(likeness.effects, ["a", "b"]);
        assert!((likeness.values[0][1] - 0.5f64.sqrt()).abs() < 1e-12 && likeness.values[1][1] == 1.0);
    }
}
