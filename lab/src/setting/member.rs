//! The numbers of a filter that can be set.

use kalmanscope_core::scenario::Values;
use kalmanscope_core::{Channel, FilterSettings};

/// A number of a filter, or a factor on a table of them.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Member {
    Fading,
    Eta,
    InputDelay,
    EnsembleSize,
    Iterations,
    SensorStd(usize),
    InitialMean(Channel),
    InitialStd(Channel),
    ProcessStd(Channel),
    Factor(Stds, Vec<FilterSettings>),
}

/// A table of standard deviations that a factor multiplies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stds {
    Sensor,
    Initial,
    Process,
}

impl Member {
    pub(super) fn get(&self, filter: &FilterSettings) -> f64 {
        match self {
            Self::Fading => filter.fading,
            Self::Eta => filter.eta,
            Self::InputDelay => f64::from(filter.input_delay),
            Self::EnsembleSize => filter.ensemble_size as f64,
            Self::Iterations => filter.iterations as f64,
            Self::SensorStd(sensor) => filter.sensor_std.get(*sensor).copied().unwrap_or(f64::NAN),
            Self::InitialMean(channel) => filter.initial_mean[*channel],
            Self::InitialStd(channel) => filter.initial_std[*channel],
            Self::ProcessStd(channel) => filter.process_std[*channel],
            Self::Factor(table, bases) => bases.first().map_or(f64::NAN, |base| table.factor(base, filter)),
        }
    }

    pub(super) fn set(&self, filter: &mut FilterSettings, nth: usize, value: f64) {
        let whole = libm::round(value);
        match self {
            Self::Fading => filter.fading = value,
            Self::Eta => filter.eta = value,
            Self::InputDelay => filter.input_delay = whole as i32,
            Self::EnsembleSize => filter.ensemble_size = whole as usize,
            Self::Iterations => filter.iterations = whole as usize,
            Self::SensorStd(sensor) => {
                if let Some(std) = filter.sensor_std.get_mut(*sensor) {
                    *std = value;
                }
            }
            Self::InitialMean(channel) => filter.initial_mean[*channel] = value,
            Self::InitialStd(channel) => filter.initial_std[*channel] = value,
            Self::ProcessStd(channel) => filter.process_std[*channel] = value,
            Self::Factor(table, bases) => {
                if let Some(base) = bases.get(nth) {
                    table.scale(base, filter, value);
                }
            }
        }
    }
}

impl Stds {
    /// The numbers of a filter, sensors or set channels.
    fn values(self, filter: &FilterSettings) -> Vec<f64> {
        match self {
            Self::Sensor => filter.sensor_std.clone(),
            Self::Initial => filter.initial_std.iter().map(|(_, std)| std).collect(),
            Self::Process => filter.process_std.iter().map(|(_, std)| std).collect(),
        }
    }

    /// The common factor of a filter's numbers over those of its base; NaN where they do not have one.
    fn factor(self, base: &FilterSettings, filter: &FilterSettings) -> f64 {
        let (base, now) = (self.values(base), self.values(filter));
        let at = base.iter().position(|value| *value > 0.0);
        let Some(factor) = at.and_then(|at| Some(now.get(at)? / base[at])) else { return f64::NAN };
        let is_common = |(base, now): (&f64, &f64)| (now - factor * base).abs() <= 1e-9 * now.abs();
        if base.len() == now.len() && base.iter().zip(&now).all(is_common) { factor } else { f64::NAN }
    }

    fn scale(self, base: &FilterSettings, filter: &mut FilterSettings, factor: f64) {
        let scaled = |values: &mut Values, base: &Values| {
            for (channel, std) in base.iter() {
                values[channel] = factor * std;
            }
        };
        match self {
            Self::Sensor => filter.sensor_std = base.sensor_std.iter().map(|std| factor * std).collect(),
            Self::Initial => scaled(&mut filter.initial_std, &base.initial_std),
            Self::Process => scaled(&mut filter.process_std, &base.process_std),
        }
    }
}
