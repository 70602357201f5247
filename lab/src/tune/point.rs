//! Points for the optimiser.

use argmin_math::{ArgminAdd, ArgminMul, ArgminSub};

/// A point in shares of the axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point(pub(super) Vec<f64>);

impl Point {
    fn with(&self, other: &Self, each: impl Fn(f64, f64) -> f64) -> Self {
        Self(self.0.iter().zip(&other.0).map(|(&a, &b)| each(a, b)).collect())
    }
}

impl ArgminAdd<Self, Self> for Point {
    fn add(&self, other: &Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl ArgminSub<Self, Self> for Point {
    fn sub(&self, other: &Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl ArgminMul<f64, Self> for Point {
    fn mul(&self, factor: &f64) -> Self {
        Self(self.0.iter().map(|x| factor * x).collect())
    }
}
