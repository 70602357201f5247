//! The linear algebra of a step. Matrices are stored column by column; only the lower triangle of a symmetric one is read.

use super::level::{Baseline, Level, each};
use super::number::{Mask, Number};

#[inline(always)]
pub(crate) fn add_times<T: Number>(y: &mut [T], a: T, x: &[T]) {
    let x = &x[..y.len()];
    for i in 0..y.len() {
        y[i] = y[i] + x[i] * a;
    }
}

#[inline(always)]
pub(crate) fn take_times<T: Number>(y: &mut [T], a: T, x: &[T]) {
    let x = &x[..y.len()];
    for i in 0..y.len() {
        y[i] = y[i] - x[i] * a;
    }
}

#[inline(always)]
pub(crate) fn entry<T: Copy>(a: &[T], n: usize, i: usize, j: usize) -> T {
    if i >= j { a[j * n + i] } else { a[i * n + j] }
}

/// The rows from which on a lone run mirrors its covariance first, and then takes several numbers of a column at a time.
const LONG: usize = 7;

#[inline(always)]
pub fn mirror<T: Copy, L: Level>(level: L, a: &mut [T], n: usize) {
    each!(level, 1, n, |j| {
        for i in 0..j {
            a[j * n + i] = a[i * n + j];
        }
    });
}

/// The numbers of a vector. Its types are few, so that the program has the sums below once for all callers.
pub(crate) trait Vector<T>: Copy {
    fn number(&self, place: usize) -> T;
}

impl<T, F: Fn(usize) -> T + Copy> Vector<T> for F {
    #[inline(always)]
    fn number(&self, place: usize) -> T {
        self(place)
    }
}

impl<T: Number> Vector<T> for &[T] {
    #[inline(always)]
    fn number(&self, place: usize) -> T {
        self[place]
    }
}

impl<T: Number> Vector<T> for (T, &[f64]) {
    #[inline(always)]
    fn number(&self, place: usize) -> T {
        self.0 * self.1[place]
    }
}

/// `out = A x`, with a row of A for each number of `out`, and the first k numbers of x.
#[inline(always)]
pub(crate) fn apply<T: Number>(out: &mut [T], a: &[T], k: usize, x: impl Vector<T>) {
    combine(out, a, [out.len(), 0], k, x);
}

/// `out = Σ aₗ xₗ` of the first k columns of `rows` numbers, from row `first` on; a few rows at a time, so that sums stay in registers.
#[inline(always)]
pub(super) fn combine<T: Number>(out: &mut [T], a: &[T], [rows, first]: [usize; 2], k: usize, x: impl Vector<T>) {
    let mut done = 0;
    if const { T::LANES == 1 } {
        combine_rows::<T, 8>(out, &mut done, a, [rows, first], k, x);
        combine_rows::<T, 4>(out, &mut done, a, [rows, first], k, x);
    }
    combine_rows::<T, 2>(out, &mut done, a, [rows, first], k, x);
    combine_rows::<T, 1>(out, &mut done, a, [rows, first], k, x);
}

#[inline(always)]
fn combine_rows<T: Number, const R: usize>(
    out: &mut [T],
    done: &mut usize,
    a: &[T],
    [rows, first]: [usize; 2],
    k: usize,
    x: impl Vector<T>,
) {
    while *done + R <= out.len() {
        let (mut sums, begin) = ([x.number(0); R], first + *done);
        for (l, column) in a.chunks_exact(rows).take(k).enumerate() {
            let (column, factor) = (&column[begin..begin + R], x.number(l));
            for r in 0..R {
                sums[r] = if l == 0 { column[r] * factor } else { sums[r] + column[r] * factor };
            }
        }
        out[*done..*done + R].copy_from_slice(&sums);
        *done += R;
    }
}

/// `out = A B` with A of `rows` rows and k columns.
// A page has this once, to be smaller.
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
pub(crate) fn multiply<T: Number>(out: &mut [T], a: &[T], b: &[T], rows: usize, k: usize) {
    product(out, a, b, rows, k);
}

#[inline(always)]
pub(crate) fn product<T: Number>(out: &mut [T], a: &[T], b: &[T], rows: usize, k: usize) {
    for (j, out) in out.chunks_exact_mut(rows).enumerate() {
        apply(out, a, k, &b[j * k..][..k]);
    }
}

/// The largest sum of a column's absolute values: of the norms it needs no root, and columns lie in one piece.
#[inline(always)]
pub(crate) fn norm<T: Number>(a: &[T], n: usize) -> T {
    let mut largest = T::of(0.0);
    for column in a.chunks_exact(n) {
        let mut sum = column[0].abs();
        for i in 1..n {
            sum = sum + column[i].abs();
        }
        largest = largest.max(sum);
    }
    largest
}

/// The lower triangle of `Φ P Φᵀ` in place of P, n × n, with `Φ = [T; 0 I]`: `rows` has T, `half` memory for `motion` × n numbers.
#[inline(always)]
pub(crate) fn congruence<T: Number>(rows: &[T], cov: &mut [T], half: &mut [T], n: usize, motion: usize) {
    match motion {
        // The motion of four masses: known to the compiler, also where no size is.
        8 if const { T::LANES == 1 } => congruence_of(rows, cov, half, n, 8),
        _ => congruence_of(rows, cov, half, n, motion),
    }
}

#[inline(always)]
fn congruence_of<T: Number>(rows: &[T], cov: &mut [T], half: &mut [T], n: usize, motion: usize) {
    if const { T::LANES == 1 } && motion >= LONG {
        mirror(Baseline, cov, n);
        multiply(half, rows, cov, motion, n);
    } else {
        for (j, half) in half.chunks_exact_mut(motion).enumerate() {
            apply(
                half,
                rows,
                n,
                #[inline(always)]
                |k| entry(cov, n, k, j),
            );
        }
    }
    for j in 0..motion {
        let column = &mut cov[j * n..(j + 1) * n];
        combine(
            &mut column[j..motion],
            half,
            [motion, j],
            n,
            #[inline(always)]
            |k| rows[k * motion + j],
        );
        for i in motion..n {
            column[i] = half[i * motion + j];
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Rooted<M> {
    pub holds: M,
    /// It has one, or lacks it because it is indefinite, not because a number is not finite.
    pub is_finite: M,
}

impl<M: Mask> Rooted<M> {
    #[inline(always)]
    pub(super) fn and(self, later: Self) -> Self {
        let is_finite = self.is_finite & (!self.holds | later.is_finite);
        Self { holds: self.holds & later.holds, is_finite }
    }
}

/// The lower triangular root, n × n; a variance of zero to rounding gives a column of zeros.
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.2.8 (semidefinite systems).
#[inline(always)]
pub(crate) fn lower_root<T: Number, L: Level>(level: L, cov: &[T], root: &mut [T], n: usize) -> Rooted<T::Mask> {
    let zero = T::of(0.0);
    let (mut holds, mut is_finite) = (T::Mask::of(true), T::Mask::of(true));
    each!(level, 0, n, |j| {
        root[j * n..j * n + j].fill(zero);
        root[j * n + j..(j + 1) * n].copy_from_slice(&cov[j * n + j..(j + 1) * n]);
    });
    each!(level, 0, n, |j| {
        let (before, after) = root.split_at_mut((j + 1) * n);
        let column = &mut before[j * n..];
        let pivot = column[j];
        let rounding = cov[j * n + j] * (4.0 * n as f64 * f64::EPSILON);
        let counts = rounding.lt(pivot) & pivot.is_normal();
        is_finite = is_finite & (!holds | pivot.is_finite());
        // A pivot a little below zero is rounding, one far below an indefinite covariance.
        holds = holds & pivot.is_finite() & (counts | (rounding * -1e4).le(pivot));
        let inverse = T::select(counts, T::of(1.0) / pivot, zero);
        each!(level, j + 1, n, |k| {
            take_times(&mut after[(k - j - 1) * n + k..(k - j) * n], column[k] * inverse, &column[k..]);
        });
        let scale = inverse * pivot.sqrt();
        for i in j..n {
            column[i] = T::select(counts, column[i] * scale, zero);
        }
    });
    Rooted { holds, is_finite }
}

/// `S = L D Lᵀ` in place of the lower triangle of S, m × m, with D⁻¹ on the diagonal. Returns det S and where S is positive definite.
///
/// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.1.2.
#[inline(always)]
pub fn factor<T: Number>(s: &mut [T], m: usize) -> (T, T::Mask) {
    let mut determinant = T::of(1.0);
    let mut holds = T::Mask::of(true);
    for j in 0..m {
        let pivot = s[j * m + j];
        let inverse = T::of(1.0) / pivot;
        // An inverse that overflows, or has lost digits as a subnormal number, would spoil all that follows.
        holds = holds & T::of(0.0).lt(pivot) & inverse.is_normal();
        for k in j + 1..m {
            let share = s[j * m + k] * inverse;
            for i in k..m {
                s[k * m + i] = s[k * m + i] - s[j * m + i] * share;
            }
        }
        for k in j + 1..m {
            s[j * m + k] = s[j * m + k] * inverse;
        }
        s[j * m + j] = inverse;
        determinant = determinant * pivot;
    }
    (determinant, holds)
}

/// `X S⁻¹` in place of X, n × m, by the factor of S.
#[inline(always)]
pub(crate) fn divide<T: Number>(factor: &[T], m: usize, x: &mut [T], n: usize) {
    for j in 0..m {
        let (before, column) = x.split_at_mut(j * n);
        for k in 0..j {
            take_times(&mut column[..n], factor[k * m + j], &before[k * n..(k + 1) * n]);
        }
    }
    for j in (0..m).rev() {
        let (column, after) = x[j * n..].split_at_mut(n);
        let inverse = factor[j * m + j];
        for i in 0..n {
            column[i] = column[i] * inverse;
        }
        for k in j + 1..m {
            take_times(column, factor[j * m + k], &after[(k - j - 1) * n..(k - j) * n]);
        }
    }
}

/// `X L⁻¹` in place of X, n × n, the last column first. Directions without variance are left out.
pub(crate) fn divide_by_root<T: Number>(x: &mut [T], root: &[T], n: usize) {
    for j in (0..n).rev() {
        let (before, after) = x.split_at_mut((j + 1) * n);
        let column = &mut before[j * n..];
        for (k, later) in (j + 1..n).zip(after.chunks_exact(n)) {
            take_times(column, root[j * n + k], later);
        }
        let pivot = root[j * n + j];
        let is_zero = pivot.le(T::of(0.0)) & T::of(0.0).le(pivot);
        let inverse = T::select(is_zero, T::of(0.0), T::of(1.0) / pivot);
        for entry in column {
            *entry = *entry * inverse;
        }
    }
}

/// `eᵀ S⁻¹ e` by the factor of S; e becomes white.
#[inline(always)]
pub fn square<T: Number>(factor: &[T], m: usize, e: &mut [T]) -> T {
    let mut sum = T::of(0.0);
    for j in 0..m {
        for k in 0..j {
            e[j] = e[j] - factor[k * m + j] * e[k];
        }
        sum = sum + e[j] * e[j] * factor[j * m + j];
    }
    sum
}

/// Subtracts `A Bᵀ` from the lower triangle of X, n × n; A and B have `columns` columns.
#[inline(always)]
pub(super) fn subtract_products<T: Number>(x: &mut [T], a: &[T], b: &[T], n: usize, columns: usize) {
    let (a, b) = (&a[..n * columns], &b[..n * columns]);
    let mut k = 0;
    while k < columns {
        // Two columns at a time, so that each number of X is loaded and stored once for both.
        let is_pair = k + 1 < columns;
        let next = if is_pair { k + 1 } else { k };
        let (a, b) = ([&a[k * n..(k + 1) * n], &a[next * n..(next + 1) * n]], [&b[k * n..], &b[next * n..]]);
        for j in 0..n {
            let column = &mut x[j * n..(j + 1) * n];
            let factors = [b[0][j], b[1][j]];
            for i in j..n {
                let less = column[i] - a[0][i] * factors[0];
                column[i] = if is_pair { less - a[1][i] * factors[1] } else { less };
            }
        }
        k += 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::lanes::Lanes;

    #[test]
    fn a_root_leaves_out_what_is_certain_and_tells_what_has_none() {
        let cov = [
            Lanes([4.0, 4.0, 1.0, f64::NAN]),
            Lanes([2.0, 0.0, 2.0, 0.0]),
            Lanes([0.0; 4]),
            Lanes([5.0, 0.0, 1.0, 1.0]),
        ];
        let mut root = [Lanes([0.0; 4]); 4];
        let Rooted { holds, is_finite } = lower_root(Baseline, &cov, &mut root, 2);
        let of = |lane: usize| root.map(|entry| entry.lane(lane));
        assert_eq!((of(0), of(1)), ([2.0, 1.0, 0.0, 2.0], [2.0, 0.0, 0.0, 0.0]));
        assert_eq!([0, 1, 2, 3].map(|lane| holds.lane(lane)), [true, true, false, false]);
        assert_eq!([2, 3].map(|lane| is_finite.lane(lane)), [true, false], "indefinite, and not a number");
    }
}
