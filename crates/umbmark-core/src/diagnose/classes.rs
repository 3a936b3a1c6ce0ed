//! Classes of effects that an experiment cannot separate: columns of nearly the same direction.

use nalgebra::DVector;

/// Effects whose columns have a cosine above this are one class.
pub const ALIKE: f64 = 0.95;

/// |cos| of the angle between two columns; 0 where one of them is zero.
pub fn likeness(a: &DVector<f64>, b: &DVector<f64>) -> f64 {
    let lengths = a.norm() * b.norm();
    if lengths > 0.0 { (a.dot(b) / lengths).abs().min(1.0) } else { 0.0 }
}

/// Groups whitened columns so that within a group every two have |cos| above `alike`: complete linkage.
///
/// Of all pairs of groups that may be joined, the pair with the largest minimum |cos| is joined first. (Single linkage would chain: A like
/// B, B like C, yet A unlike C.) Each group holds indices in increasing order, and groups stand in the order of their first.
///
/// ```
/// use nalgebra::DVector;
/// use umbmark_core::diagnose::classes::{ALIKE, complete_linkage};
/// let columns = [[1.0, 0.0], [0.0, 2.0], [-3.0, 0.1]].map(|column| DVector::from_row_slice(&column));
/// assert_eq!(complete_linkage(&columns, ALIKE), [vec![0, 2], vec![1]]);
/// ```
pub fn complete_linkage(columns: &[DVector<f64>], alike: f64) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = (0..columns.len()).map(|i| vec![i]).collect();
    while let Some((i, j)) = nearest_pair(&groups, columns, alike) {
        let joined = groups.remove(j);
        groups[i].extend(joined);
        groups[i].sort_unstable();
    }
    groups
}

/// The two groups that are most alike, if they are alike at all.
fn nearest_pair(groups: &[Vec<usize>], columns: &[DVector<f64>], alike: f64) -> Option<(usize, usize)> {
    let least = |a: &[usize], b: &[usize]| {
        let pairs = a.iter().flat_map(|i| b.iter().map(move |j| (i, j)));
        pairs.map(|(i, j)| likeness(&columns[*i], &columns[*j])).fold(1.0, f64::min)
    };
    let mut best = None;
    for i in 0..groups.len() {
        for j in i + 1..groups.len() {
            let likeness = least(&groups[i], &groups[j]);
            if likeness > alike && best.is_none_or(|(_, most)| likeness > most) {
                best = Some(((i, j), likeness));
            }
        }
    }
    best.map(|(pair, _)| pair)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions 0, 15 and 30 degrees: neighbours have cosine 0.966, the ends 0.866.
    #[test]
    fn a_chain_of_neighbours_is_not_one_class() {
        let at = |degrees: f64| DVector::from_vec(vec![degrees.to_radians().cos(), degrees.to_radians().sin()]);
        let groups = complete_linkage(&[at(0.0), at(15.0), at(30.0)], ALIKE);
        assert_eq!(groups, [vec![0, 1], vec![2]]);
        assert_eq!(complete_linkage(&[at(0.0), at(184.0), at(8.0)], ALIKE), [vec![0, 1, 2]]);
    }

    #[test]
    fn likeness_is_the_cosine_of_the_angle_whatever_the_lengths_and_the_sign() {
        for (long, short) in [(1.0, 1.0), (30.0, 0.2), (0.5, -0.1)] {
            let (a, b) = (DVector::from_vec(vec![long, 0.0]), DVector::from_vec(vec![short, short * 3f64.sqrt()]));
            assert!((likeness(&a, &b) - 0.5).abs() < 1e-15 && (likeness(&b, &b) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_column_of_zeros_is_like_nothing() {
        let zero = DVector::zeros(2);
        assert_eq!(likeness(&zero, &zero), 0.0);
        assert_eq!(complete_linkage(&[zero.clone(), zero], ALIKE).len(), 2);
    }
}
