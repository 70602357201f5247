//! Beliefs, and what moves them: the noise that a filter assumes, and a step from one sample to the next.

use std::borrow::Cow;

use super::{Correction, Course, FilterError, Observation};
use crate::mathematics::engine::{self, model};
use crate::mathematics::linalg::{Matrix, Vector, symmetric};
use crate::mathematics::model::{Hold, Model};
use crate::{Channel, Quantity};

/// A method of filtering: how a filter holds its belief over the n components of a model's state.
pub trait Belief: Send {
    /// Carries the belief over one step and adds noise: `P ← λ P + Q`.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the covariance or Q has no root.
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError>;

    /// Conditions the belief on one measurement or more, and writes the update to `correction`.
    ///
    /// # Errors
    /// Any [`FilterError`].
    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError>;

    /// Keeps a share of a component of the state and adds an independent one of mean zero and this variance: of a
    /// [`White`] force nothing is kept at the next sample. See [`Gaussian::renew`].
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

    pub(crate) fn of(belief: &engine::belief::Belief<f64>) -> Self {
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
        // A sum is finite only if all its terms are, short of an overflow, which is as bad. Four sums, for speed.
        let mut sums = [self.mean.sum(), 0.0, 0.0, 0.0];
        let entries = self.cov.as_slice().chunks_exact(4);
        entries.remainder().iter().for_each(|entry| sums[0] += entry);
        entries.for_each(|four| sums.iter_mut().zip(four).for_each(|(sum, entry)| *sum += entry));
        sums.iter().sum::<f64>().is_finite()
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
    pub(crate) fn is_finite(&self) -> bool {
        self.process.sum().is_finite() && self.sensors.iter().all(|r| r.is_finite())
    }

    /// Replaces P by `λ P + Q`, symmetric to the last bit. A variance that rounding made negative becomes zero.
    pub fn spread(&self, cov: &mut Matrix) {
        let Self { process, sensors: _, fading } = self;
        for (cov, process) in cov.as_mut_slice().iter_mut().zip(process.as_slice()) {
            *cov = *cov * fading + process;
        }
        for i in 0..cov.nrows() {
            if cov[(i, i)] < 0.0 {
                cov[(i, i)] = 0.0;
            }
        }
        cov.fill_upper_triangle_with_lower_triangle();
    }
}

/// A step from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The recorded force over mass at its beginning and at its end, linear in between \[m/s²\]; the same where it is held.
    pub forces: [f64; 2],
    /// The course of the force between samples.
    pub hold: Hold,
    /// The time that it takes \[s\].
    pub dt: f64,
}

impl Step {
    pub(super) fn part(&self, i: usize, parts: usize) -> Self {
        let model::Step { forces, dt, .. } = self.of_engine().part(i, parts);
        Self { forces, dt, ..*self }
    }

    pub(super) fn of_engine(self) -> model::Step<f64> {
        let Self { forces, hold, dt } = self;
        model::Step { forces, has_slope: hold == Hold::First, dt }
    }
}

/// A force over mass that is not recorded and is independent from sample to sample: wind, traffic, ground noise. It is
/// the component w of the state ([`Channel::WHITE_FORCE`]), so that a sensor that feels it, such as an accelerometer,
/// reads the same force that moves the plant.
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
    /// The white force of a filter with this model, whose standard deviation is `std` \[m/s²\], and these sensors, if it has one.
    pub(crate) fn of(model: &Model, std: f64, hold: Hold, sensors: &[Quantity]) -> Option<Self> {
        let place = model.place(Channel::WHITE_FORCE)?;
        let feels = |quantity: &Quantity| model.reading(*quantity).is_some_and(|reading| reading.is_of_rates());
        let course = match hold {
            Hold::Zero => Course::Held,
            Hold::First if sensors.iter().any(feels) => Course::Centred,
            Hold::First => Course::Continuous,
        };
        Some(Self { place, variance: std * std, course })
    }

    /// Adds the effect of the force's deviation from its mean over a sample, which enters through the plant's input.
    pub(crate) fn add_rest(self, model: &Model, state: &[f64], dt: f64, process: &mut Matrix) {
        if self.course != Course::Continuous {
            return;
        }
        let by_force = model.by_force(state);
        let moved = |place: usize| {
            let velocity = model.channels()[place].rate()?;
            Some((place, by_force[model.place(velocity)?]))
        };
        let moved: Vec<(usize, f64)> = (0..model.motion()).filter_map(moved).collect();
        let variance = self.variance * dt * dt * dt * dt / 12.0;
        for &(i, a) in &moved {
            for &(j, b) in &moved {
                process[(i, j)] += variance * a * b;
            }
        }
    }

    /// Sets the row and the column of w in Q to zero, since the prediction does not move w.
    pub(crate) fn leave_out(self, process: &mut Matrix) {
        process.row_mut(self.place).fill(0.0);
        process.column_mut(self.place).fill(0.0);
    }
}
