//! The unscented Kalman filter on the root of its covariance.

use std::borrow::Cow;

use super::kalman::{check, factor, report};
use super::{Belief, Correction, Noise, Observation};
use crate::filter::{FilterError, Rule};
use crate::kernel::gaussian::{Gaussian, Matrix, Vector, add_to_root, lower_root};
use crate::kernel::model::Model;

/// A Gaussian held as mean and lower triangular root L of its covariance `L Lᵀ`, which no rounding can make indefinite.
///
/// With the unscented rule every covariance is a sum of squares, so that roots are only ever added to, column by column
/// with Givens rotations, and never subtracted from. The measurement is one such triangularisation of sensors and state
/// together:
///
/// ```text
/// [√R  √W ζ]            [√S   0 ]
/// [ 0  √W ξ] · Givens = [ C   L⁺],   K = C (√S)⁻¹
/// ```
///
/// with the deviations ζ of the readings and ξ of the sigma points, the offset of the mean among them.
///
/// Source: van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation;
/// Kailath, Sayed and Hassibi (2000), *Linear Estimation*, section 12.3 (array algorithms).
#[derive(Clone, Debug)]
pub struct SquareRoot<const N: usize> {
    mean: Vector<N>,
    root: Matrix<N, N>,
}

impl<const N: usize> SquareRoot<N> {
    /// The root of a Gaussian.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] where it has none.
    pub fn new(belief: &Gaussian<N>) -> Result<Self, FilterError> {
        Ok(Self { mean: belief.mean, root: lower_root(&belief.cov)? })
    }

    /// `P ← λ P + Q`
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where Q has no root.
    fn spread(&mut self, Noise { process, fading, .. }: &Noise<N>) -> Result<(), FilterError> {
        self.root *= fading.sqrt();
        let process = lower_root(process)?;
        for i in 0..N {
            add_to_root(&mut self.root, process.column(i).into());
        }
        Ok(())
    }
}

impl<P: Model<N>, const N: usize> Belief<P, N> for SquareRoot<N> {
    const PADDED: bool = true;

    fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError> {
        let Self { mean, root } = self;
        let (spread, weight, _) = Rule::Unscented.constants(N);
        let step = |state: Vector<N>| model.runge_kutta_step(&state, force, dt);
        let centre = step(*mean);
        let mut sum = Vector::<N>::zeros();
        let mut moved = Matrix::<N, N>::zeros();
        for i in 0..N {
            let distance = root.column(i) * spread.sqrt();
            for image in [step(*mean + distance), step(*mean - distance)] {
                let d = image - centre;
                sum += d;
                add_to_root(&mut moved, d * weight.sqrt());
            }
        }
        let shift = sum * weight;
        add_to_root(&mut moved, shift);
        *mean = centre + shift;
        *root = moved;
        self.spread(noise)
    }

    fn condition<const M: usize>(
        &mut self,
        model: &P,
        observation: &Observation<M>,
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let Self { mean, root } = self;
        let (spread, weight, _) = Rule::Unscented.constants(N);
        let mut array = Array::<N, M>::new(observation);
        let centre = observation.read(model, mean);
        let mut sum = Vector::<M>::zeros();
        for i in 0..N {
            let distance = root.column(i) * spread.sqrt();
            for sign in [1.0, -1.0] {
                let reading = observation.read(model, &(*mean + distance * sign)) - centre;
                sum += reading;
                array.add(reading * weight.sqrt(), distance * (sign * weight.sqrt()));
            }
        }
        let shift = sum * weight;
        array.add(shift, Vector::zeros());
        let Array { sensors, cross, state } = array;

        let innovation = observation.values - (centre + shift);
        let innovation_cov = sensors * sensors.transpose();
        let factor = factor(&innovation_cov)?;
        let gain = factor.divide(&(cross * sensors.transpose()));
        *mean += gain * innovation;
        *root = state;
        report(observation.measured(), &innovation, &innovation_cov, &factor, &gain, correction);
        check(&Belief::<P, N>::gaussian(self))
    }

    fn gaussian(&self) -> Cow<'_, Gaussian<N>> {
        let Self { mean, root } = self;
        Cow::Owned(Gaussian { mean: *mean, cov: root * root.transpose() })
    }
}

/// The lower triangular root of the joint covariance of M readings and N components.
struct Array<const N: usize, const M: usize> {
    sensors: Matrix<M, M>,
    cross: Matrix<N, M>,
    state: Matrix<N, N>,
}

impl<const N: usize, const M: usize> Array<N, M> {
    fn new(observation: &Observation<M>) -> Self {
        let noise = Vector::<M>::from_fn(|row, _| observation.active[row].variance.sqrt());
        Self { sensors: Matrix::from_diagonal(&noise), cross: Matrix::zeros(), state: Matrix::zeros() }
    }

    /// Adds a deviation of readings and state.
    fn add(&mut self, mut reading: Vector<M>, mut deviation: Vector<N>) {
        let Self { sensors, cross, state } = self;
        for j in 0..M {
            let length = (sensors[(j, j)] * sensors[(j, j)] + reading[j] * reading[j]).sqrt();
            if length == 0.0 {
                continue;
            }
            if length == f64::INFINITY {
                sensors[(j, j)] = length;
                return;
            }
            let (cos, sin) = (sensors[(j, j)] / length, reading[j] / length);
            for i in j..M {
                (sensors[(i, j)], reading[i]) =
                    (cos * sensors[(i, j)] + sin * reading[i], cos * reading[i] - sin * sensors[(i, j)]);
            }
            for i in 0..N {
                (cross[(i, j)], deviation[i]) =
                    (cos * cross[(i, j)] + sin * deviation[i], cos * deviation[i] - sin * cross[(i, j)]);
            }
        }
        add_to_root(state, deviation);
    }
}
