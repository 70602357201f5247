//! The response of coupled oscillators: their exponential from matrices of the number of masses.

#[cfg(doc)]
use super::columns::combine;
use super::columns::{add_times, multiply};
use super::exponential::{Classes, INVERSE_FACTORIAL};
use super::level::{Level, apart};
use super::number::Number;

/// The response of m masses with `ẍ = K x + C ẋ` to a unit impulse on each, one a column, and its integrals, m × m.
///
/// ```text
/// ḧ = h K + ḣ C,  h(0) = 0,  ḣ(0) = I,  q = ∫ h,  p = ∫ q
/// exp(A dt) = [I + q K, h; h K, ḣ],  Γ₁ = [h - q C, q; q K, h],  Γ₂ = [q - p C, p; p K, q],  ḣ = I + q K + h C
/// ```
///
/// It is the closed form of one [oscillator](super::exponential::Impulse) with matrices in place of numbers.
///
/// K and C stand in bands, one for each distance of a row from its column, and a product is a sum over bands: `(A B)ᵢⱼ = Σ_d
/// A_{i,j+d} B_{j+d,j}`.
#[derive(Clone, Debug)]
pub(super) struct Coupled<T> {
    masses: usize,
    /// w, the largest distance of a row of K and C from its column, of those that may differ from zero.
    reach: usize,
    /// The bands of K and C, column by column.
    stiffness: Vec<T>,
    damping: Vec<T>,
    /// `t² K` and `t C`
    scaled: [Vec<T>; 2],
    /// h \[s\], with w columns of zeros before and after, as all matrices that are multiplied by bands.
    value: Vec<T>,
    /// q \[s²\]
    integral: Vec<T>,
    /// p \[s³\], if the caller wants it.
    second: Vec<T>,
    /// The terms cₙ₊₁, cₙ and cₙ₋₁ of the series.
    terms: [Vec<T>; 3],
    /// `q K`, `h K` and `q K + h C`
    products: [Vec<T>; 3],
    /// h, q and p of the lanes of the classes that are done.
    kept: [Vec<T>; 3],
}

/// Classes by the size of a step. The first term of a class that is left out is below rounding.
const CLASSES: Classes<4> = Classes([0.05, 0.14, 0.3, 0.6]);

/// The number of terms of each class; steps that are doubled have the last one.
const TERMS: [usize; 4] = [8, 10, 12, 15];

impl<T: Number> Coupled<T> {
    pub(super) fn new(masses: usize, reach: usize) -> Self {
        let zeros = |columns: usize| vec![T::of(0.0); columns * masses];
        let bands = || zeros(2 * reach + 1);
        let padded = || zeros(masses + 2 * reach);
        let square = || zeros(masses);
        Self {
            masses,
            reach,
            stiffness: bands(),
            damping: bands(),
            scaled: [bands(), bands()],
            value: padded(),
            integral: padded(),
            second: padded(),
            terms: [padded(), padded(), padded()],
            products: [square(), square(), square()],
            kept: [padded(), padded(), padded()],
        }
    }

    /// h, q, p, `q K`, `h K` and `q K + h C`, m × m.
    #[inline(always)]
    pub(super) fn parts<L: Level>(&self, level: L) -> [&[T]; 6] {
        let Self { reach, value, integral, second, products: [displaced, pulled, kept], .. } = self;
        let m = self.count(level);
        let inner = *reach * m..*reach * m + m * m;
        let [value, integral, second] = [&value[inner.clone()], &integral[inner.clone()], &second[inner]];
        [value, integral, second, &displaced[..m * m], &pulled[..m * m], &kept[..m * m]]
    }

    #[inline(always)]
    fn count<L: Level>(&self, level: L) -> usize {
        level.moving(2 * self.masses) / 2
    }

    /// After `dt` \[s\], from the derivatives of the rates by displacements and then velocities; p only `with_slope`.
    #[inline(always)]
    pub(super) fn compute<L: Level>(&mut self, level: L, a: &[T], dt: f64, with_slope: bool) {
        let size = apart!(level, self.take(level, a));
        let size = Classes::<4>::counted(size * dt);
        let mut done = None;
        while let Some(class) = CLASSES.after(done, size) {
            if done.is_some() {
                for (kept, part) in self.kept.iter_mut().zip([&self.value, &self.integral, &self.second]) {
                    kept.copy_from_slice(part);
                }
            }
            apart!(
                level,
                match self.count(level) {
                    // Known to the compiler, also where no size is.
                    4 => self.sum(4, dt, with_slope, class),
                    m => self.sum(m, dt, with_slope, class),
                }
            );
            if let Some(done) = done {
                CLASSES.restore(done, size, &self.kept, [&mut self.value, &mut self.integral, &mut self.second]);
            }
            done = Some(class);
        }
        apart!(level, self.take_products(self.count(level)));
    }

    /// Copies K and C; returns a bound on the rate at which terms grow \[1/s\]: the positive root of `s² = ‖C‖ s + ‖K‖`.
    #[inline(always)]
    fn take<L: Level>(&mut self, level: L, a: &[T]) -> T {
        let m = self.count(level);
        let Self { reach, stiffness, damping, .. } = self;
        let (w, mut norms) = (*reach, [T::of(0.0); 2]);
        for j in 0..m {
            let mut sums = [T::of(0.0); 2];
            for l in j.saturating_sub(w)..m.min(j + w + 1) {
                let (k, c) = (a[j * 2 * m + m + l], a[(m + j) * 2 * m + m + l]);
                sums = [sums[0] + k.abs(), sums[1] + c.abs()];
                let at = j * (2 * w + 1) + l + w - j;
                (stiffness[at], damping[at]) = (k, c);
            }
            norms = [norms[0].max(sums[0]), norms[1].max(sums[1])];
        }
        let [stiffness, damping] = norms;
        (damping + (damping * damping + stiffness * 4.0).sqrt()) * 0.5
    }

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
        let Self { reach, stiffness, damping, scaled, value, integral, second, terms, .. } = self;
        let ([by_stiffness, by_damping], [next, now, before], begin) = (scaled, terms, *reach * m);
        for i in 0..stiffness.len() {
            (by_stiffness[i], by_damping[i]) = (stiffness[i] * (t * t), damping[i] * t);
        }
        let square = m * m;
        let (value, integral) = (&mut value[begin..][..square], &mut integral[begin..][..square]);
        let second = &mut second[begin..][..square];
        for i in 0..square {
            let one = T::of(if i % (m + 1) == 0 { 1.0 } else { 0.0 });
            (now[begin + i], before[begin + i]) = (one, T::of(0.0));
            (value[i], integral[i], second[i]) = (one, one * INVERSE_FACTORIAL[2], one * INVERSE_FACTORIAL[3]);
        }
        for n in 1..count {
            {
                let bands = Bands { m, count: 2 * *reach + 1, by: [by_damping, by_stiffness] };
                let term = &mut next[begin..][..square];
                bands.multiply([now, before], term);
                add_times(value, T::of(INVERSE_FACTORIAL[n + 1]), term);
                add_times(integral, T::of(INVERSE_FACTORIAL[n + 2]), term);
                if with_slope {
                    add_times(second, T::of(INVERSE_FACTORIAL[n + 3]), term);
                }
            }
            std::mem::swap(before, now);
            std::mem::swap(now, next);
        }
        for i in 0..square {
            value[i] = value[i] * t;
            integral[i] = integral[i] * (t * t);
            second[i] = second[i] * (t * t * t);
        }
    }

    #[inline(always)]
    fn take_products(&mut self, m: usize) {
        let Self { reach, value, integral, stiffness, damping, products: [displaced, pulled, kept], .. } = self;
        let count = 2 * *reach + 1;
        let by_stiffness = Bands { m, count, by: [stiffness] };
        by_stiffness.multiply([integral], &mut displaced[..m * m]);
        by_stiffness.multiply([value], &mut pulled[..m * m]);
        Bands { m, count, by: [stiffness, damping] }.multiply([integral, value], &mut kept[..m * m]);
    }

    /// ```text
    /// q(2t) = 2 q + q K q + h h,  h(2t) = 2 h + h K q + (q K + h C) h,  p(2t) = 2 p + q t + q K p + h q
    /// ```
    #[inline(always)]
    fn double(&mut self, m: usize, t: f64, with_slope: bool) {
        let Self { reach, value, integral, second, terms: [sum, half, rest], products, .. } = self;
        let [displaced, pulled, kept] = products;
        let inner = *reach * m..*reach * m + m * m;
        let (value, integral) = (&mut value[inner.clone()], &mut integral[inner.clone()]);
        let (second, sum) = (&mut second[inner], &mut sum[..m * m]);
        let (half, rest) = (&mut half[..m * m], &mut rest[..m * m]);
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
        integral.copy_from_slice(sum);
        // The columns beside the terms are zero.
        for terms in &mut self.terms {
            terms.fill(T::of(0.0));
        }
    }
}

struct Bands<'a, T, const N: usize> {
    m: usize,
    count: usize,
    by: [&'a [T]; N],
}

impl<T: Number, const N: usize> Bands<'_, T, N> {
    /// `Σ A B`, m × m, of matrices A with their columns of zeros. It takes a few rows at a time, as [`combine`] does.
    // A page has this once for each N, to be smaller.
    #[cfg_attr(target_arch = "wasm32", inline(never))]
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    fn multiply(&self, a: [&[T]; N], out: &mut [T]) {
        // Chains have three bands: a number that the compiler then knows.
        if self.count == 3 { self.columns(3, a, out) } else { self.columns(self.count, a, out) }
    }

    #[inline(always)]
    fn columns(&self, count: usize, a: [&[T]; N], out: &mut [T]) {
        let m = self.m;
        for (j, out) in out.chunks_exact_mut(m).enumerate() {
            let (mut a, mut by) = (a, self.by);
            for matrix in 0..N {
                (a[matrix], by[matrix]) = (&a[matrix][j * m..][..count * m], &by[matrix][j * count..][..count]);
            }
            let mut row = 0;
            if const { T::LANES == 1 } {
                rows::<T, 4, N>(a, by, &mut row, out);
            }
            rows::<T, 2, N>(a, by, &mut row, out);
            rows::<T, 1, N>(a, by, &mut row, out);
        }
    }
}

#[inline(always)]
fn rows<T: Number, const R: usize, const N: usize>(a: [&[T]; N], by: [&[T]; N], row: &mut usize, out: &mut [T]) {
    while *row + R <= out.len() {
        let mut sums = [T::of(0.0); R];
        for band in 0..by[0].len() {
            for matrix in 0..N {
                let (factor, column) = (by[matrix][band], &a[matrix][band * out.len() + *row..][..R]);
                for r in 0..R {
                    sums[r] = sums[r] + column[r] * factor;
                }
            }
        }
        out[*row..*row + R].copy_from_slice(&sums);
        *row += R;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::exponential::Exponential;
    use crate::engine::lanes::Lanes;
    use crate::engine::lanes::tests::is_same;
    use crate::engine::level::Baseline;

    const SIZES: [f64; 8] = [1e-3, 0.07, 0.1, 0.25, 3.0, f64::NAN, 40.0, 1e61];

    /// The rates of three masses, this much faster, in a row, or with a reach of 2 the first one pulls on the last one too.
    fn block(i: usize, size: f64, reach: usize) -> f64 {
        const STIFFNESS: [f64; 9] = [-1.9, 0.8, 0.2, 0.8, -1.5, 0.7, 0.3, 0.7, -0.9];
        const DAMPING: [f64; 9] = [-0.2, 0.06, 0.1, 0.06, -0.3, 0.24, 0.05, 0.24, -0.24];
        match (i / 6, i % 6) {
            (j, i) if i < 3 => f64::from(u8::from(j == i + 3)),
            (j, i) if (j % 3).abs_diff(i - 3) > reach => size * 0.0,
            (j, i) if j < 3 => size * size * STIFFNESS[j * 3 + i - 3],
            (j, i) => size * DAMPING[(j - 3) * 3 + i - 3],
        }
    }

    fn of<T: Number>(sizes: &[f64], with_slope: bool, reach: usize) -> Coupled<T> {
        let a: Vec<T> = (0..36).map(|i| T::from_lanes(|lane| block(i, sizes[lane], reach))).collect();
        let mut coupled = Coupled::new(3, reach);
        coupled.compute(Baseline, &a, 0.5, with_slope);
        coupled
    }

    #[test]
    fn each_lane_has_the_series_of_its_own_step() {
        for (with_slope, reach) in [(false, 1), (true, 1), (true, 2)] {
            let lanes = of::<Lanes<8>>(&SIZES, with_slope, reach);
            for (lane, size) in SIZES.into_iter().enumerate() {
                let single = of::<f64>(&[size], with_slope, reach);
                assert_eq!(single.value.iter().all(|h| h.is_finite()), size < 100.0, "{size}");
                let pairs = lanes.value.iter().zip(&single.value).chain(lanes.integral.iter().zip(&single.integral));
                let pairs = pairs.chain(lanes.second.iter().zip(&single.second));
                let products = lanes.products.iter().flatten().zip(single.products.iter().flatten());
                for (lanes, single) in pairs.chain(products) {
                    assert!(is_same(*lanes, lane, *single), "{size}");
                }
            }
        }
    }

    #[test]
    fn it_is_the_exponential() {
        let sizes = SIZES.into_iter().filter(|size| *size < 100.0);
        for (size, reach) in sizes.flat_map(|size| [(size, 1), (size, 2)]) {
            let a: Vec<f64> = (0..36).map(|i| block(i, size, reach)).collect();
            let mut exponential = Exponential::new(6);
            exponential.compute(Baseline, &a, 6, 0.5, true);
            let coupled = of::<f64>(&[size], true, reach);
            let [value, integral, second, displaced, pulled, kept] = coupled.parts(Baseline);
            let whole = |matrix: &[f64]| {
                matrix.iter().enumerate().map(|(i, x)| x + f64::from(u8::from(i.is_multiple_of(4)))).collect()
            };
            let (displaced, kept): (Vec<f64>, Vec<f64>) = (whole(displaced), whole(kept));
            let check = |place: &str, matrix: &[f64], [row, column]: [usize; 2], part: &[f64]| {
                let of_matrix = |i: usize| matrix[(column + i / 3) * 6 + row + i % 3];
                let largest = (0..9).map(|i| of_matrix(i).abs()).fold(0.0, f64::max);
                let error = (0..9).map(|i| (of_matrix(i) - part[i]).abs()).fold(0.0, f64::max) / largest;
                // Each doubling of a step doubles its rounding, in both.
                let limit = if size > 10.0 { 1e-9 } else { 1e-13 };
                assert!(error < limit, "{size}, reach {reach}: {place}: {error:e}");
            };
            check("x by v", &exponential.transition, [0, 3], value);
            check("x by x", &exponential.transition, [0, 0], &displaced);
            check("v by x", &exponential.transition, [3, 0], pulled);
            check("v by v", &exponential.transition, [3, 3], &kept);
            check("x by a constant", &exponential.constant, [0, 3], integral);
            check("x by a slope", &exponential.slope, [0, 3], second);
        }
    }
}
