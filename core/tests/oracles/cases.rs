//! The scenarios of the oracles.

use kalmanscope_core::{Channel, Estimates, FilterKind, FilterSettings, PlantKind, Quantity, Scenario, Sensor, Signal};

use super::textbook::Sample;

/// Parameters off the initial means, sensors for displacement and acceleration, and one filter of a kind.
pub(crate) fn scenario(plant: PlantKind, kind: FilterKind) -> Scenario {
    let mut scenario = Scenario { dt: 0.01, duration: 2.5, ..Scenario::default() };
    scenario.set_plant(plant);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 0.01), Sensor::new(Quantity::ACCELERATION, 0.5)];
    scenario.filters = vec![FilterSettings {
        name: kind.name().to_owned(),
        kind,
        fading: 1.002,
        sensor_std: vec![0.01, 0.5],
        ..FilterSettings::default()
    }];
    scenario
}

/// The largest deviation of some estimates from the textbook's: means and covariances relative to standard deviations,
/// or to the rounding of the mean where these are smaller; NIS and log likelihood relative to themselves or one.
pub(crate) fn deviation(estimates: &Estimates, expected: &[Sample]) -> f64 {
    assert_eq!((estimates.stop(), estimates.len()), (None, expected.len()), "{}", estimates.name());
    let n = estimates.channels().len();
    let mut worst = 0.0_f64;
    for (k, sample) in expected.iter().enumerate() {
        let scale = |i: usize| sample.cov.at(i, i).max(0.0).sqrt().max(1e-6 * sample.mean[i].abs());
        for i in 0..n {
            worst = worst.max(part(estimates.mean(k)[i] - sample.mean[i], scale(i)));
            for j in 0..n {
                worst = worst.max(part(estimates.cov(k)[n * j + i] - sample.cov.at(i, j), scale(i) * scale(j)));
            }
        }
        let pairs = [(estimates.nis()[k], sample.nis), (estimates.log_likelihood(k), sample.log_likelihood)];
        for (found, expected) in pairs {
            assert_eq!(found.is_nan(), expected.is_nan(), "{} at {k}", estimates.name());
            worst = worst.max((found - expected).abs() / expected.abs().max(1.0));
        }
    }
    worst
}

/// `x` relative to a scale, which may be zero.
fn part(x: f64, scale: f64) -> f64 {
    if x == 0.0 { 0.0 } else { (x / scale).abs() }
}
