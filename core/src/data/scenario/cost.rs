//! Estimates of computing time.

use super::Plant;
use crate::{FilterSettings, Scenario};

/// Limits the time between two checks of the clock; a browser is two to three times slower than this \[ns\].
const CHUNK: f64 = 1e6;

/// Time to simulate one sample of a record, to within a factor of three \[ns\].
pub(crate) const OF_RECORD: f64 = 500.0;

/// Time that a filter takes for one sample on an ordinary processor, by kind and size, to within a factor of three
/// \[ns\]. It affects only the order and the portions of the work, never the results.
pub(crate) fn of_step(settings: &FilterSettings, scenario: &Scenario) -> f64 {
    let &Scenario { plant: Plant { kind: truth, .. }, input, dt, .. } = scenario;
    let one = (settings.kind.info().time)(&settings.method(truth), settings.model(truth, input).size());
    let filters = settings.guesses.max(1) * settings.process_scales.max(1) * if settings.walk > 0.0 { 2 } else { 1 };
    one * (settings.steps(truth, input, dt) * filters) as f64
}

impl FilterSettings {
    /// The time that it takes for one sample of a scenario on an ordinary processor, to within a factor of three \[ns\].
    pub fn time_of_step(&self, scenario: &Scenario) -> f64 {
        of_step(self, scenario)
    }
}

/// Time that one member of an ensemble takes for one sample \[ns\]: by the number of its
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FilterKind;
    use crate::mathematics::filter::FilterInfo;

    #[test]
    fn the_kind_of_a_filter_says_its_time() {
        static SLOW: FilterInfo = FilterInfo {
            key: "slow",
            name: "slow",
            description: "takes its time",
            reference: "",
            is_sampled: true,
            has_own_likelihood: false,
            evaluations: |_, _| 1,
            time: |settings, n| 1e6 * (n * settings.iterations) as f64,
            has_propagation: false,
            way: FilterKind::EKF.info().way,
        };
        let of =
            |kind| FilterSettings { kind, guesses: 2, ..FilterSettings::default() }.time_of_step(&Scenario::default());
        assert_eq!(of(FilterKind::new(&SLOW)), 2.0 * 1e6 * 4.0 * 5.0);
        assert!(of(FilterKind::UKF) > of(FilterKind::EKF) && of(FilterKind::PF) > of(FilterKind::UKF));
    }
}
