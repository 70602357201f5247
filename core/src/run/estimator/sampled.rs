//! A filter whose belief is a random sample, or your own, reporting its samples.

use kalmanscope_filters::filter::{Begin, Correction, Filter, FilterError, Gaussian, Noise};
use kalmanscope_filters::linalg::{Matrix, Vector};
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::random::{Normal, Purpose};
use kalmanscope_records::record::Parts;

use super::setup::Beginning;
use super::{Estimator, Failed, FilterContext};
use crate::run::sink::{AssumedNoise, Sample, Sink};
use crate::{FilterSettings, Model};

struct FollowedBelief {
    model: Model,
    filter: Filter,
    correction: Correction,
}

pub(crate) fn estimator(begin: Begin, settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    let Beginning { model, initial, noise, white, .. } = Beginning::of(settings, context);
    let normal = Normal::new(context.seed, Purpose::Ensemble(context.stream));
    let belief = match begin(initial, &settings.method(&context.plant), normal) {
        Ok(belief) => belief,
        // The initial covariance is diagonal: its root can fail only through a number that is not finite.
        Err(FilterError::NotFinite) => return Box::new(Failed(FilterError::TooLarge)),
        Err(error) => return Box::new(Failed(error)),
    };
    let (n, steps) = (model.size(), context.steps(settings));
    let (state, readings) = (model.state.clone(), mapped(&context.sensors, &|sensor| model.reading(*sensor)));
    let filter = Filter::new(state, belief, context.dt, context.hold, noise, readings, settings.adaptation);
    let filter = filter.with_options(steps, white, settings.jump);
    Box::new(FollowedBelief { model, filter, correction: Correction::nothing(n, context.sensors.len()) })
}

impl Estimator for FollowedBelief {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { model, filter, correction } = self;
        let belief = filter.belief.gaussian();
        // An update checks that a belief is finite; nothing has checked the initial one.
        if !filter.noise.is_finite()
            || !belief.is_finite()
            || report((model, filter), correction, sink.wants_prior().then_some(&belief), sink).is_err()
        {
            return Err(FilterError::TooLarge);
        }
        Ok(())
    }

    fn step(&mut self, before: f64, force: f64, measured: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { model, filter, correction } = self;
        filter.predict([before, force])?;
        let prior = sink.wants_prior().then(|| filter.belief.gaussian().into_owned());
        filter.update(force, measured, correction)?;
        report((model, filter), correction, prior.as_ref(), sink)
    }

    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let mut last = vec![f64::NAN; self.correction.innovation.len()];
        let (mut begin, mut end) = (None, 0.0);
        for (part, readings) in parts.iter() {
            (begin, end) = (begin.or(Some(part.forces[0])), part.force);
            last.iter_mut()
                .zip(readings)
                .filter(|(_, reading)| !reading.is_nan())
                .for_each(|(last, reading)| *last = *reading);
        }
        self.step(begin.unwrap_or(end), end, &last, sink)
    }
}

fn report(
    (model, filter): (&Model, &Filter),
    correction: &Correction,
    prior: Option<&Gaussian>,
    sink: &mut dyn Sink,
) -> Result<(), FilterError> {
    let (belief, unit) = in_units(model, &filter.belief.gaussian());
    let prior = prior.map(|prior| in_units(model, prior).0);
    let mut gain = correction.gain.clone();
    gain.column_iter_mut().for_each(|mut column| column.component_mul_assign(&unit));
    if !belief.is_finite() || gain.iter().any(|k| !k.is_finite()) {
        return Err(FilterError::NotFinite);
    }
    let Noise { process, sensors, .. } = &filter.noise;
    let mut process = process.diagonal();
    filter.white.into_iter().for_each(|white| process[white.place] = white.variance);
    let noise = filter.is_adaptive().then(|| AssumedNoise {
        process: process.as_slice(),
        sensors,
        uncertainty: filter.noise_uncertainty(),
        process_scale: [f64::NAN; 2],
    });
    let of = |of: fn(&Gaussian) -> &[f64]| prior.as_ref().map_or(&[][..], of);
    sink.push(&Sample {
        prior_mean: of(|prior| prior.mean.as_slice()),
        prior_cov: of(|prior| prior.cov.as_slice()),
        innovation: correction.innovation.as_slice(),
        innovation_cov: correction.innovation_cov.as_slice(),
        gain: gain.as_slice(),
        nis: correction.nis,
        determinant: correction.determinant,
        log_likelihood: correction.log_likelihood,
        effective_samples: correction.effective_samples,
        noise,
        has_widened: filter.has_widened(),
        ..Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice())
    });
    Ok(())
}

/// A belief over a model's state in the channels' units, to first order, and the size of each component's unit in them.
fn in_units(model: &Model, belief: &Gaussian) -> (Gaussian, Vector) {
    let (mut belief, mut unit) = (belief.clone(), Vector::zeros(belief.size()));
    model.to_units_in_place(belief.mean.as_mut_slice(), unit.as_mut_slice());
    let by: Matrix = &unit * unit.transpose();
    belief.cov.component_mul_assign(&by);
    (belief, unit)
}
