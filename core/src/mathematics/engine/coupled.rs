//! The response of coupled oscillators: their exponential from matrices of the number of masses.

use std::ops::Range;

use super::columns::{multiply, norm};
use super::exponential::Classes;
use super::level::Level;
use super::number::Number;
use crate::mathematics::integrate::INVERSE_FACTORIAL;

/// The response of m masses with `ẍ = K x + C ẋ` to a unit impulse on each of them, one a column, after a time, and its
/// integrals, m × m.
///
/// ```text
/// ḧ = h K + ḣ C,  h(0) = 0,  ḣ(0) = I,  q = ∫ h,  p = ∫ q
/// exp(A dt) = [I + q K, h; h K, ḣ],  Γ₁ = [h - q C, q; q K, h],  Γ₂ = [q - p C, p; p K, q],  ḣ = I + q K + h C
/// ```
///
/// It is the closed form of one [oscillator](super::impulse) with matrices in place of numbers.
#[derive(Clone, Debug)]
pub(super) struct Coupled<T> {
    /// The rows of each column of K and C that may differ from zero.
    reach: Vec<Range<usize>>,
    /// h \[s\]
    pub(super) value: Vec<T>,
    /// q \[s²\]
    pub(super) integral: Vec<T>,
    /// p \[s³\], if the caller wants it.
    pub(super) second: Vec<T>,
    /// K and C.
    pub(super) stiffness: Vec<T>,
    pub(super) damping: Vec<T>,
    /// The terms cₙ of the series, and the two before.
    terms: [Vec<T>; 3],
    /// `q K`, `h K` and `q K + h C`
    pub(super) products: [Vec<T>; 3],
    /// h, q and p of the lanes of the classes that are done.
    kept: [Vec<T>; 3],
}

/// Classes by the size of a step. The first term of a class that is left out is below rounding.
const CLASSES: Classes<4> = Classes([0.05, 0.14, 0.3, 0.6]);

/// The number of terms of each class; steps that are doubled have the last one.
const TERMS: [usize; 4] = [8, 10, 12, 15];

impl<T: Number> Coupled<T> {
    /// Memory for masses whose K and C have these rows in each column.
    pub(super) fn new(reach: Vec<Range<usize>>) -> Self {
        let square = || vec![T::of(0.0); reach.len() * reach.len()];
        Self {
            value: square(),
            integral: square(),
            second: square(),
            stiffness: square(),
            damping: square(),
            terms: [square(), square(), square()],
            products: [square(), square(), square()],
            kept: [square(), square(), square()],
            reach,
        }
    }

    /// Takes the response from the derivatives of the rates by the moving components, m of them displacements and m velocities;
    /// p only `with_slope`.
    #[inline(always)]
    pub(super) fn compute<L: Level>(&mut self, level: L, a: &[T], m: usize, dt: f64, with_slope: bool) {
        let size = level.apart(
            #[inline(always)]
            || self.take(a, m),
        );
        let size = Classes::<4>::counted(size * dt);
        let mut done = None;
        while let Some(class) = CLASSES.after(done, size) {
            if done.is_some() {
                for (kept, part) in self.kept.iter_mut().zip([&self.value, &self.integral, &self.second]) {
                    kept.copy_from_slice(part);
                }
            }
            level.apart(
                #[inline(always)]
                || self.sum(m, dt, with_slope, class),
            );
            if let Some(done) = done {
                let is_shorter = size.le(T::of(CLASSES.upper(done)));
                let parts = [&mut self.value, &mut self.integral, &mut self.second];
                for (kept, part) in self.kept.iter().zip(parts) {
                    for i in 0..m * m {
                        part[i] = T::select(is_shorter, kept[i], part[i]);
                    }
                }
            }
            done = Some(class);
        }
        level.apart(
            #[inline(always)]
            || self.take_products(m),
        );
    }

    /// Copies K and C; returns a bound on the rate at which terms grow \[1/s\]: the positive root of `s² = ‖C‖ s + ‖K‖`.
    #[inline(always)]
    fn take(&mut self, a: &[T], m: usize) -> T {
        let Self { stiffness, damping, .. } = self;
        for j in 0..m {
            stiffness[j * m..(j + 1) * m].copy_from_slice(&a[j * 2 * m + m..(j + 1) * 2 * m]);
            damping[j * m..(j + 1) * m].copy_from_slice(&a[(m + j) * 2 * m + m..(m + j + 1) * 2 * m]);
        }
        let (stiffness, damping) = (norm(&stiffness[..m * m], m), norm(&damping[..m * m], m));
        (damping + (damping * damping + stiffness * 4.0).sqrt()) * 0.5
    }

    /// Sums the series of a class over its part of the step, then doubles that part.
    #[inline(always)]
    fn sum(&mut self, m: usize, dt: f64, with_slope: bool, class: usize) {
        let doublings = Classes::<4>::doublings(class);
        let mut t = dt * libm::exp2(-(doublings as f64));
        self.series(m, t, with_slope, TERMS[class.min(TERMS.len() - 1)]);
        for _ in 0..doublings {
            self.take_products(m);
            self.double(m, t, with_slope);
            t *= 2.0;
        }
    }

    /// ```text
    /// h = t Σ cₙ/(n+1)!,  q = t² Σ cₙ/(n+2)!,  p = t³ Σ cₙ/(n+3)!,  cₙ₊₁ = cₙ C t + cₙ₋₁ K t²,  c₀ = I
    /// ```
    #[inline(always)]
    fn series(&mut self, m: usize, t: f64, with_slope: bool, count: usize) {
        let Self { reach, value, integral, second, stiffness, damping, terms, products, .. } = self;
        let (reach, [next, now, before]) = (&reach[..m], terms);
        let [by_stiffness, by_damping, _] = products;
        for i in 0..m * m {
            (by_stiffness[i], by_damping[i]) = (stiffness[i] * (t * t), damping[i] * t);
        }
        let sums = &mut [&mut value[..m * m], &mut integral[..m * m], &mut second[..m * m]];
        let sums = &mut sums[..if with_slope { 3 } else { 2 }];
        now[..m * m].fill(T::of(0.0));
        before[..m * m].fill(T::of(0.0));
        for i in 0..m {
            now[i * m + i] = T::of(1.0);
        }
        for (k, sum) in sums.iter_mut().enumerate() {
            for i in 0..m * m {
                sum[i] = now[i] * INVERSE_FACTORIAL[k + 1];
            }
        }
        for n in 1..count {
            for j in 0..m {
                let column = &mut next[j * m..(j + 1) * m];
                for l in reach[j].clone() {
                    let (c, k) = (by_damping[j * m + l], by_stiffness[j * m + l]);
                    let (now, before) = (&now[l * m..(l + 1) * m], &before[l * m..(l + 1) * m]);
                    for i in 0..m {
                        let term = now[i] * c + before[i] * k;
                        column[i] = if l == reach[j].start { term } else { column[i] + term };
                    }
                }
                for (k, sum) in sums.iter_mut().enumerate() {
                    let sum = &mut sum[j * m..(j + 1) * m];
                    for i in 0..m {
                        sum[i] = sum[i] + column[i] * INVERSE_FACTORIAL[n + k + 1];
                    }
                }
            }
            std::mem::swap(before, now);
            std::mem::swap(now, next);
        }
        let mut factor = 1.0;
        for sum in sums {
            factor *= t;
            for i in 0..m * m {
                sum[i] = sum[i] * factor;
            }
        }
    }

    /// `q K`, `h K` and `q K + h C`
    #[inline(always)]
    fn take_products(&mut self, m: usize) {
        let Self { reach, value, integral, stiffness, damping, products, .. } = self;
        let (reach, [displaced, pulled, kept]) = (&reach[..m], products);
        for j in 0..m {
            let own = j * m..(j + 1) * m;
            let (displaced, pulled, kept) = (&mut displaced[own.clone()], &mut pulled[own.clone()], &mut kept[own]);
            for l in reach[j].clone() {
                let (k, c) = (stiffness[j * m + l], damping[j * m + l]);
                let (h, q) = (&value[l * m..(l + 1) * m], &integral[l * m..(l + 1) * m]);
                let begins = l == reach[j].start;
                for i in 0..m {
                    let (by_q, by_h) = (q[i] * k, h[i] * k);
                    let both = by_q + h[i] * c;
                    displaced[i] = if begins { by_q } else { displaced[i] + by_q };
                    pulled[i] = if begins { by_h } else { pulled[i] + by_h };
                    kept[i] = if begins { both } else { kept[i] + both };
                }
            }
        }
    }

    /// ```text
    /// q(2t) = 2 q + q K q + h h,  h(2t) = 2 h + h K q + (q K + h C) h,  p(2t) = 2 p + q t + q K p + h q
    /// ```
    #[inline(always)]
    fn double(&mut self, m: usize, t: f64, with_slope: bool) {
        let Self { value, integral, second, terms: [sum, half, rest], products: [displaced, pulled, kept], .. } = self;
        if with_slope {
            multiply(half, displaced, second, m, m);
            multiply(rest, value, integral, m, m);
            for i in 0..m * m {
                second[i] = second[i] * 2.0 + integral[i] * t + half[i] + rest[i];
            }
        }
        multiply(half, displaced, integral, m, m);
        multiply(rest, value, value, m, m);
        for i in 0..m * m {
            sum[i] = integral[i] * 2.0 + half[i] + rest[i];
        }
        multiply(half, pulled, integral, m, m);
        multiply(rest, kept, value, m, m);
        for i in 0..m * m {
            value[i] = value[i] * 2.0 + half[i] + rest[i];
        }
        std::mem::swap(integral, sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::engine::exponential::Exponential;
    use crate::mathematics::engine::lanes::Lanes;
    use crate::mathematics::engine::level::Baseline;

    /// Sizes of steps of every class, including NaN.
    const SIZES: [f64; 8] = [1e-3, 0.07, 0.1, 0.25, 3.0, f64::NAN, 40.0, 1e305];

    /// The derivatives of the rates of three masses in a row, this much faster, whose dampers are no multiples of their springs.
    fn block(i: usize, size: f64) -> f64 {
        const STIFFNESS: [f64; 9] = [-1.9, 0.8, 0.0, 0.8, -1.5, 0.7, 0.0, 0.7, -0.7];
        const DAMPING: [f64; 9] = [-0.1, 0.06, 0.0, 0.06, -0.3, 0.24, 0.0, 0.24, -0.24];
        match (i / 6, i % 6) {
            (j, i) if i < 3 => f64::from(u8::from(j == i + 3)),
            (j, i) if j < 3 => size * size * STIFFNESS[j * 3 + i - 3],
            (j, i) => size * DAMPING[(j - 3) * 3 + i - 3],
        }
    }

    fn of<T: Number>(sizes: &[f64], with_slope: bool) -> Coupled<T> {
        let a: Vec<T> = (0..36).map(|i| T::from_lanes(|lane| block(i, sizes[lane]))).collect();
        let mut coupled = Coupled::new(vec![0..2, 0..3, 1..3]);
        coupled.compute(Baseline, &a, 3, 0.5, with_slope);
        coupled
    }

    #[test]
    fn each_lane_has_the_series_of_its_own_step() {
        for with_slope in [false, true] {
            let lanes = of::<Lanes<8>>(&SIZES, with_slope);
            for (lane, size) in SIZES.into_iter().enumerate() {
                let single = of::<f64>(&[size], with_slope);
                let parts = [&lanes.value, &lanes.integral, &lanes.second].into_iter().zip([
                    &single.value,
                    &single.integral,
                    &single.second,
                ]);
                for (lanes, single) in parts.chain(lanes.products.iter().zip(&single.products)) {
                    for (lanes, single) in lanes.iter().zip(single) {
                        let same = lanes.lane(lane).to_bits() == single.to_bits();
                        assert!(same || (lanes.lane(lane).is_nan() && single.is_nan()), "{size}");
                    }
                }
            }
        }
    }

    #[test]
    fn it_is_the_exponential() {
        for size in SIZES.into_iter().filter(|size| *size < 100.0) {
            let a: Vec<f64> = (0..36).map(|i| block(i, size)).collect();
            let mut exponential = Exponential::new(6);
            exponential.compute(Baseline, &a, 6, 0.5, true);
            let coupled = of::<f64>(&[size], true);
            let Coupled { value, integral, second, products: [displaced, pulled, kept], .. } = &coupled;
            let one = |i: usize| f64::from(u8::from(i % 4 == 0));
            let parts: [(&[f64], [usize; 2], &dyn Fn(usize) -> f64); 6] = [
                (&exponential.transition, [0, 3], &|i| value[i]),
                (&exponential.transition, [0, 0], &|i| displaced[i] + one(i)),
                (&exponential.transition, [3, 0], &|i| pulled[i]),
                (&exponential.transition, [3, 3], &|i| kept[i] + one(i)),
                (&exponential.constant, [0, 3], &|i| integral[i]),
                (&exponential.slope, [0, 3], &|i| second[i]),
            ];
            for (place, (whole, [row, column], part)) in parts.into_iter().enumerate() {
                let of_whole = |i: usize| whole[(column + i / 3) * 6 + row + i % 3];
                let largest = (0..9).map(|i| of_whole(i).abs()).fold(0.0, f64::max);
                let error = (0..9).map(|i| (of_whole(i) - part(i)).abs()).fold(0.0, f64::max) / largest;
                // Each doubling of a step doubles its rounding, in both.
                let limit = if size > 10.0 { 1e-9 } else { 1e-13 };
                assert!(error < limit, "{size}: part {place}: {error:e}");
            }
        }
    }
}
