//! The recent mean of the force.

use kalmanscope_core::Record;

/// Duration over which the arrow averages the force, because an arrow that followed white noise would flicker \[s\].
pub(super) const SPELL: f64 = 0.1;

/// The number of samples in a [`SPELL`], at least one.
pub(super) fn window(record: &Record) -> usize {
    (SPELL / record.dt()).round().clamp(1.0, 1e5) as usize
}

/// The mean force over mass within the [`SPELL`] that ends with sample `k` \[m/s²\].
pub(super) fn recent(record: &Record, k: usize) -> f64 {
    let first = (k + 1).saturating_sub(window(record));
    let force = record.input().get(first..=k).unwrap_or_default();
    force.iter().sum::<f64>() / window(record) as f64
}
