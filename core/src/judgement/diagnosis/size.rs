//! The size of a pattern in the innovations, in the parameters.

use super::case::Case;
use crate::Channel;

/// The lags over which increments count as correlated.
const LAGS: usize = 40;

/// The least number of increments for a size.
const ENOUGH: usize = 4 * LAGS;

/// The parameter that a pattern in the innovations may move furthest, and the standard deviation of its error over that which the
/// filter tells; about 1 where innovations are white and as large as expected. It is an approximation: each parameter is taken by
/// itself.
///
/// An update moves a parameter by `Δ = K e`, and `s = Δ / P` is the score of the log likelihood. Where scores are correlated, the
/// variance of their sum, and with it that of the estimate, is larger by
///
/// ```text
/// f² = NIS/m (1 + 2 Σ (1 - l/(L + 1)) ρ_l),  ρ_l the correlation of s at lag l = 1 … L
/// ```
///
/// Source: White (1982), Maximum likelihood estimation of misspecified models; Newey and West (1987), A simple, positive
/// semi-definite, heteroskedasticity and autocorrelation consistent covariance matrix. Both in *Econometrica*.
pub(super) fn of_pattern(case: &Case<'_>) -> Option<(Channel, f64)> {
    let (level, _) = case.nis(&case.kept);
    let parameters = case.estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter());
    let sizes = parameters.filter_map(|(place, &channel)| {
        let (means, variances) = (case.estimates.canonical_means(place), case.estimates.variances(place));
        let scores: Vec<f64> = (case.kept_samples().flatten().filter(|&k| k > 0 && variances[k - 1] > 0.0))
            .map(|k| (means[k] - means[k - 1]) / variances[k - 1])
            .collect();
        let at = |lag: usize| scores.iter().zip(scores.get(lag..)?).map(|(a, b)| a * b).reduce(|a, b| a + b);
        let own = at(0).filter(|own| *own > 0.0 && scores.len() >= ENOUGH)?;
        let weight = |lag: usize| 1.0 - lag as f64 / (LAGS + 1) as f64;
        let sum: f64 = (1..=LAGS).map(|lag| weight(lag) * at(lag).unwrap_or(0.0) / own).sum();
        let size = (level * (1.0 + 2.0 * sum).max(0.0)).sqrt();
        size.is_finite().then_some((channel, size))
    });
    sizes.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The size in words, at the end of a sentence.
pub(super) fn in_words((channel, size): (Channel, f64)) -> String {
    format!("{} may be off by about {size:.1}σ", channel.symbol())
}
