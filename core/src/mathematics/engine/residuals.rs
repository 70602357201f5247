//! Measurements against the state after an update.

use super::columns::divide;
use super::number::Number;

/// The m measurements of an update, and what was expected of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Innovations<'a, T> {
    /// The place of each measurement's sensor among all sensors.
    pub(crate) sensors: &'a [usize],
    /// e, m numbers.
    pub(crate) innovation: &'a [T],
    /// S, m × m, and its [factor](super::columns::factor).
    pub(crate) innovation_cov: &'a [T],
    pub(crate) factor: &'a [T],
    /// The diagonal of R.
    pub(crate) variances: &'a [T],
}

/// For each measurement, the residual of the linearised sensor and the variance that the state's own uncertainty gives it.
///
/// ```text
/// ε = R S⁻¹ e,  H P⁺ Hᵀ = R - R S⁻¹ R
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Residuals<T> {
    each: Vec<[T; 2]>,
    inverse: Vec<T>,
}

impl<T> Default for Residuals<T> {
    fn default() -> Self {
        Self { each: Vec::new(), inverse: Vec::new() }
    }
}

impl<T: Number> Residuals<T> {
    /// The residuals of an update, in the order of its measurements.
    pub(crate) fn of(&mut self, update: &Innovations<'_, T>) -> &[[T; 2]] {
        let Self { each, inverse } = self;
        let Innovations { innovation, factor, variances, .. } = *update;
        let m = innovation.len();
        inverse.clear();
        inverse.extend((0..m * m).map(|at| T::of(if at % (m + 1) == 0 { 1.0 } else { 0.0 })));
        divide(factor, m, inverse, m);
        each.clear();
        for (row, &r) in variances.iter().enumerate() {
            let mut white = T::of(0.0);
            for (k, &e) in innovation.iter().enumerate() {
                white = white + inverse[k * m + row] * e;
            }
            each.push([r * white, (r - r * r * inverse[row * m + row]).max(T::of(0.0))]);
        }
        each
    }
}
