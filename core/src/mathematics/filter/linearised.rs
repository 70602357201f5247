//! First-order linearisation at the mean: KF, EKF and iterated EKF.

use super::kind::time_of_linearised;
use super::propagation::Propagation;
use super::{FilterInfo, MethodSettings, Way};
use crate::mathematics::engine::design::Method;

/// A Jacobian counts as n evaluations, one a column, as it would take by differences.
fn evaluations(settings: &MethodSettings, n: usize) -> usize {
    match settings.propagation {
        Propagation::LocalLinearisation | Propagation::Euler => 1 + n,
        Propagation::RungeKutta => 4 * (1 + n),
    }
}

pub(super) static KF: FilterInfo = FilterInfo {
    key: "kf",
    name: "KF",
    description: "takes the parameters for known; optimal on a linear plant",
    reference: "Kalman (1960), A new approach to linear filtering and prediction problems",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations,
    time: |_, n| time_of_linearised(n),
    has_propagation: true,
    way: Way::Gaussian(|settings, _| Method::Linearised(settings.propagation, 1)),
};

pub(super) static EKF: FilterInfo = FilterInfo {
    key: "ekf",
    name: "EKF",
    description: "linearises plant and sensors at the mean",
    reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations,
    time: |_, n| time_of_linearised(n),
    has_propagation: true,
    way: Way::Gaussian(|settings, _| Method::Linearised(settings.propagation, 1)),
};

pub(super) static IEKF: FilterInfo = FilterInfo {
    key: "iekf",
    name: "IEKF",
    description: "linearises the sensors again where the update leads, by Gauss-Newton",
    reference: "Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations,
    time: |settings, n| settings.iterations.max(1) as f64 * time_of_linearised(n),
    has_propagation: true,
    way: Way::Gaussian(|settings, _| Method::Linearised(settings.propagation, settings.iterations)),
};
