//! The search for the best settings of a filter.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use egui::Context;
use kalmanscope_core::setting::{Address, Change};
use kalmanscope_core::{Axis, FilterSettings, Run, Scenario, Task as _, simulate};
use kalmanscope_lab::tune::{Goal, Try, Tuned, Tuner};
use serde::{Deserialize, Serialize};

use super::choice::{is_same_but_for_names, part_of};
use super::settings::{collide, is_possible, of_filters};
use super::survey::Survey;
use crate::session::{Budget, Session};
use crate::team::{Lost, Priority, RunningTask, Team};

pub struct TuneResult {
    pub choice: TuneChoice,
    of: Scenario,
    pub tuned: Tuned,
}

impl TuneResult {
    pub fn change(&self, scenario: &Scenario) -> Option<Change> {
        let best = self.tuned.scenario.filters.first()?;
        let part = part_of(scenario, &[self.choice.filter]);
        if !is_same_but_for_names(&part, &self.of) || self.is_applied(scenario) {
            return None;
        }
        let own = scenario.filters.iter().find(|filter| filter.id == self.choice.filter)?;
        let (id, name, color) = (own.id, own.name.clone(), own.color);
        let mut change = Change::default();
        change.put_filter(0, FilterSettings { id, name, color, ..best.clone() });
        Some(change)
    }

    pub fn is_applied(&self, scenario: &Scenario) -> bool {
        is_same_but_for_names(&part_of(scenario, &[self.choice.filter]), &self.tuned.scenario)
    }
}

struct Search {
    choice: TuneChoice,
    of: Scenario,
    tuner: RunningTask<Tuner, TuneProgress>,
}

type TuneProgress = (f64, Vec<Try>);

#[derive(Default)]
pub struct Tuning {
    pub choice: Option<TuneChoice>,
    search: Option<Search>,
    pub result: Option<TuneResult>,
    pub problem: Option<String>,
}

impl Tuning {
    pub fn choice(&self, scenario: &Scenario) -> Option<TuneChoice> {
        let chosen = self.choice.as_ref().and_then(|choice| choice.fitted(scenario));
        chosen.or_else(|| TuneChoice::usual(scenario, None))
    }

    pub fn choose(&mut self, choice: Option<TuneChoice>) {
        self.choice = choice;
    }

    pub fn progress(&self) -> Option<f64> {
        self.search.as_ref().map(|search| search.tuner.seen.0)
    }

    pub fn path(&self) -> &[Try] {
        let result = self.result.as_ref().map_or(&[][..], |result| &result.tuned.path);
        self.search.as_ref().map_or(result, |search| &search.tuner.seen.1)
    }

    pub(crate) fn path_in(&self, survey: &Survey) -> Option<(usize, Vec<[f64; 2]>)> {
        let of_search = |search: &Search| path_on_map(survey, &search.choice, &search.of, &search.tuner.seen.1);
        let of_result = |result: &TuneResult| path_on_map(survey, &result.choice, &result.of, &result.tuned.path);
        match &self.search {
            Some(search) => of_search(search),
            None => self.result.as_ref().and_then(of_result),
        }
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
        // A map on screen has run all its cells already: its best one is a start that costs one run.
        let guess = survey.and_then(|survey| best_of_map(survey, &choice, &of));
        let tuner = Tuner::new(of.clone(), 0, record, choice.axes.clone(), choice.goal, guess.as_deref());
        let tuner = tuner.map_err(|error| format!("This cannot be tuned: {error}."))?;
        let look = |tuner: &Tuner| (tuner.progress(), tuner.path());
        let tuner = RunningTask::begin(team, Priority::Seeds, tuner, look);
        Ok(Search { choice, of, tuner })
    }

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

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TuneChoice {
    pub filter: u32,
    pub axes: Vec<Axis>,
    pub goal: Goal,
}

impl TuneChoice {
    pub fn usual(scenario: &Scenario, filter: Option<u32>) -> Option<Self> {
        let exists = |id: &u32| scenario.filters.iter().any(|filter| filter.id == *id);
        let filter = filter.filter(exists).or(scenario.filters.first().map(|filter| filter.id))?;
        let part = part_of(scenario, &[filter]);
        let is_usual = |key: &String| key.contains(".sensor_std.") || key == "filters.*.process_std";
        let keys = of_filters(&part).into_iter().filter(is_usual);
        let axis = |key: String| Some(Axis::usual(&Address::parse(&part, &key).ok()?, &part, 2));
        Some(Self { filter, axes: keys.filter_map(axis).collect(), goal: Goal::Likelihood })
    }

    pub fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let mut scenario = scenario.clone();
        scenario.number_filters();
        if !scenario.filters.iter().any(|filter| filter.id == self.filter) {
            return Err(format!("it is about filter number {}, which the scenario lacks", self.filter));
        }
        let part = part_of(&scenario, &[self.filter]);
        for (place, axis) in self.axes.iter().enumerate() {
            axis.check().map_err(|error| error.to_string())?;
            let setting = Address::parse(&part, &axis.key).map_err(|error| error.to_string())?;
            if !setting.is_of_filters() {
                return Err(format!("`{}` is not a setting of a filter", axis.key));
            }
            if self.axes[..place].iter().any(|other| collide(&other.key, &axis.key, &part)) {
                return Err(format!("`{}` is set twice", axis.key));
            }
        }
        match self.goal {
            Goal::FreeRun(sensor) if !scenario.sensors.iter().any(|other| other.measures == sensor) => {
                Err(format!("no sensor measures the {}", sensor.name()))
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn fitted(&self, scenario: &Scenario) -> Option<Self> {
        if !scenario.filters.iter().any(|filter| filter.id == self.filter) {
            return Self::usual(scenario, None);
        }
        let part = part_of(scenario, &[self.filter]);
        // The filter is the only one: its own settings are those of all filters.
        let of_all = |axis: &Axis| {
            let key =
                part.filters_at(&axis.key).map_or_else(|| axis.key.clone(), |(_, key)| format!("filters.*.{key}"));
            Axis { key, ..axis.clone() }
        };
        let axes = self.axes.iter().map(of_all).filter(|axis| is_possible(&part, &axis.key)).collect();
        let is_measured = |goal: &Goal| match goal {
            Goal::FreeRun(sensor) => scenario.sensors.iter().any(|other| other.measures == *sensor),
            Goal::Likelihood | Goal::Consistency => true,
        };
        let goal = Some(self.goal).filter(is_measured).unwrap_or(Goal::Likelihood);
        Some(Self { filter: self.filter, axes, goal })
    }

    pub(crate) fn toggle(&mut self, key: &str, part: &Scenario) {
        let is_ticked = self.axes.iter().any(|axis| axis.key == key);
        // A table and one of its own numbers cannot be turned together.
        self.axes.retain(|axis| !collide(&axis.key, key, part));
        if let Ok(setting) = Address::parse(part, key)
            && !is_ticked
        {
            self.axes.push(Axis::usual(&setting, part, 2));
        }
    }
}

/// The filter's place in the map, and the places of the map's axes among those of a search. `None` if one is missing.
fn places(survey: &Survey, choice: &TuneChoice) -> Option<(usize, [usize; 2])> {
    let filter = survey.filters.iter().position(|id| *id == choice.filter)?;
    let place = |key: &str| choice.axes.iter().position(|axis| axis.key == key);
    let [x, y] = survey.axes();
    Some((filter, [place(&x.key)?, place(&y.key)?]))
}

/// For each axis, the map's number over the search's: both begin at different times, and factors are relative.
fn ratios(survey: &Survey, part: &Scenario) -> [f64; 2] {
    let present = survey.present(part);
    let settings = survey.ensemble.settings();
    [0, 1].map(|at| if settings.get(at).is_some_and(Address::is_factor) { present[at] } else { 1.0 })
}

/// The tuned settings in the best cell of a map, which must vary some of them; the others stay as they are.
fn best_of_map(survey: &Survey, choice: &TuneChoice, part: &Scenario) -> Option<Vec<f64>> {
    let (filter, places) = places(survey, choice)?;
    let score = |cell: usize| {
        let score = choice.goal.score(survey.value(cell, filter, choice.goal.measure())?);
        score.is_finite().then_some((cell, score))
    };
    let (best, _) = (0..survey.ensemble.cells()).filter_map(score).max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let present = |axis: &Axis| Address::parse(part, &axis.key).map_or(f64::NAN, |setting| setting.get(part));
    let mut values: Vec<f64> = choice.axes.iter().map(present).collect();
    let ratios = ratios(survey, part);
    for ((at, value), ratio) in places.into_iter().zip(survey.ensemble.values(best)).zip(ratios) {
        values[at] = value / ratio;
    }
    values.iter().all(|value| value.is_finite()).then_some(values)
}

fn path_on_map(survey: &Survey, choice: &TuneChoice, part: &Scenario, path: &[Try]) -> Option<(usize, Vec<[f64; 2]>)> {
    let (filter, places) = places(survey, choice)?;
    let ratios = ratios(survey, part);
    let point = |tried: &Try| [0, 1].map(|at| ratios[at] * tried.values.get(places[at]).copied().unwrap_or(f64::NAN));
    Some((filter, path.iter().map(point).collect()))
}
