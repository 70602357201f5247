//! The matrix exponential and its integrals.

use super::{INVERSE_FACTORIAL, doublings};
use crate::linalg::Matrix;

/// `Φ = exp(A dt)` and the integrals that take what is constant, or linear in time, to its effect after `dt`.
#[derive(Clone, Debug)]
pub struct Integrals {
    /// Φ, n × n.
    pub transition: Matrix,
    /// `Γ₁ = ∫₀^dt exp(A s) ds = dt φ₁(A dt)`, n × n: the effect of a constant.
    pub constant: Matrix,
    /// `Γ₂ = ∫₀^dt Γ₁(s) ds = dt² φ₂(A dt)`, n × n: the effect of a slope.
    pub slope: Matrix,
}

/// The exponential of `A dt` and its integrals, for any n × n matrix `A`, singular or not.
///
/// ```text
/// Γ₂(t) = Σ Aⁿ tⁿ⁺²/(n+2)!,  Γ₁ = t I + A Γ₂,  Φ = I + A Γ₁
/// Γ₂(2t) = Γ₂ + t Γ₁ + Φ Γ₂
/// ```
///
/// A Taylor series of Γ₂ over a step so short that its terms exhaust double precision, then doubled.
///
/// Source: Moler and Van Loan (2003), Nineteen dubious ways to compute the exponential of a matrix, method 3; Van Loan
/// (1978), Computing integrals involving the matrix exponential.
pub fn exponential_integrals(a: &Matrix, dt: f64) -> Integrals {
    let n = a.nrows();
    let identity = Matrix::identity(n, n);
    let doublings = doublings((a * dt).abs().row_sum().max());
    // A power of two: a step that it divides is not rounded.
    let short = dt / libm::exp2(f64::from(doublings));
    let m = a * short;
    let mut slope = &identity * INVERSE_FACTORIAL[16];
    for power in (2..16).rev() {
        slope = &m * slope + &identity * INVERSE_FACTORIAL[power];
    }
    slope *= short * short;
    let constant_of = |slope: &Matrix, t: f64| &identity * t + a * slope;
    let mut t = short;
    for _ in 0..doublings {
        let constant = constant_of(&slope, t);
        let transition = &identity + a * &constant;
        slope = &slope + &constant * t + transition * &slope;
        t *= 2.0;
    }
    let constant = constant_of(&slope, dt);
    Integrals { transition: &identity + a * &constant, constant, slope }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_and_a_nilpotent_have_closed_forms() {
        let turn = Matrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, 0.0]);
        for angle in [1e-9, 0.3, 2.0, 40.0] {
            let Integrals { transition, constant, slope } = exponential_integrals(&turn, angle);
            let (sin, cos) = libm::sincos(angle);
            let off = |found: &Matrix, expected: [f64; 4]| (found - Matrix::from_row_slice(2, 2, &expected)).amax();
            assert!(off(&transition, [cos, sin, -sin, cos]) < 1e-13, "{angle}");
            assert!(off(&constant, [sin, 1.0 - cos, cos - 1.0, sin]) < 1e-13, "{angle}");
            let (rest, lag) = (1.0 - cos, angle - sin);
            assert!(off(&slope, [rest, lag, -lag, rest]) < 1e-12, "{angle}");
        }
        let shift = Matrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let Integrals { transition, constant, slope } = exponential_integrals(&shift, 3.0);
        assert_eq!(transition, Matrix::from_row_slice(2, 2, &[1.0, 3.0, 0.0, 1.0]));
        assert_eq!(constant, Matrix::from_row_slice(2, 2, &[3.0, 4.5, 0.0, 3.0]));
        assert_eq!(slope, Matrix::from_row_slice(2, 2, &[4.5, 4.5, 0.0, 4.5]));
    }

    #[test]
    fn a_rate_without_bounds_gives_no_number_and_no_endless_loop() {
        for entry in [f64::INFINITY, 1e307, f64::NAN] {
            let Integrals { transition, .. } = exponential_integrals(&Matrix::repeat(2, 2, entry), 3.0);
            assert!(!transition.sum().is_finite(), "{entry}");
        }
    }
}
