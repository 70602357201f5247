//! A filter of any kind over any plant, as its settings say, with its types and sizes erased.

use crate::filter::{
    Belief, Correction, Ensemble, Filter, Linearised, Noise, Particles, Rule, SigmaPoints, SquareRoot,
};
use crate::gaussian::{Gaussian, Matrix, Vector};
use crate::model::Model;
use crate::plant::{PlantKind, Visitor};
use crate::random::{Normal, Purpose};
use crate::{Estimates, FilterError, FilterKind, FilterSettings, PerChannel, Quantity};

/// A filter that can be stepped.
pub(crate) trait Estimator: Send {
    /// Reports the initial belief.
    fn begin(&self, estimates: &mut Estimates);

    /// Predicts from the last sample with its force, updates with this sample's measurements, and reports.
    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        estimates: &mut Estimates,
    ) -> Result<(), FilterError>;
}

/// A filter and what its last measurement told.
struct Followed<P, B, const N: usize> {
    filter: Filter<P, B, N>,
    correction: Correction<N>,
}

impl<P: Model<N>, B: Belief<P, N>, const N: usize> Estimator for Followed<P, B, N> {
    fn begin(&self, estimates: &mut Estimates) {
        let Noise { process, sensors, fading: _ } = self.filter.noise();
        let is_finite = process.sum().is_finite() && sensors.iter().all(|r| r.is_finite());
        if !is_finite || report(&self.filter, &Correction::NOTHING, estimates).is_err() {
            estimates.stop_at(FilterError::TooLarge);
        }
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        estimates: &mut Estimates,
    ) -> Result<(), FilterError> {
        let Self { filter, correction } = self;
        filter.predict(force_before)?;
        filter.update(force, measured, correction)?;
        report(filter, correction, estimates)
    }
}

fn report<P: Model<N>, B: Belief<P, N>, const N: usize>(
    filter: &Filter<P, B, N>,
    correction: &Correction<N>,
    estimates: &mut Estimates,
) -> Result<(), FilterError> {
    let belief = filter.belief().gaussian();
    if filter.model().in_units() {
        // An update has seen to it that the belief is finite, but nothing has yet looked at an initial one.
        if estimates.is_empty() && !belief.is_finite() {
            return Err(FilterError::NotFinite);
        }
        estimates.push(&belief, correction);
    } else {
        let (belief, unit) = filter.model().to_units(&belief);
        let mut correction = correction.clone();
        for gain in &mut correction.gain {
            for i in 0..N {
                gain[i] *= unit[i];
            }
        }
        if !belief.is_finite() || correction.gain.as_flattened().iter().any(|k| !k.is_finite()) {
            return Err(FilterError::NotFinite);
        }
        estimates.push(&belief, &correction);
    }
    if filter.is_adaptive() {
        estimates.note_noise(filter.noise());
    }
    Ok(())
}

/// A filter that has no covariance to draw its sample from, or none that has a root, fails at the first sample.
struct Failed(FilterError);

impl Estimator for Failed {
    fn begin(&self, estimates: &mut Estimates) {
        estimates.stop_at(self.0);
    }

    fn step(&mut self, _: f64, _: f64, _: &[f64], _: &mut Estimates) -> Result<(), FilterError> {
        Err(self.0)
    }
}

/// What a filter is built from besides its settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surroundings<'a> {
    /// The truth's kind, which the filter takes unless it has its own.
    pub(crate) plant: PlantKind,
    /// What each sensor measures.
    pub(crate) sensors: &'a [Quantity],
    /// Time between samples \[s\].
    pub(crate) dt: f64,
    /// Seed of the scenario.
    pub(crate) seed: u64,
    /// The number of the filter's own stream of random numbers, from 0 on.
    pub(crate) stream: usize,
}

/// Builds the filter of some settings.
pub(crate) fn estimator(settings: &FilterSettings, surroundings: Surroundings<'_>) -> Box<dyn Estimator> {
    with_model(settings, surroundings.plant, Build { settings, surroundings })
}

struct Build<'a> {
    settings: &'a FilterSettings,
    surroundings: Surroundings<'a>,
}

impl Visitor for Build<'_> {
    type Output = Box<dyn Estimator>;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Box<dyn Estimator> {
        let Self { settings, surroundings: Surroundings { seed, stream, .. } } = self;
        let belief = initial_belief(&model, settings);
        let normal = || Normal::new(seed, Purpose::Ensemble(stream));
        let size = settings.ensemble_size;
        match settings.kind {
            FilterKind::Kf | FilterKind::Ekf => {
                let belief = Linearised::new(belief, settings.propagation, 1);
                self.filter(model, belief)
            }
            FilterKind::Iekf => {
                let belief = Linearised::new(belief, settings.propagation, settings.iterations);
                self.filter(model, belief)
            }
            FilterKind::Ukf => self.filter(model, SigmaPoints::new(belief, Rule::Unscented)),
            FilterKind::Ckf => self.filter(model, SigmaPoints::new(belief, Rule::Cubature)),
            FilterKind::SrUkf => self.try_filter(model, SquareRoot::new(&belief)),
            FilterKind::Enkf => self.try_filter(model, Ensemble::new(belief, size, normal())),
            FilterKind::Pf => self.try_filter(model, Particles::new(belief, size, normal())),
        }
    }
}

impl Build<'_> {
    fn try_filter<P: Model<N>, B: Belief<P, N> + 'static, const N: usize>(
        &self,
        model: P,
        belief: Result<B, FilterError>,
    ) -> Box<dyn Estimator> {
        match belief {
            Ok(belief) => self.filter(model, belief),
            // At the beginning there is but a diagonal, and what its root may lack is numbers.
            Err(FilterError::NotFinite) => Box::new(Failed(FilterError::TooLarge)),
            Err(error) => Box::new(Failed(error)),
        }
    }

    fn filter<P: Model<N>, B: Belief<P, N> + 'static, const N: usize>(
        &self,
        model: P,
        belief: B,
    ) -> Box<dyn Estimator> {
        let filter = build_filter(model, belief, self.settings, &self.surroundings);
        Box::new(Followed { filter, correction: Correction::NOTHING })
    }
}

/// The filter of some settings, with its types.
pub(crate) fn build_filter<P: Model<N>, B: Belief<P, N>, const N: usize>(
    model: P,
    belief: B,
    settings: &FilterSettings,
    surroundings: &Surroundings<'_>,
) -> Filter<P, B, N> {
    let outputs = surroundings.sensors.iter().map(|&q| model.output(q)).collect();
    let noise = noise(&model, settings);
    Filter::new(model, belief, surroundings.dt, noise, outputs, settings.adaptation)
}

/// Lets a visitor work with the model that a filter with these settings has.
pub(crate) fn with_model<V: Visitor>(settings: &FilterSettings, truth: PlantKind, visitor: V) -> V::Output {
    let kind = settings.plant.unwrap_or(truth);
    let eta = if settings.kind == FilterKind::Kf { 0.0 } else { settings.eta };
    kind.visit_log(eta, settings.log_parameters, visitor)
}

/// The initial belief in the model's state.
pub(crate) fn initial_belief<P: Model<N>, const N: usize>(model: &P, settings: &FilterSettings) -> Gaussian<N> {
    let (mean, unit) = model.to_state(&Vector::from(P::CHANNELS.map(|c| settings.initial_mean[c])));
    Gaussian::independent(mean, &spread::<P, N>(settings, &settings.initial_std).component_mul(&unit))
}

/// Q, R and fading factor in the model's state.
pub(crate) fn noise<P: Model<N>, const N: usize>(model: &P, settings: &FilterSettings) -> Noise<N> {
    let (_, unit) = model.to_state(&Vector::from(P::CHANNELS.map(|c| settings.initial_mean[c])));
    let process = spread::<P, N>(settings, &settings.process_std).component_mul(&unit);
    Noise {
        process: Matrix::from_diagonal(&process.component_mul(&process)),
        sensors: settings.sensor_std.iter().map(|s| s * s).collect(),
        fading: settings.fading,
    }
}

/// Standard deviations of a model's components; the KF knows the parameters, so these have none.
fn spread<P: Model<N>, const N: usize>(settings: &FilterSettings, std: &PerChannel) -> Vector<N> {
    let known = settings.kind == FilterKind::Kf;
    Vector::from(P::CHANNELS.map(|c| if known && c.is_parameter() { 0.0 } else { std[c] }))
}
