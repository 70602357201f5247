//! Arrays and their triangles: the roots of covariances that are sums of squares.

use super::columns::take_times;
use super::level::{Level, each};
use super::number::Number;

/// The product of two rows, of their first `length` numbers; rows are `width` numbers long.
#[inline(always)]
pub(super) fn along<T: Number>(rows: &[T], width: usize, one: usize, other: usize, length: usize) -> T {
    let mut sum = rows[one * width] * rows[other * width];
    for k in 1..length {
        sum = sum + rows[one * width + k] * rows[other * width + k];
    }
    sum
}

/// The product of two rows in sums that do not wait for each other. The first `lead` numbers, and those after whole blocks of a
/// row of `base` more, are summed one by one: no bit changes where columns are left out that are zero.
#[inline(always)]
fn dot<T: Number>(a: &[T], b: &[T], [lead, base]: [usize; 2]) -> T {
    let ((a_lead, a), (b_lead, b)) = (a.split_at(lead), b[..a.len()].split_at(lead));
    let blocks = a.len().min(base / 4 * 4);
    let ((a, a_rest), (b, b_rest)) = (a.split_at(blocks), b.split_at(blocks));
    let mut sums = [T::of(0.0); 4];
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for lane in 0..4 {
            sums[lane] = sums[lane] + a[lane] * b[lane];
        }
    }
    let mut last = T::of(0.0);
    for (a, b) in a_lead.iter().zip(b_lead) {
        last = last + *a * *b;
    }
    for (a, b) in a_rest.iter().zip(b_rest) {
        last = last + *a * *b;
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + last
}

/// The lower triangular root of `A Aᵀ`, row by row. A has `count` rows of `lead + base` numbers and is overwritten. `reach`
/// limits those of the `base` numbers of a row, and of all rows before it, that are not zero.
///
/// The reflections are those of `[0, A]`, with a column of zeros for each of the triangle. For a row d and another row x
/// below it they give
///
/// ```text
/// [0, d] → [|d|, 0],   [0, x] → [d·x / |d|, x - d (d·x / d·d)]
/// ```
///
/// so that no row waits for a root. A row that is zero, or too small to square, gives a column of zeros: a component known for
/// certain stays so. Source: Golub and Van Loan (2013), *Matrix Computations*, sections 5.1.2 and 5.2.9.
#[inline(always)]
pub(super) fn triangularise<T: Number, L: Level>(
    level: L,
    array: &mut [T],
    [lead, base]: [usize; 2],
    reach: impl Fn(usize) -> usize,
    triangle: &mut [T],
    count: usize,
) {
    let (width, zero) = (lead + base, T::of(0.0));
    let (array, triangle) = (&mut array[..count * width], &mut triangle[..count * count]);
    each!(level, 0, count, |j| {
        let whole_blocks = reach(j).div_ceil(4) * 4;
        let used = lead + if whole_blocks <= base / 4 * 4 { whole_blocks } else { base };
        let (before, after) = array.split_at_mut((j + 1) * width);
        let own = &before[j * width..j * width + used];
        let square = dot(own, own, [lead, base]);
        // Not a number counts.
        let counts = !square.lt(T::of(f64::MIN_POSITIVE));
        let inverse = T::select(counts, T::of(1.0) / square, zero);
        let length = T::select(counts, square.sqrt(), zero);
        let scale = length * inverse;
        for k in j + 1..count {
            triangle[j * count + k] = zero;
        }
        triangle[j * count + j] = length;
        for i in j + 1..count {
            let row = &mut after[(i - j - 1) * width..(i - j - 1) * width + used];
            let product = dot(own, row, [lead, base]);
            triangle[i * count + j] = product * scale;
            take_times(row, product * inverse, own);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::engine::lanes::Lanes;
    use crate::mathematics::engine::level::{Baseline, Known};

    /// `X Xᵀ` of rows of numbers.
    fn square(rows: &[f64], count: usize) -> Vec<f64> {
        let width = rows.len() / count;
        (0..count * count).map(|at| along(rows, width, at / count, at % count, width)).collect()
    }

    fn triangle<L: Level>(level: L, array: &[f64], shape: [usize; 2], count: usize) -> Vec<f64> {
        let mut out = vec![f64::NAN; count * count];
        triangularise(level, &mut array.to_vec(), shape, |_| shape[1], &mut out, count);
        out
    }

    #[test]
    fn a_triangle_squares_to_the_covariance_of_its_array() {
        let array: Vec<f64> = (0..3 * 7).map(|i| libm::sin(f64::from(7 * i))).collect();
        let cov = square(&array, 3);
        for shape in [[0, 7], [1, 6], [2, 5], [5, 2]] {
            let root = triangle(Baseline, &array, shape, 3);
            assert!(square(&root, 3).iter().zip(&cov).all(|(a, b)| (a - b).abs() < 1e-14), "{shape:?}");
            assert!(root[1] == 0.0 && root[2] == 0.0 && root[5] == 0.0, "{shape:?} {root:?}");
            assert!([0, 4, 8].iter().all(|&at| root[at] > 0.0), "{shape:?} {root:?}");
            assert_eq!(root, triangle(Known::<_, 3, 2>(Baseline), &array, shape, 3));
        }
    }

    #[test]
    fn columns_of_zeros_and_other_lanes_change_no_bit() {
        let (n, m) = (6, 2);
        let of = |row: usize, column: usize| {
            let number = libm::sin((13 * row + 5 * column) as f64);
            if column < m + 1 + row { number } else { 0.0 }
        };
        let array: Vec<f64> = (0..n * (m + n)).map(|at| of(at / (m + n), at % (m + n))).collect();
        let [mut short, mut all] = [vec![f64::NAN; n * n], vec![f64::NAN; n * n]];
        triangularise(Baseline, &mut array.clone(), [m, n], |row| row + 1, &mut short, n);
        triangularise(Baseline, &mut array.clone(), [m, n], |_| n, &mut all, n);
        assert_eq!(short, all);
        let mut lanes: Vec<_> = array.iter().map(|&number| Lanes([number, 0.0, f64::NAN, number])).collect();
        let mut out = vec![Lanes([0.0; 4]); n * n];
        triangularise(Baseline, &mut lanes, [m, n], |row| row + 1, &mut out, n);
        let lane = |lane: usize| out.iter().map(|number| number.lane(lane)).collect::<Vec<_>>();
        assert_eq!([lane(0), lane(1), lane(3)], [all.clone(), vec![0.0; n * n], all]);
    }

    #[test]
    fn a_component_without_variance_keeps_none() {
        let root = triangle(Baseline, &[1.0, -0.7, 0.0, 0.0, 0.3, 1e-170], [0, 2], 3);
        let cov = square(&root, 3);
        assert_eq!([cov[1], cov[4], cov[7]], [0.0; 3]);
        assert!((cov[8] - 0.09).abs() < 1e-15);
    }

    #[test]
    fn a_row_that_is_too_large_to_square_does_not_vanish() {
        for number in [1e200, f64::INFINITY, f64::NAN] {
            let root = triangle(Baseline, &[number, 1.0, 1.0, 1.0], [0, 2], 2);
            assert!(!square(&root, 2).iter().sum::<f64>().is_finite(), "{number}");
        }
    }
}
