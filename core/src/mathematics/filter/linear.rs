//! The Kalman filter of a linear system that the user defines.

use super::kalman::{Expected, condition_on};
use super::measurement_model::{Linearisation, MeasurementModel};
use super::measurements::Measurements;
use super::system::{SystemError, check, check_column, covariance};
use super::{Correction, Gaussian, Noise};
use crate::mathematics::gaussian_likelihood;
use crate::mathematics::linalg::{Matrix, Vector, add_product, copy_vector, multiply, multiply_symmetric};

/// A Kalman filter of any linear system, without a scenario: n components of the state x, p inputs u, m sensors.
///
/// ```text
/// xₖ₊₁ = A xₖ + B uₖ + w,  w ~ N(0, Q)
/// zₖ = H xₖ + v,           v ~ N(0, R),   or h(xₖ) + v with a function h
/// ```
///
/// A is n × n, B n × p, H m × n, Q n × n, R m × m: in any units, and with correlated sensors if R says so. With a
/// function h this is an extended Kalman filter ([`MeasurementModel`]).
///
/// ```
/// use kalmanscope_core::KalmanFilter;
/// use kalmanscope_core::filter::Gaussian;
/// use kalmanscope_core::filter::{Matrix, Vector};
/// # fn main() -> Result<(), kalmanscope_core::SystemError> {
/// // A cart on a rail: position and velocity, pushed by a known acceleration; a ruler reads the position.
/// let dt = 0.1;
/// let a = Matrix::from_row_slice(2, 2, &[1.0, dt, 0.0, 1.0]);
/// let b = Matrix::from_row_slice(2, 1, &[0.5 * dt * dt, dt]);
/// let h = Matrix::from_row_slice(1, 2, &[1.0, 0.0]);
/// let (q, r) = (&b * b.transpose() * 0.01, Matrix::repeat(1, 1, 0.04));
/// let initial = Gaussian::independent(Vector::zeros(2), &Vector::repeat(2, 1.0));
/// let mut filter = KalmanFilter::new(a, b, h, q, r, initial)?;
/// for k in 1..=50 {
///     let time = dt * f64::from(k);
///     let ruler = if k % 10 == 0 { f64::NAN } else { 0.5 * time * time };
///     filter.step(&[1.0], &[ruler])?;
/// }
/// assert!((filter.mean()[1] - 5.0).abs() < 0.01 && filter.cov()[(1, 1)].sqrt() < 0.1);
/// assert!(filter.log_likelihood().is_nan(), "the last reading was missing");
/// # Ok(())
/// # }
/// ```
///
/// Source: Kalman (1960), A new approach to linear filtering and prediction problems; Gelb, ed. (1974), *Applied Optimal
/// Estimation*, section 6.1 (a function h).
pub struct KalmanFilter {
    transition: Matrix,
    input: Matrix,
    model: MeasurementModel,
    noise: Noise,
    sensor_noise: Matrix,
    belief: Gaussian,
    prior: Gaussian,
    measurements: Measurements,
    linearisation: Linearisation,
    expected: Expected,
    correction: Correction,
    /// A P, and A x.
    half: Matrix,
    moved: Vector,
}

impl KalmanFilter {
    /// The filter of the system with A, B, H, Q and R, before its first prediction. A system without an input has a B of
    /// n × 0. `initial` has the mean and the covariance P of the state.
    ///
    /// # Errors
    /// [`SystemError`]: if the shape of a matrix does not fit the others, a number is not finite, or Q, R or P is no
    /// covariance.
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
        let are_correlated = (0..m).any(|i| (0..i).any(|j| sensor_noise[(i, j)] != 0.0));
        let noise = Noise { process, sensors: sensor_noise.diagonal().as_slice().to_vec(), fading: 1.0 };
        let belief = Gaussian { mean, cov };
        Ok(Self {
            prior: belief.clone(),
            measurements: Measurements::new(are_correlated),
            linearisation: Linearisation::new(m),
            expected: Expected::default(),
            correction: Correction::nothing(n, m),
            half: Matrix::zeros(0, 0),
            moved: Vector::zeros(n),
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
        let Self { transition, input: by_input, noise, belief, prior, half, moved, .. } = self;
        moved.fill(0.0);
        add_product(moved.as_mut_slice(), transition, belief.mean.as_slice());
        add_product(moved.as_mut_slice(), by_input, input);
        copy_vector(&mut prior.mean, moved);
        multiply(half, transition, &belief.cov);
        multiply_symmetric(&mut prior.cov, 1.0, half, transition);
        noise.spread(&mut prior.cov);
        prior.check()?;
        belief.copy_from(prior);
        Ok(())
    }

    /// Conditions the belief on a reading of each sensor; NaN skips a sensor.
    ///
    /// # Errors
    /// [`SystemError::Length`] where there are not m readings; [`SystemError::Filter`] where one is infinite or S is not
    /// positive definite; [`SystemError::NotFinite`] and [`SystemError::Shape`] for what a measurement function writes. The
    /// belief is then as it was.
    pub fn update(&mut self, measured: &[f64]) -> Result<(), SystemError> {
        let (n, m) = (self.belief.size(), self.sensor_noise.nrows());
        self.prior.copy_from(&self.belief);
        self.correction.clear(n, m);
        self.measurements.clear();
        if measured.len() != m {
            let why = "a number for each sensor, NaN where it has no reading";
            return Err(SystemError::Length { what: "the sample", found: measured.len(), needed: m, why });
        }
        let update = self.condition(measured);
        if update.is_err() {
            self.belief.copy_from(&self.prior);
            self.correction.clear(n, m);
            self.measurements.clear();
        }
        update
    }

    fn condition(&mut self, measured: &[f64]) -> Result<(), SystemError> {
        let Self { model, noise, sensor_noise, belief, measurements, linearisation, expected, correction, .. } = self;
        measurements.take(measured, &noise.sensors, |_| true)?;
        measurements.take_noise(sensor_noise);
        if measurements.is_empty() {
            return Ok(());
        }
        linearisation.take(model, &belief.mean, |i| belief.cov[(i, i)].sqrt());
        let shape = (sensor_noise.nrows(), belief.size());
        check("the Jacobian", &linearisation.jacobian, shape, "a row for each sensor, a column for each component")?;
        check_column("the measurement function", linearisation.readings.as_slice(), shape.0, "")?;
        linearisation.pick(measurements.sensors(), expected);
        expected.follow(belief, measurements);
        condition_on(belief, expected, measurements, correction)?;
        Ok(correction.check(measurements.sensors())?)
    }

    /// The mean of the state after the last prediction or update, n numbers.
    pub fn mean(&self) -> &Vector {
        &self.belief.mean
    }

    /// The covariance P of the state after the last prediction or update, n × n.
    pub fn cov(&self) -> &Matrix {
        &self.belief.cov
    }

    /// The belief before the last update. Since the last prediction, if no update has followed it, this is the
    /// prediction.
    pub fn prior(&self) -> &Gaussian {
        &self.prior
    }

    /// `e = z - H x⁻` of the last update, m numbers; NaN for a sensor without a reading.
    pub fn innovation(&self) -> &Vector {
        &self.correction.innovation
    }

    /// `S = H P⁻ Hᵀ + R` of the last update, the covariance of e, m × m; NaN in rows and columns of sensors without a reading.
    pub fn innovation_cov(&self) -> &Matrix {
        &self.correction.innovation_cov
    }

    /// `K = P⁻ Hᵀ S⁻¹` of the last update, n × m; zero in columns of sensors without a reading.
    pub fn gain(&self) -> &Matrix {
        &self.correction.gain
    }

    /// The normalised innovation squared `eᵀ S⁻¹ e` of the last update; NaN where nothing was measured.
    pub fn nis(&self) -> f64 {
        self.correction.nis
    }

    /// The log likelihood of the readings of the last update; NaN where nothing was measured.
    ///
    /// ```text
    /// -(NIS + ln det S + m ln 2π) / 2,  m the number of readings
    /// ```
    pub fn log_likelihood(&self) -> f64 {
        match self.measurements.len() {
            0 => f64::NAN,
            count => {
                let ln_determinant = self.correction.last.factor.ln_determinant();
                gaussian_likelihood::log_likelihood(self.correction.nis, ln_determinant, count as u32)
            }
        }
    }
}
