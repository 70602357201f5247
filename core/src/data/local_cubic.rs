//! The least-squares cubic through readings near a time.

use nalgebra::{Matrix4, Vector4};

/// What the least-squares cubic through some values changes from a time to one that is `shift` later \[s\]; 0 if they do not
/// determine one. `size` is the time over which they lie, about \[s\].
///
/// A reading that is shifted so keeps its noise as white as it is, which it would not on a curve through the readings. Source:
/// Savitzky and Golay (1964), Smoothing and differentiation of data by simplified least squares procedures.
pub(super) fn change<'a>(readings: impl Iterator<Item = (&'a f64, &'a f64)>, from: f64, shift: f64, size: f64) -> f64 {
    let (mut normal, mut right) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
    for (time, value) in readings {
        let u = (time - from) / size;
        let powers = Vector4::new(1.0, u, u * u, u * u * u);
        normal += powers * powers.transpose();
        right += powers * *value;
    }
    let u = shift / size;
    let powers = Vector4::new(0.0, u, u * u, u * u * u);
    normal.cholesky().map_or(0.0, |factor| factor.solve(&right).dot(&powers))
}
