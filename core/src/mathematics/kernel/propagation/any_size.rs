//! The matrix exponential of any size in one function, for steps that are seldom taken.

use crate::mathematics::integrate::{INVERSE_FACTORIAL, doublings};
use crate::mathematics::kernel::gaussian::Matrix;

/// Limits the number of rows.
const LARGEST: usize = 13;

/// [`exp_and_integral`](super::exp_and_integral) to the last bit, but slower: there each size is compiled to code of
/// its own, which is long; here all sizes share one function.
pub(crate) fn shared_exp_and_integral<const N: usize>(a: &Matrix<N, N>, dt: f64) -> (Matrix<N, N>, Matrix<N, N>) {
    const { assert!(N <= LARGEST) };
    let (exp, integral) = of_square(&Square::new(N, a.as_slice()), dt);
    (Matrix::from_column_slice(exp.values()), Matrix::from_column_slice(integral.values()))
}

/// A square matrix, column by column.
#[derive(Clone, Copy)]
struct Square {
    n: usize,
    numbers: [f64; LARGEST * LARGEST],
}

impl Square {
    fn new(n: usize, values: &[f64]) -> Self {
        let mut numbers = [0.0; LARGEST * LARGEST];
        numbers[..n * n].copy_from_slice(values);
        Self { n, numbers }
    }

    fn values(&self) -> &[f64] {
        &self.numbers[..self.n * self.n]
    }

    fn times(mut self, factor: f64) -> Self {
        for number in &mut self.numbers[..self.n * self.n] {
            *number *= factor;
        }
        self
    }

    fn plus(mut self, other: &Self) -> Self {
        for (number, other) in self.numbers.iter_mut().zip(other.values()) {
            *number += other;
        }
        self
    }

    /// The sum of `s I` and this matrix.
    fn plus_identity(self, s: f64) -> Self {
        let n = self.n;
        let mut identity = Self { n, numbers: [0.0; LARGEST * LARGEST] };
        for i in 0..n {
            identity.numbers[i * n + i] = s;
        }
        identity.plus(&self)
    }

    fn product(&self, other: &Self) -> Self {
        let n = self.n;
        let mut result = Self { n, numbers: [0.0; LARGEST * LARGEST] };
        for (column, factors) in result.numbers.chunks_exact_mut(n).zip(other.values().chunks_exact(n)) {
            for (k, (own, factor)) in self.values().chunks_exact(n).zip(factors).enumerate() {
                for (sum, x) in column.iter_mut().zip(own) {
                    // Does not add the first term to zero: that would lose the sign of a negative zero.
                    *sum = if k == 0 { x * factor } else { x * factor + *sum };
                }
            }
        }
        result
    }

    /// The largest sum of a column's absolute values.
    fn norm(&self) -> f64 {
        self.values().chunks_exact(self.n).map(|column| column.iter().map(|x| x.abs()).sum()).fold(f64::NAN, f64::max)
    }
}

/// The operations of [`exp_and_integral`](super::exp_and_integral), in their order.
fn of_square(a: &Square, dt: f64) -> (Square, Square) {
    let m = a.times(dt);
    let square = m.product(&m);
    if square.norm() <= 0.05 {
        let cube = square.product(&m);
        let triple = |first: usize| {
            let [c0, c1, c2] = [0, 1, 2].map(|n| INVERSE_FACTORIAL[first + n + 1]);
            m.times(c1).plus_identity(c0).plus(&square.times(c2))
        };
        let mut series = triple(9);
        for first in [6, 3, 0] {
            series = triple(first).plus(&cube.product(&series));
        }
        let integral = series.times(dt);
        return (a.product(&integral).plus_identity(1.0), integral);
    }
    let doublings = doublings(m.norm());
    let scale = 1.0 / libm::exp2(f64::from(doublings));
    let (m, square, short) = (m.times(scale), square.times(scale * scale), dt * scale);
    let cube = square.product(&m);
    let quartet = |first: usize| {
        let [c0, c1, c2, c3] = [0, 1, 2, 3].map(|n| INVERSE_FACTORIAL[first + n + 1]);
        m.times(c1).plus_identity(c0).plus(&square.times(c2)).plus(&cube.times(c3))
    };
    let fourth = square.product(&square);
    let mut series = quartet(12);
    for first in [8, 4, 0] {
        series = quartet(first).plus(&fourth.product(&series));
    }
    let mut integral = series.times(short);
    for _ in 0..doublings {
        integral = integral.product(&a.product(&integral).plus_identity(2.0));
    }
    (a.product(&integral).plus_identity(1.0), integral)
}

#[cfg(test)]
mod tests {
    use super::super::exp_and_integral;
    use super::*;

    fn agree<const N: usize>() {
        for seed in 0..40 {
            let number = |i: usize, j: usize| libm::sin((7 * i + 3 * j * j + seed * (i + 2 * j + 1)) as f64);
            let sparse = |i: usize, j: usize| if (i + j + seed).is_multiple_of(3) { 0.0 } else { number(i, j) };
            for size in [1e-9, 0.01, 0.3, 4.0, 300.0, 1e200, f64::NAN] {
                let a = Matrix::<N, N>::from_fn(|i, j| sparse(i, j) * size);
                let bits = |x: &Matrix<N, N>| x.map(|x| if x.is_nan() { 1 } else { x.to_bits() });
                let ((exp, integral), (other_exp, other_integral)) =
                    (exp_and_integral(&a, 0.02), shared_exp_and_integral(&a, 0.02));
                assert_eq!(bits(&exp), bits(&other_exp), "{N} rows, seed {seed}, size {size}");
                assert_eq!(bits(&integral), bits(&other_integral), "{N} rows, seed {seed}, size {size}");
            }
        }
    }

    #[test]
    fn every_size_has_the_bits_of_its_own_program() {
        agree::<2>();
        agree::<4>();
        agree::<5>();
        agree::<8>();
        agree::<13>();
    }
}
