//! Builds a filter from its settings; it reports to its estimates.

use crate::data::record::Parts;
use crate::mathematics::filter::share::Share;
use crate::mathematics::filter::{Belief, Correction, Filter, FilterError, Gaussian, Noise, White};
use crate::mathematics::linalg::{Matrix, Vector, copy, fit_vector};
use crate::mathematics::random::{Normal, Purpose};
use crate::samples::estimator::{Estimator, Failed, FilterContext};
use crate::samples::plucks::Plucks;
use crate::samples::sink::{AssumedNoise, Sample, Sink};
use crate::{Channel, FilterSettings, Model, Values};

/// A filter and the result of its last measurement update.
struct Followed {
    filter: Filter,
    correction: Correction,
    in_units: InUnits,
    /// The belief before the update, if the sink wants it.
    prior: Gaussian,
    /// The noise of parts of steps.
    of_share: Share,
    of_part: Correction,
    weights: Vec<f64>,
    plucks: Plucks,
    dt: f64,
    sample: usize,
}

impl Followed {
    /// Goes on to the next sample.
    fn pass(&mut self) -> Result<(), FilterError> {
        self.sample += 1;
        let [from, to] = [self.sample - 1, self.sample].map(|sample| self.dt * sample as f64);
        self.plucks.pass(&mut self.filter, [from, to])
    }
}

impl Estimator for Followed {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, correction, in_units, .. } = self;
        let mut prior = sink.wants_prior().then(|| filter.belief().gaussian().into_owned());
        // An update checks that a belief is finite; nothing has checked the initial one.
        if !filter.noise().is_finite()
            || !filter.belief().gaussian().is_finite()
            || report(filter, correction, prior.as_mut(), &mut in_units.clone(), sink).is_err()
        {
            return Err(FilterError::TooLarge);
        }
        Ok(())
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        self.pass()?;
        let Self { filter, correction, in_units, prior, .. } = self;
        let wants_prior = sink.wants_prior();
        filter.predict([force_before, force])?;
        if wants_prior {
            prior.copy_from(&filter.belief().gaussian());
        }
        filter.update(force, measured, correction)?;
        report(filter, correction, wants_prior.then_some(prior), in_units, sink)
    }

    /// The belief before the update is that before the last reading.
    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.pass()?;
        let Self { filter, correction, in_units, prior, of_share, of_part, weights, .. } = self;
        let (n, m) = (filter.model().size(), filter.noise().sensors.len());
        let (wants_prior, mut has_prior) = (sink.wants_prior(), false);
        correction.clear(n, m);
        weights.clear();
        weights.resize(filter.weights().len(), f64::NAN);
        for (part, readings) in parts.iter() {
            filter.predict_share(part.share, part.forces, of_share, |_, _, _| Ok(()))?;
            let is_read = readings.iter().any(|reading| !reading.is_nan());
            if is_read && wants_prior {
                prior.copy_from(&filter.belief().gaussian());
                has_prior = true;
            }
            filter.update(part.force, readings, of_part)?;
            if is_read {
                correction.add(of_part);
                for (weight, own) in weights.iter_mut().zip(filter.weights()).filter(|(_, own)| !own.is_nan()) {
                    *weight = *own;
                }
            }
        }
        let belief = filter.belief().gaussian();
        if wants_prior && !has_prior {
            prior.copy_from(&belief);
        }
        let model = filter.model();
        let told = Told { model, belief: &belief, correction, noise: None, weights, has_widened: false };
        push(&told, wants_prior.then_some(prior), in_units, sink)
    }
}

/// Writes the belief, and that before the update if there is one, to the sink in the channels' units. `prior` is
/// converted in place; `in_units` is scratch memory.
pub(crate) fn report(
    filter: &Filter,
    correction: &Correction,
    prior: Option<&mut Gaussian>,
    in_units: &mut InUnits,
    sink: &mut dyn Sink,
) -> Result<(), FilterError> {
    let belief = filter.belief().gaussian();
    let mut process = std::mem::take(&mut in_units.process);
    process.clear();
    let noise = filter.is_adaptive().then(|| {
        let Noise { process: matrix, sensors, .. } = filter.noise();
        process.extend((0..matrix.nrows()).map(|i| matrix[(i, i)]));
        filter.white_force().into_iter().for_each(|white| process[white.place] = white.variance);
        AssumedNoise {
            process: &process,
            sensors,
            uncertainty: filter.noise_uncertainty(),
            process_scale: [f64::NAN; 2],
        }
    });
    let told = Told {
        model: filter.model(),
        belief: &belief,
        correction,
        noise,
        weights: filter.weights(),
        has_widened: filter.has_widened(),
    };
    let pushed = push(&told, prior, in_units, sink);
    in_units.process = process;
    pushed
}

/// What a filter tells of a sample.
pub(crate) struct Told<'a> {
    pub(crate) model: &'a Model,
    /// The belief after the update, over the model's state.
    pub(crate) belief: &'a Gaussian,
    pub(crate) correction: &'a Correction,
    /// The noise of a filter that learns it.
    pub(crate) noise: Option<AssumedNoise<'a>>,
    /// The weights of a filter that weighs its readings.
    pub(crate) weights: &'a [f64],
    pub(crate) has_widened: bool,
}

/// Writes what a filter tells to the sink in the channels' units, as [`report`] does.
pub(crate) fn push(
    told: &Told<'_>,
    mut prior: Option<&mut Gaussian>,
    in_units: &mut InUnits,
    sink: &mut dyn Sink,
) -> Result<(), FilterError> {
    let &Told { model, belief, correction, noise, weights, has_widened } = told;
    let (mut belief, mut gain) = (belief, &correction.gain);
    if !model.in_units() {
        in_units.take(model, belief, gain);
        (belief, gain) = (&in_units.belief, &in_units.gain);
        if !belief.is_finite() || gain.iter().any(|k| !k.is_finite()) {
            return Err(FilterError::NotFinite);
        }
        prior.iter_mut().for_each(|prior| to_units(model, prior, &mut in_units.unit));
    }
    let (prior_mean, prior_cov) =
        prior.as_ref().map_or((&[][..], &[][..]), |prior| (prior.mean.as_slice(), prior.cov.as_slice()));
    sink.push(&Sample {
        mean: belief.mean.as_slice(),
        cov: belief.cov.as_slice(),
        prior_mean,
        prior_cov,
        innovation: correction.innovation.as_slice(),
        innovation_cov: correction.innovation_cov.as_slice(),
        gain: gain.as_slice(),
        earlier: correction.earlier,
        nis: correction.nis,
        determinant: correction.determinant,
        log_likelihood: correction.log_likelihood,
        effective_samples: correction.effective_samples,
        noise,
        weights,
        has_widened,
    });
    Ok(())
}

/// A belief and a gain in the channels' units, to first order.
#[derive(Clone)]
pub(crate) struct InUnits {
    pub(crate) belief: Gaussian,
    gain: Matrix,
    /// The size of each component's unit in its channel's unit.
    unit: Vector,
    /// The diagonal of Q, of a filter that learns it.
    process: Vec<f64>,
}

impl Default for InUnits {
    fn default() -> Self {
        let none = || Matrix::zeros(0, 0);
        Self {
            belief: Gaussian { mean: Vector::zeros(0), cov: none() },
            gain: none(),
            unit: Vector::zeros(0),
            process: Vec::new(),
        }
    }
}

impl InUnits {
    /// Converts a belief over a model's state, and the gain of an update of it.
    pub(crate) fn take(&mut self, model: &Model, from: &Gaussian, from_gain: &Matrix) {
        let Self { belief, gain, unit, .. } = self;
        belief.copy_from(from);
        to_units(model, belief, unit);
        copy(gain, from_gain);
        for mut column in gain.column_iter_mut() {
            column.component_mul_assign(unit);
        }
    }
}

/// Converts a belief over a model's state, to first order. Writes the size of each component's unit, in its channel's
/// unit, to `unit`.
fn to_units(model: &Model, belief: &mut Gaussian, unit: &mut Vector) {
    fit_vector(unit, belief.size());
    model.to_units_in_place(belief.mean.as_mut_slice(), unit.as_mut_slice());
    for (mut column, by) in belief.cov.column_iter_mut().zip(unit.iter()) {
        column.iter_mut().zip(unit.iter()).for_each(|(entry, unit)| *entry *= unit * by);
    }
}

/// Builds the filter of some settings.
pub(crate) fn estimator(settings: &FilterSettings, context: &FilterContext<'_>) -> Box<dyn Estimator> {
    match initial_belief(settings, context).map(|belief| build_filter(belief, settings, context)) {
        Ok(filter) => {
            let filter = if settings.jump { filter.with_jump() } else { filter };
            let correction = Correction::nothing(filter.model().size(), context.sensors.len());
            let prior = filter.belief().gaussian().into_owned();
            let of_share = Share::new(filter.noise().clone(), filter.model().size());
            let (of_part, weights, in_units) = (correction.clone(), Vec::new(), InUnits::default());
            let plucks = Plucks::new(settings, filter.model(), context.start);
            let (dt, sample) = (context.dt, 0);
            Box::new(Followed { filter, correction, in_units, prior, of_share, of_part, weights, plucks, dt, sample })
        }
        // The initial covariance is diagonal: its root can fail only through a number that is not finite.
        Err(FilterError::NotFinite) => Box::new(Failed(FilterError::TooLarge)),
        Err(error) => Box::new(Failed(error)),
    }
}

/// The belief that a filter of some settings begins with.
pub(crate) fn initial_belief(
    settings: &FilterSettings,
    context: &FilterContext<'_>,
) -> Result<Box<dyn Belief>, FilterError> {
    (settings.kind.info().begin)(
        initial_gaussian(&context.model(settings), settings),
        &settings.method(context.plant),
        normal(context),
    )
}

/// The random numbers of a filter.
pub(crate) fn normal(context: &FilterContext<'_>) -> Normal {
    Normal::new(context.seed, Purpose::Ensemble(context.stream))
}

/// Mean and covariance that some settings begin with, in the model's state.
pub(crate) fn initial_gaussian(model: &Model, settings: &FilterSettings) -> Gaussian {
    let (mean, unit) = initial_state(model, settings);
    Gaussian::independent(mean, &spread(model, settings, &settings.initial_std).component_mul(&unit))
}

/// The filter of some settings that begins with this belief.
pub(crate) fn build_filter<B: Belief + ?Sized>(
    belief: Box<B>,
    settings: &FilterSettings,
    context: &FilterContext<'_>,
) -> Filter<B> {
    let model = context.model(settings);
    let (mean, unit) = initial_state(&model, settings);
    let process = spread(&model, settings, &settings.process_std).component_mul(&unit);
    let mut noise = Noise {
        process: Matrix::from_diagonal(&process.component_mul(&process)),
        sensors: settings.sensor_std.iter().map(|s| s * s).collect(),
        fading: settings.fading,
    };
    let white = White::of(&model, settings.process_std[Channel::WHITE_FORCE], context.hold, context.sensors);
    if let Some(white) = white {
        white.add_rest(&model, mean.as_slice(), context.dt, &mut noise.process);
    }
    let filter = Filter::new(model, belief, context.dt, context.hold, noise, context.sensors, settings.adaptation);
    let places: Vec<usize> = settings.consider.iter().filter_map(|channel| filter.model().place(*channel)).collect();
    let filter = filter.with_considered(&places);
    filter.with_substeps(context.steps(settings)).with_white_force(white).with_robust(settings.robust)
}

/// The initial mean as a state, and the size of each channel's unit in the state's unit. For a logarithm that is one
/// over the initial mean. It converts all standard deviations of the settings, including that of the process noise, and
/// stays the same when the estimate moves.
fn initial_state(model: &Model, settings: &FilterSettings) -> (Vector, Vector) {
    let mean: Vec<f64> = model.channels().iter().map(|&c| settings.initial_mean[c]).collect();
    model.to_state(&mean)
}

/// Standard deviations of a model's components; zero for those that the filter knows.
fn spread(model: &Model, settings: &FilterSettings, std: &Values) -> Vector {
    let of = |&channel| if settings.knows(channel) { 0.0 } else { std[channel] };
    Vector::from_iterator(model.size(), model.channels().iter().map(of))
}
