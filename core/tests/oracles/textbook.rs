//! The filters as in their papers: weighted sums, explicit inverses, `P - K S Kᵀ`.

use kalmanscope_core::{Channel, FilterKind, FilterSettings, Propagation, Quantity, Record, Scenario, Values};

use super::matrix::{Matrix, along, dot};
use super::plants::{Dual, Plant, jacobian, runge_kutta, values};

#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) mean: Vec<f64>,
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
    pub(crate) mean: Vec<f64>,
    pub(crate) cov: Matrix,
    process: Matrix,
    noise: Vec<f64>,
}

struct Measured {
    sensors: Vec<(usize, Quantity)>,
    values: Vec<f64>,
    force: f64,
}

struct Expected {
    innovation: Vec<f64>,
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
            Matrix::diagonal(&channels.iter().enumerate().map(std).map(|s| s * s).collect::<Vec<_>>())
        };
        let start = |(i, &c): (usize, &Channel)| {
            if plant.is_log(i) { settings.initial_mean[c].ln() } else { settings.initial_mean[c] }
        };
        let parts = settings.steps(&scenario.plant.kind, scenario.input, dt);
        Self {
            scenario,
            propagation: settings.propagation_for(&scenario.plant.kind),
            mean: channels.iter().enumerate().map(start).collect(),
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
            let state = Dual::state(&self.mean);
            self.plant.reading(&state, 0.0, quantity).is_some() && !record.measured(i)[k].is_nan()
        };
        let sensors: Vec<_> = sensors.filter(seen).collect();
        let values = sensors.iter().map(|&(i, _)| record.measured(i)[k]).collect();
        self.update(&Measured { sensors, values, force: record.force(k) })
    }

    fn sample(&self, nis: f64, log_likelihood: f64) -> Sample {
        let mut mean = self.mean.clone();
        let mut scale = vec![1.0; mean.len()];
        for i in (0..mean.len()).filter(|&i| self.plant.is_log(i)) {
            mean[i] = mean[i].exp();
            scale[i] = mean[i];
        }
        let cov = Matrix::diagonal(&scale).times(&self.cov).times(&Matrix::diagonal(&scale));
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
                transition.times(&self.cov).times(&transition.transposed())
            } else {
                let (points, weights) = self.sigma_points();
                let step = |y: &Vec<f64>| values(&runge_kutta(&self.plant, &Dual::state(y), force, self.dt));
                let images: Vec<Vec<f64>> = points.iter().map(step).collect();
                self.mean = weighted_mean(&images, &weights);
                weighted_cov((&images, &self.mean), (&images, &self.mean), &weights)
            };
        }
        self.cov = self.cov.scaled(self.settings.fading).plus(&self.process);
    }

    fn linearised_step(&self, force: f64) -> (Vec<f64>, Matrix) {
        let n = self.mean.len();
        let state = Dual::state(&self.mean);
        let rate = self.plant.rate(&state, force);
        let (rate, a) = (values(&rate), jacobian(&rate));
        match self.propagation {
            Propagation::LocalLinearisation => {
                let (transition, shift) = a.held(&rate, self.dt);
                (along(&self.mean, &shift, 1.0), transition)
            }
            Propagation::RungeKutta => {
                let next = runge_kutta(&self.plant, &state, force, self.dt);
                (values(&next), jacobian(&next))
            }
            Propagation::Euler => (along(&self.mean, &rate, self.dt), Matrix::identity(n).plus(&a.scaled(self.dt))),
        }
    }

    /// Points, and the weights of each in means and in covariances. Source: van der Merwe (2004), *Sigma-Point Kalman Filters*,
    /// section 3.2 (α = 1, β = 2, κ = 3 - n); Arasaratnam and Haykin (2009), Cubature Kalman filters, section V.
    fn sigma_points(&self) -> (Vec<Vec<f64>>, Vec<[f64; 2]>) {
        let n = self.mean.len();
        let size = n as f64;
        let root = self.cov.cholesky();
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
                points.push(along(&self.mean, &root.column(i), sign * distance));
                weights.push([0.5 / (size + lambda); 2]);
            }
        }
        (points, weights)
    }

    fn readings(&self, measured: &Measured, state: &[f64]) -> Vec<Dual> {
        let state = Dual::state(state);
        let read = |&(_, quantity)| self.plant.reading(&state, measured.force, quantity).unwrap();
        measured.sensors.iter().map(read).collect()
    }

    fn noise_of(&self, measured: &Measured) -> Matrix {
        Matrix::diagonal(&measured.sensors.iter().map(|&(i, _)| self.noise[i]).collect::<Vec<_>>())
    }

    fn linearised(&self, measured: &Measured, at: &[f64]) -> (Expected, Matrix) {
        let readings = self.readings(measured, at);
        let h = jacobian(&readings);
        // z - h(yᵢ) - H (y⁻ - yᵢ)
        let back = h.apply(&along(&self.mean, at, -1.0));
        let innovation = along(&along(&measured.values, &values(&readings), -1.0), &back, -1.0);
        let cross = self.cov.times(&h.transposed());
        let innovation_cov = h.times(&cross).plus(&self.noise_of(measured));
        (Expected { innovation, innovation_cov, cross }, h)
    }

    fn expect(&self, measured: &Measured) -> Expected {
        if self.is_linearising() {
            return self.linearised(measured, &self.mean).0;
        }
        let (points, weights) = self.sigma_points();
        let images: Vec<Vec<f64>> = points.iter().map(|y| values(&self.readings(measured, y))).collect();
        let mean = weighted_mean(&images, &weights);
        let cov = weighted_cov((&images, &mean), (&images, &mean), &weights);
        Expected {
            innovation: along(&measured.values, &mean, -1.0),
            innovation_cov: cov.plus(&self.noise_of(measured)),
            cross: weighted_cov((&points, &self.mean), (&images, &mean), &weights),
        }
    }

    fn update(&mut self, measured: &Measured) -> (f64, f64) {
        if measured.values.is_empty() {
            return (f64::NAN, f64::NAN);
        }
        let first = self.expect(measured);
        let Expected { innovation, innovation_cov, cross } = &first;
        let (inverse, determinant) = innovation_cov.inverse();
        let mut gain = cross.times(&inverse);
        let prior = self.cov.clone();
        let mut mean = along(&self.mean, &gain.apply(innovation), 1.0);
        let mut cov = prior.minus(&gain.times(innovation_cov).times(&gain.transposed()));
        if self.settings.kind == FilterKind::IEKF {
            for _ in 1..self.settings.iterations {
                let (expected, h) = self.linearised(measured, &mean);
                let last = mean;
                gain = expected.cross.times(&expected.innovation_cov.inverse().0);
                mean = along(&self.mean, &gain.apply(&expected.innovation), 1.0);
                cov = Matrix::identity(mean.len()).minus(&gain.times(&h)).times(&prior);
                // The core stops when a step is below a millionth of the standard deviation.
                if (0..mean.len()).all(|i| (mean[i] - last[i]).abs() <= 1e-6 * cov.at(i, i).max(0.0).sqrt()) {
                    break;
                }
            }
        }
        (self.mean, self.cov) = (mean, cov);
        self.adapt(measured, innovation, &gain);
        let nis = dot(innovation, &inverse.apply(innovation));
        let tau = std::f64::consts::TAU;
        (nis, -0.5 * (nis + (determinant * tau.powi(innovation.len() as i32)).ln()))
    }

    /// The residual is the innovation after the update. Source: Akhlaghi, Zhou and Huang (2017), equations 10 and 15.
    fn adapt(&mut self, measured: &Measured, innovation: &[f64], gain: &Matrix) {
        let adaptation = self.settings.adaptation;
        let keep = adaptation.forgetting;
        if adaptation.process_noise {
            let shift = gain.apply(innovation);
            self.process = self.process.scaled(keep).plus(&Matrix::outer(&shift, &shift).scaled(1.0 - keep));
        }
        if adaptation.sensor_noise {
            let readings = self.readings(measured, &self.mean);
            let h = jacobian(&readings);
            let seen = h.times(&self.cov).times(&h.transposed());
            for (row, &(i, _)) in measured.sensors.iter().enumerate() {
                let residual = measured.values[row] - readings[row].value;
                self.noise[i] = keep * self.noise[i] + (1.0 - keep) * (residual * residual + seen.at(row, row));
            }
        }
    }
}

fn weighted_mean(points: &[Vec<f64>], weights: &[[f64; 2]]) -> Vec<f64> {
    let zero = vec![0.0; points[0].len()];
    points.iter().zip(weights).fold(zero, |sum, (point, weight)| along(&sum, point, weight[0]))
}

type About<'a> = (&'a [Vec<f64>], &'a [f64]);

fn weighted_cov((a, a_mean): About<'_>, (b, b_mean): About<'_>, weights: &[[f64; 2]]) -> Matrix {
    let zero = Matrix::from_fn(a_mean.len(), b_mean.len(), |_, _| 0.0);
    a.iter().zip(b).zip(weights).fold(zero, |sum, ((a, b), weight)| {
        sum.plus(&Matrix::outer(&along(a, a_mean, -1.0), &along(b, b_mean, -1.0)).scaled(weight[1]))
    })
}
