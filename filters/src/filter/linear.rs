//! The Kalman filter of a linear system that the user defines.

use thiserror::Error;

use super::kalman::{self, Expected};
use super::{Correction, FilterError, Gaussian, Noise};
use crate::gaussian_likelihood;
use crate::linalg::{Matrix, Vector, lower_root, symmetric};
use crate::lists::places;

/// A Kalman filter of any linear system, without a scenario: n components of the state x, p inputs u, m sensors.
///
/// ```text
/// xₖ₊₁ = A xₖ + B uₖ + w,  w ~ N(0, Q)
/// zₖ = H xₖ + v,           v ~ N(0, R),   or h(xₖ) + v with a function h
/// ```
///
/// A is n × n, B n × p, H m × n, Q n × n, R m × m: in any units, and with correlated sensors if R says so. With a
/// function h this is an extended Kalman filter ([`MeasurementModel`]). The crate's page has examples.
///
/// Source: Kalman (1960), A new approach to linear filtering and prediction problems; Gelb, ed. (1974), *Applied Optimal
/// Estimation*, section 6.1 (a function h).
pub struct KalmanFilter {
    transition: Matrix,
    input: Matrix,
    model: MeasurementModel,
    noise: Noise,
    sensor_noise: Matrix,
    /// Mean and covariance P of the state after the last prediction or update.
    pub belief: Gaussian,
    /// The belief before the last update. Since the last prediction, if no update has followed it, this is the prediction.
    pub prior: Gaussian,
    /// The last update: `e = z - H x⁻`, `S = H P⁻ Hᵀ + R`, `K = P⁻ Hᵀ S⁻¹`, NIS and the log likelihood of the readings,
    /// `-(NIS + ln det S + m ln 2π) / 2`.
    pub correction: Correction,
}

impl KalmanFilter {
    /// The filter of the system with A, B, H, Q and R, before its first prediction. A system without an input has a B of
    /// n × 0. `initial` has the mean and the covariance P of the state.
    ///
    /// # Errors
    /// [`SystemError`]: the shape of a matrix does not fit, a number is not finite, or Q, R or P is no covariance.
    pub fn new(
        a: Matrix,
        b: Matrix,
        h: impl Into<MeasurementModel>,
        q: Matrix,
        r: Matrix,
        initial: Gaussian,
    ) -> Result<Self, SystemError> {
        let model = h.into();
        let Gaussian { mean, cov } = initial;
        let n = mean.len();
        if n == 0 {
            return Err(SystemError::NoState);
        }
        check_column("the initial mean", mean.as_slice(), n, "")?;
        let cov = covariance("P", cov, n, "a row and a column for each component of the initial mean")?;
        check("A", &a, (n, n), "a row and a column for each component of the state")?;
        check("B", &b, (n, b.ncols()), "a row for each component of the state, a column for each input")?;
        let process = covariance("Q", q, n, "a row and a column for each component of the state")?;
        let m = model.matrix().unwrap_or(&r).nrows();
        if let Some(h) = model.matrix() {
            check("H", h, (m, n), "a row for each sensor, a column for each component of the state")?;
        }
        let sensor_noise = covariance("R", r, m, "a row and a column for each sensor")?;
        let noise = Noise { process, sensors: Vec::new(), fading: 1.0 };
        let belief = Gaussian { mean, cov };
        Ok(Self {
            prior: belief.clone(),
            correction: Correction::nothing(n, m),
            transition: a,
            input: b,
            model,
            noise,
            sensor_noise,
            belief,
        })
    }

    /// [`Self::predict`] and [`Self::update`]: from one sample to the next, with the input before it and the readings at it.
    ///
    /// # Errors
    /// Those of both. Where the update fails the belief is the prediction.
    pub fn step(&mut self, input: &[f64], measured: &[f64]) -> Result<(), SystemError> {
        self.predict(input)?;
        self.update(measured)
    }

    /// Moves the belief by a step: `x ← A x + B u`, `P ← A P Aᵀ + Q`. The results of the last update stay.
    ///
    /// # Errors
    /// [`SystemError::Length`] where the input has not p numbers, [`SystemError::NotFinite`] where one of them is not finite,
    /// and [`SystemError::Filter`] where the prediction is not: the belief is then as it was.
    pub fn predict(&mut self, input: &[f64]) -> Result<(), SystemError> {
        check_column("the input", input, self.input.ncols(), "a number for each column of B")?;
        let Self { transition, input: by_input, noise, belief, prior, .. } = self;
        prior.mean = &*transition * &belief.mean + &*by_input * Vector::from_column_slice(input);
        prior.cov = &*transition * &belief.cov * transition.transpose();
        noise.spread(&mut prior.cov);
        prior.check()?;
        belief.copy_from(prior);
        Ok(())
    }

    /// Conditions the belief on a reading of each sensor; NaN skips a sensor.
    ///
    /// # Errors
    /// [`SystemError::Length`] without m readings; [`SystemError::Filter`] where one is infinite or S is not positive definite;
    /// [`SystemError::NotFinite`] and [`SystemError::Shape`] by a measurement function. The belief is then as it was.
    pub fn update(&mut self, measured: &[f64]) -> Result<(), SystemError> {
        let (n, m) = (self.belief.size(), self.sensor_noise.nrows());
        self.prior.copy_from(&self.belief);
        self.correction = Correction::nothing(n, m);
        if measured.len() != m {
            let why = "a number for each sensor, NaN where it has no reading";
            return Err(SystemError::Length { what: "the sample", found: measured.len(), needed: m, why });
        }
        let update = self.condition(measured);
        if update.is_err() {
            self.belief.copy_from(&self.prior);
            self.correction = Correction::nothing(n, m);
        }
        update
    }

    fn condition(&mut self, measured: &[f64]) -> Result<(), SystemError> {
        let Self { model, sensor_noise, belief, correction, .. } = self;
        let sensors = places(measured.len(), &|sensor| !measured[sensor].is_nan());
        if sensors.iter().any(|&sensor| measured[sensor].is_infinite()) {
            return Err(FilterError::InfiniteMeasurement.into());
        }
        if sensors.is_empty() {
            return Ok(());
        }
        let shape = (sensor_noise.nrows(), belief.size());
        let (readings, jacobian) = linearise(model, shape.0, &belief.mean, |i| belief.cov[(i, i)].sqrt());
        check("the Jacobian", &jacobian, shape, "a row for each sensor, a column for each component")?;
        check_column("the measurement function", readings.as_slice(), shape.0, "")?;
        let noise = sensor_noise.select_rows(&sensors).select_columns(&sensors);
        let expected =
            Expected::with_noise(belief, readings.select_rows(&sensors), jacobian.select_rows(&sensors), &noise);
        let innovation = Vector::from_fn(sensors.len(), |row, _| measured[sensors[row]] - expected.mean[row]);
        let (factor, gain) = kalman::update(belief, &expected, &innovation, &noise)?;
        correction.report(&sensors, &innovation, &expected.cov, &factor, &gain);
        let (ln_determinant, count) = (factor.ln_determinant(), sensors.len() as u32);
        correction.log_likelihood = gaussian_likelihood::log_likelihood(correction.nis, ln_determinant, count);
        if correction.nis.is_finite() { Ok(()) } else { Err(FilterError::ImpossibleMeasurement.into()) }
    }
}

/// The measurement model of a [`KalmanFilter`]: `z = H x` with an m × n matrix H, or `z = h(x)` with a function.
pub struct MeasurementModel(Kind);

type Function = Box<dyn Fn(&[f64], &mut [f64]) + Send>;
type Jacobian = Box<dyn Fn(&[f64], &mut Matrix) + Send>;

enum Kind {
    Matrix(Matrix),
    Function { function: Function, jacobian: Option<Jacobian> },
}

impl From<Matrix> for MeasurementModel {
    fn from(matrix: Matrix) -> Self {
        Self(Kind::Matrix(matrix))
    }
}

impl MeasurementModel {
    /// A function that writes the m readings in a state. Its Jacobian is found by differences, with 2n calls in an update:
    ///
    /// ```text
    /// ∂h/∂xᵢ ≈ (h(x + d eᵢ) - h(x - d eᵢ)) / 2d,  d = max(6e-6 |xᵢ|, 1e-4 σᵢ)
    /// ```
    pub fn function(function: impl Fn(&[f64], &mut [f64]) + Send + 'static) -> Self {
        Self(Kind::Function { function: Box::new(function), jacobian: None })
    }

    /// The same with its Jacobian `∂h/∂x`: `jacobian` writes it over an m × n matrix of zeros. A matrix H ignores it.
    #[must_use]
    pub fn with_jacobian(self, jacobian: impl Fn(&[f64], &mut Matrix) + Send + 'static) -> Self {
        match self.0 {
            Kind::Function { function, .. } => Self(Kind::Function { function, jacobian: Some(Box::new(jacobian)) }),
            linear @ Kind::Matrix(_) => Self(linear),
        }
    }

    fn matrix(&self) -> Option<&Matrix> {
        match &self.0 {
            Kind::Matrix(matrix) => Some(matrix),
            Kind::Function { .. } => None,
        }
    }
}

/// The readings in a state, m numbers, and their Jacobian, m × n; `std` gives the standard deviation of a component.
fn linearise(model: &MeasurementModel, m: usize, at: &Vector, std: impl Fn(usize) -> f64) -> (Vector, Matrix) {
    let mut readings = Vector::zeros(m);
    match &model.0 {
        Kind::Matrix(matrix) => {
            readings.gemv(1.0, matrix, at, 0.0);
            (readings, matrix.clone())
        }
        Kind::Function { function, jacobian } => {
            function(at.as_slice(), readings.as_mut_slice());
            let mut by_state = Matrix::zeros(m, at.len());
            match jacobian {
                Some(jacobian) => jacobian(at.as_slice(), &mut by_state),
                None => differences(function, at, &readings, std, &mut by_state),
            }
            (readings, by_state)
        }
    }
}

/// Central differences over a share of a standard deviation, which is large against rounding, and in which h counts as linear.
fn differences(function: &Function, at: &Vector, readings: &Vector, std: impl Fn(usize) -> f64, jacobian: &mut Matrix) {
    let (mut beside, mut there) = (at.clone(), readings.clone());
    for i in 0..at.len() {
        let step = (ROUNDING * at[i].abs()).max(OF_STD * std(i));
        let step = if step > 0.0 { step } else { ROUNDING };
        let mut column = jacobian.column_mut(i);
        for side in [1.0, -1.0] {
            beside[i] = at[i] + side * step;
            // The step after rounding.
            let taken = 2.0 * (beside[i] - at[i]);
            there.fill(0.0);
            function(beside.as_slice(), there.as_mut_slice());
            for ((entry, there), here) in column.iter_mut().zip(there.iter()).zip(readings.iter()) {
                *entry += (there - here) / taken;
            }
        }
        beside[i] = at[i];
    }
}

/// The step of a difference, in sizes of the component: the third root of the rounding.
const ROUNDING: f64 = 6e-6;

/// The step of a difference, in standard deviations.
const OF_STD: f64 = 1e-4;

/// The reason why a [`KalmanFilter`] cannot begin, or refuses a number.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SystemError {
    /// The state has no component.
    #[error("the initial mean is empty, but a state must have a component")]
    NoState,
    /// The shape of a matrix does not fit the state and the sensors.
    #[error("{matrix} is {} × {}, but must be {} × {}: {why}", .found.0, .found.1, .needed.0, .needed.1)]
    Shape {
        /// The matrix: A, B, H, Q, R or P, or the Jacobian of a measurement function.
        matrix: &'static str,
        /// Its rows and columns.
        found: (usize, usize),
        /// Those that it must have.
        needed: (usize, usize),
        /// The reason.
        why: &'static str,
    },
    /// The length of a column of numbers does not fit the system.
    #[error("{what} has {found} numbers, but must have {needed}: {why}")]
    Length {
        /// The column.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length that it must have.
        needed: usize,
        /// The reason.
        why: &'static str,
    },
    /// A number is not finite.
    #[error("{place} is {value}, but must be a finite number")]
    NotFinite {
        /// The matrix or column, with the place in it, counted from 0.
        place: String,
        /// The number.
        value: f64,
    },
    /// A covariance is not symmetric.
    #[error(
        "{matrix} must be symmetric, but {matrix}[{row}, {column}] is {one} and {matrix}[{column}, {row}] is {other}"
    )]
    Asymmetric {
        /// The matrix.
        matrix: &'static str,
        /// The place, counted from 0.
        row: usize,
        /// The place, counted from 0.
        column: usize,
        /// The entry there.
        one: f64,
        /// The entry on the other side of the diagonal.
        other: f64,
    },
    /// A covariance has a negative variance in some direction.
    #[error("{0} must be a covariance, but has a negative variance in some direction")]
    Indefinite(&'static str),
    /// The filter cannot take this step. The belief is as it was.
    #[error(transparent)]
    Filter(#[from] FilterError),
}

fn check(name: &'static str, matrix: &Matrix, needed: (usize, usize), why: &'static str) -> Result<(), SystemError> {
    let found = matrix.shape();
    if found != needed {
        return Err(SystemError::Shape { matrix: name, found, needed, why });
    }
    check_finite(matrix.as_slice(), |place| format!("{name}[{}, {}]", place % found.0, place / found.0))
}

fn check_column(name: &'static str, column: &[f64], needed: usize, why: &'static str) -> Result<(), SystemError> {
    if column.len() != needed {
        return Err(SystemError::Length { what: name, found: column.len(), needed, why });
    }
    check_finite(column, |place| format!("{name}[{place}]"))
}

fn check_finite(numbers: &[f64], name: impl Fn(usize) -> String) -> Result<(), SystemError> {
    match numbers.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(SystemError::NotFinite { place: name(place), value: numbers[place] }),
        None => Ok(()),
    }
}

/// The size of rounding in a covariance that was computed, in standard deviations of both components.
const ASYMMETRY: f64 = 1e-9;

fn covariance(name: &'static str, matrix: Matrix, n: usize, why: &'static str) -> Result<Matrix, SystemError> {
    check(name, &matrix, (n, n), why)?;
    for row in 0..n {
        for column in 0..row {
            let (one, other) = (matrix[(row, column)], matrix[(column, row)]);
            let size = (matrix[(row, row)] * matrix[(column, column)]).abs().sqrt();
            if (one - other).abs() > ASYMMETRY * size {
                return Err(SystemError::Asymmetric { matrix: name, row, column, one, other });
            }
        }
    }
    let matrix = symmetric(matrix);
    if lower_root(&matrix).is_ok() { Ok(matrix) } else { Err(SystemError::Indefinite(name)) }
}
