//! A filter whose belief is a random sample, or your own, reporting its samples.

use kalmanscope_filters::filter::{Begin, Correction, Filter, FilterError, Gaussian, Noise};
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::random::{Normal, Purpose};
use kalmanscope_records::record::Parts;

use super::engine::push;
use super::setup::Beginning;
use super::update::InUnits;
use super::{Estimator, FilterContext};
use crate::FilterSettings;
use crate::run::forces::Forces;
use crate::run::sink::{AssumedNoise, Sample, Sink};

struct FollowedBelief {
    filter: Filter,
    correction: Correction,
    in_units: Option<Box<InUnits<f64>>>,
}

pub(crate) fn estimator(begin: Begin, settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    let Beginning { model, initial, noise, white, .. } = Beginning::of(settings, context);
    let normal = Normal::new(context.seed, Purpose::Ensemble(context.stream));
    let belief = match begin(initial, &settings.method(&context.plant), normal) {
        Ok(belief) => belief,
        // The initial covariance is diagonal: its root can fail only through a number that is not finite.
        Err(FilterError::NotFinite) => return Box::new(FilterError::TooLarge),
        Err(error) => return Box::new(error),
    };
    let (n, sensors, steps) = (model.size(), context.sensors.len(), context.steps(settings));
    let in_units = InUnits::new(&model.state.logarithms, n, sensors);
    let readings = mapped(&context.sensors, &|sensor| model.reading(*sensor));
    let filter = Filter::new(model.state, belief, context.dt, context.hold, noise, readings, settings.adaptation);
    let filter = filter.with_options(steps, white, settings.jump);
    Box::new(FollowedBelief { filter, correction: Correction::nothing(n, sensors), in_units })
}

impl FollowedBelief {
    /// In the channels' units, to first order.
    fn report(&mut self, prior: Option<&Gaussian>, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, correction, in_units } = self;
        let belief = filter.belief.gaussian();
        if !belief.is_finite() || correction.gain.iter().any(|k| !k.is_finite()) {
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
        let of = |of: fn(&Gaussian) -> &[f64]| prior.map_or(&[][..], of);
        let sample = Sample {
            prior_mean: of(|prior| prior.mean.as_slice()),
            prior_cov: of(|prior| prior.cov.as_slice()),
            innovation: correction.innovation.as_slice(),
            innovation_cov: correction.innovation_cov.as_slice(),
            gain: correction.gain.as_slice(),
            nis: correction.nis,
            determinant: correction.determinant,
            log_likelihood: correction.log_likelihood,
            effective_samples: correction.effective_samples,
            noise,
            has_widened: filter.has_widened(),
            ..Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice())
        };
        push(sample, in_units.as_deref_mut(), sink)
    }
}

impl Estimator for FollowedBelief {
    fn begin(&mut self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        // An update checks that a belief is finite; nothing has checked the initial one.
        if !self.filter.noise.is_finite() {
            return Err(FilterError::TooLarge);
        }
        let prior = sink.wants_prior().then(|| self.filter.belief.gaussian().into_owned());
        self.report(prior.as_ref(), sink).map_err(|_| FilterError::TooLarge)
    }

    fn step(&mut self, force: [f64; 2], forces: &Forces, z: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.filter.predict(forces.over(force))?;
        let prior = sink.wants_prior().then(|| self.filter.belief.gaussian().into_owned());
        self.filter.update(forces.now(force[1]), z, &mut self.correction)?;
        self.report(prior.as_ref(), sink)
    }

    fn step_through(&mut self, parts: &Parts, forces: &Forces, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let mut last = vec![f64::NAN; self.correction.innovation.len()];
        let (mut begin, mut end) = (None, 0.0);
        for (part, readings) in parts.iter() {
            (begin, end) = (begin.or(Some(part.forces[0])), part.force);
            for (last, reading) in last.iter_mut().zip(readings).filter(|(_, reading)| !reading.is_nan()) {
                *last = *reading;
            }
        }
        self.step([begin.unwrap_or(end), end], forces, &last, sink)
    }
}
