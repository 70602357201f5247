//! The linear oscillator's response in closed form.

use super::{INVERSE_FACTORIAL, doublings};

/// The response of `ẍ = a x + b ẋ` to a unit impulse, after a time `dt`, and its integral.
///
/// ```text
/// h'' = a h + b h',  h(0) = 0,  h'(0) = 1,  q = ∫₀^dt h ds
/// ```
///
/// Both are entire functions of `a` and `b`: one series serves the underdamped, critical, overdamped and unstable
/// oscillator and the free mass, without a case for each and without cancellation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ImpulseResponse {
    /// h(dt) \[s\]
    pub value: f64,
    /// q(dt) \[s²\]
    pub integral: f64,
}

impl ImpulseResponse {
    /// The response with stiffness `a = -ωₙ²` \[1/s²\] and damping `b = -2ζωₙ` \[1/s\].
    #[inline]
    pub(crate) fn new(a: f64, b: f64, dt: f64) -> Self {
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

    /// p, the integral of q over the step \[s³\]: the response to a slope.
    ///
    /// ```text
    /// p = dt³ Σ cₙ/(n+3)!,  p(2t) = p + t q + (1 + a q) p + h q
    /// ```
    pub(crate) fn second_integral(a: f64, b: f64, dt: f64) -> f64 {
        let doublings = doublings(2.0 * a.abs().sqrt().max(b.abs()) * dt);
        let mut t = dt / libm::exp2(f64::from(doublings));
        let Self { value: mut h, integral: mut q } = Self::series::<14>(a, b, t);
        let (alpha, beta) = (a * t * t, b * t);
        let (mut sum, mut before, mut c) = (0.0, 0.0, 1.0);
        for factor in &INVERSE_FACTORIAL[3..17] {
            sum += c * factor;
            (before, c) = (c, beta * c + alpha * before);
        }
        let mut p = sum * t * t * t;
        for _ in 0..doublings {
            p += t * q + (1.0 + a * q) * p + h * q;
            (h, q) = (h * (2.0 + 2.0 * a * q + b * h), q * (2.0 + a * q) + h * h);
            t *= 2.0;
        }
        p
    }

    /// The response by a classical fourth-order Runge-Kutta step: its Taylor polynomial.
    #[inline]
    pub(crate) fn runge_kutta(a: f64, b: f64, dt: f64) -> Self {
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
    pub(crate) fn advance(&self, a: f64, b: f64, [x, v]: [f64; 2], acceleration: f64) -> [f64; 2] {
        let Self { value: h, integral: q } = *self;
        [x + (h - b * q) * v + q * acceleration, v + a * q * v + h * acceleration]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::integrate::exponential_integrals;
    use crate::mathematics::linalg::Matrix;

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
    fn the_response_to_a_slope_is_that_of_the_general_exponential() {
        for (a, b) in [(-36.0, -0.6), (-4.0, -9.0), (-0.0, 0.3), (25.0, 1.0), (-9e4, -12.0)] {
            for dt in [1e-5, 0.001, 0.02, 0.3] {
                let general = exponential_integrals(&Matrix::from_row_slice(2, 2, &[0.0, 1.0, a, b]), dt);
                let response = ImpulseResponse::new(a, b, dt);
                let p = ImpulseResponse::second_integral(a, b, dt);
                let size = general.slope.amax();
                assert!(
                    (general.slope[(0, 1)] - p).abs() < 1e-12 * general.slope[(0, 1)].abs().max(1e-3 * size),
                    "{a} {b} {dt}"
                );
                assert!((general.constant[(0, 1)] - response.integral).abs() < 1e-12 * general.constant.amax());
            }
        }
    }

    #[test]
    fn rates_without_bounds_give_no_number_and_no_endless_loop() {
        assert!(!ImpulseResponse::new(f64::NEG_INFINITY, -1.0, 0.1).value.is_finite());
        assert!(ImpulseResponse::new(f64::NAN, -1.0, 0.1).value.is_nan());
        for (a, b) in [(-1e307, -1e307), (-1e120, 0.0), (0.0, -1e60), (-1e120, -1e60)] {
            assert!(!ImpulseResponse::new(a, b, 10.0).value.is_finite(), "{a} {b}");
            assert!(!ImpulseResponse::second_integral(a, b, 10.0).is_finite(), "{a} {b}");
        }
    }
}
