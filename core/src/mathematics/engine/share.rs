//! The noise of a share of a step.

use super::belief::Noise;
use super::number::Number;

/// The process noise of steps that are shorter than dt: their share of Q, and of λ as a power. It is kept from one step to the next of
/// the same length.
#[derive(Clone, Debug)]
pub(super) struct Share<T> {
    share: f64,
    noise: Noise<T>,
}

impl<T: Number> Share<T> {
    /// For filters with this noise.
    pub(super) fn new(whole: &Noise<T>) -> Self {
        Self { share: 1.0, noise: Noise { sensors: Vec::new(), ..whole.clone() } }
    }

    /// The noise of a share of a step, from that of a whole one.
    #[inline(always)]
    pub(super) fn of<'a>(&'a mut self, share: f64, whole: &'a Noise<T>) -> &'a Noise<T> {
        if share == 1.0 {
            return whole;
        }
        if share != self.share {
            self.take(share, whole);
        }
        &self.noise
    }

    #[inline(never)]
    fn take(&mut self, share: f64, whole: &Noise<T>) {
        let Noise { process, matrix, fading, .. } = &mut self.noise;
        for (own, whole) in process.iter_mut().zip(&whole.process).chain(matrix.iter_mut().zip(&whole.matrix)) {
            *own = *whole * share;
        }
        *fading = T::from_lanes(|lane| libm::pow(whole.fading.lane(lane), share));
        self.share = share;
    }
}
