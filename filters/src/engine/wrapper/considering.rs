//! Components that count but are not estimated.

use super::{Readings, Recursion, Span, Wrapper};
use crate::engine::belief::GaussianBelief;
use crate::engine::dynamics::Dynamics;
use crate::engine::filter::GaussianFilter;
use crate::engine::number::Number;
use crate::engine::update::UpdateResult;

/// A filter that does not estimate some components of its state, but counts their uncertainty.
///
/// ```text
/// K = [Kₓ; 0],  P⁺ = [Pₓₓ - Kₓ S Kₓᵀ   Pₓc - Kₓ (H P)c]
///                   [       ...              Pcc      ]
/// ```
///
/// with the Kₓ of an ordinary update: its other blocks are those of that update, so that only the mean and the covariance of what
/// is considered have to be put back. The sum of the ordinary P⁺ and `Kc S Kcᵀ` is a covariance.
///
/// Fading does not widen these components, since the filter has learnt nothing of them that it could forget. A prediction puts λ on all
/// of P; so P⁻ becomes `D (P⁻ - Q) D + Q`, where D has `1/√λ` in the places of these components, and 1 in all others.
///
/// Source: Schmidt (1966), Application of state-space methods to navigation problems.
pub struct Considering<T> {
    places: Vec<usize>,
    before: GaussianBelief<T>,
}

impl<T: Number> Considering<T> {
    pub fn of<P: Dynamics>(places: Vec<usize>, filter: &GaussianFilter<T, P>) -> Option<Box<dyn Wrapper<T, P>>> {
        let before = filter.belief.clone();
        (!places.is_empty()).then(|| Box::new(Self { places, before }) as _)
    }

    fn take_fading_back(&self, filter: &mut GaussianFilter<T, impl Dynamics>, share: f64) {
        let GaussianFilter { belief, noise, of_share, .. } = filter;
        let noise = of_share.of(share, noise);
        let (n, scale) = (belief.size(), T::of(1.0) / noise.fading.sqrt());
        let is_considered = |i: usize| self.places.contains(&i);
        for j in 0..n {
            for i in j..n {
                let by = match (is_considered(i), is_considered(j)) {
                    (true, true) => scale * scale,
                    (true, false) | (false, true) => scale,
                    (false, false) => continue,
                };
                let q = noise.entry(i, j);
                belief.cov[j * n + i] = (belief.cov[j * n + i] - q) * by + q;
            }
        }
    }
}

impl<T: Number, P: Dynamics> Wrapper<T, P> for Considering<T> {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<'_, T>) {
        inner.predict(span);
        let filter = inner.filter();
        filter.square();
        self.take_fading_back(filter, span.share);
        let rooted = filter.take_root();
        filter.checks.predicted = filter.checks.predicted.and(rooted);
    }

    fn update(&mut self, inner: &mut dyn Recursion<T, P>, readings: Readings<'_, T>) -> UpdateResult<T> {
        let Self { places, before } = self;
        let filter = inner.filter();
        filter.square();
        before.copy_from(&filter.belief);
        let mut result = inner.update(readings);
        let filter = inner.filter();
        let n = before.size();
        for &i in &*places {
            filter.belief.mean[i] = before.mean[i];
            for &j in places.iter().filter(|j| **j <= i) {
                filter.belief.cov[j * n + i] = before.cov[j * n + i];
            }
            filter.update.gain.iter_mut().skip(i).step_by(n).for_each(|gain| *gain = T::of(0.0));
        }
        let rooted = filter.take_root();
        result.holds = result.holds & rooted.holds;
        filter.checks.is_positive = filter.checks.is_positive & rooted.holds;
        result
    }
}
