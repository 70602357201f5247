//! The noise of a part of a step.

use super::Noise;
use crate::mathematics::linalg::Matrix;

/// The noise of a filter for steps that are shorter than dt: their share of Q, and of λ as a power. It is kept from one step
/// to the next of the same length.
pub(crate) struct Share {
    share: f64,
    noise: Noise,
    silent: Noise,
}

impl Share {
    /// The noise of whole steps, over n components.
    pub(crate) fn new(noise: Noise, n: usize) -> Self {
        let silent = Noise { process: Matrix::zeros(n, n), sensors: Vec::new(), fading: 1.0 };
        Self { share: 1.0, noise, silent }
    }

    /// Takes the noise for a share of a step, from that of a whole one.
    pub(crate) fn set(&mut self, share: f64, whole: &Noise) {
        if share == self.share {
            return;
        }
        self.noise.process.copy_from(&whole.process);
        self.noise.process *= share;
        self.noise.fading = if share == 1.0 { whole.fading } else { libm::pow(whole.fading, share) };
        self.share = share;
    }

    /// The noise of a substep: none before the last.
    pub(crate) fn of(&self, is_last: bool) -> &Noise {
        if is_last { &self.noise } else { &self.silent }
    }
}
