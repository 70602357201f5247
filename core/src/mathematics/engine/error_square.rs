//! The normalised estimation error squared.

use super::columns::entry;
use super::level::{Level, each};
use super::number::{Mask, Number};

/// Limits the rounding error of an estimate over a long record, relative to its largest value.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

#[derive(Clone, Debug, Default)]
pub(crate) struct ErrorSquare<T> {
    pub(crate) places: Vec<usize>,
    pub(crate) errors: Vec<T>,
    /// The largest absolute mean of each channel so far; the rounding error of an estimate is relative to it.
    sizes: Vec<T>,
    variances: Vec<T>,
    factor: Vec<T>,
}

impl<T: Number> ErrorSquare<T> {
    pub(crate) fn new(places: Vec<usize>) -> Self {
        let (count, zeros) = (places.len(), |count: usize| vec![T::of(0.0); count]);
        Self {
            places,
            errors: zeros(count),
            sizes: zeros(count),
            variances: zeros(count),
            factor: zeros(count * count),
        }
    }

    /// `eᵀ P⁻¹ e` by the factor `P = L D Lᵀ` over the components of positive variance, and their number: zero where there is
    /// none, P is not positive definite or e is not a number. A variance is at least that of the rounding error.
    ///
    /// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.1.2.
    ///
    /// The places may be those of the `WHOLE` state.
    #[inline(always)]
    pub(crate) fn of<L: Level, const WHOLE: bool>(&mut self, level: L, [mean, cov]: [&[T]; 2]) -> (T, T) {
        let Self { places, errors, sizes, variances, factor } = self;
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let n = level.size(mean.len());
        let count = if WHOLE { n } else { places.len() };
        let (mean, cov) = (&mean[..n], &cov[..n * n]);
        let (errors, sizes) = (&mut errors[..count], &mut sizes[..count]);
        let (variances, factor) = (&mut variances[..count], &mut factor[..count * count]);
        for j in 0..count {
            let place = |at: usize| if WHOLE { at } else { places[at] };
            for i in j..count {
                factor[j * count + i] = entry(cov, n, place(i), place(j));
            }
            sizes[j] = sizes[j].max(mean[place(j)].abs());
            let floor = sizes[j] * sizes[j] * (ROUNDING * ROUNDING);
            let variance = factor[j * count + j];
            variances[j] = T::select(zero.lt(variance), variance + floor, zero);
            factor[j * count + j] = variances[j];
        }
        let (mut sum, mut degrees, mut is_positive) = (zero, zero, T::Mask::of(true));
        each!(level, 0, count, |j| {
            let (variance, pivot) = (variances[j], factor[j * count + j]);
            let counts = zero.lt(variance);
            is_positive = is_positive & (!counts | (variance * (4.0 * count as f64 * f64::EPSILON)).lt(pivot));
            let inverse = T::select(counts, one / pivot, zero);
            degrees = degrees + T::select(counts, one, zero);
            sum = sum + errors[j] * errors[j] * inverse;
            for k in j + 1..count {
                let share = factor[j * count + k] * inverse;
                errors[k] = errors[k] - share * errors[j];
                for i in k..count {
                    factor[k * count + i] = factor[k * count + i] - factor[j * count + i] * share;
                }
            }
        });
        let counts = is_positive & sum.is_number();
        (sum, T::select(counts, degrees, zero))
    }
}
