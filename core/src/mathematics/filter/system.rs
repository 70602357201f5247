//! The matrices of a system that the user defines, and the errors in them.

use std::fmt;

use thiserror::Error;

use super::FilterError;
use crate::mathematics::linalg::{Matrix, RootError, lower_root, symmetric};

/// The reason why a [`KalmanFilter`](super::KalmanFilter) cannot begin, or refuses a number.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SystemError {
    /// The state has no component.
    #[error("the initial mean is empty, but a state must have a component")]
    NoState,
    /// The shape of a matrix does not fit the state and the sensors.
    #[error("{matrix} is {found}, but must be {needed}: {why}")]
    Shape {
        /// The matrix: A, B, H, Q, R or P, or the Jacobian of a measurement function.
        matrix: &'static str,
        /// Its shape.
        found: Shape,
        /// The shape that it must have.
        needed: Shape,
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

/// Rows and columns of a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape(pub usize, pub usize);

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} × {}", self.0, self.1)
    }
}

pub(super) fn check(
    name: &'static str,
    matrix: &Matrix,
    needed: (usize, usize),
    why: &'static str,
) -> Result<(), SystemError> {
    let (rows, columns) = matrix.shape();
    if (rows, columns) != needed {
        let (found, needed) = (Shape(rows, columns), Shape(needed.0, needed.1));
        return Err(SystemError::Shape { matrix: name, found, needed, why });
    }
    match matrix.iter().position(|value| !value.is_finite()) {
        Some(place) => {
            let (row, column) = (place % rows, place / rows);
            let value = matrix[(row, column)];
            Err(SystemError::NotFinite { place: format!("{name}[{row}, {column}]"), value })
        }
        None => Ok(()),
    }
}

pub(super) fn check_column(
    name: &'static str,
    column: &[f64],
    needed: usize,
    why: &'static str,
) -> Result<(), SystemError> {
    if column.len() != needed {
        return Err(SystemError::Length { what: name, found: column.len(), needed, why });
    }
    match column.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(SystemError::NotFinite { place: format!("{name}[{place}]"), value: column[place] }),
        None => Ok(()),
    }
}

/// The size of rounding in a covariance that was computed, in standard deviations of both components.
const ROUNDING: f64 = 1e-9;

/// A covariance of n components, symmetric to the last bit.
pub(super) fn covariance(
    name: &'static str,
    matrix: Matrix,
    n: usize,
    why: &'static str,
) -> Result<Matrix, SystemError> {
    check(name, &matrix, (n, n), why)?;
    for row in 0..n {
        for column in 0..row {
            let (one, other) = (matrix[(row, column)], matrix[(column, row)]);
            let size = (matrix[(row, row)] * matrix[(column, column)]).abs().sqrt();
            if (one - other).abs() > ROUNDING * size {
                return Err(SystemError::Asymmetric { matrix: name, row, column, one, other });
            }
        }
    }
    let matrix = symmetric(matrix);
    match lower_root(&matrix) {
        Ok(_) => Ok(matrix),
        Err(RootError::Indefinite | RootError::NotFinite) => Err(SystemError::Indefinite(name)),
    }
}
