//! The cost of a filter's settings.

use std::sync::Arc;

use argmin::core::{CostFunction, Error};
use kalmanscope_core::setting::Address;

use super::Goal;
use super::point::Point;
use crate::{EnsembleError, outcome};
use kalmanscope_core::{Axis, Measure, Pass, Record, Scenario, VerdictKind};

/// The cost of settings that are impossible, beyond their axes, or stop the filter.
pub(super) const FORBIDDEN: f64 = 1e100;

/// A filter, a record, and the settings that may be turned.
pub(super) struct Cost {
    pub(super) scenario: Scenario,
    pub(super) place: usize,
    pub(super) record: Arc<Record>,
    pub(super) axes: Vec<Axis>,
    settings: Vec<Address>,
    pub(super) goal: Goal,
}

/// The cost of points.
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

    /// The place of the scenario's own values, or the nearest one on the axes.
    pub(super) fn present(&self) -> Vec<f64> {
        let share = |(axis, value): (&Axis, f64)| {
            let share = axis.share_of(value);
            if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
        };
        self.axes.iter().zip(self.present_values()).map(share).collect()
    }

    /// The scenario's own values.
    pub(super) fn present_values(&self) -> Vec<f64> {
        self.settings.iter().map(|setting| setting.get(&self.scenario)).collect()
    }

    /// The values at a place.
    pub(super) fn values(&self, shares: &[f64]) -> Vec<f64> {
        self.axes.iter().zip(shares).map(|(axis, &share)| axis.at_share(share)).collect()
    }

    /// The scenario with these values.
    pub(super) fn with_values(&self, values: &[f64]) -> Scenario {
        let mut scenario = self.scenario.clone();
        for (setting, &value) in self.settings.iter().zip(values) {
            setting.set(&mut scenario, value);
        }
        scenario
    }

    /// The cost at a place.
    pub(super) fn of(&self, shares: &[f64]) -> f64 {
        if !shares.iter().all(|share| (0.0..=1.0).contains(share)) {
            return FORBIDDEN;
        }
        self.of_scenario(&self.with_values(&self.values(shares)))
    }

    /// The cost of a scenario: the goal's number with its sign turned.
    pub(super) fn of_scenario(&self, scenario: &Scenario) -> f64 {
        let measures = [Measure::STOPPED, self.goal.measure()];
        let Ok(row) = outcome::any(scenario, self.place, &self.record, &measures) else { return FORBIDDEN };
        let cost = -self.goal.score(row[1]);
        if row[0] == 0.0 && cost.is_finite() { cost.min(FORBIDDEN) } else { FORBIDDEN }
    }

    /// The verdict on the filter of a scenario.
    pub(super) fn verdict(&self, scenario: &Scenario) -> Option<VerdictKind> {
        let row = outcome::any(scenario, self.place, &self.record, &[Measure::VERDICT]).ok()?;
        VerdictKind::ALL.get(row[0] as usize).copied().filter(|_| row[0] >= 0.0)
    }
}
