//! The size of a pattern in the innovations, in the parameters.

use std::f64::consts::TAU;

use super::case::Case;
use crate::Channel;

/// Scores count as correlated over this many samples, or over a swing if that is longer.
const LEAST: usize = 40;

/// The least number of samples for a size, over those of a window.
const ENOUGH: usize = 4;

/// The parameter that a pattern in the innovations may move furthest, and the standard deviation of its error over that which the
/// filter tells; about 1 where innovations are white and as large as expected. It is an approximation: each parameter is taken by
/// itself.
///
/// An update moves a parameter by `Δ = K e`, and `s = Δ / P` is the score of the log likelihood. Where scores are correlated, the
/// variance of their sum, and with it that of the estimate, is larger by
///
/// ```text
/// f² = NIS/m (1 + 2 Σ (1 - l/L) ρ_l) = NIS/m ⟨(s_k + … + s_{k+L-1})²⟩ / (L ⟨s²⟩),  ρ_l the correlation of s at lag l < L
/// ```
///
/// with the mean over all windows of L samples in which the filter is not forgiven.
///
/// Source: White (1982), Maximum likelihood estimation of misspecified models; Newey and West (1987), A simple, positive
/// semi-definite, heteroskedasticity and autocorrelation consistent covariance matrix. Both in *Econometrica*.
pub(super) fn of_pattern(case: &Case<'_>) -> Option<(Channel, f64)> {
    let (level, _) = case.nis(&case.kept);
    let window = swing(case).map_or(LEAST, |swing| LEAST.max(swing));
    let ranges = case.ranges(|part| case.kept[part]);
    let parameters = case.estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter());
    let sizes = parameters.filter_map(|(place, &channel)| {
        let (means, variances) = (case.estimates.canonical_means(place), case.estimates.variances(place));
        let [mut squares, mut sums] = [(0.0, 0); 2];
        for range in &ranges {
            let mut totals = vec![0.0];
            for k in range.clone().filter(|&k| k > 0 && variances[k - 1] > 0.0) {
                let score = (means[k] - means[k - 1]) / variances[k - 1];
                squares = (squares.0 + score * score, squares.1 + 1);
                totals.push(totals[totals.len() - 1] + score);
            }
            let ends = totals.iter().skip(window);
            sums = ends.zip(&totals).fold(sums, |(sum, count), (end, begin)| {
                let one = end - begin;
                (sum + one * one, count + 1)
            });
        }
        let mean = |(sum, count): (f64, usize)| sum / count as f64;
        let size = (level * mean(sums) / (window as f64 * mean(squares))).sqrt();
        (size.is_finite() && squares.1 >= ENOUGH * window).then_some((channel, size))
    });
    sizes.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The samples of a swing, by the last estimate of ωₙ.
fn swing(case: &Case<'_>) -> Option<usize> {
    let place = case.estimates.place(Channel::NATURAL_FREQUENCY)?;
    let turn = case.estimates.canonical_mean(case.last()?, place).abs() * case.record.dt();
    (turn > 0.0).then(|| (TAU / turn).min(case.len() as f64) as usize)
}

/// The size in words, at the end of a sentence.
pub(super) fn in_words((channel, size): (Channel, f64)) -> String {
    format!("{} may be off by about {size:.1}σ", channel.symbol())
}
