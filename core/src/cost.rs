//! Estimates of computing time.

use crate::{FilterKind, FilterSettings, InputKind, PlantKind};

/// Limits the time between two checks of the clock; a browser is two to three times slower than this \[ns\].
const CHUNK: f64 = 1e6;

/// Time to simulate one sample of a record, to within a factor of three \[ns\].
pub(crate) const OF_RECORD: f64 = 500.0;

/// Time that a filter takes for one sample on an ordinary processor, by kind and size, to within a factor of three
/// \[ns\]. It affects only the order and the portions of the work, never the results.
pub(crate) fn of_step(settings: &FilterSettings, truth: PlantKind) -> f64 {
    let n = settings.model(truth, InputKind::Force).size() as f64;
    // A matrix product takes n³ multiplications; the rest of a step takes about n².
    let local = 60.0 + 6.0 * n * n + n * n * n;
    let one = match settings.kind {
        kind if kind == FilterKind::IEKF => local * settings.iterations.max(1) as f64,
        kind if kind == FilterKind::UKF || kind == FilterKind::SR_UKF || kind == FilterKind::CKF => 4.0 * local,
        kind if kind == FilterKind::RBPF => settings.ensemble_size.max(1) as f64 * 4.0 * local,
        kind if kind.is_sampled() => settings.ensemble_size.max(1) as f64 * 75.0 * n,
        _ => local,
    };
    one * (settings.substeps.max(1) * settings.guesses.max(1)) as f64
}

impl FilterSettings {
    /// The time that it takes for one sample of a truth of this kind on an ordinary processor, to within a factor of three
    /// \[ns\].
    pub fn time_of_step(&self, truth: PlantKind) -> f64 {
        of_step(self, truth)
    }
}

/// Time that one member of an ensemble takes for one sample where no kernel serves the filter \[ns\]: by the number of its
/// components for a step, and by their square for the sample's covariance and the draws. Measured by `cargo bench --bench measurements -- largest`.
const OF_COMPONENT: f64 = 250.0;
const OF_COVARIANCE: f64 = 12.0;

/// Limits the time for one sample of an ensemble, which nothing divides; a browser is three to four times slower \[ns\].
const LONGEST: f64 = 0.25e9;

/// Limits the members of an ensemble, by its number of components and its steps a sample.
pub(crate) fn largest_ensemble(components: usize, substeps: usize) -> usize {
    let n = components.max(1) as f64;
    (LONGEST / (OF_COMPONENT * n * substeps.max(1) as f64 + OF_COVARIANCE * n * n)) as usize
}

/// The number of samples that a filter computes between two checks of the clock.
pub(crate) fn chunk(step: f64) -> usize {
    (CHUNK / step).clamp(1.0, 1e5) as usize
}
