//! The measurement models of systems that the user defines.

use crate::mathematics::linalg::{Matrix, Vector};

/// The measurement model of a [`KalmanFilter`](super::KalmanFilter) with m sensors and n components of the state: `z =
/// H x` with an m × n matrix H, or `z = h(x)` with a function.
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
    /// A function that writes the m readings in a state of n components. Its Jacobian is found by differences, with 2n calls
    /// in an update:
    ///
    /// ```text
    /// ∂h/∂xᵢ ≈ (h(x + d eᵢ) - h(x - d eᵢ)) / 2d,  d = max(6e-6 |xᵢ|, 1e-4 σᵢ)
    /// ```
    pub fn function(function: impl Fn(&[f64], &mut [f64]) + Send + 'static) -> Self {
        Self(Kind::Function { function: Box::new(function), jacobian: None })
    }

    /// The same function with its Jacobian `∂h/∂x`: `jacobian` writes it over an m × n matrix of zeros. A model with a
    /// matrix H ignores it.
    #[must_use]
    pub fn with_jacobian(self, jacobian: impl Fn(&[f64], &mut Matrix) + Send + 'static) -> Self {
        match self.0 {
            Kind::Function { function, .. } => Self(Kind::Function { function, jacobian: Some(Box::new(jacobian)) }),
            linear @ Kind::Matrix(_) => Self(linear),
        }
    }

    /// H, if the readings are linear in the state.
    pub(super) fn matrix(&self) -> Option<&Matrix> {
        match &self.0 {
            Kind::Matrix(matrix) => Some(matrix),
            Kind::Function { .. } => None,
        }
    }
}

/// The readings of all sensors in a state, with their derivatives by the state.
#[derive(Clone, Debug)]
pub(super) struct Linearisation {
    /// h(x), m numbers.
    pub(super) readings: Vector,
    /// H, m × n.
    pub(super) jacobian: Matrix,
    /// A state near the first one, and the readings in it.
    beside: Vector,
    there: Vector,
}

impl Linearisation {
    /// Memory for m sensors.
    pub(super) fn new(m: usize) -> Self {
        let none = || Vector::zeros(0);
        Self { readings: Vector::zeros(m), jacobian: Matrix::zeros(0, 0), beside: none(), there: none() }
    }

    /// Takes readings and Jacobian in the state `at`; `std` gives the standard deviation of a component.
    pub(super) fn take(&mut self, model: &MeasurementModel, at: &Vector, std: impl Fn(usize) -> f64) {
        let Self { readings, jacobian, .. } = self;
        match &model.0 {
            Kind::Matrix(matrix) => {
                jacobian.clone_from(matrix);
                readings.gemv(1.0, matrix, at, 0.0);
            }
            Kind::Function { function, jacobian: of_ones_own } => {
                readings.fill(0.0);
                function(at.as_slice(), readings.as_mut_slice());
                *jacobian = Matrix::zeros(readings.len(), at.len());
                match of_ones_own {
                    Some(of_ones_own) => of_ones_own(at.as_slice(), jacobian),
                    None => self.differences(function, at, std),
                }
            }
        }
    }

    /// Central differences. A step is a share of a standard deviation, within which h counts as linear, and large against the
    /// rounding of the component.
    fn differences(&mut self, function: &Function, at: &Vector, std: impl Fn(usize) -> f64) {
        let Self { readings, jacobian, beside, there } = self;
        beside.clone_from(at);
        *there = Vector::zeros(readings.len());
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
}

/// The step of a difference, in sizes of the component: the third root of the rounding.
const ROUNDING: f64 = 6e-6;

/// The step of a difference, in standard deviations.
const OF_STD: f64 = 1e-4;
