//! First-order linearisation at the mean: KF, EKF and iterated EKF.

use std::borrow::Cow;

use super::kalman::{self, Expected, View};
use super::{Belief, Correction, Noise, Observation};
use crate::mathematics::filter::FilterError;
use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Vector};
use crate::mathematics::kernel::model::{Model, Output};

/// A Gaussian that moves and is measured as if plant and sensors were linear around its mean.
///
/// With `iterations` of more than one the update is a Gauss-Newton descent to the most probable state, each step
/// linearising the sensors again at the result of the last:
///
/// ```text
/// yᵢ₊₁ = y⁻ + Kᵢ (z - h(yᵢ) - Hᵢ (y⁻ - yᵢ)),  y₀ = y⁻
/// ```
///
/// Innovation and S are those at y⁻, gain and covariance those of the last step.
///
/// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal
/// Estimation*, section 6.1; Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method.
#[derive(Clone, Debug)]
pub struct Linearised<const N: usize> {
    belief: Gaussian<N>,
    iterations: usize,
}

impl<const N: usize> Linearised<N> {
    /// Replaces the mean and keeps the covariance.
    pub(crate) fn move_to(&mut self, mean: Vector<N>) {
        self.belief.mean = mean;
    }

    /// A belief that moves by local linearisation and linearises the sensors up to `iterations` times an update.
    pub fn new(belief: Gaussian<N>, iterations: usize) -> Self {
        Self { belief, iterations }
    }
}

impl<P: Model<N>, const N: usize> Belief<P, N> for Linearised<N> {
    const PADDED: bool = false;

    #[inline]
    fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError> {
        let Self { belief, .. } = self;
        let (mean, transition) = model.linearised_step(&belief.mean, force, dt);
        belief.mean = mean;
        belief.cov = kalman::spread(congruence(P::MOTION, &transition, &belief.cov), noise);
        Ok(())
    }

    #[inline]
    fn condition<const M: usize>(
        &mut self,
        model: &P,
        observation: &Observation<M>,
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let Self { belief, iterations, .. } = self;
        if let Some(components) = observation.components() {
            return kalman::condition_on_components(belief, components, observation, correction);
        }
        let expected = expect(model, belief, observation);
        if *iterations > 1 {
            return iterate(model, belief, &expected, observation, *iterations, correction);
        }
        kalman::condition(belief, &expected, observation, correction)
    }

    #[inline]
    fn gaussian(&self) -> Cow<'_, Gaussian<N>> {
        Cow::Borrowed(&self.belief)
    }
}

/// The lower triangle of `Φ P Φᵀ`, where the first `motion` rows of Φ are full and the rest is diagonal.
#[inline]
fn congruence<const N: usize>(motion: usize, transition: &Matrix<N, N>, cov: &Matrix<N, N>) -> Matrix<N, N> {
    // The first rows of Φ P.
    let mut half = Matrix::<N, N>::zeros();
    for j in 0..N {
        for i in 0..motion {
            half[(i, j)] = transition[(i, 0)] * cov[(0, j)];
        }
        for k in 1..N {
            for i in 0..motion {
                half[(i, j)] += transition[(i, k)] * cov[(k, j)];
            }
        }
    }
    let mut result = Matrix::<N, N>::zeros();
    for j in 0..motion {
        for i in j..motion {
            result[(i, j)] = half[(i, 0)] * transition[(j, 0)];
        }
        for k in 1..N {
            for i in j..motion {
                result[(i, j)] += half[(i, k)] * transition[(j, k)];
            }
        }
        // P is symmetric: these rows of P Φᵀ are columns of Φ P.
        for i in motion..N {
            result[(i, j)] = half[(j, i)] * transition[(i, i)];
        }
    }
    for j in motion..N {
        for i in j..N {
            result[(i, j)] = cov[(i, j)] * (transition[(i, i)] * transition[(j, j)]);
        }
    }
    result
}

/// `h(y⁻)`, `S = H P⁻ Hᵀ + R` and `P⁻ Hᵀ`, for sensors that do not all read a component of the state.
fn expect<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    belief: &Gaussian<N>,
    observation: &Observation<M>,
) -> Expected<N, M> {
    let mean = observation.read(model, &belief.mean);
    expect_with(belief, mean, sensor_jacobian(model, &belief.mean, observation), observation)
}

fn expect_with<const N: usize, const M: usize>(
    belief: &Gaussian<N>,
    mean: Vector<M>,
    jacobian: Matrix<M, N>,
    observation: &Observation<M>,
) -> Expected<N, M> {
    let cross = belief.cov * jacobian.transpose();
    let mut cov = jacobian * cross;
    observation.add_noise(&mut cov);
    Expected { mean, cov, cross, view: View::Linear(jacobian) }
}

/// H at a state, M × N.
fn sensor_jacobian<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    state: &Vector<N>,
    observation: &Observation<M>,
) -> Matrix<M, N> {
    let rate = model.jacobian(state);
    let mut jacobian = Matrix::<M, N>::zeros();
    for (row, sensor) in observation.measured().iter().enumerate() {
        match sensor.output {
            Output::State(i) => jacobian[(row, i)] = 1.0,
            Output::Rate(i) => jacobian.set_row(row, &rate.row(i)),
        }
    }
    jacobian
}

fn iterate<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    belief: &mut Gaussian<N>,
    first: &Expected<N, M>,
    observation: &Observation<M>,
    iterations: usize,
    correction: &mut Correction<N>,
) -> Result<(), FilterError> {
    let prior = belief.clone();
    kalman::condition(belief, first, observation, correction)?;
    for _ in 1..iterations {
        let at = belief.mean;
        let jacobian = sensor_jacobian(model, &at, observation);
        let mean = observation.read(model, &at) + jacobian * (prior.mean - at);
        let expected = expect_with(&prior, mean, jacobian, observation);
        *belief = prior.clone();
        let mut step = Correction::NOTHING;
        kalman::condition(belief, &expected, observation, &mut step)?;
        correction.gain = step.gain;
        let moved = belief.mean - at;
        if (0..N).all(|i| moved[i] * moved[i] <= CONVERGED * belief.cov[(i, i)]) {
            break;
        }
    }
    Ok(())
}

/// The descent has converged when a step is this small, squared, against the variance.
const CONVERGED: f64 = 1e-12;
