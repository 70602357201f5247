//! The least-squares cubic through readings near a time.

use crate::mathematics::least_squares::NormalEquations;

/// What the least-squares cubic through some values changes from a time to one that is `shift` later \[s\]; 0 if they do not
/// determine one. `size` is the time over which they lie, about \[s\].
///
/// A reading that is shifted so keeps its noise as white as it is, which it would not on a curve through the readings. Source:
/// Savitzky and Golay (1964), Smoothing and differentiation of data by simplified least squares procedures.
pub(super) fn change<'a>(readings: impl Iterator<Item = (&'a f64, &'a f64)>, from: f64, shift: f64, size: f64) -> f64 {
    let mut equations = NormalEquations::<4>::new();
    for (time, value) in readings {
        let u = (time - from) / size;
        equations.add([1.0, u, u * u, u * u * u], *value, 1.0);
    }
    let u = shift / size;
    equations.solution().map_or(0.0, |[_, first, second, third]| u * (first + u * (second + u * third)))
}
