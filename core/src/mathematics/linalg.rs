//! Matrices of any size: nalgebra's, and the factorisations that filters also need.

mod ldl;
mod root;

use nalgebra::{DMatrix, DVector};

pub(crate) use ldl::Ldl;
pub(crate) use root::{RootError, lower_root};

/// A column of numbers.
pub type Vector = DVector<f64>;
/// A rectangle of numbers.
pub type Matrix = DMatrix<f64>;

/// Gives a matrix these numbers of rows and columns, and uses its memory again if that is large enough. The entries are
/// meaningless, unless it had this shape before.
pub(crate) fn fit(matrix: &mut Matrix, rows: usize, columns: usize) {
    if matrix.shape() == (rows, columns) {
        return;
    }
    let mut entries: Vec<f64> = std::mem::replace(matrix, Matrix::zeros(0, 0)).data.into();
    entries.resize(rows * columns, 0.0);
    *matrix = Matrix::from_vec(rows, columns, entries);
}

/// The lower triangle of a square matrix, mirrored: this makes a matrix symmetric to the last bit again after rounding.
#[must_use]
pub(crate) fn symmetric(mut matrix: Matrix) -> Matrix {
    matrix.fill_upper_triangle_with_lower_triangle();
    matrix
}
