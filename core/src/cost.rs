//! About how long a filter takes for a sample.

use crate::{FilterKind, FilterSettings, InputKind, PlantKind};

/// How long a filter may go on before someone looks at the time: a browser is two to three times slower than this \[ns\].
const CHUNK: f64 = 1e6;

/// Nanoseconds that a sample of a simulated record takes, to within a factor of three.
pub(crate) const OF_RECORD: f64 = 500.0;

/// Nanoseconds that a filter takes for a sample on an ordinary processor, by kind and size, as far as that can be told
/// beforehand: to within a factor of three. Nothing but when something is computed depends on it.
pub(crate) fn of_step(settings: &FilterSettings, truth: PlantKind) -> f64 {
    let n = settings.model(truth, InputKind::Force).size() as f64;
    // A matrix product takes n³ multiplications, what is beside it n².
    let local = 60.0 + 6.0 * n * n + n * n * n;
    match settings.kind {
        kind if kind == FilterKind::IEKF => local * settings.iterations.max(1) as f64,
        kind if kind == FilterKind::UKF || kind == FilterKind::SR_UKF || kind == FilterKind::CKF => 4.0 * local,
        kind if kind.is_sampled() => settings.ensemble_size.max(1) as f64 * 25.0 * n,
        _ => local,
    }
}

/// How many samples a filter makes before someone looks at the time.
pub(crate) fn chunk(step: f64) -> usize {
    (CHUNK / step).clamp(1.0, 1e5) as usize
}
