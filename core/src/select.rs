//! The choice between the tuned kernels and the reference filters.

use crate::estimator::{Estimator, FilterContext};
use crate::smoother::Smoother;
use crate::{FilterSettings, filter, kernel};

/// Builds the filter of some settings: a tuned kernel where there is one, else the reference filter.
pub(crate) fn estimator(settings: &FilterSettings, context: FilterContext<'_>) -> Box<dyn Estimator> {
    kernel::estimator::estimator(settings, context).unwrap_or_else(|| filter::estimator::estimator(settings, &context))
}

/// The smoother of a filter, if its kind has one.
pub(crate) fn smoother(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Smoother> {
    if settings.kind.is_sampled() {
        return None;
    }
    let tuned = kernel::smoother::beliefs(settings, context);
    tuned.or_else(|| filter::smoother::beliefs(settings, &context)).map(Smoother::new)
}
