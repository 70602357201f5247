//! The filters as in their papers: weighted sums, explicit inverses, `P - K S Kᵀ`.

use kalmanscope_core::{Channel, FilterKind, FilterSettings, Propagation, Quantity, Record, Scenario, Values};
use nalgebra::{DMatrix, DVector};

use super::plants::{Number, Plant, runge_kutta, value, with_jacobian};
use crate::numbers::exponential;

type Matrix = DMatrix<f64>;
type Vector = DVector<f64>;

#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) mean: Vector,
    pub(crate) cov: Matrix,
    /// NaN where nothing was measured.
    pub(crate) nis: f64,
    pub(crate) log_likelihood: f64,
}

/// A filter in progress; mean and covariance are in the state's units, which may be logarithms.
pub(crate) struct Textbook<'a> {
    scenario: &'a Scenario,
    settings: &'a FilterSettings,
    plant: Plant,
    propagation: Propagation,
    /// The steps of a prediction, and the time of one.
    parts: usize,
    dt: f64,
    pub(crate) mean: Vector,
    pub(crate) cov: Matrix,
    process: Matrix,
    noise: Vec<f64>,
}

struct Measured {
    sensors: Vec<(usize, Quantity)>,
    values: Vector,
    force: f64,
}

struct Expected {
    innovation: Vector,
    innovation_cov: Matrix,
    cross: Matrix,
}

pub(crate) fn filter(scenario: &Scenario, place: usize, record: &Record) -> Vec<Sample> {
    let mut filter = Textbook::new(scenario, &scenario.filters[place], record.dt());
    let mut samples = vec![filter.sample(f64::NAN, f64::NAN)];
    for k in 1..record.len() {
        let (nis, log_likelihood) = filter.step(record, k);
        samples.push(filter.sample(nis, log_likelihood));
    }
    samples
}

impl<'a> Textbook<'a> {
    pub(crate) fn new(scenario: &'a Scenario, settings: &'a FilterSettings, dt: f64) -> Self {
        let known = settings.kind == FilterKind::KF;
        let plant = Plant {
            kind: settings.plant.clone().unwrap_or(scenario.plant.kind.clone()),
            eta: if known { 0.0 } else { settings.eta },
            log: settings.log_parameters,
        };
        let channels = plant.channels();
        let unit = |i: usize| if plant.is_log(i) { 1.0 / settings.initial_mean[channels[i]] } else { 1.0 };
        let variances = |stds: &Values| {
            let std = |(i, &c): (usize, &Channel)| if known && c.is_parameter() { 0.0 } else { stds[c] * unit(i) };
            diagonal(channels.iter().enumerate().map(std).map(|s| s * s))
        };
        let start = |(i, &c): (usize, &Channel)| {
            if plant.is_log(i) { settings.initial_mean[c].ln() } else { settings.initial_mean[c] }
        };
        let parts = settings.steps(&scenario.plant.kind, scenario.input, dt);
        Self {
            scenario,
            propagation: settings.propagation_for(&scenario.plant.kind),
            mean: Vector::from_iterator(channels.len(), channels.iter().enumerate().map(start)),
            cov: variances(&settings.initial_std),
            process: variances(&settings.process_std),
            noise: settings.sensor_std.iter().map(|s| s * s).collect(),
            parts,
            dt: dt / parts as f64,
            settings,
            plant,
        }
    }
}

impl Textbook<'_> {
    /// Returns NIS and log likelihood.
    pub(crate) fn step(&mut self, record: &Record, k: usize) -> (f64, f64) {
        self.predict(record.force(k - 1));
        let sensors = self.scenario.sensors.iter().map(|s| s.measures).enumerate();
        let seen = |&(i, quantity): &(usize, _)| {
            let state = vec![Number::default(); self.mean.len()];
            self.plant.reading(&state, 0.0, quantity).is_some() && !record.measured(i)[k].is_nan()
        };
        let sensors: Vec<_> = sensors.filter(seen).collect();
        let values = Vector::from_iterator(sensors.len(), sensors.iter().map(|&(i, _)| record.measured(i)[k]));
        self.update(&Measured { sensors, values, force: record.force(k) })
    }

    fn sample(&self, nis: f64, log_likelihood: f64) -> Sample {
        let mut mean = self.mean.clone();
        let mut scale = vec![1.0; mean.len()];
        for i in (0..mean.len()).filter(|&i| self.plant.is_log(i)) {
            mean[i] = mean[i].exp();
            scale[i] = mean[i];
        }
        let cov = Matrix::from_fn(mean.len(), mean.len(), |i, j| scale[i] * self.cov[(i, j)] * scale[j]);
        Sample { mean, cov, nis, log_likelihood }
    }

    fn is_linearising(&self) -> bool {
        [FilterKind::KF, FilterKind::EKF, FilterKind::IEKF].contains(&self.settings.kind)
    }

    fn predict(&mut self, force: f64) {
        for _ in 0..self.parts {
            self.cov = if self.is_linearising() {
                let (mean, transition) = self.linearised_step(force);
                self.mean = mean;
                &transition * &self.cov * transition.transpose()
            } else {
                let (points, weights) = self.sigma_points();
                let step = |y: &[Number]| runge_kutta(&self.plant, y, force, self.dt);
                let images: Vec<Vector> = points.iter().map(|y| value(step, y.as_slice())).collect();
                self.mean = weighted_mean(&images, &weights);
                weighted_cov((&images, &self.mean), (&images, &self.mean), &weights)
            };
        }
        self.cov = &self.cov * self.settings.fading + &self.process;
    }

    fn linearised_step(&self, force: f64) -> (Vector, Matrix) {
        let (n, mean) = (self.mean.len(), self.mean.as_slice());
        if self.propagation == Propagation::RungeKutta {
            return with_jacobian(|y| runge_kutta(&self.plant, y, force, self.dt), mean);
        }
        let (rate, a) = with_jacobian(|y| self.plant.rate(y, force), mean);
        if self.propagation == Propagation::Euler {
            return (&self.mean + rate * self.dt, Matrix::identity(n, n) + a * self.dt);
        }
        let (transition, shift) = held(&a, rate.as_slice(), self.dt);
        (&self.mean + shift, transition)
    }

    /// Points, and the weights of each in means and in covariances. Source: van der Merwe (2004), *Sigma-Point Kalman Filters*,
    /// section 3.2 (α = 1, β = 2, κ = 3 - n); Arasaratnam and Haykin (2009), Cubature Kalman filters, section V.
    fn sigma_points(&self) -> (Vec<Vector>, Vec<[f64; 2]>) {
        let n = self.mean.len();
        let size = n as f64;
        let root = cholesky(&self.cov);
        let cubature = self.settings.kind == FilterKind::CKF;
        let (alpha, beta, kappa) = (1.0, 2.0, 3.0 - size);
        let lambda = if cubature { 0.0 } else { alpha * alpha * (size + kappa) - size };
        let distance = (size + lambda).sqrt();
        let mut points = Vec::new();
        let mut weights = Vec::new();
        if !cubature {
            let centre = lambda / (size + lambda);
            points.push(self.mean.clone());
            weights.push([centre, centre + 1.0 - alpha * alpha + beta]);
        }
        for sign in [1.0, -1.0] {
            for i in 0..n {
                points.push(&self.mean + root.column(i) * (sign * distance));
                weights.push([0.5 / (size + lambda); 2]);
            }
        }
        (points, weights)
    }

    fn readings(&self, measured: &Measured, state: &[Number]) -> Vec<Number> {
        let read = |&(_, quantity)| self.plant.reading(state, measured.force, quantity).unwrap();
        measured.sensors.iter().map(read).collect()
    }

    fn noise_of(&self, measured: &Measured) -> Matrix {
        diagonal(measured.sensors.iter().map(|&(i, _)| self.noise[i]))
    }

    fn linearised(&self, measured: &Measured, at: &Vector) -> (Expected, Matrix) {
        let (readings, h) = with_jacobian(|y| self.readings(measured, y), at.as_slice());
        // z - h(yᵢ) - H (y⁻ - yᵢ)
        let innovation = &measured.values - readings - &h * (&self.mean - at);
        let cross = &self.cov * h.transpose();
        let innovation_cov = &h * &cross + self.noise_of(measured);
        (Expected { innovation, innovation_cov, cross }, h)
    }

    fn expect(&self, measured: &Measured) -> Expected {
        if self.is_linearising() {
            return self.linearised(measured, &self.mean).0;
        }
        let (points, weights) = self.sigma_points();
        let images: Vec<Vector> = points.iter().map(|y| value(|y| self.readings(measured, y), y.as_slice())).collect();
        let mean = weighted_mean(&images, &weights);
        let cov = weighted_cov((&images, &mean), (&images, &mean), &weights);
        Expected {
            innovation: &measured.values - &mean,
            innovation_cov: cov + self.noise_of(measured),
            cross: weighted_cov((&points, &self.mean), (&images, &mean), &weights),
        }
    }

    fn update(&mut self, measured: &Measured) -> (f64, f64) {
        if measured.values.is_empty() {
            return (f64::NAN, f64::NAN);
        }
        let first = self.expect(measured);
        let Expected { innovation, innovation_cov, cross } = &first;
        let inverse = innovation_cov.clone().try_inverse().unwrap();
        let mut gain = cross * &inverse;
        let mut mean = &self.mean + &gain * innovation;
        let mut cov = &self.cov - &gain * innovation_cov * gain.transpose();
        if self.settings.kind == FilterKind::IEKF {
            for _ in 1..self.settings.iterations {
                let (expected, h) = self.linearised(measured, &mean);
                let last = mean;
                gain = expected.cross * expected.innovation_cov.try_inverse().unwrap();
                mean = &self.mean + &gain * expected.innovation;
                cov = &self.cov - &gain * h * &self.cov;
                // The core stops when a step is below a millionth of the standard deviation.
                if (0..mean.len()).all(|i| (mean[i] - last[i]).abs() <= 1e-6 * cov[(i, i)].max(0.0).sqrt()) {
                    break;
                }
            }
        }
        (self.mean, self.cov) = (mean, cov);
        self.adapt(measured, innovation, &gain);
        let nis = innovation.dot(&(inverse * innovation));
        let tau = std::f64::consts::TAU;
        (nis, -0.5 * (nis + (innovation_cov.determinant() * tau.powi(innovation.len() as i32)).ln()))
    }

    /// The residual is the innovation after the update. Source: Akhlaghi, Zhou and Huang (2017), equations 10 and 15.
    fn adapt(&mut self, measured: &Measured, innovation: &Vector, gain: &Matrix) {
        let adaptation = self.settings.adaptation;
        let keep = adaptation.forgetting;
        if adaptation.process_noise {
            let shift = gain * innovation;
            self.process = &self.process * keep + &shift * shift.transpose() * (1.0 - keep);
        }
        if adaptation.sensor_noise {
            let (readings, h) = with_jacobian(|y| self.readings(measured, y), self.mean.as_slice());
            let seen = &h * &self.cov * h.transpose();
            for (row, &(i, _)) in measured.sensors.iter().enumerate() {
                let residual = measured.values[row] - readings[row];
                self.noise[i] = keep * self.noise[i] + (1.0 - keep) * (residual * residual + seen[(row, row)]);
            }
        }
    }
}

fn diagonal(entries: impl Iterator<Item = f64>) -> Matrix {
    Matrix::from_diagonal(&Vector::from_vec(entries.collect()))
}

/// The lower triangular Cholesky factor, by the textbook's formula; the column of a zero variance is zero.
fn cholesky(cov: &Matrix) -> Matrix {
    let n = cov.nrows();
    let mut factor = Matrix::zeros(n, n);
    for j in 0..n {
        let square = cov[(j, j)] - (0..j).map(|k| factor[(j, k)] * factor[(j, k)]).sum::<f64>();
        if square > 1e-15 * cov[(j, j)] {
            for i in j..n {
                let rest = cov[(i, j)] - (0..j).map(|k| factor[(i, k)] * factor[(j, k)]).sum::<f64>();
                factor[(i, j)] = rest / square.sqrt();
            }
        }
    }
    factor
}

/// `exp(A dt)` and `dt φ₁(A dt) g`: exp([A dt, g dt; 0, 0]) = [exp(A dt), dt φ₁(A dt) g; 0, 1].
pub(crate) fn held(a: &Matrix, g: &[f64], dt: f64) -> (Matrix, Vector) {
    let n = g.len();
    let mut whole = a.clone().insert_column(n, 0.0).insert_row(n, 0.0);
    whole.view_mut((0, n), (n, 1)).copy_from_slice(g);
    let whole = exponential(&(whole * dt));
    (whole.view((0, 0), (n, n)).into_owned(), whole.view((0, n), (n, 1)).column(0).into_owned())
}

fn weighted_mean(points: &[Vector], weights: &[[f64; 2]]) -> Vector {
    let zero = Vector::zeros(points[0].len());
    points.iter().zip(weights).fold(zero, |sum, (point, weight)| sum + point * weight[0])
}

type About<'a> = (&'a [Vector], &'a Vector);

fn weighted_cov((a, a_mean): About<'_>, (b, b_mean): About<'_>, weights: &[[f64; 2]]) -> Matrix {
    let zero = Matrix::zeros(a_mean.len(), b_mean.len());
    let parts = a.iter().zip(b).zip(weights);
    parts.fold(zero, |sum, ((a, b), weight)| sum + (a - a_mean) * (b - b_mean).transpose() * weight[1])
}
