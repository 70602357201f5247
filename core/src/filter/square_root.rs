//! The unscented Kalman filter on the root of its covariance.

use std::borrow::Cow;

use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Observation, Rule, Step, kalman};
use crate::Model;
use crate::linalg::{Matrix, Vector, add_to_root, lower_root, symmetric};

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
pub struct SquareRoot {
    mean: Vector,
    root: Matrix,
}

impl SquareRoot {
    /// The root of a Gaussian.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where it has none.
    pub fn new(belief: &Gaussian) -> Result<Self, FilterError> {
        Ok(Self { mean: belief.mean.clone(), root: lower_root(&belief.cov)? })
    }

    /// The sigma points, each a column: the centre, and the pair of each column of the root.
    fn points(&self) -> Matrix {
        let Self { mean, root } = self;
        let distance = Rule::Unscented.constants(mean.len()).0.sqrt();
        Matrix::from_fn(mean.len(), 2 * mean.len() + 1, |i, j| match j.checked_sub(1) {
            None => mean[i],
            Some(j) if j % 2 == 0 => mean[i] + root[(i, j / 2)] * distance,
            Some(j) => mean[i] - root[(i, j / 2)] * distance,
        })
    }

    /// `P ← λ P + Q`
    fn spread(&mut self, Noise { process, fading, .. }: &Noise) -> Result<(), FilterError> {
        self.root *= fading.sqrt();
        for column in lower_root(process)?.column_iter() {
            add_to_root(&mut self.root, column.into_owned());
        }
        Ok(())
    }
}

impl Belief for SquareRoot {
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let n = model.size();
        let (_, weight, _) = Rule::Unscented.constants(n);
        let mut images = self.points();
        step.advance(model, &mut images);
        let centre = images.column(0);
        let mut sum = Vector::zeros(n);
        let mut root = Matrix::zeros(n, n);
        for image in images.column_iter().skip(1) {
            let deviation = image - centre;
            sum += &deviation;
            add_to_root(&mut root, deviation * weight.sqrt());
        }
        let shift = sum * weight;
        self.mean = centre + &shift;
        add_to_root(&mut root, shift);
        self.root = root;
        self.spread(noise)
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let n = model.size();
        let (spread, weight, _) = Rule::Unscented.constants(n);
        let readings = observation.read_all(model, &self.points());
        let centre = readings.column(0);
        let mut array = Array::new(n, observation);
        let mut sum = Vector::zeros(observation.len());
        for (j, reading) in readings.column_iter().skip(1).enumerate() {
            let deviation = reading - centre;
            sum += &deviation;
            let distance = self.root.column(j / 2) * spread.sqrt();
            let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
            array.add(deviation * weight.sqrt(), distance * (sign * weight.sqrt()));
        }
        let shift = sum * weight;
        let expected = centre + &shift;
        array.add(shift, Vector::zeros(n));
        let Array { sensors, cross, state } = array;

        let innovation = observation.innovation(&expected);
        let innovation_cov = symmetric(&sensors * sensors.transpose());
        let factor = kalman::factor(&innovation_cov)?;
        let gain = factor.divide(&(cross * sensors.transpose()));
        self.mean += &gain * &innovation;
        self.root = state;
        correction.report(observation, &innovation, &innovation_cov, &factor, &gain);
        self.gaussian().check()
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        let Self { mean, root } = self;
        Cow::Owned(Gaussian { mean: mean.clone(), cov: root * root.transpose() })
    }
}

/// The lower triangular root of the joint covariance of m readings and n components.
struct Array {
    sensors: Matrix,
    cross: Matrix,
    state: Matrix,
}

impl Array {
    fn new(n: usize, observation: &Observation) -> Self {
        let m = observation.len();
        let noise = Vector::from_iterator(m, observation.variances().iter().map(|r| r.sqrt()));
        Self { sensors: Matrix::from_diagonal(&noise), cross: Matrix::zeros(n, m), state: Matrix::zeros(n, n) }
    }

    /// Adds a deviation of readings and state.
    fn add(&mut self, mut reading: Vector, mut deviation: Vector) {
        let Self { sensors, cross, state } = self;
        for j in 0..reading.len() {
            let length = (sensors[(j, j)] * sensors[(j, j)] + reading[j] * reading[j]).sqrt();
            if length == 0.0 {
                continue;
            }
            if length == f64::INFINITY {
                sensors[(j, j)] = length;
                return;
            }
            let (cos, sin) = (sensors[(j, j)] / length, reading[j] / length);
            for i in j..reading.len() {
                rotate(cos, sin, &mut sensors[(i, j)], &mut reading[i]);
            }
            for i in 0..deviation.len() {
                rotate(cos, sin, &mut cross[(i, j)], &mut deviation[i]);
            }
        }
        add_to_root(state, deviation);
    }
}

/// A Givens rotation of two numbers.
fn rotate(cos: f64, sin: f64, kept: &mut f64, added: &mut f64) {
    (*kept, *added) = (cos * *kept + sin * *added, cos * *added - sin * *kept);
}

pub(super) static SR_UKF: FilterInfo = FilterInfo {
    key: "sr_ukf",
    name: "SR-UKF",
    description: "a UKF on the root of its covariance, which no rounding makes indefinite",
    reference: "van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation",
    is_sampled: false,
    evaluations: |_, n| 4 * (2 * n + 1),
    begin: |initial, _, _| Ok(Box::new(SquareRoot::new(&initial)?)),
};
