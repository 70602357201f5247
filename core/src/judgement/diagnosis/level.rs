//! Many tests at once.

use super::evidence::Evidence;

/// Limits the probability that any test rejects a consistent filter.
const LEVEL: f64 = 1e-4;

/// Decides whether each piece of evidence counts: its effect matters, and its p-value is below the level for all tests
/// together.
///
/// ```text
/// p₍ᵢ₎ ≤ α / (m - i + 1)  for the i-th smallest of m p-values and all before it
/// ```
///
/// Source: Holm (1979), A simple sequentially rejective multiple test procedure, *Scandinavian Journal of Statistics* 6.
pub(crate) fn decide(evidence: &mut [Evidence]) {
    let mut order: Vec<usize> = (0..evidence.len()).collect();
    order.sort_by(|&a, &b| evidence[a].p_value.total_cmp(&evidence[b].p_value));
    for (rank, &place) in order.iter().enumerate() {
        let one = &mut evidence[place];
        if one.p_value > LEVEL / (order.len() - rank) as f64 {
            break;
        }
        one.counts = one.effect >= 1.0;
    }
}
