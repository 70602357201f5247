//! The exponential of the block of A that moves, and its integrals; that of the linear oscillator in closed form. The size of a step has
//! a class, which has a length of the series. Lanes of different classes compute each class, and each lane takes its result.

use super::columns::{multiply, norm};
use super::level::{Level, apart};
use super::number::{Number, unrolled};

pub(super) const INVERSE_FACTORIAL: [f64; 18] = {
    let mut table = [1.0; 18];
    let mut n = 1;
    while n < table.len() {
        table[n] = table[n - 1] / n as f64;
        n += 1;
    }
    table
};

/// Limits the size of a step: a longer one has no correct digit, and its terms overflow, which callers detect.
const LARGEST: f64 = 1e60;

/// Classes up to each limit, then one more for each doubling of the last one.
pub(super) struct Classes<const N: usize>(pub(super) [f64; N]);

impl<const N: usize> Classes<N> {
    /// Sizes of NaN and of more than [`LARGEST`] become zero, which is of the first class.
    #[inline(always)]
    pub(super) fn counted<T: Number>(size: T) -> T {
        T::select(size.lt(T::of(LARGEST)), size, T::of(0.0))
    }

    #[inline(always)]
    pub(super) fn after<T: Number>(&self, class: Option<usize>, sizes: T) -> Option<usize> {
        let done = class.map_or(f64::NEG_INFINITY, |class| self.upper(class));
        let mut least = f64::INFINITY;
        for lane in 0..T::LANES {
            let size = sizes.lane(lane);
            least = if done < size && size < least { size } else { least };
        }
        (least < f64::INFINITY).then(|| self.of(least))
    }

    #[inline(always)]
    pub(super) fn restore<T: Number>(&self, done: usize, sizes: T, kept: &[Vec<T>], parts: [&mut Vec<T>; 3]) {
        let is_done = sizes.le(T::of(self.upper(done)));
        for (kept, part) in kept.iter().zip(parts) {
            for i in 0..part.len() {
                part[i] = T::select(is_done, kept[i], part[i]);
            }
        }
    }

    fn of(&self, size: f64) -> usize {
        let longest = self.0[N - 1];
        // One doubling less than the quotient: it is rounded.
        let exponent = || ((size / longest).to_bits() >> 52) as usize - 1023;
        let mut class = if size > longest { N - 2 + exponent().max(1) } else { 0 };
        while self.upper(class) < size {
            class += 1;
        }
        class
    }

    #[inline(always)]
    pub(super) fn upper(&self, class: usize) -> f64 {
        self.0[class.min(N - 1)] * libm::exp2(Self::doublings(class) as f64)
    }

    #[inline(always)]
    pub(super) fn doublings(class: usize) -> usize {
        (class + 1).saturating_sub(N)
    }
}

/// `Φ = exp(A dt)` and the integrals for an input that is constant or linear in time, after `dt`; n × n matrices.
#[derive(Clone, Debug)]
pub struct Exponential<T> {
    /// Φ
    pub transition: Vec<T>,
    /// `Γ₁ = dt φ₁(A dt)`
    pub constant: Vec<T>,
    /// `Γ₂ = dt² φ₂(A dt)`, if the caller wants it.
    pub slope: Vec<T>,
    powers: [Vec<T>; 4],
    work: Vec<T>,
    kept: [Vec<T>; 3],
}

/// Classes by the root of the norm of `(A dt)²`: 8, 12 and 16 terms exhaust double precision.
const CLASSES: Classes<3> = Classes([0.0387, 0.28, 0.5]);

impl<T: Number> Exponential<T> {
    pub fn new(n: usize) -> Self {
        let square = || vec![T::of(0.0); n * n];
        Self {
            transition: square(),
            constant: square(),
            slope: square(),
            powers: [square(), square(), square(), square()],
            work: square(),
            kept: [square(), square(), square()],
        }
    }

    /// The exponential of a block and its integrals, the second one only `with_slope`.
    ///
    /// ```text
    /// Γ₂(t) = Σ Aⁿ tⁿ⁺²/(n+2)!,  Γ₁ = t I + A Γ₂,  Φ = I + A Γ₁
    /// Γ₂(2t) = Γ₂ + t Γ₁ + Φ Γ₂,  Γ₁(2t) = Γ₁ + Φ Γ₁
    /// ```
    ///
    /// Source: Moler and Van Loan (2003), Nineteen dubious ways to compute the exponential of a matrix, method 3; Van Loan
    /// (1978), Computing integrals involving the matrix exponential; Paterson and Stockmeyer (1973), On the number of
    /// nonscalar multiplications necessary to evaluate polynomials.
    #[inline(always)]
    pub fn compute<L: Level>(&mut self, level: L, a: &[T], n: usize, dt: f64, with_slope: bool) {
        let size = apart!(level, self.raise(a, level.moving(n), dt));
        let size = Classes::<3>::counted(size);
        let mut done = None;
        while let Some(class) = CLASSES.after(done, size) {
            if done.is_some() {
                for (kept, part) in self.kept.iter_mut().zip([&self.transition, &self.constant, &self.slope]) {
                    kept.copy_from_slice(part);
                }
            }
            apart!(level, self.sum(a, level.moving(n), dt, with_slope, class));
            if let Some(done) = done {
                let parts = [&mut self.transition, &mut self.constant, &mut self.slope];
                CLASSES.restore(done, size, &self.kept, parts);
            }
            done = Some(class);
        }
    }

    #[inline(always)]
    fn raise(&mut self, a: &[T], n: usize, dt: f64) -> T {
        let [first, second, third, fourth] = &mut self.powers;
        let (first, second, a) = (&mut first[..n * n], &mut second[..n * n], &a[..n * n]);
        for i in 0..n * n {
            first[i] = a[i] * dt;
        }
        multiply(second, first, first, n, n);
        multiply(third, second, first, n, n);
        multiply(fourth, second, second, n, n);
        // Rows of different units make the norm of A dt large, but not that of its square.
        norm(second, n).sqrt()
    }

    #[inline(always)]
    fn sum(&mut self, a: &[T], n: usize, dt: f64, with_slope: bool, class: usize) {
        let Self { transition, constant, slope, powers: [first, second, third, fourth], work, kept: _ } = self;
        let (first, second, third, a) = (&first[..n * n], &second[..n * n], &third[..n * n], &a[..n * n]);
        let (transition, constant) = (&mut transition[..n * n], &mut constant[..n * n]);
        let (slope, work) = (&mut slope[..n * n], &mut work[..n * n]);
        let quartets = (class + 2).min(4);
        let doublings = Classes::<3>::doublings(class);
        // A power of two: dividing by it rounds nothing.
        let scale = libm::exp2(-(doublings as f64));
        let scales = [1.0, scale, scale * scale, scale * scale * scale];
        let (k, sum) = if with_slope { (2, &mut *slope) } else { (1, &mut *constant) };
        for quartet in (0..quartets).rev() {
            let begins = quartet + 1 == quartets;
            if !begins {
                multiply(work, fourth, sum, n, n);
            }
            let c = |i: usize| INVERSE_FACTORIAL[4 * quartet + i + k] * scales[i];
            let (c, far) = ([c(0), c(1), c(2), c(3)], scales[2] * scales[2]);
            for i in 0..n * n {
                let terms = first[i] * c[1] + second[i] * c[2] + third[i] * c[3];
                sum[i] = if begins { terms } else { work[i] * far + terms };
            }
            for i in 0..n {
                sum[i * n + i] = sum[i * n + i] + c[0];
            }
        }
        let mut t = dt * scale;
        let factor = if with_slope { t * t } else { t };
        for i in 0..n * n {
            sum[i] = sum[i] * factor;
        }
        for _ in 0..doublings {
            if with_slope {
                plus_product(constant, t, a, slope, n);
            }
            plus_product(transition, 1.0, a, constant, n);
            multiply(work, transition, if with_slope { slope } else { constant }, n, n);
            for i in 0..n * n {
                if with_slope {
                    slope[i] = slope[i] + work[i] + constant[i] * t;
                } else {
                    constant[i] = constant[i] + work[i];
                }
            }
            t *= 2.0;
        }
        if with_slope {
            plus_product(constant, dt, a, slope, n);
        }
        plus_product(transition, 1.0, a, constant, n);
    }
}

/// `out = t I + A B`
#[inline(always)]
fn plus_product<T: Number>(out: &mut [T], t: f64, a: &[T], b: &[T], n: usize) {
    multiply(out, a, b, n, n);
    for j in 0..n {
        out[j * n + j] = out[j * n + j] + t;
    }
}

/// The response of `ẍ = a x + b ẋ` to an impulse after a time, its integral, and the integral of that.
///
/// ```text
/// exp(A dt) = [1 + a q, h; a h, 1 + a q + b h],  Γ₁ = [h - b q, q; a q, h],  Γ₂ = [q - b p, p; a p, q]
/// ```
///
/// All are entire functions of a and b: one series serves underdamped, critical, overdamped and unstable oscillators, and free masses.
#[derive(Clone, Copy, Debug)]
pub struct Impulse<T> {
    /// h \[s\]
    pub h: T,
    /// q \[s²\]
    pub q: T,
    /// p \[s³\], if the caller wants it.
    pub p: T,
}

/// Classes by the size of a step: ten terms, fourteen, then doublings.
const IMPULSE_CLASSES: Classes<2> = Classes([0.07, 0.25]);

impl<T: Number> Impulse<T> {
    /// The response with stiffness a \[1/s²\] and damping b \[1/s\] after `dt` \[s\]; p only `with_slope`.
    #[inline(always)]
    pub fn new<L: Level>(level: L, a: T, b: T, dt: f64, with_slope: bool) -> Self {
        let size = Classes::<2>::counted(a.abs().sqrt().max(b.abs()) * dt);
        if size.largest() <= IMPULSE_CLASSES.0[0] {
            return Self::terms::<5>(a, b, dt, with_slope);
        }
        let (mut response, mut done) = (Self { h: a, q: a, p: a }, None);
        while let Some(class) = IMPULSE_CLASSES.after(done, size) {
            let own = apart!(level, Self::of_class(a, b, dt, class, with_slope));
            let shorter = done.map_or(f64::NEG_INFINITY, |done| IMPULSE_CLASSES.upper(done));
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

    /// `h = t Σ cₙ/(n+1)!`, `q = t² Σ cₙ/(n+2)!`, `p = t³ Σ cₙ/(n+3)!` with `cₙ₊₁ = b t cₙ + a t² cₙ₋₁`, `c₀ = 1`; two terms a pass,
    /// so that even and odd coefficients do not wait for each other. Two of the sums leave out p.
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
    use crate::engine::lanes::Lanes;
    use crate::engine::level::Baseline;
    use nalgebra::DMatrix;

    const SIZES: [f64; 8] = [1e-3, 3.0, 0.2, 0.4, 1e-6, f64::NAN, 40.0, 1e61];

    fn block(i: usize, size: f64) -> f64 {
        let rates = [0.0, 0.0, -1.0, 0.4, 0.0, 0.0, 0.3, -1.3, 1.0, 0.0, -0.1, 0.0, 0.0, 1.0, 0.05, -0.2];
        size * rates[i]
    }

    fn of_lanes<T: Number>(sizes: &[f64], with_slope: bool) -> Exponential<T> {
        let a: Vec<T> = (0..16).map(|i| T::from_lanes(|lane| block(i, sizes[lane]))).collect();
        let mut exponential = Exponential::new(4);
        exponential.compute(Baseline, &a, 4, 1.0, with_slope);
        exponential
    }

    #[test]
    fn each_lane_has_the_series_of_its_own_step() {
        for with_slope in [false, true] {
            let lanes = of_lanes::<Lanes<8>>(&SIZES, with_slope);
            for (lane, size) in SIZES.into_iter().enumerate() {
                let single = of_lanes::<f64>(&[size], with_slope);
                let parts = [(&lanes.transition, &single.transition), (&lanes.constant, &single.constant)];
                for (lanes, single) in parts {
                    for (lanes, single) in lanes.iter().zip(single) {
                        let same = lanes.lane(lane).to_bits() == single.to_bits();
                        assert!(same || (lanes.lane(lane).is_nan() && single.is_nan()), "{size}");
                        assert!(single.is_finite() == (size < 100.0), "{size}: {single}");
                    }
                }
            }
        }
    }

    /// exp of `[A, I, 0; 0, 0, I; 0, 0, 0] dt` is `[Φ, Γ₁, Γ₂; ...]`.
    #[test]
    fn the_exponential_is_that_of_a_larger_matrix() {
        for size in SIZES.into_iter().filter(|size| *size < 100.0) {
            let mut whole = DMatrix::<f64>::zeros(12, 12);
            for i in 0..4 {
                (0..4).for_each(|j| whole[(i, j)] = block(4 * j + i, size));
                (whole[(i, 4 + i)], whole[(4 + i, 8 + i)]) = (1.0, 1.0);
            }
            let (short, identity) = (&whole / 1024.0, DMatrix::identity(12, 12));
            let series = (1..=20).rev().fold(identity.clone(), |sum, n| &identity + &short * sum / f64::from(n));
            let whole = (0..10).fold(series, |half, _| &half * &half);
            let single = of_lanes::<f64>(&[size], true);
            for (place, part) in [&single.transition, &single.constant, &single.slope].into_iter().enumerate() {
                let expected = whole.view((0, 4 * place), (4, 4));
                let error = (expected - DMatrix::from_column_slice(4, 4, part)).amax() / expected.amax();
                // Each doubling of a step doubles its rounding, in both.
                let limit = if size > 10.0 { 1e-9 } else { 1e-13 };
                assert!(error < limit, "{size}: {error:e}");
            }
        }
    }

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
