//! Products of matrices, written into memory that is already allocated.

use super::{Matrix, fit};

/// Makes `out` the product `A B`.
pub(crate) fn multiply(out: &mut Matrix, a: &Matrix, b: &Matrix) {
    let (rows, inner) = a.shape();
    fit(out, rows, b.ncols());
    out.as_mut_slice().fill(0.0);
    for j in 0..b.ncols() {
        let factors = &b.as_slice()[j * inner..][..inner];
        let column = &mut out.as_mut_slice()[j * rows..][..rows];
        add_columns(column, a.as_slice(), rows, factors.iter().copied());
    }
}

/// Adds `A x` to a sum.
pub(crate) fn add_product(sum: &mut [f64], a: &Matrix, x: &[f64]) {
    add_columns(sum, a.as_slice(), a.nrows(), x.iter().copied());
}

/// Makes `out` the product `A Hᵀ`, where most entries of H are zero: these are left out.
pub(crate) fn multiply_sparse(out: &mut Matrix, a: &Matrix, h: &Matrix) {
    let (r, m) = (a.nrows(), h.nrows());
    fit(out, r, m);
    out.as_mut_slice().fill(0.0);
    if r == 0 || m == 0 {
        return;
    }
    for (factors, column) in h.as_slice().chunks_exact(m).zip(a.as_slice().chunks_exact(r)) {
        for (sum, &factor) in out.as_mut_slice().chunks_exact_mut(r).zip(factors) {
            if factor != 0.0 {
                sum.iter_mut().zip(column).for_each(|(sum, entry)| *sum += entry * factor);
            }
        }
    }
}

/// Writes the lower triangle of `w A Bᵀ`, which must be symmetric (such as `A Aᵀ`), to the square `out`. If A has fewer
/// rows than `out`, it writes the first rows and columns only. It reads as many rows of B as A has.
pub(crate) fn multiply_symmetric(out: &mut Matrix, w: f64, a: &Matrix, b: &Matrix) {
    let (r, c, lead) = (a.nrows(), b.nrows(), out.nrows());
    for j in 0..r {
        let column = &mut out.as_mut_slice()[j * lead..][j..r];
        column.fill(0.0);
        let factors = b.as_slice()[j..].iter().step_by(c).take(a.ncols()).map(|b| b * w);
        add_columns(column, &a.as_slice()[j..], r, factors);
    }
}

/// Adds columns to a sum, each times its factor; a column begins `lead` numbers after the one before. Four at a time: the
/// sum is read and written a quarter as often.
#[inline]
fn add_columns(sum: &mut [f64], columns: &[f64], lead: usize, mut factors: impl ExactSizeIterator<Item = f64>) {
    let r = sum.len();
    if r == 0 {
        return;
    }
    let mut at = 0;
    while factors.len() >= 4 {
        let [f0, f1, f2, f3] = std::array::from_fn(|_| factors.next().unwrap_or_default());
        let [a0, a1, a2, a3]: [&[f64]; 4] = std::array::from_fn(|k| &columns[at + k * lead..][..r]);
        for i in 0..r {
            sum[i] += (a0[i] * f0 + a1[i] * f1) + (a2[i] * f2 + a3[i] * f3);
        }
        at += 4 * lead;
    }
    for factor in factors {
        for (sum, a) in sum.iter_mut().zip(&columns[at..][..r]) {
            *sum += a * factor;
        }
        at += lead;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_definition() {
        let of = |r: usize, c: usize, seed: f64| Matrix::from_fn(r, c, |i, j| libm::sin(seed + (3 * i + 5 * j) as f64));
        let mut out = Matrix::zeros(0, 0);
        for n in [1, 2, 4, 7, 9] {
            let (a, b) = (of(n + 1, n, 0.3), of(n, 6, 0.9));
            multiply(&mut out, &a, &b);
            assert!((&out - &a * &b).amax() < 1e-14);
            let sparse = Matrix::from_fn(2, n, |i, j| if i == j { 0.7 } else { 0.0 });
            multiply_sparse(&mut out, &a, &sparse);
            assert!((&out - &a * sparse.transpose()).amax() < 1e-14);
            let mut lower = Matrix::zeros(n + 1, n + 1);
            multiply_symmetric(&mut lower, 0.7, &a, &a);
            assert!((&lower - (&a * a.transpose() * 0.7).lower_triangle()).amax() < 1e-14);
        }
    }
}
