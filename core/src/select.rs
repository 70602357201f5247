//! The choice between a tuned kernel, the engine and the book. Smoothers have no kernel: one pass over a record is enough.

use crate::engine::{self, Setup};
use crate::estimator::{Estimator, FilterContext};
use crate::guesses::{Guesses, members};
use crate::smoother::Smoother;
use crate::{FilterSettings, filter, kernel};

/// Builds the filter of some settings, or those of its guesses side by side.
pub(crate) fn estimator(settings: &FilterSettings, context: FilterContext<'_>) -> Box<dyn Estimator> {
    if settings.guesses > 1 {
        return Box::new(Guesses::new(members(settings).iter().map(|member| single(member, context))));
    }
    single(settings, context)
}

/// Builds the filter of one guess: a tuned kernel where there is one, else the engine's, else that of the book.
fn single(settings: &FilterSettings, context: FilterContext<'_>) -> Box<dyn Estimator> {
    let kernel = if settings.substeps == 1 { kernel::estimator::estimator(settings, context) } else { None };
    kernel.or_else(|| of_engine(settings, &context)).unwrap_or_else(|| filter::estimator::estimator(settings, &context))
}

/// The engine's filter, if it has all that the settings ask for.
fn of_engine(settings: &FilterSettings, context: &FilterContext<'_>) -> Option<Box<dyn Estimator>> {
    let sensors = context.sensors.len();
    let setup = Setup::of(settings, context, (0..sensors).collect())?;
    Some(engine::estimator::estimator(&setup, sensors))
}

/// The smoother of a filter, if its kind has one.
pub(crate) fn smoother(settings: &FilterSettings, context: FilterContext<'_>) -> Option<Smoother> {
    if settings.kind.is_sampled() {
        return None;
    }
    filter::smoother::beliefs(settings, &context).map(|beliefs| Smoother::new(beliefs, settings.input_delay))
}
