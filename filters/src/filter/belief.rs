//! Beliefs, the noise that a filter assumes, a step between samples, a sample's measurements, and an update's result.

use std::borrow::Cow;

use super::{Course, FilterError, Step, System};
use crate::engine::belief::GaussianBelief;
use crate::engine::model::{ForceOn, Input, Reading};
use crate::linalg::{Ldl, Matrix, Vector, symmetric};

/// A method of filtering: how a filter holds its belief over the n components of a model's state.
pub trait Belief: Send {
    /// Carries the belief over one step and adds noise: `P ← λ P + Q`.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the covariance or Q has no root.
    fn predict(&mut self, system: &mut dyn System, step: Step<'_>, noise: &Noise) -> Result<(), FilterError>;

    /// Conditions the belief on one measurement or more, and writes the update to `correction`.
    ///
    /// # Errors
    /// Any [`FilterError`].
    fn condition(
        &mut self,
        system: &mut dyn System,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError>;

    /// Keeps a share of a component and adds an independent one of mean zero and this variance: see [`Gaussian::renew`].
    ///
    /// # Errors
    /// Any [`FilterError`].
    fn renew(&mut self, place: usize, kept: f64, variance: f64) -> Result<(), FilterError>;

    /// Mean and covariance.
    fn gaussian(&self) -> Cow<'_, Gaussian>;
}

/// A normal distribution over n components.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaussian {
    /// Mean, n numbers.
    pub mean: Vector,
    /// Covariance, n × n, symmetric to the last bit.
    pub cov: Matrix,
}

impl Gaussian {
    /// Independent components with the given standard deviations.
    pub fn independent(mean: Vector, std: &Vector) -> Self {
        Self { mean, cov: Matrix::from_diagonal(&std.map(|s| s * s)) }
    }

    /// Makes it a copy of another one, in its own memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.mean.clone_from(&other.mean);
        self.cov.clone_from(&other.cov);
    }

    /// The engine's mean and covariance.
    pub fn of(belief: &GaussianBelief<f64>) -> Self {
        let n = belief.mean.len();
        let cov = symmetric(Matrix::from_column_slice(n, n, &belief.cov));
        Self { mean: Vector::from_column_slice(&belief.mean), cov }
    }

    /// n, the number of components.
    pub fn size(&self) -> usize {
        self.mean.len()
    }

    /// Whether every number of it is finite.
    pub fn is_finite(&self) -> bool {
        // A sum is finite only if all its terms are, short of an overflow, which is as bad.
        (self.mean.sum() + self.cov.sum()).is_finite()
    }

    /// Keeps this share of a component, and adds an independent one with mean zero and this variance.
    pub fn renew(&mut self, place: usize, kept: f64, variance: f64) {
        let Self { mean, cov } = self;
        mean[place] *= kept;
        cov.row_mut(place).scale_mut(kept);
        cov.column_mut(place).scale_mut(kept);
        cov[(place, place)] += variance;
    }

    /// Checks that the numbers are those of a valid belief.
    ///
    /// # Errors
    /// [`FilterError::NotFinite`] and, where a variance is below zero, [`FilterError::IndefiniteCovariance`].
    pub fn check(&self) -> Result<(), FilterError> {
        if !self.is_finite() {
            return Err(FilterError::NotFinite);
        }
        if (0..self.size()).any(|i| self.cov[(i, i)] < 0.0) {
            return Err(FilterError::IndefiniteCovariance);
        }
        Ok(())
    }
}

/// The noise that a filter assumes for model and sensors, and its fading.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Q, the covariance that each step adds, n × n, in the state's units squared.
    pub process: Matrix,
    /// Diagonal of R, in the sensors' order and units squared.
    pub sensors: Vec<f64>,
    /// Fading factor λ ≥ 1 on the predicted covariance.
    pub fading: f64,
}

impl Noise {
    /// Whether all of it is finite.
    pub fn is_finite(&self) -> bool {
        self.process.sum().is_finite() && self.sensors.iter().all(|r| r.is_finite())
    }

    /// Replaces P by `λ P + Q`, symmetric to the last bit. A variance that rounding made negative becomes zero.
    pub fn spread(&self, cov: &mut Matrix) {
        let Self { process, sensors: _, fading } = self;
        cov.zip_apply(process, |cov, process| *cov = *cov * fading + process);
        for i in 0..cov.nrows() {
            if cov[(i, i)] < 0.0 {
                cov[(i, i)] = 0.0;
            }
        }
        cov.fill_upper_triangle_with_lower_triangle();
    }
}

/// A force over mass that is not recorded and is independent from sample to sample: wind, traffic, ground noise. It is the component w of
/// the state, so that a sensor that feels it, such as an accelerometer, reads the same force that moves the plant.
///
/// ```text
/// w ~ N(0, s²) drawn again for each sample,  s² = q / dt
/// x⁺ = Φ x + Γ w,  z = h(x) + D w + v,  cov(Γ w, D w + v) = Γ s² Dᵀ
/// Γ Γᵀ s² = q [dt³/4, dt²/2; dt²/2, dt] of a light oscillator, and D = 1 of an accelerometer on it
/// ```
///
/// with the intensity q of the white force \[m²/s³\]: its two-sided spectral density. The filter of the state with w is
/// that of correlated process noise and sensor noise, with the covariance Γ s² Dᵀ: the covariance of x and w after an
/// update is the term that textbooks subtract from the next prediction.
///
/// The course of the force between samples depends on input and sensors ([`Course`]).
///
/// Source: Anderson and Moore (1979), *Optimal Filtering*, section 5.5; Simon (2006), *Optimal State Estimation*, section
/// 7.1 (correlated process and measurement noise); Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to
/// Tracking and Navigation*, sections 6.2.2 and 6.3.2 (white acceleration, continuous and held).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct White {
    /// The place of w in the state.
    pub place: usize,
    /// s², the variance of w \[(m/s²)²\].
    pub variance: f64,
    /// The course of the force between samples.
    pub course: Course,
}

impl White {
    /// Sets the row and the column of w in Q to zero, since the prediction does not move w.
    pub fn leave_out(self, process: &mut Matrix) {
        process.row_mut(self.place).fill(0.0);
        process.column_mut(self.place).fill(0.0);
    }
}

/// The m measurements of one sample that are not missing.
#[derive(Clone, Debug)]
pub struct Observation {
    pub(super) readings: Vec<Option<Reading>>,
    /// The place of each measurement's sensor among all sensors.
    pub sensors: Vec<usize>,
    /// z, in the sensors' units.
    pub values: Vec<f64>,
    /// The diagonal of R, in the sensors' units squared.
    pub variances: Vec<f64>,
    /// The recorded force over mass at the sample on all masses \[m/s²\].
    pub force: f64,
    /// The recorded forces on single masses.
    pub on: Vec<ForceOn>,
}

impl Observation {
    pub(super) fn of(readings: Vec<Option<Reading>>) -> Self {
        Self { readings, sensors: Vec::new(), values: Vec::new(), variances: Vec::new(), force: 0.0, on: Vec::new() }
    }

    /// A number for each sensor, NaN where it is missing, and the variance of each.
    pub(super) fn take(&mut self, input: Input<'_>, measured: &[f64], noise: &[f64]) -> Result<(), FilterError> {
        let Self { readings, sensors, values, variances, force, on } = self;
        *force = input.force;
        on.clear();
        on.extend(input.on.iter().map(|on| ForceOn { ends: [on.value(input.at); 2], ..*on }));
        sensors.clear();
        values.clear();
        variances.clear();
        for (sensor, (&value, &variance)) in measured.iter().zip(noise).enumerate() {
            if value.is_nan() || readings[sensor].is_none() {
                continue;
            }
            if value.is_infinite() {
                return Err(FilterError::InfiniteMeasurement);
            }
            sensors.push(sensor);
            values.push(value);
            variances.push(variance);
        }
        Ok(())
    }

    /// m, the number of measurements.
    pub fn len(&self) -> usize {
        self.sensors.len()
    }

    /// Whether nothing was measured.
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }

    fn input(&self) -> Input<'_> {
        Input { force: self.force, on: &self.on, at: 0.0 }
    }

    fn readings(&self) -> Vec<&Reading> {
        self.sensors.iter().filter_map(|&sensor| self.readings[sensor].as_ref()).collect()
    }

    /// `h(y, f)`, the m numbers that the sensors would read in each of some states of n numbers, one column for each.
    pub fn read(&self, system: &mut dyn System, states: &[f64]) -> Matrix {
        let mut values = Matrix::zeros(self.len(), states.len() / system.size());
        system.read(states, self.input(), &self.readings(), values.as_mut_slice());
        values
    }

    /// `H = ∂h/∂y`, m × n, in a state.
    pub fn jacobian(&self, system: &dyn System, state: &[f64]) -> Matrix {
        system.jacobian(state, self.input(), &self.readings())
    }

    /// Adds R to a covariance of the readings, m × m, and makes it symmetric to the last bit, from its lower triangle.
    pub fn add_noise(&self, cov: &mut Matrix) {
        cov.fill_upper_triangle_with_lower_triangle();
        for (row, variance) in self.variances.iter().enumerate() {
            cov[(row, row)] += variance;
        }
    }

    /// The innovation `e = z - h`, where h is `expected`.
    pub fn innovation(&self, expected: &Vector) -> Vector {
        Vector::from_fn(self.len(), |row, _| self.values[row] - expected[row])
    }
}

/// The effect of one sample of m sensors on n channels. Sensors that were skipped have an innovation of NaN and no gain.
#[derive(Clone, Debug)]
pub struct Correction {
    /// e = z - h(y⁻), m numbers in the sensors' units.
    pub innovation: Vector,
    /// S, the covariance of e, m × m.
    pub innovation_cov: Matrix,
    /// K, n × m. The column of a sensor is the change of each channel per unit of its innovation.
    pub gain: Matrix,
    /// Normalised innovation squared `eᵀ S⁻¹ e`.
    pub nis: f64,
    /// det S over the sensors that were not skipped; zero or infinite if it leaves the range of numbers.
    pub determinant: f64,
    /// For a particle filter, the logarithm of the mean likelihood of its particles. NaN for others: there it follows from NIS and det S.
    pub log_likelihood: f64,
    /// Effective sample size of a particle filter before it resampled; NaN for any other.
    pub effective_samples: f64,
}

impl Correction {
    /// The correction of n channels by m sensors that all measured nothing.
    pub fn nothing(n: usize, m: usize) -> Self {
        let nan = f64::NAN;
        Self {
            innovation: Vector::repeat(m, nan),
            innovation_cov: Matrix::repeat(m, m, nan),
            gain: Matrix::zeros(n, m),
            nis: nan,
            determinant: nan,
            log_likelihood: nan,
            effective_samples: nan,
        }
    }

    /// Takes in e, S with its factor, and K of the sensors that measured; each number goes to the place of its sensor.
    pub fn report(
        &mut self,
        sensors: &[usize],
        innovation: &Vector,
        innovation_cov: &Matrix,
        factor: &Ldl,
        gain: &Matrix,
    ) {
        self.nis = factor.square(innovation);
        self.determinant = factor.determinant;
        for (i, &row) in sensors.iter().enumerate() {
            self.innovation[row] = innovation[i];
            self.gain.set_column(row, &gain.column(i));
            for (j, &column) in sensors.iter().enumerate() {
                self.innovation_cov[(row, column)] = innovation_cov[(i, j)];
            }
        }
    }

    /// Fails where their likelihood is not finite, with [`FilterError::NotFinite`] if the belief is the reason.
    pub(super) fn check(&self, sensors: &[usize]) -> Result<(), FilterError> {
        // A factor of S has a finite ln det S.
        if self.nis.is_finite() && !self.log_likelihood.is_infinite() {
            return Ok(());
        }
        let surprising = sensors.iter().all(|&sensor| self.innovation[sensor].is_finite());
        Err(if surprising { FilterError::ImpossibleMeasurement } else { FilterError::NotFinite })
    }
}
