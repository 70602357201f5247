//! The choice between a tuned kernel and the book. Smoothers have no kernel: they are computed once, for a whole record.

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
    filter::smoother::beliefs(settings, &context).map(Smoother::new)
}
