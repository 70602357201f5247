//! Matrices of any size: nalgebra's, and the factors that filters need besides.

mod givens;
mod ldl;
mod root;

use nalgebra::{DMatrix, DVector};

pub use givens::add_to_root;
pub use ldl::Ldl;
pub use root::{RootError, lower_root};

/// A column of numbers.
pub type Vector = DVector<f64>;
/// A rectangle of numbers.
pub type Matrix = DMatrix<f64>;

/// The lower triangle of a square matrix, mirrored: what rounding has made of a symmetric matrix is symmetric to the last
/// bit again.
#[must_use]
pub fn symmetric(mut matrix: Matrix) -> Matrix {
    matrix.fill_upper_triangle_with_lower_triangle();
    matrix
}
