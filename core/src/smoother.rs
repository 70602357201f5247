//! Estimates with hindsight: the whole record tells of every sample.

use crate::estimator::FilterContext;
use crate::{Estimates, FilterSettings, Record, filter, kernel};

/// Smooths a filter's estimates over the first `samples` of a record: the filter goes forward, the smoother back.
///
/// ```text
/// G = C (P⁻ₖ₊₁)⁻¹,  C = cov(yₖ, y⁻ₖ₊₁)
/// yₖˢ = yₖ + G (yˢₖ₊₁ - y⁻ₖ₊₁),  Pₖˢ = Pₖ + G (Pˢₖ₊₁ - P⁻ₖ₊₁) Gᵀ
/// ```
///
/// `C = P Φᵀ` for the KF, EKF and IEKF, and comes from the sigma points for UKF, SR-UKF and CKF. Sampled filters have no
/// smoother here: they give no estimates. Where the filter stops, the smoother begins with the last sample before.
///
/// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems; Särkkä (2008), Unscented
/// Rauch-Tung-Striebel smoother.
pub(crate) fn smooth(
    settings: &FilterSettings,
    context: FilterContext<'_>,
    record: &Record,
    samples: usize,
    estimates: &mut Estimates,
) {
    if samples > 0
        && !settings.kind.is_sampled()
        && !kernel::smoother::smooth(settings, context, record, samples, estimates)
    {
        filter::smoother::smooth(settings, &context, record, samples, estimates);
    }
}
