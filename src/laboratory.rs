//! The laboratory: maps of scores over two settings, beside the session that they follow.
//!
//! ```text
//! Session ──scenario, source──▶ Survey ──cells──▶ Team ──rows──▶ EnsembleRows ──▶ views
//! ```
//! A change of the scenario begins another survey. The earlier one stays on screen until the new one covers the map. A
//! change of the axes' own settings only moves the dot.

mod choice;
mod monte_carlo;
mod sensors;
mod settings;
mod survey;
#[cfg(test)]
mod tests;
mod tuning;

use std::rc::Rc;

use egui::Context;
use kalmanscope_core::{Run, Scenario, Source};
use serde::{Deserialize, Serialize};

use crate::session::Session;
use crate::team::{Finding, Team};

pub(crate) use choice::part_of;
pub use choice::{MOST, MapChoice};
pub use monte_carlo::{SEEDS, SeedChoice, SeedRuns, Seeds};
pub use sensors::{SensorChoice, Sensors};
pub(crate) use settings::{
    candidates, collide, label as setting_label, measure_label, name as setting_name, of_filters, offered,
};
pub use survey::Survey;
pub use tuning::{TuneChoice, TuneResult, Tuning};

const FEW: usize = 32;

pub struct Laboratory {
    team: Rc<dyn Team>,
    pub choice: Option<MapChoice>,
    survey: Option<Survey>,
    before: Option<Survey>,
    pub seeds: Seeds,
    pub tuning: Tuning,
    pub sensors: Sensors,
    /// Its number changes whenever the map has to be drawn again, also when rows have come.
    pub state: WorkState,
    pub edition: u64,
}

impl Laboratory {
    pub fn new(team: Rc<dyn Team>) -> Self {
        Self {
            team,
            choice: None,
            survey: None,
            before: None,
            seeds: Seeds::default(),
            tuning: Tuning::default(),
            sensors: Sensors::default(),
            state: WorkState::default(),
            edition: 0,
        }
    }

    pub(crate) fn work_with(&mut self, team: Rc<dyn Team>) {
        self.rest();
        self.seeds.rest();
        self.sensors.rest();
        self.team = team;
    }

    pub fn choose(&mut self, choice: Option<MapChoice>) {
        self.choice = choice;
        self.state.is_stopped = false;
    }

    pub fn shown(&self) -> Option<&Survey> {
        self.before.as_ref().or(self.survey.as_ref())
    }

    pub fn is_shown_old(&self) -> bool {
        self.before.is_some()
    }

    pub fn progress(&self) -> Option<f64> {
        let sheet = &self.survey.as_ref()?.sheet;
        (!sheet.is_complete()).then(|| sheet.done() as f64 / sheet.len() as f64)
    }

    pub fn is_working(&self) -> bool {
        self.survey.as_ref().is_some_and(|survey| survey.work.is_some())
    }

    pub fn graphics(&self) -> Option<Finding> {
        self.team.graphics().map(|graphics| graphics.found())
    }

    pub fn set_stopped(&mut self, stopped: bool) -> bool {
        let changes = self.state.set_stopped(stopped, self.progress().is_some());
        if changes {
            self.rest();
        }
        changes
    }

    pub fn follow(&mut self, session: &Session, is_in_sight: bool, is_small: bool, ctx: &Context) {
        if !is_in_sight {
            return self.rest();
        }
        let run = session.run();
        match self.fit(run, session.is_measured(), is_small) {
            Err(problem) => {
                (self.survey, self.before) = (None, None);
                self.state.fail(problem);
            }
            Ok(choice) => {
                let source = match (&self.survey, run.source()) {
                    (Some(survey), source) => survey.steady(source),
                    // A live record grows; a map is of one record, the one with which it began.
                    (None, Source::Live(record)) => Source::Measured(record),
                    (None, source) => source,
                };
                if !self.survey.as_ref().is_some_and(|survey| survey.is_of(run.scenario(), &source, &choice)) {
                    self.begin(run, source, &choice);
                }
                for survey in [&mut self.survey, &mut self.before].into_iter().flatten() {
                    survey.ensemble.call_filters(run.scenario());
                }
                self.choice = Some(choice);
                self.work(ctx);
            }
        }
    }

    pub fn follow_seeds(&mut self, session: &Session, filters: &[u32], is_in_sight: bool, ctx: &Context) {
        if !is_in_sight {
            return self.seeds.rest();
        }
        // The map comes first: seeds beside it would share its workers, and both would come late.
        let team = Some(&self.team).filter(|_| !self.is_working());
        self.seeds.follow(session.run(), filters, team, ctx);
    }

    pub fn tune(&mut self, session: &Session) {
        let Self { team, survey, tuning, .. } = self;
        tuning.begin(&**team, session.run(), session.is_measured(), survey.as_ref());
    }

    pub fn follow_tuning(&mut self, session: &Session, is_in_sight: bool, ctx: &Context) {
        if is_in_sight {
            self.tuning.follow(session.run().scenario(), session.budget(), ctx);
        }
    }

    pub fn follow_sensors(&mut self, session: &Session, is_in_sight: bool, ctx: &Context) {
        let Self { team, sensors, .. } = self;
        if is_in_sight { sensors.follow(&**team, session.run(), session.budget(), ctx) } else { sensors.rest() }
    }

    fn fit(&self, run: &Run, is_measured: bool, is_small: bool) -> Result<MapChoice, String> {
        if run.samples() > Session::LONGEST_WHOLE + 1 {
            return Err(format!("The record has {} samples: too many to run it for every cell.", run.samples()));
        }
        let (scenario, record) = (run.scenario(), run.record());
        let count = if is_small { FEW } else { self.team.usual_count() };
        let fitted = self.choice.as_ref().and_then(|choice| choice.fitted(scenario, record, is_measured));
        let choice = fitted.or_else(|| MapChoice::usual(scenario, record, is_measured, count));
        choice.ok_or_else(|| "There is no filter whose settings could be varied.".to_owned())
    }

    fn begin(&mut self, run: &Run, source: Source, choice: &MapChoice) {
        self.edition += 1;
        self.state.begin();
        self.state.version += 1;
        match Survey::new(run.scenario(), source, choice, self.survey.as_ref()) {
            Ok(survey) => {
                if let Some(mut last) = self.survey.replace(survey).filter(|last| last.sheet.covers_all()) {
                    // The earlier map stays on screen, but its missing cells would take the workers of the new one.
                    last.work = None;
                    self.before = Some(last);
                }
                // Only the scores that were computed can be shown.
                self.before = self.before.take().filter(|before| before.has(choice.measure));
            }
            Err(problem) => {
                (self.survey, self.before) = (None, None);
                self.state.fail(format!("There is no map: {problem}."));
            }
        }
    }

    fn work(&mut self, ctx: &Context) {
        let Self { team, survey, before, state, edition, .. } = self;
        let Some(survey) = survey.as_mut().filter(|_| !state.is_stopped) else { return };
        match survey.follow(team, ctx) {
            Ok(true) => state.version += 1,
            Ok(false) => {}
            Err(error) => state.fail(format!("There is no map: {error}.")),
        }
        if before.is_some() && survey.sheet.covers_all() {
            *before = None;
            *edition += 1;
            state.version += 1;
        }
    }

    fn rest(&mut self) {
        self.survey.iter_mut().for_each(|survey| survey.work = None);
    }

    pub fn choices(&self) -> Choices {
        let (seeds, sensors) = (Some(self.seeds.choice), Some(self.sensors.choice.clone()));
        Choices { map: self.choice.clone(), seeds, tuning: self.tuning.choice.clone(), sensors }
    }

    pub fn restore(&mut self, Choices { map, seeds, tuning, sensors }: Choices) {
        self.choose(map);
        self.seeds.choose(seeds.unwrap_or_default());
        self.tuning.choose(tuning);
        self.sensors.choice = sensors.unwrap_or_default();
    }
}

#[derive(Debug, Default)]
pub struct WorkState {
    pub is_stopped: bool,
    pub problem: Option<String>,
    pub version: u64,
}

impl WorkState {
    fn set_stopped(&mut self, stopped: bool, is_incomplete: bool) -> bool {
        let changes = self.is_stopped != stopped && is_incomplete;
        if changes {
            self.is_stopped = stopped;
        }
        changes
    }

    fn begin(&mut self) {
        (self.is_stopped, self.problem) = (false, None);
    }

    fn fail(&mut self, problem: String) {
        if self.problem.as_ref() != Some(&problem) {
            self.problem = Some(problem);
            self.version += 1;
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Choices {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapChoice>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seeds: Option<SeedChoice>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tuning: Option<TuneChoice>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensors: Option<SensorChoice>,
}

impl Choices {
    pub fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let Self { map, seeds, tuning, sensors } = self;
        map.as_ref().map_or(Ok(()), |map| map.check(scenario))?;
        seeds.as_ref().map_or(Ok(()), SeedChoice::check).map_err(|reason| format!("Monte Carlo: {reason}"))?;
        let of_sensors = sensors.as_ref().map_or(Ok(()), SensorChoice::check);
        of_sensors.map_err(|reason| format!("Which sensor next: {reason}"))?;
        tuning
            .as_ref()
            .map_or(Ok(()), |tuning| tuning.check(scenario))
            .map_err(|reason| format!("Tune for me: {reason}"))
    }

    /// These choices without those of filters and settings that a scenario no longer has: no view fits a choice that is not shown.
    pub(crate) fn possible_with(self, scenario: &Scenario) -> Self {
        Self {
            map: self.map.filter(|map| map.check(scenario).is_ok()),
            tuning: self.tuning.filter(|tuning| tuning.check(scenario).is_ok()),
            ..self
        }
    }

    pub(crate) fn or(self, others: Self) -> Self {
        let Self { map, seeds, tuning, sensors } = self;
        let (map, seeds) = (map.or(others.map), seeds.or(others.seeds));
        Self { map, seeds, tuning: tuning.or(others.tuning), sensors: sensors.or(others.sensors) }
    }
}
