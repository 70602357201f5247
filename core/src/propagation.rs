//! How a state moves over one step: exact for linear rates, Runge-Kutta for others.

mod held;

use crate::gaussian::{Matrix, Vector};

pub use held::{held_parameters_step, oscillator_step};
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
pub fn exp_and_integral<const N: usize>(a: &Matrix<N, N>, dt: f64) -> (Matrix<N, N>, Matrix<N, N>) {
    let identity = Matrix::<N, N>::identity();
    let m = a * dt;
    let square = m * m;
    if norm(&square) <= 0.05 {
        // Σ mⁿ/(n+1)!, whose terms fall with the norm of the square: twelve are enough. Three powers at a time.
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
    // A power of two: what is scaled by it is not rounded.
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

/// How often a step must be halved until `size`, a norm of `A dt`, is at most one half.
fn doublings(size: f64) -> u32 {
    if size <= 0.5 {
        0
    } else if size < 1e300 {
        libm::ceil(libm::log2(2.0 * size)) as u32
    } else {
        // Without doublings such a step overflows, and is seen to; a step halved to nothing would not be.
        0
    }
}

/// The response of `ẍ = a x + b ẋ` to a unit impulse, after a time `dt`, and its integral.
///
/// ```text
/// h'' = a h + b h',  h(0) = 0,  h'(0) = 1,  q = ∫₀^dt h ds
/// ```
///
/// Both are entire functions of `a` and `b`: one series serves the underdamped, critical, overdamped and unstable
/// oscillator and the free mass, without a case for each and without cancellation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpulseResponse {
    /// h(dt) \[s\]
    pub value: f64,
    /// q(dt) \[s²\]
    pub integral: f64,
}

/// 1/n! for n = 0..=16.
const INVERSE_FACTORIAL: [f64; 17] = {
    let mut table = [1.0; 17];
    let mut n = 1;
    while n < table.len() {
        table[n] = table[n - 1] / n as f64;
        n += 1;
    }
    table
};

impl ImpulseResponse {
    /// The response with stiffness `a = -ωₙ²` \[1/s²\] and damping `b = -2ζωₙ` \[1/s\].
    #[inline]
    pub fn new(a: f64, b: f64, dt: f64) -> Self {
        let size = a.abs().sqrt().max(b.abs()) * dt;
        if size <= 0.07 {
            return Self::series::<10>(a, b, dt);
        }
        if size <= 0.25 {
            return Self::series::<14>(a, b, dt);
        }
        // Halve the step until the series is short, then double the response.
        let doublings = doublings(2.0 * size);
        let short = dt / libm::exp2(f64::from(doublings));
        let mut response = Self::series::<14>(a, b, short);
        for _ in 0..doublings {
            let Self { value: h, integral: q } = response;
            response = Self { value: h * (2.0 + 2.0 * a * q + b * h), integral: q * (2.0 + a * q) + h * h };
        }
        response
    }

    /// What classical fourth-order Runge-Kutta makes of the response: its Taylor polynomial.
    #[inline]
    pub fn runge_kutta(a: f64, b: f64, dt: f64) -> Self {
        let (alpha, beta) = (a * dt * dt, b * dt);
        let second = alpha + beta * beta;
        let third = beta * (second + alpha);
        let [_, _, half, sixth, twenty_fourth, ..] = INVERSE_FACTORIAL;
        Self {
            value: dt * ((1.0 + beta * half) + (second * sixth + third * twenty_fourth)),
            integral: dt * dt * ((half + beta * sixth) + second * twenty_fourth),
        }
    }

    /// The first `TERMS` terms of `h = dt Σ cₙ/(n+1)!` and `q = dt² Σ cₙ/(n+2)!` with `cₙ₊₁ = b dt cₙ + a dt² cₙ₋₁`,
    /// `c₀ = 1`; taken in steps of two, so that even and odd coefficients do not wait for each other.
    #[inline]
    fn series<const TERMS: usize>(a: f64, b: f64, dt: f64) -> Self {
        let (alpha, beta) = (a * dt * dt, b * dt);
        let forward = beta * beta + 2.0 * alpha;
        let back = alpha * alpha;
        let mut c = [[1.0, beta], [beta * beta + alpha, beta * forward]];
        let (mut h, mut q) = ([0.0; 2], [0.0; 2]);
        for n in (0..TERMS).step_by(2) {
            for parity in 0..2 {
                h[parity] += c[0][parity] * INVERSE_FACTORIAL[n + parity + 1];
                q[parity] += c[0][parity] * INVERSE_FACTORIAL[n + parity + 2];
            }
            let next = [forward * c[1][0] - back * c[0][0], forward * c[1][1] - back * c[0][1]];
            c = [c[1], next];
        }
        Self { value: (h[0] + h[1]) * dt, integral: (q[0] + q[1]) * dt * dt }
    }

    /// Displacement and velocity after the step, from those before it and the acceleration at its beginning, with the
    /// force held.
    ///
    /// ```text
    /// x' = x + (h - b q) v + q ẍ,  v' = v + a q v + h ẍ
    /// ```
    #[inline]
    pub fn advance(&self, a: f64, b: f64, [x, v]: [f64; 2], acceleration: f64) -> [f64; 2] {
        let Self { value: h, integral: q } = *self;
        [x + (h - b * q) * v + q * acceleration, v + a * q * v + h * acceleration]
    }
}

/// One classical fourth-order Runge-Kutta step of `ẏ = rate(y)` over `dt` \[s\].
#[inline]
pub fn runge_kutta<const N: usize>(state: &Vector<N>, dt: f64, rate: impl Fn(&Vector<N>) -> Vector<N>) -> Vector<N> {
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
        let (exp, _) = exp_and_integral(&Matrix::<2, 2>::repeat(f64::INFINITY), 0.1);
        assert!(!exp.sum().is_finite());
        assert!(!ImpulseResponse::new(f64::NEG_INFINITY, -1.0, 0.1).value.is_finite());
        assert!(ImpulseResponse::new(f64::NAN, -1.0, 0.1).value.is_nan());
        let (exp, _) = exp_and_integral(&Matrix::<2, 2>::repeat(1e307), 3.0);
        assert!(!exp.sum().is_finite());
        assert!(!ImpulseResponse::new(-1e307, -1e307, 10.0).value.is_finite());
    }

    /// Textbook closed forms, one for each kind of oscillator.
    fn closed_form(wn: f64, zeta: f64, t: f64) -> (f64, f64) {
        let decay = (-zeta * wn * t).exp();
        let (h, dh);
        if wn == 0.0 {
            return (t, t * t / 2.0);
        } else if zeta == 1.0 {
            h = t * decay;
            dh = decay * (1.0 - wn * t);
        } else if zeta < 1.0 {
            let wd = wn * (1.0 - zeta * zeta).sqrt();
            h = decay * (wd * t).sin() / wd;
            dh = decay * (wd * t).cos() - zeta * wn * h;
        } else {
            let wd = wn * (zeta * zeta - 1.0).sqrt();
            h = decay * (wd * t).sinh() / wd;
            dh = decay * (wd * t).cosh() - zeta * wn * h;
        }
        (h, (1.0 - dh - 2.0 * zeta * wn * h) / (wn * wn))
    }

    #[test]
    fn impulse_response_is_the_textbooks() {
        for (wn, zeta) in [(6.0, 0.05), (6.0, 0.0), (6.0, 1.0), (3.0, 4.0), (6.0, -0.1), (300.0, 0.02), (0.0, 0.0)] {
            for t in [0.001, 0.01, 0.04, 0.1, 1.0] {
                let response = ImpulseResponse::new(-wn * wn, -2.0 * zeta * wn, t);
                let (h, q) = closed_form(wn, zeta, t);
                let scale = if wn == 0.0 { t } else { t.min(1.0 / wn) };
                assert!((response.value - h).abs() < 1e-11 * scale, "h of {wn} {zeta} {t}");
                // The closed form of q cancels for short steps; its rounding is ε/ωₙ².
                let rounding = if wn == 0.0 { 1e-15 } else { 1e-14 / (wn * wn) };
                assert!((response.integral - q).abs() < 1e-10 * scale * scale + rounding, "q of {wn} {zeta} {t}");
            }
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
