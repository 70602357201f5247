//! The search for the best settings of a filter, a slice of each frame.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use egui::Context;
use kalmanscope_core::{FilterSettings, Run, Scenario, Source};
use kalmanscope_lab::tune::{Goal, Try, Tuned, Tuner};
use kalmanscope_lab::{Axis, Setting, simulate};

use super::choice::part_of;
use super::settings::{candidates, collide, is_possible};
use super::survey::Survey;
use crate::session::{Budget, Session};

/// The user's choice of a search, as plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct TuneChoice {
    /// The id of the filter.
    pub filter: u32,
    /// The settings with their ranges. Keys have `*` for the filter's name, as in a map.
    pub axes: Vec<Axis>,
    /// The number that is made as good as can be.
    pub goal: Goal,
}

impl TuneChoice {
    /// The noise of all sensors and a factor on √Q, of the first filter or of that with an id.
    pub fn usual(scenario: &Scenario, filter: Option<u32>) -> Option<Self> {
        let exists = |id: &u32| scenario.filters.iter().any(|filter| filter.id == *id);
        let filter = filter.filter(exists).or(scenario.filters.first().map(|filter| filter.id))?;
        let part = part_of(scenario, &[filter]);
        let is_usual = |key: &String| key.contains(".sensor_std.") || key == "filters.*.process_std";
        let keys = candidates(&part, true).into_iter().filter(is_usual);
        let axis = |key: String| Some(Axis::usual(&Setting::new(&part, &key).ok()?, &part, 2));
        Some(Self { filter, axes: keys.filter_map(axis).collect(), goal: Goal::Likelihood })
    }

    /// The same as far as the scenario has the filter, its settings and the sensor.
    pub(crate) fn fitted(&self, scenario: &Scenario) -> Option<Self> {
        if !scenario.filters.iter().any(|filter| filter.id == self.filter) {
            return Self::usual(scenario, None);
        }
        let part = part_of(scenario, &[self.filter]);
        let axes = self.axes.iter().filter(|axis| is_possible(&part, &axis.key)).cloned().collect();
        let is_measured = |goal: &Goal| match goal {
            Goal::FreeRun(sensor) => scenario.sensors.iter().any(|other| other.measures == *sensor),
            Goal::Likelihood | Goal::Consistency => true,
        };
        let goal = Some(self.goal).filter(is_measured).unwrap_or(Goal::Likelihood);
        Some(Self { filter: self.filter, axes, goal })
    }

    /// Ticks a setting, with its usual range, or unticks it. Those that would set the same number are unticked.
    pub(crate) fn toggle(&mut self, key: &str, part: &Scenario) {
        let is_ticked = self.axes.iter().any(|axis| axis.key == key);
        self.axes.retain(|axis| !collide(&axis.key, key));
        if let Ok(setting) = Setting::new(part, key)
            && !is_ticked
        {
            self.axes.push(Axis::usual(&setting, part, 2));
        }
    }
}

/// The result of a search.
pub struct TuneResult {
    choice: TuneChoice,
    /// The scenario with the filter alone, as the search found it.
    of: Scenario,
    tuned: Tuned,
}

impl TuneResult {
    /// The choice that the search began with.
    pub fn choice(&self) -> &TuneChoice {
        &self.choice
    }

    /// The path, the verdict and the remarks.
    pub fn tuned(&self) -> &Tuned {
        &self.tuned
    }

    /// The scenario with the best values; none where it has other settings than the search began with.
    pub fn applied(&self, scenario: &Scenario) -> Option<Scenario> {
        let best = self.tuned.scenario.filters.first()?;
        if part_of(scenario, &[self.choice.filter]) != self.of || self.is_applied(scenario) {
            return None;
        }
        let mut scenario = scenario.clone();
        let filter = scenario.filters.iter_mut().find(|filter| filter.id == self.choice.filter)?;
        *filter = FilterSettings { color: filter.color, ..best.clone() };
        scenario.validate().ok().map(|()| scenario)
    }

    /// Whether a scenario has the best values.
    pub fn is_applied(&self, scenario: &Scenario) -> bool {
        part_of(scenario, &[self.choice.filter]) == self.tuned.scenario
    }
}

struct Search {
    choice: TuneChoice,
    of: Scenario,
    tuner: Tuner,
}

/// The tuning of one filter.
#[derive(Default)]
pub struct Tuning {
    /// The user's choice; none for the usual one.
    choice: Option<TuneChoice>,
    search: Option<Search>,
    result: Option<TuneResult>,
    problem: Option<String>,
}

impl Tuning {
    /// The choice as far as a scenario has what it names.
    pub fn choice(&self, scenario: &Scenario) -> Option<TuneChoice> {
        let chosen = self.choice.as_ref().and_then(|choice| choice.fitted(scenario));
        chosen.or_else(|| TuneChoice::usual(scenario, None))
    }

    /// Takes over a choice.
    pub fn choose(&mut self, choice: TuneChoice) {
        self.choice = Some(choice);
    }

    /// The share of the search that is done, at least, from 0 to 1; none where none is under way.
    pub fn progress(&self) -> Option<f64> {
        self.search.as_ref().map(|search| search.tuner.progress())
    }

    /// Each try so far that was better than all before, of the search under way or else of the result.
    pub fn path(&self) -> &[Try] {
        let result = self.result.as_ref().map_or(&[][..], |result| &result.tuned.path);
        self.search.as_ref().map_or(result, |search| search.tuner.path())
    }

    /// The result of the last search that came to an end.
    pub fn result(&self) -> Option<&TuneResult> {
        self.result.as_ref()
    }

    /// Why there is no search, if so.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Stops the search. Returns whether there was one.
    pub fn cancel(&mut self) -> bool {
        self.search.take().is_some()
    }

    pub(super) fn begin(&mut self, run: &Run, is_measured: bool, survey: Option<&Survey>) {
        self.result = None;
        match self.search(run, is_measured, survey) {
            Ok(search) => (self.search, self.problem) = (Some(search), None),
            Err(problem) => (self.search, self.problem) = (None, Some(problem)),
        }
    }

    fn search(&self, run: &Run, is_measured: bool, survey: Option<&Survey>) -> Result<Search, String> {
        let choice = self.choice(run.scenario()).ok_or("There is no filter to tune.")?;
        if choice.axes.is_empty() {
            return Err("Tick a setting to tune.".to_owned());
        }
        if run.samples() > Session::LONGEST_WHOLE + 1 {
            return Err(format!("The record has {} samples: too many to run it for every try.", run.samples()));
        }
        let of = part_of(run.scenario(), &[choice.filter]);
        let record = match run.source() {
            Source::Measured(record) if is_measured => record,
            _ => Arc::new(simulate(&of)),
        };
        let tuner = Tuner::new(of.clone(), 0, record, choice.axes.clone(), choice.goal);
        let mut tuner = tuner.map_err(|error| format!("This cannot be tuned: {error}."))?;
        if let Some(values) = survey.and_then(|survey| best_of_map(survey, &choice, &of)) {
            tuner.try_values(&values);
        }
        Ok(Search { choice, of, tuner })
    }

    /// Goes on for as long as a slice of a frame allows. A search of settings that have changed since ends.
    pub(super) fn follow(&mut self, scenario: &Scenario, budget: Budget, ctx: &Context) {
        let Some(search) = &mut self.search else { return };
        if part_of(scenario, &[search.choice.filter]) != search.of {
            self.search = None;
            self.problem = Some("The settings have changed: the search has stopped.".to_owned());
            return;
        }
        if !search.tuner.advance(&mut budget.slice()) {
            ctx.request_repaint();
            return;
        }
        if let Some(Search { choice, of, tuner }) = self.search.take() {
            self.result = Some(TuneResult { choice, of, tuned: tuner.finish() });
        }
    }
}

/// The values of the tuned settings in the best cell of a map: its own settings must be among them. The others stay as they
/// are.
fn best_of_map(survey: &Survey, choice: &TuneChoice, part: &Scenario) -> Option<Vec<f64>> {
    let filter = survey.filters().iter().position(|id| *id == choice.filter)?;
    let place = |key: &str| choice.axes.iter().position(|axis| axis.key == key);
    let [x, y] = survey.axes();
    let places = [place(&x.key)?, place(&y.key)?];
    let score = |cell: usize| {
        let score = choice.goal.score(survey.value(cell, filter, choice.goal.measure())?);
        score.is_finite().then_some((cell, score))
    };
    let (best, _) = (0..survey.ensemble().cells()).filter_map(score).max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let setting = |axis: &Axis| Setting::new(part, &axis.key).ok();
    let mut values: Vec<f64> =
        choice.axes.iter().map(|axis| setting(axis).map_or(f64::NAN, |setting| setting.get(part))).collect();
    let present = survey.present(part);
    for ((at, value), present) in places.into_iter().zip(survey.ensemble().values(best)).zip(present) {
        // A factor of the map is relative to the numbers at the map's beginning.
        let is_factor = setting(&choice.axes[at]).is_some_and(|setting| setting.is_factor());
        values[at] = if is_factor { value / present } else { value };
    }
    values.iter().all(|value| value.is_finite()).then_some(values)
}
