//! The search for the best settings of a filter.

mod choice;
mod on_map;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use egui::Context;
use kalmanscope_core::simulate;
use kalmanscope_core::{FilterSettings, Run, Scenario, Task as _};
use kalmanscope_lab::tune::{Try, Tuned, Tuner};

use super::choice::{is_same_but_for_names, part_of};
use super::survey::Survey;
use crate::session::{Budget, Session};
use crate::team::{Lost, Priority, Running, Team};
use on_map::{best_of_map, path_on_map};

pub use choice::TuneChoice;

pub struct TuneResult {
    choice: TuneChoice,
    of: Scenario,
    tuned: Tuned,
}

impl TuneResult {
    pub fn choice(&self) -> &TuneChoice {
        &self.choice
    }

    pub fn tuned(&self) -> &Tuned {
        &self.tuned
    }

    /// The scenario with the best values. `None` if its settings have changed since the search began.
    pub fn applied(&self, scenario: &Scenario) -> Option<Scenario> {
        let best = self.tuned.scenario.filters.first()?;
        let part = part_of(scenario, &[self.choice.filter]);
        if !is_same_but_for_names(&part, &self.of) || self.is_applied(scenario) {
            return None;
        }
        let mut scenario = scenario.clone();
        let filter = scenario.filters.iter_mut().find(|filter| filter.id == self.choice.filter)?;
        *filter = FilterSettings { color: filter.color, name: std::mem::take(&mut filter.name), ..best.clone() };
        scenario.validate().ok().map(|()| scenario)
    }

    pub fn is_applied(&self, scenario: &Scenario) -> bool {
        is_same_but_for_names(&part_of(scenario, &[self.choice.filter]), &self.tuned.scenario)
    }
}

struct Search {
    choice: TuneChoice,
    of: Scenario,
    tuner: Running<Tuner, Seen>,
}

type Seen = (f64, Vec<Try>);

#[derive(Default)]
pub struct Tuning {
    choice: Option<TuneChoice>,
    search: Option<Search>,
    result: Option<TuneResult>,
    problem: Option<String>,
}

impl Tuning {
    pub fn choice(&self, scenario: &Scenario) -> Option<TuneChoice> {
        let chosen = self.choice.as_ref().and_then(|choice| choice.fitted(scenario));
        chosen.or_else(|| TuneChoice::usual(scenario, None))
    }

    pub fn chosen(&self) -> Option<&TuneChoice> {
        self.choice.as_ref()
    }

    pub fn choose(&mut self, choice: Option<TuneChoice>) {
        self.choice = choice;
    }

    /// A lower limit of the share of the search that is done, from 0 to 1. `None` if no search is under way.
    pub fn progress(&self) -> Option<f64> {
        self.search.as_ref().map(|search| search.tuner.seen().0)
    }

    /// Each try so far that was better than all before, of the search under way or else of the result.
    pub fn path(&self) -> &[Try] {
        let result = self.result.as_ref().map_or(&[][..], |result| &result.tuned.path);
        self.search.as_ref().map_or(result, |search| &search.tuner.seen().1)
    }

    /// The path of the search in a map, if the search tunes both of the map's axes: the filter's place in the map, and
    /// the points.
    pub(crate) fn path_in(&self, survey: &Survey) -> Option<(usize, Vec<[f64; 2]>)> {
        let of_search = |search: &Search| path_on_map(survey, &search.choice, &search.of, &search.tuner.seen().1);
        let of_result = |result: &TuneResult| path_on_map(survey, &result.choice, &result.of, &result.tuned.path);
        match &self.search {
            Some(search) => of_search(search),
            None => self.result.as_ref().and_then(of_result),
        }
    }

    pub fn result(&self) -> Option<&TuneResult> {
        self.result.as_ref()
    }

    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    pub fn cancel(&mut self) -> bool {
        self.search.take().is_some()
    }

    pub(super) fn begin(&mut self, team: &dyn Team, run: &Run, is_measured: bool, survey: Option<&Survey>) {
        self.result = None;
        match self.search(team, run, is_measured, survey) {
            Ok(search) => (self.search, self.problem) = (Some(search), None),
            Err(problem) => (self.search, self.problem) = (None, Some(problem)),
        }
    }

    fn search(&self, team: &dyn Team, run: &Run, is_measured: bool, survey: Option<&Survey>) -> Result<Search, String> {
        let choice = self.choice(run.scenario()).ok_or("There is no filter to tune.")?;
        if choice.axes.is_empty() {
            return Err("Tick a setting to tune.".to_owned());
        }
        if run.samples() > Session::LONGEST_WHOLE + 1 {
            return Err(format!("The record has {} samples: too many to run it for every try.", run.samples()));
        }
        let of = part_of(run.scenario(), &[choice.filter]);
        let given = run.source().record().filter(|_| is_measured).map(Arc::clone);
        let record = given.unwrap_or_else(|| Arc::new(simulate(&of)));
        let tuner = Tuner::new(of.clone(), 0, record, choice.axes.clone(), choice.goal);
        let mut tuner = tuner.map_err(|error| format!("This cannot be tuned: {error}."))?;
        if let Some(values) = survey.and_then(|survey| best_of_map(survey, &choice, &of)) {
            tuner.try_values(&values);
        }
        let look = |tuner: &Tuner| (tuner.progress(), tuner.path().to_vec());
        let tuner = Running::begin(team, Priority::Seeds, tuner, look);
        Ok(Search { choice, of, tuner })
    }

    /// Continues for a slice of a frame, or reads the progress of its thread. Ends a search whose settings have changed.
    pub(super) fn follow(&mut self, scenario: &Scenario, budget: Budget, ctx: &Context) {
        let Some(search) = &mut self.search else { return };
        if !is_same_but_for_names(&part_of(scenario, &[search.choice.filter]), &search.of) {
            self.search = None;
            self.problem = Some("The settings have changed: the search has stopped.".to_owned());
            return;
        }
        match search.tuner.advance(&mut budget.slice()) {
            Ok(None) if search.tuner.is_beside() => {}
            Ok(None) => ctx.request_repaint(),
            Ok(Some(tuned)) => {
                self.result = self.search.take().map(|Search { choice, of, .. }| TuneResult { choice, of, tuned });
            }
            Err(Lost) => {
                self.search = None;
                self.problem = Some("The search has stopped: its thread has failed.".to_owned());
            }
        }
    }
}
