//! Which sensor next: the forecast for the scenario on screen, which begins again with each change of it.

use egui::Context;
use kalmanscope_core::setting::Change;
use kalmanscope_core::{Channel, Run, Scenario, Sensor, Task, Work};
use kalmanscope_lab::next_sensor::{DURATIONS, SensorForecast, SensorPlan, WHOLE};
use serde::{Deserialize, Serialize};

use super::choice::{is_same_but_for_names, part_of};
use crate::session::{Budget, Session};
use crate::team::{Lost, Priority, RunningTask, Team};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorChoice {
    /// `None` for the first one, as of the parameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filter: Option<u32>,
    /// The parameter by which sensors are ranked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameter: Option<Channel>,
    /// The place among [`DURATIONS`].
    pub duration: usize,
    pub plan: SensorPlan,
}

impl Default for SensorChoice {
    fn default() -> Self {
        Self { filter: None, parameter: None, duration: WHOLE, plan: SensorPlan::default() }
    }
}

impl SensorChoice {
    pub fn check(&self) -> Result<(), String> {
        self.plan.check()?;
        let is_known = self.duration < DURATIONS.len();
        if is_known { Ok(()) } else { Err(format!("it has the duration {}, but must have 0, 1 or 2", self.duration)) }
    }

    pub fn filter(&self, scenario: &Scenario) -> Option<u32> {
        let ids = || scenario.filters.iter().map(|filter| filter.id);
        self.filter.filter(|id| ids().any(|other| other == *id)).or_else(|| ids().next())
    }

    pub fn change(&self, sensor: Sensor, scenario: &Scenario) -> Change {
        let mut change = Change::default();
        let gone = scenario.measured().into_iter().filter(|other| self.plan.alone && *other != sensor.measures);
        gone.for_each(|quantity| change.remove_sensor(quantity));
        change.put_sensor(sensor);
        change
    }
}

/// The subject of a forecast: the scenario with one filter, and the plan.
type Question = (Scenario, SensorPlan);

#[derive(Default)]
pub struct Sensors {
    pub choice: SensorChoice,
    work: Option<(Question, RunningTask<Work<SensorForecast>>)>,
    pub shown: Option<(Question, SensorForecast)>,
    stopped: Option<Question>,
    pub problem: Option<String>,
}

impl Sensors {
    pub fn progress(&self) -> Option<f64> {
        self.work.as_ref().map(|(_, task)| task.seen)
    }

    pub fn is_stopped(&self) -> bool {
        self.stopped.is_some()
    }

    pub fn set_stopped(&mut self, stopped: bool) -> bool {
        if !stopped {
            return self.stopped.take().is_some();
        }
        let Some((question, _)) = self.work.take() else { return false };
        self.stopped = Some(question);
        true
    }

    pub(super) fn rest(&mut self) {
        self.work = None;
    }

    pub(super) fn follow(&mut self, team: &dyn Team, run: &Run, budget: Budget, ctx: &Context) {
        let begun = self.begin(team, run);
        self.problem = begun.err();
        if self.problem.is_some() {
            (self.work, self.shown) = (None, None);
        }
        let Some((_, task)) = &mut self.work else { return };
        match task.advance(&mut budget.slice()) {
            Ok(None) if task.is_beside() => {}
            Ok(None) => ctx.request_repaint(),
            Ok(Some(forecast)) => self.shown = self.work.take().map(|(question, _)| (question, forecast)),
            Err(Lost) => _ = self.set_stopped(true),
        }
    }

    fn begin(&mut self, team: &dyn Team, run: &Run) -> Result<(), String> {
        let (scenario, plan) = (run.scenario(), &self.choice.plan);
        let id = self.choice.filter(scenario).ok_or("There is no filter, whose parameters a sensor could narrow.")?;
        if run.source().is_measured() {
            return Err("The record is measured: a forecast needs a scenario's own truth and force.".to_owned());
        }
        if run.samples() > Session::LONGEST_WHOLE + 1 {
            return Err(format!("The record has {} samples: too many to follow it for every sensor.", run.samples()));
        }
        // Each input has its own seed.
        let part = Scenario { seed: 0, ..part_of(scenario, &[id]) };
        let is_it = |(of, by): &Question| by == plan && is_same_but_for_names(of, &part);
        if self.shown.as_ref().is_some_and(|(question, _)| is_it(question)) {
            (self.work, self.stopped) = (None, None);
            return Ok(());
        }
        if self.work.as_ref().is_some_and(|(question, _)| is_it(question)) || self.stopped.as_ref().is_some_and(is_it) {
            return Ok(());
        }
        self.stopped = None;
        let work = plan.clone().forecast(&part, 0).map_err(|error| format!("There is no forecast: {error}."))?;
        let task = RunningTask::begin(team, Priority::Seeds, work, Task::progress);
        self.work = Some(((part, plan.clone()), task));
        Ok(())
    }
}
