//! Givens rotations on triangular roots.

use super::Matrix;

/// Replaces the lower triangular root `L`, n × n, by that of `L Lᵀ + d dᵀ`. Overwrites d.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 6.5.4.
pub(crate) fn add_to_root(root: &mut Matrix, d: &mut [f64]) {
    let n = d.len().max(1);
    for (j, column) in root.as_mut_slice().chunks_exact_mut(n).enumerate() {
        if let Some((cos, sin)) = rotation(&mut column[j], d[j]) {
            rotate(cos, sin, &mut column[j + 1..], &mut d[j + 1..]);
        } else if !column[j].is_finite() {
            return;
        }
    }
}

/// Rotates the number `added` into `kept`, so that it becomes zero. Returns cosine and sine of the rotation. `None` if
/// there is nothing to rotate, or `kept` becomes infinite.
pub(crate) fn rotation(kept: &mut f64, added: f64) -> Option<(f64, f64)> {
    if added == 0.0 {
        return None;
    }
    let length = (*kept * *kept + added * added).sqrt();
    if length == 0.0 {
        return None;
    }
    if length == f64::INFINITY {
        // The quotients would be zero, and the overflow would go unnoticed.
        *kept = length;
        return None;
    }
    let (cos, sin) = (*kept / length, added / length);
    *kept = length;
    Some((cos, sin))
}

/// Rotates two columns into each other.
#[inline]
pub(crate) fn rotate(cos: f64, sin: f64, kept: &mut [f64], added: &mut [f64]) {
    for (kept, added) in kept.iter_mut().zip(added) {
        (*kept, *added) = (cos * *kept + sin * *added, cos * *added - sin * *kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::linalg::Vector;

    #[test]
    fn a_root_can_be_added_to() {
        let mut root = Matrix::from_row_slice(3, 3, &[2.0, 0.0, 0.0, -0.3, 0.0, 0.0, 0.7, 0.4, 0.1]);
        let mut d = Vector::from_column_slice(&[0.3, -1.0, 2.0]);
        let cov = &root * root.transpose() + &d * d.transpose();
        add_to_root(&mut root, d.as_mut_slice());
        assert!((&root * root.transpose() - cov).amax() < 1e-14);
        assert_eq!(root.upper_triangle(), Matrix::from_diagonal(&root.diagonal()));
    }
}
