//! Beliefs as a mean and a covariance, predicted and updated by the engine.

use std::borrow::Cow;
use std::sync::Arc;

use super::{Belief, Correction, FilterError, Gaussian, Noise, Observation, Propagation, Rule, Step};
use crate::Model;
use crate::mathematics::engine::design::Method;
use crate::mathematics::engine::single::{Measured, Moments as Slices, Single};
use crate::mathematics::engine::step::Step as EngineStep;
use crate::mathematics::linalg::{Matrix, Vector};
use crate::mathematics::model::{Hold, Reading};

/// A Gaussian that the engine predicts and updates: KF, EKF, IEKF, UKF and CKF.
#[derive(Clone, Debug)]
pub struct Moments {
    belief: Gaussian,
    /// The copy for an update that is done again.
    kept: Option<Gaussian>,
    way: Way,
    engine: Option<Box<Engine>>,
}

/// The way in which a belief moves and is measured.
#[derive(Clone, Copy, Debug)]
enum Way {
    Linearised(Propagation, usize),
    SigmaPoints(Rule),
}

/// The engine's memory, made at the first step.
#[derive(Clone, Debug)]
pub(super) struct Engine {
    single: Single,
    /// The readings of all sensors; `None` for those that the model does not have.
    readings: Arc<[Option<Reading>]>,
    /// The sensors that the model has, by their places among all.
    sensors: Vec<usize>,
    values: Vec<f64>,
    variances: Vec<f64>,
}

impl Moments {
    /// A belief that moves by `propagation` and is measured as if plant and sensors were linear around its mean.
    ///
    /// With `iterations` of more than one the update is a Gauss-Newton descent to the most probable state, each step
    /// linearising the sensors again at the result of the last. It stops after `iterations`, or as soon as no component
    /// moves by more than 1e-6 of its standard deviation. The correction reports innovation, S, NIS and likelihood of
    /// the first iteration, at y⁻; gain and covariance are those of the last.
    ///
    /// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal
    /// Estimation*, section 6.1; Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method.
    pub fn linearised(belief: Gaussian, propagation: Propagation, iterations: usize) -> Self {
        Self { belief, kept: None, way: Way::Linearised(propagation, iterations), engine: None }
    }

    /// A belief that moves and is measured by sigma points, each moved by one Runge-Kutta step, and drawn again for the
    /// measurement.
    pub fn sigma_points(belief: Gaussian, rule: Rule) -> Self {
        Self { belief, kept: None, way: Way::SigmaPoints(rule), engine: None }
    }
}

impl Moments {
    /// The belief.
    pub fn belief(&self) -> &Gaussian {
        &self.belief
    }

    /// Replaces the mean and keeps the covariance.
    pub(crate) fn move_to(&mut self, mean: Vector) {
        self.belief.mean = mean;
    }
}

impl Way {
    /// The engine's method for n components.
    fn method(self, n: usize) -> Method {
        match self {
            Self::Linearised(propagation, iterations) => Method::Linearised(propagation, iterations),
            Self::SigmaPoints(rule) => Method::SigmaPoints(rule.of_size(n)),
        }
    }
}

impl Engine {
    /// The engine of a model, with these sensors if they matter.
    pub(super) fn of<'a>(
        engine: &'a mut Option<Box<Self>>,
        method: Method,
        model: &Model,
        readings: Option<&Arc<[Option<Reading>]>>,
    ) -> &'a mut Self {
        let is_right = |engine: &Self| readings.is_none_or(|readings| Arc::ptr_eq(readings, &engine.readings));
        if !engine.as_deref().is_some_and(is_right) {
            *engine = Some(Box::new(Self::new(method, model, readings.map_or_else(|| Arc::from([]), Arc::clone))));
        }
        engine.get_or_insert_with(|| Box::new(Self::new(method, model, Arc::from([]))))
    }

    fn new(method: Method, model: &Model, readings: Arc<[Option<Reading>]>) -> Self {
        let known = || readings.iter().enumerate().filter_map(|(sensor, reading)| Some((sensor, reading.clone()?)));
        let sensors: Vec<usize> = known().map(|(sensor, _)| sensor).collect();
        let single = Single::new(model, method, known().map(|(_, reading)| reading).collect());
        let (values, variances) = (vec![f64::NAN; sensors.len()], vec![1.0; sensors.len()]);
        Self { single, readings, sensors, values, variances }
    }

    /// The engine, for a belief that moves.
    pub(super) fn single(&mut self) -> &mut Single {
        &mut self.single
    }

    /// Conditions a belief on the measurements of a sample.
    ///
    /// # Errors
    /// Those of [`Single::condition`].
    pub(super) fn condition(
        &mut self,
        belief: Slices<'_>,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let n = belief.mean.len();
        self.take(observation);
        let Self { single, values, variances, .. } = self;
        let measured = Measured { force: observation.force(), values, variances };
        let mut is_first = true;
        single.condition(belief, measured, |told, parts| {
            correction.take(observation, parts, n);
            if std::mem::take(&mut is_first) {
                correction.tell(observation, [told.nis, told.determinant]);
            } else {
                correction.tell_gain(observation);
            }
        })
    }

    /// Takes in the measurements of a sample.
    fn take(&mut self, observation: &Observation) {
        let Self { sensors, values, variances, .. } = self;
        values.fill(f64::NAN);
        let measured = observation.sensors().iter().zip(observation.values()).zip(observation.variances());
        let mut places = sensors.iter().enumerate();
        for ((sensor, value), variance) in measured {
            if let Some((place, _)) = places.by_ref().find(|(_, known)| *known == sensor) {
                (values[place], variances[place]) = (*value, *variance);
            }
        }
    }
}

impl Step {
    /// The engine's form of it.
    pub(super) fn of_engine(self) -> EngineStep<f64> {
        let Self { forces, hold, dt } = self;
        EngineStep { forces, has_slope: hold == Hold::First, dt }
    }
}

impl Gaussian {
    fn slices(&mut self) -> Slices<'_> {
        self.slices_with(&mut [])
    }

    /// The same with a root of the covariance.
    pub(super) fn slices_with<'a>(&'a mut self, root: &'a mut [f64]) -> Slices<'a> {
        Slices { mean: self.mean.as_mut_slice(), cov: self.cov.as_mut_slice(), root }
    }
}

impl Belief for Moments {
    /// `y⁻` and `P⁻`, with the noise
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { belief, way, engine, .. } = self;
        Engine::of(engine, way.method(model.size()), model, None).single.advance(belief.slices(), &step.of_engine())?;
        noise.spread(&mut belief.cov);
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief, way, engine, .. } = self;
        let engine = Engine::of(engine, way.method(model.size()), model, Some(observation.all_readings()));
        engine.condition(belief.slices(), observation, correction)?;
        belief.cov.fill_upper_triangle_with_lower_triangle();
        Ok(())
    }

    fn renew(&mut self, place: usize, variance: f64) -> Result<(), FilterError> {
        self.belief.renew(place, variance);
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }

    fn store(&mut self) -> bool {
        let Self { belief, kept, .. } = self;
        kept.get_or_insert_with(|| belief.clone()).copy_from(belief);
        true
    }

    fn restore(&mut self) {
        if let Some(kept) = &self.kept {
            self.belief.copy_from(kept);
        }
    }

    fn replace(&mut self, gaussian: &Gaussian) -> Result<bool, FilterError> {
        self.belief.copy_from(gaussian);
        Ok(true)
    }

    fn transition(&mut self, model: &Model, step: Step) -> Result<Matrix, FilterError> {
        let Self { belief, way, engine, .. } = self;
        let mut transition = Matrix::zeros(belief.size(), belief.size());
        let single = &mut Engine::of(engine, way.method(model.size()), model, None).single;
        // The mean stays: only Φ is wanted.
        let mut belief = belief.clone();
        single.transition_into(&mut belief.slices(), &step.of_engine(), transition.as_mut_slice())?;
        Ok(transition)
    }
}
