//! The result of an update.

use super::reported::Reported;
use super::{FilterError, Observation};
use crate::mathematics::engine::single::Parts;
use crate::mathematics::linalg::{Ldl, Matrix, Vector, copy, copy_vector, fit, fit_vector};

/// The update by the sensors that measured, with everything that a smoother needs.
#[derive(Clone, Debug)]
pub(crate) struct Last {
    /// e, m numbers.
    pub(crate) innovation: Vector,
    /// S, m × m.
    pub(crate) innovation_cov: Matrix,
    /// K, n × m.
    pub(crate) gain: Matrix,
    /// H, m × n; meaningless without [`Self::has_jacobian`].
    pub(crate) jacobian: Matrix,
    /// Whether there was an H.
    pub(crate) has_jacobian: bool,
    pub(super) factor: Ldl,
    pub(super) excess: Matrix,
}

impl Default for Last {
    fn default() -> Self {
        let none = || Matrix::zeros(0, 0);
        Self {
            innovation: Vector::zeros(0),
            innovation_cov: none(),
            gain: none(),
            jacobian: none(),
            has_jacobian: false,
            factor: Ldl::default(),
            excess: none(),
        }
    }
}

/// The effect of one sample of the sensors on the belief, with n channels and m sensors. Sensors that were skipped have an innovation of NaN and no
/// gain.
#[derive(Clone, Debug)]
pub struct Correction {
    /// e = z - h(y⁻), m numbers in the sensors' units.
    pub innovation: Vector,
    /// S, the covariance of e, m × m.
    pub innovation_cov: Matrix,
    /// K, n × m. The column of a sensor is the change of each channel per unit of its innovation.
    pub gain: Matrix,
    /// The readings before those of e, S and K within the same sample, by the same sensors; NIS and det S count them too.
    pub earlier: u32,
    /// Normalised innovation squared `eᵀ S⁻¹ e`.
    pub nis: f64,
    /// det S over the sensors that were not skipped; zero or infinite if it leaves the range of numbers.
    pub determinant: f64,
    /// For a particle filter, the logarithm of the mean likelihood of its particles. NaN for any other filter: there it
    /// follows from NIS and det S.
    pub log_likelihood: f64,
    /// Effective sample size of a particle filter before it resampled; NaN for any other.
    pub effective_samples: f64,
    /// The last update. With several iterations it is not the one that is reported.
    pub(crate) last: Last,
    /// Memory to work in.
    reported: Reported,
    kept: Vec<usize>,
}

impl Default for Correction {
    /// The correction by no sensor at all.
    fn default() -> Self {
        Self::nothing(0, 0)
    }
}

impl Correction {
    /// e and S of all sensors, as they are reported.
    pub(super) fn reported(&self) -> (&Vector, &Matrix) {
        (&self.innovation, &self.innovation_cov)
    }

    /// The correction of n channels by m sensors that all measured nothing.
    pub fn nothing(n: usize, m: usize) -> Self {
        Self {
            innovation: Vector::repeat(m, f64::NAN),
            innovation_cov: Matrix::repeat(m, m, f64::NAN),
            gain: Matrix::zeros(n, m),
            earlier: 0,
            nis: f64::NAN,
            determinant: f64::NAN,
            log_likelihood: f64::NAN,
            effective_samples: f64::NAN,
            last: Last::default(),
            reported: Reported::default(),
            kept: Vec::new(),
        }
    }

    /// Makes it [`Self::nothing`], in the same memory where the sizes are the same.
    pub(crate) fn clear(&mut self, n: usize, m: usize) {
        if self.gain.shape() != (n, m) {
            *self = Self::nothing(n, m);
            return;
        }
        self.earlier = 0;
        let Self { innovation, innovation_cov, gain, nis, determinant, log_likelihood, effective_samples, .. } = self;
        innovation.fill(f64::NAN);
        innovation_cov.fill(f64::NAN);
        gain.fill(0.0);
        for number in [nis, determinant, log_likelihood, effective_samples] {
            *number = f64::NAN;
        }
    }

    /// Reports S with the variance that `more` gives added to the diagonal, and e and NIS to that S. A sensor for which it gives
    /// `None` is reported as skipped. What the update did to the belief stays.
    pub(super) fn report_with(&mut self, measured: &[usize], more: impl Fn(usize) -> Option<f64>) {
        let mut kept = std::mem::take(&mut self.kept);
        kept.clear();
        for &sensor in measured {
            let Some(more) = more(sensor) else {
                self.innovation[sensor] = f64::NAN;
                self.innovation_cov.row_mut(sensor).fill(f64::NAN);
                self.innovation_cov.column_mut(sensor).fill(f64::NAN);
                continue;
            };
            self.innovation_cov[(sensor, sensor)] += more;
            kept.push(sensor);
        }
        self.take_squares(&kept);
        self.kept = kept;
    }

    /// Adds the effect of a later update within the same sample, which is independent of this one. e, S and K of a sensor that is in
    /// both are those of the later one.
    pub(crate) fn add(&mut self, later: &Self) {
        let has = |correction: &Self, sensor: usize| !correction.innovation[sensor].is_nan();
        let m = self.innovation.len();
        let in_later = |sensor: &usize| has(later, *sensor);
        for sensor in (0..m).filter(in_later) {
            self.earlier += u32::from(has(self, sensor));
            self.innovation[sensor] = later.innovation[sensor];
            self.gain.set_column(sensor, &later.gain.column(sensor));
            for other in 0..m {
                let both = match (in_later(&other), has(self, other)) {
                    (true, _) => later.innovation_cov[(sensor, other)],
                    (false, true) => 0.0,
                    (false, false) => f64::NAN,
                };
                (self.innovation_cov[(sensor, other)], self.innovation_cov[(other, sensor)]) = (both, both);
            }
        }
        if self.nis.is_nan() {
            (self.nis, self.determinant) = (later.nis, later.determinant);
        } else if !later.nis.is_nan() {
            (self.nis, self.determinant) = (self.nis + later.nis, self.determinant * later.determinant);
        }
    }

    /// NIS and det S of e and S as they are reported, over these sensors; NaN without any.
    pub(crate) fn take_squares(&mut self, kept: &[usize]) {
        let Self { reported, innovation, innovation_cov, .. } = self;
        let squares = reported.squares((innovation, innovation_cov), kept);
        [self.nis, self.determinant] = squares.unwrap_or([f64::NAN; 2]);
    }

    /// Takes in e, S with its factor, and K of the sensors that measured; each number goes to the place of its sensor.
    pub fn report(
        &mut self,
        observation: &Observation,
        innovation: &Vector,
        innovation_cov: &Matrix,
        factor: &Ldl,
        gain: &Matrix,
    ) {
        let last = &mut self.last;
        copy_vector(&mut last.innovation, innovation);
        copy(&mut last.innovation_cov, innovation_cov);
        copy(&mut last.gain, gain);
        last.factor = factor.clone();
        last.has_jacobian = false;
        self.report_last(observation.sensors());
    }

    /// Checks that the measurements of these sensors have a finite likelihood.
    ///
    /// # Errors
    /// [`FilterError::ImpossibleMeasurement`], and [`FilterError::NotFinite`] if the belief is the reason.
    pub(super) fn check(&self, sensors: &[usize]) -> Result<(), FilterError> {
        // A factor of S has a finite ln det S.
        if self.nis.is_finite() && !self.log_likelihood.is_infinite() {
            return Ok(());
        }
        let surprising = sensors.iter().all(|&sensor| self.innovation[sensor].is_finite());
        Err(if surprising { FilterError::ImpossibleMeasurement } else { FilterError::NotFinite })
    }

    /// Takes in an update by the engine, of a belief over n components.
    pub(super) fn take(&mut self, observation: &Observation, parts: Parts<'_>, n: usize) {
        let (m, [innovation, innovation_cov, gain]) = (observation.len(), parts.numbers());
        let last = &mut self.last;
        fit_vector(&mut last.innovation, m);
        last.innovation.copy_from_slice(innovation);
        fit(&mut last.innovation_cov, m, m);
        last.innovation_cov.copy_from_slice(innovation_cov);
        last.innovation_cov.fill_upper_triangle_with_lower_triangle();
        fit(&mut last.gain, n, m);
        last.gain.copy_from_slice(gain);
        fit(&mut last.jacobian, m, n);
        last.has_jacobian = parts.jacobian_into(last.jacobian.as_mut_slice());
    }

    /// Reports the last update, with its NIS and det S.
    pub(super) fn tell(&mut self, observation: &Observation, [nis, determinant]: [f64; 2]) {
        (self.nis, self.determinant) = (nis, determinant);
        let Last { innovation, innovation_cov, .. } = &self.last;
        for (i, &row) in observation.sensors().iter().enumerate() {
            self.innovation[row] = innovation[i];
            for (j, &column) in observation.sensors().iter().enumerate() {
                self.innovation_cov[(row, column)] = innovation_cov[(i, j)];
            }
        }
        self.tell_gain(observation);
    }

    /// Reports the gain of the last update.
    pub(super) fn tell_gain(&mut self, observation: &Observation) {
        let gain = &self.last.gain;
        let n = gain.nrows();
        for (i, &sensor) in observation.sensors().iter().enumerate() {
            self.gain.as_mut_slice()[sensor * n..][..n].copy_from_slice(&gain.as_slice()[i * n..][..n]);
        }
    }

    /// Reports the last update, by these sensors.
    pub(super) fn report_last(&mut self, sensors: &[usize]) {
        let Last { innovation, innovation_cov, gain, factor, .. } = &self.last;
        self.nis = factor.square(innovation);
        self.determinant = factor.determinant();
        for (i, &row) in sensors.iter().enumerate() {
            self.innovation[row] = innovation[i];
            let n = gain.nrows();
            self.gain.as_mut_slice()[row * n..][..n].copy_from_slice(&gain.as_slice()[i * n..][..n]);
            for (j, &column) in sensors.iter().enumerate() {
                self.innovation_cov[(row, column)] = innovation_cov[(i, j)];
            }
        }
    }
}
