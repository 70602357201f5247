//! A Kalman filter of a system of one's own, without a scenario: a boat that is tracked in a plane.
//!
//! ```text
//! cargo run -p kalmanscope-filters --example own_system
//! ```

use kalmanscope_filters::filter::Gaussian;
use kalmanscope_filters::filter::{Matrix, Vector};
use kalmanscope_filters::{KalmanFilter, MeasurementModel, SystemError};

/// Time between samples \[s\].
const DT: f64 = 1.0;

/// The boat's position and velocity at a sample: `[x, y, vx, vy]` in m and m/s.
fn truth(k: u32) -> [f64; 4] {
    let time = DT * f64::from(k);
    [100.0 + 3.0 * time, 400.0 - 2.0 * time, 3.0, -2.0]
}

/// The filter of a boat that goes straight on, whatever its sensors: `x⁺ = A x + w`, `Q = B B' q` with the effect B of an
/// acceleration that is held for a step.
fn boat(model: impl Into<MeasurementModel>, sensor_std: [f64; 2]) -> Result<KalmanFilter, SystemError> {
    let a = Matrix::from_row_slice(4, 4, &[1., 0., DT, 0., 0., 1., 0., DT, 0., 0., 1., 0., 0., 0., 0., 1.]);
    let held = Matrix::from_row_slice(4, 2, &[0.5 * DT * DT, 0., 0., 0.5 * DT * DT, DT, 0., 0., DT]);
    let q = &held * held.transpose() * 1e-6;
    let r = Matrix::from_diagonal(&Vector::from_column_slice(&sensor_std.map(|std| std * std)));
    let start = Vector::from_column_slice(&[120.0, 380.0, 0.0, 0.0]);
    let initial = Gaussian::independent(start, &Vector::from_column_slice(&[50.0, 50.0, 5.0, 5.0]));
    KalmanFilter::new(a, Matrix::zeros(4, 0), model, q, r, initial)
}

/// Noise of standard deviation one that is no noise: the example is the same each time.
fn noise(k: u32, sensor: u32) -> f64 {
    libm::sin(f64::from(k * k + 3 * k * sensor)) * std::f64::consts::SQRT_2
}

/// Tracks the boat by its coordinates, `z = H x`, for a minute; one in five is missing. Returns the filter at the end.
///
/// # Errors
/// [`SystemError`] where the filter fails.
pub(crate) fn by_coordinates() -> Result<KalmanFilter, SystemError> {
    let h = Matrix::from_row_slice(2, 4, &[1., 0., 0., 0., 0., 1., 0., 0.]);
    let mut filter = boat(h, [5.0, 5.0])?;
    for k in 1..=60 {
        let [x, y, ..] = truth(k);
        let east = if k % 5 == 0 { f64::NAN } else { x + 5.0 * noise(k, 1) };
        filter.step(&[], &[east, y + 5.0 * noise(k, 2)])?;
    }
    Ok(filter)
}

/// Tracks the boat by a radar at the origin, `z = h(x)` with distance and bearing, for a minute. The Jacobian is that of the
/// caller, or comes from differences. Returns the filter at the end.
///
/// # Errors
/// [`SystemError`] where the filter fails.
pub(crate) fn by_radar(with_jacobian: bool) -> Result<KalmanFilter, SystemError> {
    let mut radar = MeasurementModel::function(|state, readings| {
        let (x, y) = (state[0], state[1]);
        (readings[0], readings[1]) = (libm::hypot(x, y), libm::atan2(y, x));
    });
    if with_jacobian {
        radar = radar.with_jacobian(|state, jacobian| {
            let (x, y) = (state[0], state[1]);
            let distance = libm::hypot(x, y);
            (jacobian[(0, 0)], jacobian[(0, 1)]) = (x / distance, y / distance);
            (jacobian[(1, 0)], jacobian[(1, 1)]) = (-y / (distance * distance), x / (distance * distance));
        });
    }
    let mut filter = boat(radar, [5.0, 0.01])?;
    for k in 1..=60 {
        let [x, y, ..] = truth(k);
        filter.step(&[], &[libm::hypot(x, y) + 5.0 * noise(k, 1), libm::atan2(y, x) + 0.01 * noise(k, 2)])?;
    }
    Ok(filter)
}

/// Errors of the estimate after a minute, in standard deviations.
pub(crate) fn errors(filter: &KalmanFilter) -> Vec<f64> {
    let truth = truth(60);
    (0..4).map(|i| (filter.belief.mean[i] - truth[i]) / filter.belief.cov[(i, i)].sqrt()).collect()
}

fn main() -> Result<(), SystemError> {
    for (name, filter) in [("coordinates", by_coordinates()?), ("radar", by_radar(false)?)] {
        let (mean, std) = (&filter.belief.mean, filter.belief.cov.diagonal().map(f64::sqrt));
        println!("by {name}: vx = {:.2} ± {:.2} m/s, vy = {:.2} ± {:.2} m/s", mean[2], std[2], mean[3], std[3]);
        println!("  NIS {:.2}, log likelihood {:.2}", filter.correction.nis, filter.correction.log_likelihood);
        println!("  errors in standard deviations: {:.1?}", errors(&filter));
    }
    Ok(())
}
