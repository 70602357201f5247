//! Tails of distributions, fast enough for a verdict on every frame.

/// The probability that a standard normal number is above `z`. Source: Abramowitz and Stegun (1964), *Handbook of Mathematical
/// Functions*, section 7.1.
pub(crate) fn normal_tail(z: f64) -> f64 {
    0.5 * libm::erfc(z / std::f64::consts::SQRT_2)
}

/// The standard normal number that is as unlikely as a sum of squares with this many degrees of freedom and the mean `level`;
/// to a few percent. Source: Wilson and Hilferty (1931), The distribution of chi-square, *PNAS* 17.
pub(crate) fn chi_squared_score(level: f64, degrees: f64) -> f64 {
    let variance = 2.0 / (9.0 * degrees);
    (libm::cbrt(level) - 1.0 + variance) / variance.sqrt()
}

/// Twice the probability that the mean of the squares is at least as far from 1 as `level`, to the same side.
pub(crate) fn chi_squared_p(level: f64, degrees: f64) -> f64 {
    if level.is_nan() || degrees <= 0.0 {
        return 1.0;
    }
    (2.0 * normal_tail(chi_squared_score(level, degrees).abs())).min(1.0)
}

/// The probability that a normal number is as far from zero as `z`.
pub(crate) fn normal_p(z: f64) -> f64 {
    if z.is_nan() { 1.0 } else { 2.0 * normal_tail(z.abs()) }
}
