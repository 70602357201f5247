//! The choice between a tuned kernel and the book.

use crate::estimator::{Estimator, FilterContext};
use crate::smoother::Smoother;
use crate::{FilterSettings, filter, kernel};

/// Builds the filter of some settings: a tuned kernel where there is one, else the book.
pub(crate) fn estimator(settings: &FilterSettings, context: FilterContext<'_>) -> Box<dyn Estimator> {
    kernel::estimator::estimator(settings, context).unwrap_or_else(|| filter::estimator::estimator(settings, &context))
}

/// The smoother of a filter, if it can have one.
pub(crate) fn smoother(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Smoother> {
    if settings.kind.is_sampled() {
        return None;
    }
    let tuned = kernel::smoother::beliefs(settings, context);
    tuned
        .or_else(|| filter::smoother::beliefs(settings, &context))
        .map(|beliefs| Smoother::new(beliefs, settings.input_delay))
}
