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

use super::{Belief, Correction, FilterError, Gaussian, Noise};

/// The places of such components, with what is known of all components before an update.
#[derive(Clone, Debug)]
pub(super) struct Considered {
    places: Vec<usize>,
    before: Gaussian,
    /// The belief with these components put back.
    after: Gaussian,
}

impl Considered {
    /// For some places; `None` for none.
    pub(super) fn new(places: &[usize]) -> Option<Self> {
        let nothing = Gaussian { mean: super::Vector::zeros(0), cov: super::Matrix::zeros(0, 0) };
        (!places.is_empty()).then(|| Self { places: places.to_vec(), before: nothing.clone(), after: nothing })
    }

    /// Takes the fading of a prediction with this noise away.
    ///
    /// # Errors
    /// Those of [`Belief::replace`].
    pub(super) fn keep<B: Belief + ?Sized>(&mut self, belief: &mut B, noise: &Noise) -> Result<(), FilterError> {
        if noise.fading == 1.0 {
            return Ok(());
        }
        let Self { places, after, .. } = self;
        after.copy_from(&belief.gaussian());
        after.cov.fill_upper_triangle_with_lower_triangle();
        after.cov -= &noise.process;
        let scale = 1.0 / noise.fading.sqrt();
        for &i in &*places {
            after.cov.row_mut(i).scale_mut(scale);
            after.cov.column_mut(i).scale_mut(scale);
        }
        after.cov += &noise.process;
        belief.replace(after).map(|_| ())
    }

    /// Takes in a belief before an update.
    pub(super) fn store(&mut self, belief: &Gaussian) {
        self.before.copy_from(belief);
    }

    /// Puts back what the update has changed of the components.
    ///
    /// # Errors
    /// Those of [`Belief::replace`].
    pub(super) fn restore<B: Belief + ?Sized>(
        &mut self,
        belief: &mut B,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { places, before, after } = self;
        after.copy_from(&belief.gaussian());
        for &i in &*places {
            after.mean[i] = before.mean[i];
            for &j in &*places {
                // After a prediction only the lower triangle counts.
                after.cov[(i, j)] = before.cov[(i.max(j), i.min(j))];
            }
        }
        if belief.replace(after)? {
            places.iter().for_each(|&i| correction.gain.row_mut(i).fill(0.0));
        }
        Ok(())
    }
}
