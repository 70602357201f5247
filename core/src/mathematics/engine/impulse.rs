//! The linear oscillator's response in closed form.

use super::exponential::{Classes, INVERSE_FACTORIAL};
use super::level::{Level, apart};
use super::number::{Number, unrolled};

/// The response of `ẍ = a x + b ẋ` to an impulse after a time, its integral, and the integral of that.
///
/// ```text
/// exp(A dt) = [1 + a q, h; a h, 1 + a q + b h],  Γ₁ = [h - b q, q; a q, h],  Γ₂ = [q - b p, p; a p, q]
/// ```
///
/// All are entire functions of a and b: one series serves underdamped, critical, overdamped and unstable oscillators, and free masses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Impulse<T> {
    /// h \[s\]
    pub h: T,
    /// q \[s²\]
    pub q: T,
    /// p \[s³\], if the caller wants it.
    pub p: T,
}

/// Classes by the size of a step: ten terms, fourteen, then doublings.
const CLASSES: Classes<2> = Classes([0.07, 0.25]);

impl<T: Number> Impulse<T> {
    /// The response with stiffness a \[1/s²\] and damping b \[1/s\] after `dt` \[s\]; p only `with_slope`.
    #[inline(always)]
    pub(crate) fn new<L: Level>(level: L, a: T, b: T, dt: f64, with_slope: bool) -> Self {
        let size = Classes::<2>::counted(a.abs().sqrt().max(b.abs()) * dt);
        if size.largest() <= CLASSES.0[0] {
            return Self::terms::<5>(a, b, dt, with_slope);
        }
        let (mut response, mut done) = (Self { h: a, q: a, p: a }, None);
        while let Some(class) = CLASSES.after(done, size) {
            let own = apart!(level, Self::of_class(a, b, dt, class, with_slope));
            let shorter = done.map_or(f64::NEG_INFINITY, |done| CLASSES.upper(done));
            let is_own = T::of(shorter).lt(size);
            response = Self {
                h: T::select(is_own, own.h, response.h),
                q: T::select(is_own, own.q, response.q),
                p: T::select(is_own, own.p, response.p),
            };
            done = Some(class);
        }
        response
    }

    #[inline(always)]
    fn of_class(a: T, b: T, dt: f64, class: usize, with_slope: bool) -> Self {
        if class == 0 {
            return Self::terms::<5>(a, b, dt, with_slope);
        }
        let doublings = Classes::<2>::doublings(class);
        let mut t = dt * libm::exp2(-(doublings as f64));
        let Self { mut h, mut q, mut p } = Self::terms::<7>(a, b, t, with_slope);
        for _ in 0..doublings {
            if with_slope {
                p = p + q * t + (a * q + 1.0) * p + h * q;
            }
            (h, q) = (h * (a * q * 2.0 + 2.0 + b * h), q * (a * q + 2.0) + h * h);
            t *= 2.0;
        }
        Self { h, q, p }
    }

    #[inline(always)]
    fn terms<const PAIRS: usize>(a: T, b: T, t: f64, with_slope: bool) -> Self {
        if with_slope { Self::series::<PAIRS, 3>(a, b, t) } else { Self::series::<PAIRS, 2>(a, b, t) }
    }

    /// `h = t Σ cₙ/(n+1)!`, `q = t² Σ cₙ/(n+2)!`, `p = t³ Σ cₙ/(n+3)!` with `cₙ₊₁ = b t cₙ + a t² cₙ₋₁`, `c₀ = 1`; in steps of
    /// two, so that even and odd coefficients do not wait for each other. Two of the sums leave out p.
    #[inline(always)]
    fn series<const PAIRS: usize, const SUMS: usize>(a: T, b: T, t: f64) -> Self {
        let (alpha, beta) = (a * (t * t), b * t);
        let square = beta * beta;
        let (forward, back) = (square + alpha * 2.0, alpha * alpha);
        let mut c = [[T::of(1.0), beta], [square + alpha, beta * forward]];
        let mut sums = [[T::of(0.0); 2]; 3];
        unrolled::<PAIRS>(
            #[inline(always)]
            |pair| {
                for parity in 0..2 {
                    let term = c[0][parity];
                    for k in 0..SUMS {
                        sums[k][parity] = sums[k][parity] + term * INVERSE_FACTORIAL[2 * pair + parity + k + 1];
                    }
                }
                let next = [forward * c[1][0] - back * c[0][0], forward * c[1][1] - back * c[0][1]];
                c = [c[1], next];
            },
        );
        let sum = |k: usize| sums[k][0] + sums[k][1];
        Self { h: sum(0) * t, q: sum(1) * (t * t), p: sum(2) * (t * t * t) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::engine::exponential::Exponential;
    use crate::mathematics::engine::lanes::Lanes;
    use crate::mathematics::engine::level::Baseline;

    const DT: f64 = 0.01;

    #[test]
    fn each_lane_has_the_response_of_its_own_oscillator() {
        let frequencies: [f64; 8] = [6.0, 2000.0, 10.0, 0.0, 40.0, f64::INFINITY, 300.0, 1.0];
        let a = frequencies.map(|frequency| -frequency * frequency);
        let b = frequencies.map(|frequency| -0.1 * frequency);
        let lanes = Impulse::new(Baseline, Lanes(a), Lanes(b), DT, true);
        for lane in 0..8 {
            let single = Impulse::new(Baseline, a[lane], b[lane], DT, true);
            for (lanes, single) in [(lanes.h, single.h), (lanes.q, single.q), (lanes.p, single.p)] {
                let lanes = lanes.lane(lane);
                assert!(lanes.to_bits() == single.to_bits() || (lanes.is_nan() && single.is_nan()), "{}", a[lane]);
            }
            if a[lane].is_finite() {
                let mut any = Exponential::new(2);
                any.compute(Baseline, &[0.0, a[lane], 1.0, b[lane]], 2, DT, true);
                // Φ and Γ₂ in terms of h and q; what is left of Γ₂ is p.
                let (h, q, p) = (any.transition[2], any.slope[3], (any.slope[3] - any.slope[0]) / b[lane]);
                for (single, any) in [(single.h, h), (single.q, q), (single.p, p)] {
                    assert!(
                        any.is_nan() || (single - any).abs() <= 1e-8 * any.abs(),
                        "{}: {single:e} {any:e}",
                        a[lane]
                    );
                }
            }
        }
    }
}
