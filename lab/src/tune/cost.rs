//! The cost of a filter's settings.

use std::sync::Arc;

use argmin::core::{CostFunction, Error};
use argmin_math::{ArgminAdd, ArgminMul, ArgminSub};
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Measure, Pass, Record, Scenario, VerdictKind};

use super::Goal;
use crate::{EnsembleError, outcome};

/// The cost of settings that are impossible, beyond their axes, or stop the filter.
pub(super) const FORBIDDEN: f64 = 1e100;

pub(super) struct Cost {
    pub(super) scenario: Scenario,
    pub(super) place: usize,
    pub(super) record: Arc<Record>,
    pub(super) axes: Vec<Axis>,
    settings: Vec<Address>,
    pub(super) goal: Goal,
}

pub(super) struct Objective(pub(super) Arc<Cost>);

impl CostFunction for Objective {
    type Param = Point;
    type Output = f64;

    fn cost(&self, point: &Point) -> Result<f64, Error> {
        Ok(self.0.of(&point.0))
    }
}

impl Cost {
    pub(super) fn new(
        mut scenario: Scenario,
        place: usize,
        record: Arc<Record>,
        axes: Vec<Axis>,
        goal: Goal,
    ) -> Result<Self, EnsembleError> {
        scenario.number_filters();
        let mut settings = Vec::new();
        for axis in &axes {
            axis.check()?;
            let setting = Address::parse(&scenario, &axis.key)?;
            if !setting.is_of_filters() {
                return Err(EnsembleError::Fixed(axis.key.clone()));
            }
            settings.push(setting);
        }
        Pass::new(&scenario, place, &record)?;
        Ok(Self { scenario, place, record, axes, settings, goal })
    }

    pub(super) fn present(&self) -> Vec<f64> {
        let share = |(axis, value): (&Axis, f64)| {
            let share = axis.share_of(value);
            if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
        };
        self.axes.iter().zip(self.present_values()).map(share).collect()
    }

    pub(super) fn present_values(&self) -> Vec<f64> {
        self.settings.iter().map(|setting| setting.get(&self.scenario)).collect()
    }

    pub(super) fn values(&self, shares: &[f64]) -> Vec<f64> {
        self.axes.iter().zip(shares).map(|(axis, &share)| axis.at_share(share)).collect()
    }

    pub(super) fn with_values(&self, values: &[f64]) -> Scenario {
        let mut scenario = self.scenario.clone();
        for (setting, &value) in self.settings.iter().zip(values) {
            setting.set(&mut scenario, value);
        }
        scenario
    }

    pub(super) fn of(&self, shares: &[f64]) -> f64 {
        if !shares.iter().all(|share| (0.0..=1.0).contains(share)) {
            return FORBIDDEN;
        }
        self.of_scenario(&self.with_values(&self.values(shares)))
    }

    pub(super) fn of_scenario(&self, scenario: &Scenario) -> f64 {
        let measures = [Measure::STOPPED, self.goal.measure()];
        let Ok(row) = outcome::any(scenario, self.place, &self.record, &measures) else { return FORBIDDEN };
        let cost = -self.goal.score(row[1]);
        if row[0] == 0.0 && cost.is_finite() { cost.min(FORBIDDEN) } else { FORBIDDEN }
    }

    pub(super) fn verdict(&self, scenario: &Scenario) -> Option<VerdictKind> {
        let row = outcome::any(scenario, self.place, &self.record, &[Measure::VERDICT]).ok()?;
        VerdictKind::ALL.get(row[0] as usize).copied().filter(|_| row[0] >= 0.0)
    }
}

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
