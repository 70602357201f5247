//! Predict and update, written once: a kind of filter is a choice of how to push a Gaussian through a function.

mod linearised;
mod unscented;

use thiserror::Error;

use crate::gaussian::{Factor, Gaussian, Matrix, Vector, minus_product, mirrored};
use crate::model::{Model, Output};
use crate::sensor::MAX_SENSORS;

/// Why a filter cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FilterError {
    /// A number of the belief has overflowed or is undefined.
    #[error("the estimate is no longer a finite number: the filter has diverged")]
    NotFinite,
    /// The covariance has a negative variance in some direction.
    #[error("the covariance is no longer positive semidefinite")]
    IndefiniteCovariance,
    /// The innovation covariance S cannot be inverted.
    #[error("the innovation covariance S is singular")]
    SingularInnovation,
}

/// How a Gaussian is pushed through the model and the sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transform {
    /// First-order linearisation at the mean: the (extended) Kalman filter.
    Linearised,
    /// Scaled sigma points, each moved by a Runge-Kutta step: the unscented Kalman filter.
    Unscented,
}

/// The noise that a filter ascribes to model and sensors, and how fast it forgets.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise<const N: usize> {
    /// Q, the covariance that each step adds, in the channels' units squared.
    pub process: Matrix<N, N>,
    /// Diagonal of R, in the sensors' order and units squared.
    pub sensors: Vec<f64>,
    /// Fading factor λ ≥ 1 on the predicted covariance.
    pub fading: f64,
}

/// A recursive estimator with a Gaussian belief over the N-component state of a model.
#[derive(Clone, Debug)]
pub struct Filter<P: Model<N>, const N: usize> {
    model: P,
    transform: Transform,
    dt: f64,
    noise: Noise<N>,
    outputs: Vec<Output>,
    belief: Gaussian<N>,
}

/// What one measurement told. Sensors that were skipped have an innovation of NaN and no gain.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction<const N: usize> {
    /// e = z - h(y⁻), in the sensors' units.
    pub innovation: [f64; MAX_SENSORS],
    /// S, the covariance of e.
    pub innovation_cov: [[f64; MAX_SENSORS]; MAX_SENSORS],
    /// K: for each sensor, what a unit of innovation adds to each channel.
    pub gain: [[f64; N]; MAX_SENSORS],
    /// Normalised innovation squared `eᵀ S⁻¹ e`.
    pub nis: f64,
    /// `-(NIS + ln det S + m ln 2π) / 2`
    pub log_likelihood: f64,
}

impl<const N: usize> Correction<N> {
    /// The correction by no measurement at all.
    pub const NOTHING: Self = Self {
        innovation: [f64::NAN; MAX_SENSORS],
        innovation_cov: [[f64::NAN; MAX_SENSORS]; MAX_SENSORS],
        gain: [[0.0; N]; MAX_SENSORS],
        nis: f64::NAN,
        log_likelihood: f64::NAN,
    };

    /// Makes it [`Self::NOTHING`], number by number: cheaper than the copy of a constant.
    #[inline]
    fn clear(&mut self) {
        self.innovation = [f64::NAN; MAX_SENSORS];
        self.innovation_cov = [[f64::NAN; MAX_SENSORS]; MAX_SENSORS];
        self.gain = [[0.0; N]; MAX_SENSORS];
        self.nis = f64::NAN;
        self.log_likelihood = f64::NAN;
    }
}

/// A sensor that has delivered a measurement: where it reads, its place among the sensors, its variance.
#[derive(Clone, Copy, Debug)]
struct Active {
    sensor: usize,
    output: Output,
    variance: f64,
}

/// What a belief says of M measurements before they are seen.
struct Expected<const N: usize, const M: usize> {
    mean: Vector<M>,
    /// S, noise included.
    cov: Matrix<M, M>,
    /// Covariance of state and measurement.
    cross: Matrix<N, M>,
    view: View<N, M>,
}

/// How measurements depend on the state.
enum View<const N: usize, const M: usize> {
    /// Each is a component of it: H picks. With `H P⁻ Hᵀ`.
    Components(Matrix<M, M>),
    /// Linearly, or taken to: H.
    Linear(Matrix<M, N>),
    /// Not linearly.
    Curved,
}

impl<P: Model<N>, const N: usize> Filter<P, N> {
    /// A filter at k = 0. `outputs` says what each sensor reads, `dt` \[s\] is the time between samples.
    pub fn new(
        model: P,
        transform: Transform,
        dt: f64,
        noise: Noise<N>,
        outputs: Vec<Output>,
        belief: Gaussian<N>,
    ) -> Self {
        Self { model, transform, dt, noise, outputs, belief }
    }

    /// The belief after the last predict or update.
    pub fn belief(&self) -> &Gaussian<N> {
        &self.belief
    }

    /// Carries the belief over one step in which the force over mass was `force` \[m/s²\].
    ///
    /// ```text
    /// P⁻ = λ cov(g-step of y) + Q
    /// ```
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] where sigma points cannot be drawn. A prediction that overflows is found by
    /// the update.
    pub fn predict(&mut self, force: f64) -> Result<(), FilterError> {
        let Self { model, transform, dt, noise, outputs: _, belief } = self;
        match transform {
            Transform::Linearised => linearised::predict(model, belief, force, *dt),
            Transform::Unscented => unscented::predict(model, belief, force, *dt)?,
        }
        for (entry, added) in belief.cov.iter_mut().zip(&noise.process) {
            *entry = *entry * noise.fading + added;
        }
        if belief.has_negative_variance() {
            // A variance that is zero but for rounding has come out on the wrong side.
            for i in 0..N {
                belief.cov[(i, i)] = belief.cov[(i, i)].max(0.0);
            }
        }
        Ok(())
    }

    /// Conditions the belief on one sample of the sensors, while `force` acts, and reports in `correction` how. A
    /// measurement that is NaN skips its sensor.
    ///
    /// ```text
    /// e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e
    /// ```
    ///
    /// # Errors
    /// [`FilterError::SingularInnovation`] where S is not positive definite; [`FilterError::IndefiniteCovariance`] where
    /// sigma points cannot be drawn or a variance comes out negative; [`FilterError::NotFinite`] where the belief
    /// overflows.
    pub fn update(&mut self, force: f64, measured: &[f64], correction: &mut Correction<N>) -> Result<(), FilterError> {
        correction.clear();
        let mut active = [Active { sensor: 0, output: Output::State(0), variance: 0.0 }; MAX_SENSORS];
        let mut count = 0;
        for (sensor, &output) in self.outputs.iter().enumerate() {
            if !measured[sensor].is_nan() {
                active[count] = Active { sensor, output, variance: self.noise.sensors[sensor] };
                count += 1;
            }
        }
        match count {
            0 if self.belief.is_finite() => Ok(()),
            0 => Err(FilterError::NotFinite),
            1 => self.condition([active[0]], force, measured, correction),
            2 => self.condition([active[0], active[1]], force, measured, correction),
            _ => self.condition(active, force, measured, correction),
        }
    }

    fn condition<const M: usize>(
        &mut self,
        active: [Active; M],
        force: f64,
        measured: &[f64],
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let Self { model, transform, belief, .. } = self;
        let expected = match (components(&active), &transform) {
            // Sigma points through a linear function give its exact moments, which this gives for less.
            (Some(components), _) => linearised::expect_components(belief, components, &active),
            (None, Transform::Linearised) => linearised::expect(model, belief, &active, force),
            (None, Transform::Unscented) => unscented::expect(model, belief, &active, force)?,
        };
        let Expected { mean, cov: innovation_cov, cross, view } = expected;
        let innovation = Vector::<M>::from_fn(|i, _| measured[active[i].sensor]) - mean;
        let Some(factor) = Factor::new(&innovation_cov) else {
            return Err(if innovation_cov.sum().is_finite() {
                FilterError::SingularInnovation
            } else {
                FilterError::NotFinite
            });
        };
        let gain = factor.divide(&cross);

        belief.mean += gain * innovation;
        belief.cov = match &view {
            // Picked columns of `P - K (P Hᵀ)ᵀ`, computed again rather than fetched.
            View::Components(seen) => {
                joseph(&belief.cov, &gain, &cross, &active, |_| minus_product(cross, &gain, seen))
            }
            View::Linear(jacobian) => joseph(&belief.cov, &gain, &cross, &active, |x| x * jacobian.transpose()),
            View::Curved => subtract(&belief.cov, &gain, &innovation_cov),
        };
        if !belief.is_finite() {
            return Err(FilterError::NotFinite);
        }
        if belief.has_negative_variance() {
            return Err(FilterError::IndefiniteCovariance);
        }

        let nis = factor.square(&innovation);
        let ln_det = libm::log(factor.determinant());
        correction.nis = nis;
        correction.log_likelihood = -0.5 * (nis + ln_det + M as f64 * LN_2_PI);
        for (i, row) in active.iter().enumerate() {
            correction.innovation[row.sensor] = innovation[i];
            correction.gain[row.sensor] = gain.column(i).into();
            for (j, column) in active.iter().enumerate() {
                correction.innovation_cov[row.sensor][column.sensor] = innovation_cov[(i, j)];
            }
        }
        Ok(())
    }
}

/// Which component of the state each sensor reads, if they all read one.
#[inline]
fn components<const M: usize>(active: &[Active; M]) -> Option<[usize; M]> {
    let mut components = [0; M];
    for (component, sensor) in components.iter_mut().zip(active) {
        let Output::State(i) = sensor.output else { return None };
        *component = i;
    }
    Some(components)
}

/// ln 2π
const LN_2_PI: f64 = 1.837_877_066_409_345_5;

/// `(I - K H) P (I - K H)ᵀ + K R Kᵀ`, which keeps P positive semidefinite where sensors are far more precise than the
/// belief; written as two updates of the sensors' rank:
///
/// ```text
/// M = P - K (P Hᵀ)ᵀ,  P⁺ = M - (M Hᵀ - K R) Kᵀ
/// ```
///
/// Source: Bucy and Joseph (1968), *Filtering for Stochastic Processes with Applications to Guidance*.
#[inline]
fn joseph<const N: usize, const M: usize>(
    cov: &Matrix<N, N>,
    gain: &Matrix<N, M>,
    cross: &Matrix<N, M>,
    active: &[Active; M],
    seen: impl Fn(&Matrix<N, N>) -> Matrix<N, M>,
) -> Matrix<N, N> {
    let kept = minus_product(*cov, gain, cross);
    let mut excess = seen(&kept);
    for (k, sensor) in active.iter().enumerate() {
        for i in 0..N {
            excess[(i, k)] -= gain[(i, k)] * sensor.variance;
        }
    }
    mirrored(minus_product(kept, &excess, gain))
}

/// `P - K S Kᵀ`
fn subtract<const N: usize, const M: usize>(
    cov: &Matrix<N, N>,
    gain: &Matrix<N, M>,
    innovation_cov: &Matrix<M, M>,
) -> Matrix<N, N> {
    mirrored(minus_product(*cov, &(gain * innovation_cov), gain))
}
