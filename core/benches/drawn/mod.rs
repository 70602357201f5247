//! What situations drawn at random have in common.

use std::sync::Arc;

use kalmanscope_core::filter::Normal;
use kalmanscope_core::{Channel, FilterSettings, Force, Record};

/// Numbers at random.
pub(crate) struct Draw(Normal);

impl Draw {
    /// A stream of its own for each seed and kind of situation.
    pub(crate) fn new(seed: u64, kind: u64) -> Self {
        Self(Normal::from_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ kind))
    }

    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.uniform()
    }

    pub(crate) fn uniform(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    pub(crate) fn log_uniform(&mut self, from: f64, to: f64) -> f64 {
        libm::exp(self.uniform(libm::log(from), libm::log(to)))
    }

    pub(crate) fn choice<T: Copy>(&mut self, of: &[T]) -> T {
        of[((self.unit() * of.len() as f64) as usize).min(of.len() - 1)]
    }

    pub(crate) fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    pub(crate) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    pub(crate) fn normal(&mut self) -> f64 {
        self.0.sample()
    }

    /// Lets a filter begin with beliefs of mean and standard deviation, from which the means of parameters are off at random.
    pub(crate) fn guess(&mut self, filter: &mut FilterSettings, beliefs: &[(Channel, f64, f64)]) {
        for &(channel, mean, std) in beliefs {
            filter.initial_std[channel] = std;
            filter.initial_mean[channel] =
                if channel.is_parameter() { mean + std * self.normal().clamp(-2.0, 2.0) } else { mean };
            if channel.is_parameter() {
                filter.process_std[channel] = 1e-5 * mean;
            }
        }
    }
}

/// The density of a force \[m²/s³\] about ωₙ, as if it were white noise.
pub(crate) fn power(force: &Force, wn: f64, dt: f64) -> f64 {
    match *force {
        Force::WhiteNoise { std } => std * std * dt,
        Force::Chirp { amplitude, .. } => amplitude * amplitude / (5.4 * wn) * std::f64::consts::PI,
        Force::ImpulseTrain { impulse, period } => impulse * impulse / period,
        _ => 0.0,
    }
}

/// The same record without a word on the truth.
pub(crate) fn without_truth(record: &Record) -> Arc<Record> {
    Arc::new(record.clone().without_truth())
}
