//! Numbers at random.

use kalmanscope_core::filter::Normal;
use kalmanscope_core::{Channel, FilterSettings, Force};

pub(super) struct Draw(Normal);

impl Draw {
    pub(super) fn new(seed: u64, kind: u64) -> Self {
        Self(Normal::from_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ kind))
    }

    /// From 0 to 1.
    pub(super) fn unit(&mut self) -> f64 {
        self.0.uniform()
    }

    pub(super) fn uniform(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    pub(super) fn log_uniform(&mut self, from: f64, to: f64) -> f64 {
        libm::exp(self.uniform(libm::log(from), libm::log(to)))
    }

    pub(super) fn choice<T: Copy>(&mut self, of: &[T]) -> T {
        of[((self.unit() * of.len() as f64) as usize).min(of.len() - 1)]
    }

    pub(super) fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    pub(super) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    pub(super) fn normal(&mut self) -> f64 {
        self.0.sample()
    }

    pub(super) fn guess(&mut self, filter: &mut FilterSettings, beliefs: &[(Channel, f64, f64)]) {
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
pub(super) fn power(force: &Force, wn: f64, dt: f64) -> f64 {
    match *force {
        Force::WhiteNoise { std } => std * std * dt,
        Force::Chirp { amplitude, .. } => amplitude * amplitude / (5.4 * wn) * std::f64::consts::PI,
        Force::ImpulseTrain { impulse, period } => impulse * impulse / period,
        _ => 0.0,
    }
}
