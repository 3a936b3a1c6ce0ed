//! Products of columns, kept by their lower triangle: the products of every part of the data are most of what a diagnosis keeps in memory.

use nalgebra::DMatrix;
use std::ops::{AddAssign, Index, SubAssign};

/// A symmetric matrix, each of its two equal halves kept once.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    width: usize,
    /// Rows of the lower triangle, one after the other.
    lower: Vec<f64>,
}

impl Packed {
    /// Of a symmetric matrix.
    pub fn of(matrix: &DMatrix<f64>) -> Packed {
        let width = matrix.ncols();
        let lower = (0..width).flat_map(|i| (0..=i).map(move |j| matrix[(i, j)])).collect();
        Packed { width, lower }
    }

    /// All of it.
    pub fn whole(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.width, self.width, |i, j| self[(i, j)])
    }
}

impl Index<(usize, usize)> for Packed {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        let (row, column) = (i.max(j), i.min(j));
        &self.lower[row * (row + 1) / 2 + column]
    }
}

impl AddAssign<&Packed> for DMatrix<f64> {
    fn add_assign(&mut self, other: &Packed) {
        for j in 0..other.width {
            (0..other.width).for_each(|i| self[(i, j)] += other[(i, j)]);
        }
    }
}

impl SubAssign<&Packed> for DMatrix<f64> {
    fn sub_assign(&mut self, other: &Packed) {
        for j in 0..other.width {
            (0..other.width).for_each(|i| self[(i, j)] -= other[(i, j)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_halves_are_those_of_the_matrix_and_are_added_and_taken_off() {
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 4.0, 2.0, 3.0, 5.0, 4.0, 5.0, 6.0]);
        let packed = Packed::of(&matrix);
        assert_eq!((packed.whole(), packed.lower.len()), (matrix.clone(), 6));
        assert_eq!((packed[(0, 2)], packed[(2, 0)], packed[(1, 1)]), (4.0, 4.0, 3.0));
        let mut sum = matrix.clone();
        sum += &packed;
        assert_eq!(sum, 2.0 * &matrix);
        sum -= &packed;
        sum -= &packed;
        assert_eq!(sum, DMatrix::zeros(3, 3));
    }
}
