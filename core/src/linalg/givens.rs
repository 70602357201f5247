//! Givens rotations on triangular roots.

use super::{Matrix, Vector};

/// Makes of the lower triangular root `L`, n × n, that of `L Lᵀ + d dᵀ`.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 6.5.4.
pub fn add_to_root(root: &mut Matrix, mut d: Vector) {
    for j in 0..d.len() {
        let length = (root[(j, j)] * root[(j, j)] + d[j] * d[j]).sqrt();
        if length == 0.0 {
            continue;
        }
        if length == f64::INFINITY {
            // Its quotients would be zeros, and a number that is too large to square would vanish without a word.
            root[(j, j)] = length;
            return;
        }
        let (cos, sin) = (root[(j, j)] / length, d[j] / length);
        for i in j..d.len() {
            let (kept, added) = (root[(i, j)], d[i]);
            root[(i, j)] = cos * kept + sin * added;
            d[i] = cos * added - sin * kept;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_can_be_added_to() {
        let mut root = Matrix::from_row_slice(3, 3, &[2.0, 0.0, 0.0, -0.3, 0.0, 0.0, 0.7, 0.4, 0.1]);
        let d = Vector::from_column_slice(&[0.3, -1.0, 2.0]);
        let cov = &root * root.transpose() + &d * d.transpose();
        add_to_root(&mut root, d);
        assert!((&root * root.transpose() - cov).amax() < 1e-14);
        assert_eq!(root.upper_triangle(), Matrix::from_diagonal(&root.diagonal()));
    }
}
