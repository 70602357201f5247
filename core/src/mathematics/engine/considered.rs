//! Components of the state that count but are not estimated.
//!
//! ```text
//! K = [Kₓ; 0],  P⁺ = [Pₓₓ - Kₓ S Kₓᵀ   Pₓc - Kₓ (H P)c]
//!                   [       ...              Pcc      ]
//! ```
//!
//! with the Kₓ of an ordinary update: its other blocks are those of that update, so that only the mean and the covariance of what
//! is considered have to be put back. The sum of the ordinary P⁺ and `Kc S Kcᵀ` is a covariance.
//!
//! Fading does not widen these components, since the filter has learnt nothing of them that it could forget. A prediction puts λ on all
//! of P; so P⁻ becomes `D (P⁻ - Q) D + Q`, where D has `1/√λ` in the places of these components, and 1 in all others.
//!
//! Source: Schmidt (1966), Application of state-space methods to navigation problems.

use super::belief::{Belief, Noise};
use super::number::Number;

/// The places of such components, with what is known of all components before an update.
#[derive(Clone, Debug)]
pub(super) struct Considered<T> {
    places: Vec<usize>,
    before: Belief<T>,
}

impl<T: Number> Considered<T> {
    /// For some places; `None` for none.
    pub(super) fn new(places: &[usize], belief: &Belief<T>) -> Option<Box<Self>> {
        (!places.is_empty()).then(|| Box::new(Self { places: places.to_vec(), before: belief.clone() }))
    }

    /// Takes the fading of a prediction with this noise away.
    pub(super) fn keep(&self, belief: &mut Belief<T>, noise: &Noise<T>) {
        let (n, scale) = (belief.size(), T::of(1.0) / noise.fading.sqrt());
        let is_considered = |i: usize| self.places.contains(&i);
        for j in 0..n {
            for i in j..n {
                let by = match (is_considered(i), is_considered(j)) {
                    (true, true) => scale * scale,
                    (true, false) | (false, true) => scale,
                    (false, false) => continue,
                };
                let q = if !noise.matrix.is_empty() {
                    noise.matrix[j * n + i]
                } else if i == j {
                    noise.process[i]
                } else {
                    T::of(0.0)
                };
                belief.cov[j * n + i] = (belief.cov[j * n + i] - q) * by + q;
            }
        }
    }

    /// Takes in a belief before an update.
    pub(super) fn store(&mut self, belief: &Belief<T>) {
        self.before.copy_from(belief);
    }

    /// Puts back what the update has changed of the components, and makes their gain zero.
    pub(super) fn restore(&self, belief: &mut Belief<T>, gain: &mut [T]) {
        let n = belief.size();
        for &i in &self.places {
            belief.mean[i] = self.before.mean[i];
            for &j in self.places.iter().filter(|j| **j <= i) {
                belief.cov[j * n + i] = self.before.cov[j * n + i];
            }
            gain.iter_mut().skip(i).step_by(n).for_each(|gain| *gain = T::of(0.0));
        }
    }
}
