//! The filter of some settings.

use crate::mathematics::filter::Way;
use crate::samples::estimator::bounded::{Bounded, Truncation};
use crate::samples::estimator::setup::Setup;
use crate::samples::estimator::{Estimator, Failed, FilterContext, engine, sampled};
use crate::samples::mixture::Mixture;
use crate::samples::mixture::guesses::{self, Guesses};
use crate::samples::mixture::scales::Scales;
use crate::samples::mixture::walk::{self, Walk};
use crate::scenario::Bounds;
use crate::{Channel, FilterError, FilterSettings};

pub(crate) fn estimator(settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    if !settings.bounds.is_empty() {
        let truncation = Truncation::of(settings, context.model(settings).channels());
        let free = FilterSettings { bounds: Bounds::default(), ..settings.clone() };
        return Box::new(Bounded::new(estimator(&free, context), truncation));
    }
    if settings.process_scales > 1 {
        let rule = Scales::new(settings, context);
        let members = rule.members(settings, context.model(settings).channels());
        return Box::new(Mixture::new(&members, rule, |member| single(member, context)));
    }
    if settings.guesses > 1 {
        let members = guesses::members(settings);
        return Box::new(Mixture::new(&members, Guesses::new(members.len()), |member| walking(member, context)));
    }
    walking(settings, context)
}

/// Builds the filter of one guess, or two where its parameters may walk.
fn walking(settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    if settings.walk == 0.0 {
        return single(settings, context);
    }
    let members = walk::members(settings, context);
    let (model, frequency) = (context.model(settings), Channel::NATURAL_FREQUENCY);
    let turn = match model.place(frequency) {
        Some(_) => settings.initial_mean[frequency].abs() * context.dt,
        None => settings.turn(&model, context.dt),
    };
    let rule = Walk::new(if turn > 0.0 { turn } else { context.dt });
    Box::new(Mixture::new(&members, rule, |member| single(member, context)))
}

fn single(settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    match settings.kind.info().way {
        Way::Belief(begin) => sampled::estimator(begin, settings, context),
        Way::Gaussian(_) => match Setup::of(settings, context, (0..context.sensors.len()).collect()) {
            Some(setup) => engine::estimator(&setup, settings),
            None => Box::new(Failed(FilterError::TooLarge)),
        },
    }
}
