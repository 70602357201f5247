//! Tuned versions of the filters in [`crate::mathematics::filter`], for common plants of a size known to the compiler. Tests compare
//! each of them with the reference filters.

mod adaptation;
pub(crate) mod gaussian;
mod kalman;
mod linearised;
pub(crate) mod model;
mod observation;
pub(crate) mod plant;
pub(crate) mod propagation;
mod sigma_points;

use std::borrow::Cow;

use observation::Active;

use crate::mathematics::filter::jump::Jump;
use crate::mathematics::filter::{Adaptation, FilterError};
use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Vector};
use crate::mathematics::kernel::model::{Model, Output};

pub use linearised::Linearised;
pub(crate) use observation::Observation;
pub use sigma_points::SigmaPoints;

/// The most sensors that a kernel serves.
pub const MAX_SENSORS: usize = 4;

/// The noise that a filter ascribes to model and sensors, and how fast it forgets.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise<const N: usize> {
    /// Q, the covariance that each step adds, in the state's units squared.
    pub process: Matrix<N, N>,
    /// Diagonal of R, in the sensors' order and units squared.
    pub sensors: Vec<f64>,
    /// Fading factor λ ≥ 1 on the predicted covariance.
    pub fading: f64,
}

impl<const N: usize> Noise<N> {
    /// Whether every number of Q and R is finite.
    pub(crate) fn is_finite(&self) -> bool {
        let Self { process, sensors, fading: _ } = self;
        process.sum().is_finite() && sensors.iter().all(|r| r.is_finite())
    }
}

/// The effect of one sample of the sensors on the belief. Sensors that were skipped have an innovation of NaN and no gain.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction<const N: usize> {
    /// e = z - h(y⁻), in the sensors' units.
    pub innovation: [f64; MAX_SENSORS],
    /// S, the covariance of e.
    pub innovation_cov: [[f64; MAX_SENSORS]; MAX_SENSORS],
    /// K: for each sensor, the change of each channel per unit of innovation.
    pub gain: [[f64; N]; MAX_SENSORS],
    /// Normalised innovation squared `eᵀ S⁻¹ e`.
    pub nis: f64,
    /// det S over the sensors that were not skipped; zero or infinite where it leaves the range of numbers.
    pub determinant: f64,
}

impl<const N: usize> Correction<N> {
    /// The correction by no measurement at all.
    pub const NOTHING: Self = Self {
        innovation: [f64::NAN; MAX_SENSORS],
        innovation_cov: [[f64::NAN; MAX_SENSORS]; MAX_SENSORS],
        gain: [[0.0; N]; MAX_SENSORS],
        nis: f64::NAN,
        determinant: f64::NAN,
    };

    /// Makes it [`Self::NOTHING`], number by number: cheaper than the copy of a constant.
    #[inline]
    fn clear(&mut self) {
        self.innovation = [f64::NAN; MAX_SENSORS];
        self.innovation_cov = [[f64::NAN; MAX_SENSORS]; MAX_SENSORS];
        self.gain = [[0.0; N]; MAX_SENSORS];
        self.nis = f64::NAN;
        self.determinant = f64::NAN;
    }
}

/// A representation of a filter's belief over the N components of a model's state.
pub trait Belief<P: Model<N>, const N: usize>: Send {
    /// Whether all observations are padded to [`MAX_SENSORS`], as those of three sensors are on a page. It gives the same bits;
    /// tests use it.
    const PADDED: bool;

    /// Carries the belief over one step of `dt` \[s\] in which the force over mass was `force` \[m/s²\], and adds noise:
    /// `P ← λ P + Q`.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the covariance or Q has no root.
    fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError>;

    /// Conditions the belief on measurements and reports in `correction` how.
    ///
    /// # Errors
    /// Any [`FilterError`].
    fn condition<const M: usize>(
        &mut self,
        model: &P,
        observation: &Observation<M>,
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError>;

    /// Mean and covariance.
    fn gaussian(&self) -> Cow<'_, Gaussian<N>>;
}

/// Whether three sensors have an update of their own. It takes less time than a padded one and gives the same bits. A page
/// leaves it out, to be smaller.
const THREE_APART: bool = cfg!(not(target_arch = "wasm32"));

/// A recursive estimator of the N-component state of a model.
#[derive(Clone, Debug)]
pub struct Filter<P, B, const N: usize> {
    model: P,
    belief: B,
    dt: f64,
    noise: Noise<N>,
    outputs: Vec<Option<Output>>,
    adaptation: Adaptation,
    /// The variance of each R that is learnt.
    uncertainty: Vec<f64>,
    jump: Option<Jump>,
}

impl<P: Model<N>, B: Belief<P, N>, const N: usize> Filter<P, B, N> {
    /// A filter at k = 0. `outputs` has the reading of each sensor, if the model has it; `dt` \[s\] is the time between
    /// samples.
    pub fn new(
        model: P,
        belief: B,
        dt: f64,
        noise: Noise<N>,
        outputs: Vec<Option<Output>>,
        adaptation: Adaptation,
    ) -> Self {
        let uncertainty = noise.sensors.iter().map(|r| adaptation.initial_uncertainty(*r)).collect();
        Self { model, belief, dt, noise, outputs, adaptation, uncertainty, jump: None }
    }

    /// The same filter, which widens P once where its innovations grow at once. The belief must be the initial one.
    #[must_use]
    pub(crate) fn with_jump(self) -> Self {
        let initial = self.belief.gaussian().cov.diagonal().as_slice().to_vec();
        Self { jump: Some(Jump::new(initial)), ..self }
    }

    /// The belief after the last predict or update.
    pub fn belief(&self) -> &B {
        &self.belief
    }

    /// The belief, to be replaced.
    pub(crate) fn belief_mut(&mut self) -> &mut B {
        &mut self.belief
    }

    /// The model.
    pub fn model(&self) -> &P {
        &self.model
    }

    /// The number of sensors, with those that the model does not have.
    pub(crate) fn sensors(&self) -> usize {
        self.outputs.len()
    }

    /// The noise that the filter assumes by now.
    pub fn noise(&self) -> &Noise<N> {
        &self.noise
    }

    /// The variance of each R, where the filter learns R; zero elsewhere.
    pub(crate) fn noise_uncertainty(&self) -> &[f64] {
        &self.uncertainty
    }

    /// Whether the filter learns its noise.
    pub(crate) fn is_adaptive(&self) -> bool {
        self.adaptation.is_on()
    }

    /// Whether the last prediction has widened P because the innovations had grown at once.
    pub(crate) fn has_widened(&self) -> bool {
        self.jump.as_ref().is_some_and(Jump::has_widened)
    }

    /// Carries the belief over one step in which the force over mass was `force` \[m/s²\].
    ///
    /// ```text
    /// P⁻ = λ cov(g-step of y) + Q
    /// ```
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where sigma points cannot be drawn,
    /// [`FilterError::UndefinedForce`]. Any other prediction that overflows is found by the update.
    #[inline]
    pub fn predict(&mut self, force: f64) -> Result<(), FilterError> {
        if !force.is_finite() {
            return Err(FilterError::UndefinedForce);
        }
        if let Some(widening) = self.jump.as_mut().and_then(Jump::widening) {
            let mut noise = self.noise.clone();
            widening.enumerate().for_each(|(i, variance)| noise.process[(i, i)] += variance);
            return self.belief.predict(&self.model, force, self.dt, &noise);
        }
        self.belief.predict(&self.model, force, self.dt, &self.noise)
    }

    /// Conditions the belief on one sample of the sensors, while `force` acts, and writes the update to `correction`. A
    /// measurement that is NaN skips its sensor.
    ///
    /// # Errors
    /// [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`] where S is not positive definite;
    /// [`FilterError::IndefiniteCovariance`] where sigma points cannot be drawn or a variance comes out negative;
    /// [`FilterError::NotFinite`] where the belief overflows; [`FilterError::ImpossibleMeasurement`] where the likelihood
    /// does; [`FilterError::InfiniteMeasurement`].
    pub fn update(&mut self, force: f64, measured: &[f64], correction: &mut Correction<N>) -> Result<(), FilterError> {
        correction.clear();
        let mut active = [Active { sensor: 0, output: Output::State(0), variance: 1.0 }; MAX_SENSORS];
        let mut count = 0;
        for (sensor, (&output, &value)) in self.outputs.iter().zip(measured).enumerate() {
            if let Some(output) = output.filter(|_| !value.is_nan()) {
                if value.is_infinite() {
                    return Err(FilterError::InfiniteMeasurement);
                }
                active[count] = Active { sensor, output, variance: self.noise.sensors[sensor] };
                count += 1;
            }
        }
        let [a, b, c, d] = active;
        match count {
            0 => kalman::check(&self.belief.gaussian()),
            _ if B::PADDED => self.condition([a, b, c, d], count, force, measured, correction),
            1 => self.condition([a], count, force, measured, correction),
            2 => self.condition([a, b], count, force, measured, correction),
            3 if THREE_APART => self.condition([a, b, c], count, force, measured, correction),
            _ => self.condition([a, b, c, d], count, force, measured, correction),
        }
    }

    fn condition<const M: usize>(
        &mut self,
        active: [Active; M],
        count: usize,
        force: f64,
        measured: &[f64],
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let value = |row: usize| if row < count { measured[active[row].sensor] } else { 0.0 };
        let observation = Observation { active, values: Vector::from_fn(|row, _| value(row)), force, count };
        self.belief.condition(&self.model, &observation, correction)?;
        // A factor of S has a finite ln det S.
        if !correction.nis.is_finite() {
            let surprising = observation.measured().iter().all(|a| correction.innovation[a.sensor].is_finite());
            return Err(if surprising { FilterError::ImpossibleMeasurement } else { FilterError::NotFinite });
        }
        if self.adaptation.is_on() {
            let Self { adaptation, noise, uncertainty, .. } = self;
            adaptation.adapt_kernel(observation.measured(), correction, noise, uncertainty);
        }
        if let Some(jump) = &mut self.jump {
            jump.look(correction.nis, count);
        }
        Ok(())
    }
}
