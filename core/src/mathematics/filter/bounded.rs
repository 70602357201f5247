//! Bounds of some components of the state.
//!
//! ```text
//! projection   y ← y + k (b - yᵢ),  k = P eᵢ / Pᵢᵢ,  where yᵢ is beyond the end b
//! truncation   y ← y + k (μ - yᵢ),  P ← P + k (s² - Pᵢᵢ) kᵀ
//! ```
//!
//! with the mean μ and the standard deviation s of N(yᵢ, Pᵢᵢ) between the ends. The filter goes on from the projection: a step from
//! beyond an end would be one of an impossible oscillator. What it tells is truncated. It does not go on from that: the same end
//! would count anew at each sample, and the band would be too narrow.
//!
//! Source: Simon (2010), Kalman filtering with state constraints: a survey of linear and nonlinear algorithms, sections 2.4 and 2.5.

use super::{Belief, FilterError, Gaussian};
use crate::mathematics::linalg::Vector;
use crate::mathematics::truncated_normal::truncated;

/// Places with their ends, the first below the second.
#[derive(Clone, Debug)]
pub(crate) struct Bounded {
    places: Vec<(usize, [f64; 2])>,
    after: Gaussian,
}

impl Bounded {
    /// For some places; `None` for none.
    pub(super) fn new(places: &[(usize, [f64; 2])]) -> Option<Self> {
        let nothing = Gaussian { mean: super::Vector::zeros(0), cov: super::Matrix::zeros(0, 0) };
        (!places.is_empty()).then(|| Self { places: places.to_vec(), after: nothing })
    }

    /// Brings a mean back that is beyond an end, along what the filter knows of the others.
    ///
    /// # Errors
    /// Those of [`Belief::replace`].
    pub(super) fn project<B: Belief + ?Sized>(&mut self, belief: &mut B) -> Result<(), FilterError> {
        let Self { places, after } = self;
        let is_beyond = |mean: &Vector| places.iter().any(|&(i, [least, most])| !(least..=most).contains(&mean[i]));
        if !is_beyond(&belief.gaussian().mean) {
            return Ok(());
        }
        after.copy_from(&belief.gaussian());
        for &(i, [least, most]) in &*places {
            let by = after.mean[i].clamp(least, most) - after.mean[i];
            move_along(after, i, by);
        }
        // An end that a later one has moved again.
        places.iter().for_each(|&(i, [least, most])| after.mean[i] = after.mean[i].clamp(least, most));
        belief.replace(after).map(|_| ())
    }

    /// The moments of a belief between the ends, one component after the other.
    pub(crate) fn truncate(&self, belief: &mut Gaussian) {
        for &(i, ends) in &self.places {
            let variance = belief.cov[(i, i)];
            if !(variance > 0.0 && belief.mean[i].is_finite()) {
                continue;
            }
            let [mean, std] = truncated([belief.mean[i], variance.sqrt()], ends);
            let along = belief.cov.column(i) / variance;
            let by = mean - belief.mean[i];
            move_along(belief, i, by);
            belief.mean[i] = mean;
            belief.cov += (std * std - variance) * &along * along.transpose();
        }
    }
}

/// Moves a component, and all others by what is known of them together.
fn move_along(belief: &mut Gaussian, i: usize, by: f64) {
    let variance = belief.cov[(i, i)];
    if by == 0.0 {
        return;
    }
    if variance > 0.0 {
        let along = belief.cov.column(i) * (by / variance);
        belief.mean += along;
    } else {
        belief.mean[i] += by;
    }
}
