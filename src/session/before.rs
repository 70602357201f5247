//! The picture from before a change: the filters that the change concerns, with their settings from before, on the record from
//! before.

use std::sync::Arc;

use kalmanscope_core::setting::{Change, Changed};
use kalmanscope_core::{Channel, Diagnostics, Estimates, Scenario, ScenarioError};
use kalmanscope_diagnosis::{Hindsight, Study, Wanted};

use super::{Mode, Session};
use crate::text::significant;

/// Edits that follow each other within this time are one change \[s\].
const ONE_CHANGE: f64 = 0.8;

/// Limits the samples of a picture from before: twice the work must remain a short work.
const MOST: usize = 20_000;

/// These words stand for the settings before, where another scenario has been opened since.
const ANOTHER: &str = "other settings";

#[derive(Clone)]
pub struct Version {
    pub(super) scenario: Arc<Scenario>,
    pub(super) opening: Arc<()>,
}

impl Version {
    pub(super) fn opened(mut scenario: Scenario) -> Self {
        scenario.number_filters();
        scenario.keep_draws();
        Self { scenario: Arc::new(scenario), opening: Arc::default() }
    }
}

impl PartialEq for Version {
    fn eq(&self, other: &Self) -> bool {
        // Each edit makes another scenario, so nobody compares their contents in each frame.
        Arc::ptr_eq(&self.scenario, &other.scenario)
    }
}

pub struct Before {
    version: Version,
    study: Study,
    pub words: String,
    is_of_filters: bool,
    is_complete: bool,
}

impl Before {
    pub fn estimates(&self, id: u32) -> Option<&Estimates> {
        let all = self.study.run().estimates();
        all.iter().find(|estimates| estimates.id() == id).filter(|estimates| !estimates.is_empty())
    }

    pub fn diagnostics(&self, id: u32) -> Option<(&Diagnostics, &Estimates)> {
        let (analysis, all) = (self.study.analysis(), self.study.run().estimates());
        analysis.diagnostics().iter().zip(all).find(|(_, estimates)| estimates.id() == id)
    }

    pub fn truth(&self, channel: Channel) -> Option<&[f64]> {
        self.study.run().record().truth(channel).filter(|_| !self.is_of_filters)
    }

    pub fn len(&self) -> usize {
        self.study.run().len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn record(&self) -> &kalmanscope_core::Record {
        self.study.run().record()
    }
}

impl Session {
    pub fn edit(&mut self, change: &Change) -> Result<(), ScenarioError> {
        let mut scenario = (*self.scenario).clone();
        self.changed.extend(change.apply(&mut scenario)?);
        self.restore(Version { opening: Arc::clone(&self.opening), ..Version::opened(scenario) });
        Ok(())
    }

    pub fn replace(&mut self, scenario: Scenario) {
        self.restore(Version::opened(scenario));
    }

    pub fn version(&self) -> Version {
        Version { scenario: Arc::clone(&self.scenario), opening: Arc::clone(&self.opening) }
    }

    pub fn restore(&mut self, version: Version) {
        let goes_on = self.since_edit < ONE_CHANGE && self.before.is_some();
        self.since_edit = 0.0;
        let was = self.version();
        self.show(version);
        match (&self.before, &self.other) {
            (_, Some(other)) => self.remember(other.clone()),
            (Some(before), None) if goes_on => self.remember(before.version.clone()),
            _ => self.remember(was),
        }
    }

    pub fn rest(&mut self, elapsed: f64) {
        self.since_edit += elapsed;
    }

    pub fn before(&self) -> Option<&Before> {
        let is_shown = |before: &&Before| {
            let same_times = before.study.run().record().dt() == self.run().record().dt();
            let kept = self.run().record().forgotten() == 0;
            before.is_complete && same_times && kept && !before.words.is_empty()
        };
        self.before.as_ref().filter(is_shown)
    }

    pub fn forget_before(&mut self) {
        self.before = None;
        self.generation += 1;
    }

    pub fn has_snapshot(&self) -> bool {
        self.other.is_some()
    }

    pub fn swap_snapshot(&mut self) {
        let now = self.version();
        let next = self.other.replace(now.clone()).unwrap_or_else(|| now.clone());
        self.since_edit = f64::INFINITY;
        if next != now {
            self.show(next);
        }
        self.remember(now);
    }

    pub fn begin_anew(&mut self) {
        self.other = None;
        self.forget_before();
        if self.waiting {
            self.begin_job();
        }
        self.is_opened = self.job.is_some();
    }

    pub fn is_before_behind(&self) -> bool {
        self.before.as_ref().is_some_and(|before| !before.is_complete)
    }

    fn remember(&mut self, version: Version) {
        let was = &version.scenario;
        let changed = Changed::among(&self.changed, was, &self.scenario);
        let is_same_plant = was.plant.kind.equation() == self.scenario.plant.kind.equation();
        let changed = Some(changed).filter(|_| is_same_plant && Arc::ptr_eq(&version.opening, &self.opening));
        let is_kept = |id: u32| self.scenario.filters.iter().any(|filter| filter.id == id);
        let concerns = |id: u32| is_kept(id) && changed.as_ref().is_none_or(|changed| changed.concerns(id));
        let ids: Vec<u32> = was.filters.iter().map(|filter| filter.id).filter(|&id| concerns(id)).collect();
        let is_of_filters = changed.as_ref().is_some_and(Changed::is_of_filters);
        let words = changed.map_or_else(|| ANOTHER.to_owned(), |changed| difference(&changed).unwrap_or_default());
        let words = match (&self.other, words.is_empty()) {
            (Some(_), false) => format!("snapshot: {words}"),
            _ => words,
        };
        if let Some(before) = &mut self.before
            && before.version == version
            && before.study.run().scenario().filters.iter().map(|filter| filter.id).eq(ids.iter().copied())
        {
            (before.words, before.is_of_filters) = (words, is_of_filters);
            return;
        }
        self.before = None;
        self.generation += 1;
        let Ok(source) = self.library.source(was) else { return };
        let samples = source.record().map_or_else(|| was.samples(), |record| record.len());
        if samples > MOST {
            return;
        }
        let mut shown = (**was).clone();
        shown.filters.retain(|filter| ids.contains(&filter.id));
        // An impossible scenario has no picture.
        if let Ok(study) = Study::new(shown, source, MOST + 1) {
            self.before = Some(Before { version, study, words, is_of_filters, is_complete: false });
        }
    }

    pub(super) fn follow_before(&mut self, while_time: &mut dyn FnMut() -> bool) {
        if self.behind() {
            return;
        }
        let (done, wanted) = (self.run().done(), self.wanted);
        let is_whole = self.mode() == Mode::Whole;
        let Some(before) = &mut self.before else { return };
        let goal = if is_whole { usize::MAX } else { done };
        let was_complete = before.is_complete;
        if before.study.run().done() > goal {
            // The run has gone back to an earlier time.
            let scenario = before.study.run().scenario().clone();
            let source = before.study.run().source();
            if let Ok(study) = Study::new(&scenario, source, MOST + 1) {
                before.study = study;
            }
        }
        if let Some(record) = self.library.live().filter(|_| before.study.run().is_live()) {
            before.study.lengthen(Arc::clone(record));
        }
        before.study.want(Wanted { smoothed: Hindsight::None, bounds: false, ..wanted });
        before.is_complete = before.study.advance_to(goal, while_time) || (was_complete && !is_whole);
        if before.is_complete != was_complete {
            self.generation += 1;
        }
    }
}

const NAMED: usize = 2;

fn difference(change: &Changed<'_>) -> Option<String> {
    let all = change.what_was(|number| significant(number, 4));
    let more = if all.len() > NAMED { ", …" } else { "" };
    (!all.is_empty()).then(|| all.into_iter().take(NAMED).collect::<Vec<_>>().join(", ") + more)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edited(session: &mut Session, settings: &[(&str, f64)]) -> String {
        let mut change = Change::default();
        settings.iter().for_each(|(address, value)| change.set(session.scenario(), address, *value));
        session.rest(2.0 * ONE_CHANGE);
        session.edit(&change).unwrap();
        session.before.as_ref().unwrap().words.clone()
    }

    #[test]
    fn a_change_is_named_by_what_was_before() {
        let mut session = Session::new(Scenario { duration: 1.0, ..Scenario::default() }).unwrap();
        let first = session.version();
        assert_eq!(edited(&mut session, &[("filters#1.fading", 1.0)]), "EKF λ = 1.005");
        let all = [("filters#1.fading", 1.2), ("filters#1.initial_mean.natural_frequency", 9.0), ("seed", 7.0)];
        assert_eq!(edited(&mut session, &all), "EKF λ = 1, EKF guess ωₙ = 8, …");
        session.restore(first);
        session.rest(2.0 * ONE_CHANGE);
        session.replace(Scenario { seed: 9, ..session.scenario().clone() });
        assert_eq!(session.before.as_ref().unwrap().words, ANOTHER);
        assert!(Arc::ptr_eq(&session.scenario, &session.run().shared_scenario()), "the run has the session's scenario");
    }
}
