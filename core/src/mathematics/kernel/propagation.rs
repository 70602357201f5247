//! The motion of a state of a known size over one step: exact for linear rates, Runge-Kutta for others.

mod any_size;
mod chain;
mod held;

use super::gaussian::{Matrix, Vector};
use crate::mathematics::integrate::{INVERSE_FACTORIAL, doublings};

pub(crate) use crate::mathematics::integrate::ImpulseResponse;
pub(crate) use any_size::shared_exp_and_integral;
#[doc(hidden)]
pub use chain::SERIES;
pub(crate) use chain::chain_step;
pub(crate) use held::{held_parameters_step, oscillator_step};
pub(crate) use held::{held_rows, held_runge_kutta};

/// `exp(A dt)` and its integral `∫₀^dt exp(A s) ds = dt φ₁(A dt)`, for any `A`, singular or not.
///
/// ```text
/// Γ(t) = ∫₀^t exp(A s) ds,  exp(A t) = I + A Γ(t),  Γ(2t) = Γ(t) (I + exp(A t))
/// ```
///
/// A Taylor series of Γ over a step so short that its terms, 16 at most, exhaust double precision, then doubled.
///
/// Source: Moler and Van Loan (2003), Nineteen dubious ways to compute the exponential of a matrix, method 3; Paterson and
/// Stockmeyer (1973), On the number of nonscalar multiplications necessary to evaluate polynomials.
pub(crate) fn exp_and_integral<const N: usize>(a: &Matrix<N, N>, dt: f64) -> (Matrix<N, N>, Matrix<N, N>) {
    let identity = Matrix::<N, N>::identity();
    let m = a * dt;
    let square = m * m;
    if norm(&square) <= 0.05 {
        // Σ mⁿ/(n+1)!: its terms fall with the norm of the square, so that twelve are enough. Three powers at a time.
        let cube = square * m;
        let triple = |first: usize| {
            let [c0, c1, c2] = [0, 1, 2].map(|n| INVERSE_FACTORIAL[first + n + 1]);
            identity * c0 + m * c1 + square * c2
        };
        let mut series = triple(9);
        for first in [6, 3, 0] {
            series = triple(first) + cube * series;
        }
        let integral = series * dt;
        return (identity + a * integral, integral);
    }
    let doublings = doublings(norm(&m));
    // A power of two: scaling by it rounds nothing.
    let scale = 1.0 / libm::exp2(f64::from(doublings));
    let (m, square, short) = (m * scale, square * (scale * scale), dt * scale);
    // Four powers at a time: six products of matrices, not fifteen.
    let powers = [identity, m, square, square * m];
    let quartet = |first: usize| {
        let mut sum = powers[0] * INVERSE_FACTORIAL[first + 1];
        for n in 1..4 {
            sum += powers[n] * INVERSE_FACTORIAL[first + n + 1];
        }
        sum
    };
    let fourth = square * square;
    let mut series = quartet(12);
    for first in [8, 4, 0] {
        series = quartet(first) + fourth * series;
    }
    let mut integral = series * short;
    for _ in 0..doublings {
        integral *= identity * 2.0 + a * integral;
    }
    (identity + a * integral, integral)
}

/// The largest sum of a column's absolute values.
fn norm<const N: usize>(a: &Matrix<N, N>) -> f64 {
    a.abs().row_sum().amax()
}

/// One classical fourth-order Runge-Kutta step of `ẏ = rate(y)` over `dt` \[s\].
#[inline]
pub(crate) fn runge_kutta<const N: usize>(
    state: &Vector<N>,
    dt: f64,
    rate: impl Fn(&Vector<N>) -> Vector<N>,
) -> Vector<N> {
    let half = 0.5 * dt;
    let k1 = rate(state);
    let k2 = rate(&(state + k1 * half));
    let k3 = rate(&(state + k2 * half));
    let k4 = rate(&(state + k3 * dt));
    state + (k1 + (k2 + k3) * 2.0 + k4) * (dt / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_of_a_rotation_and_of_a_nilpotent() {
        let turn = Matrix::<2, 2>::new(0.0, 1.0, -1.0, 0.0);
        for angle in [1e-9, 0.3, 2.0, 40.0] {
            let (exp, integral) = exp_and_integral(&turn, angle);
            let (sin, cos) = libm::sincos(angle);
            assert!((exp - Matrix::<2, 2>::new(cos, sin, -sin, cos)).amax() < 1e-13, "{angle}");
            let expected = Matrix::<2, 2>::new(sin, 1.0 - cos, cos - 1.0, sin);
            assert!((integral - expected).amax() < 1e-13, "{angle}");
        }
        let shift = Matrix::<2, 2>::new(0.0, 1.0, 0.0, 0.0);
        let (exp, integral) = exp_and_integral(&shift, 3.0);
        assert_eq!(exp, Matrix::<2, 2>::new(1.0, 3.0, 0.0, 1.0));
        assert_eq!(integral, Matrix::<2, 2>::new(3.0, 4.5, 0.0, 3.0));
    }

    #[test]
    fn a_rate_without_bounds_gives_no_number_and_no_endless_loop() {
        for entry in [f64::INFINITY, 1e307, 1e60] {
            let (exp, _) = exp_and_integral(&Matrix::<2, 2>::repeat(entry), 3.0);
            assert!(!exp.sum().is_finite(), "{entry}");
        }
    }

    #[test]
    fn runge_kutta_of_a_linear_oscillator_is_its_taylor_polynomial() {
        for (a, b) in [(-36.0, -0.6), (-4.0, -9.0), (-0.0, 0.3), (25.0, 1.0)] {
            for dt in [0.001, 0.02, 0.3] {
                let stages = runge_kutta(&Vector::<2>::new(0.3, -0.7), dt, |y| {
                    Vector::<2>::new(y[1], 2.0 + a * y[0] + b * y[1])
                });
                let acceleration = 2.0 + a * 0.3 - b * 0.7;
                let polynomial = ImpulseResponse::runge_kutta(a, b, dt).advance(a, b, [0.3, -0.7], acceleration);
                assert!((stages - Vector::from(polynomial)).amax() < 1e-14 * stages.amax().max(1.0), "{a} {b} {dt}");
            }
        }
    }

    #[test]
    fn runge_kutta_is_of_fourth_order() {
        let error = |steps: u32| {
            let dt = 1.0 / f64::from(steps);
            let mut y = Vector::<2>::new(1.0, 0.0);
            for _ in 0..steps {
                y = runge_kutta(&y, dt, |y| Vector::<2>::new(y[1], -4.0 * y[0]));
            }
            (y[0] - libm::cos(2.0)).abs()
        };
        let order = libm::log2(error(20) / error(40));
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }
}
