//! Trials of causes for filters with a bad verdict.

use kalmanscope_core::Task as _;
use kalmanscope_diagnosis::Verdict;
use kalmanscope_diagnosis::{Remedy, Search};

use super::Session;
use crate::team::{Priority, RunningTask};

#[derive(Default)]
pub(super) struct Trials {
    wanted: Vec<u32>,
    attempts: Vec<Attempt>,
    is_done: bool,
}

pub struct Attempt {
    filter: u32,
    of: (u64, usize),
    search: Option<RunningTask<Search, SearchProgress>>,
    pub progress: f64,
    pub before: Option<Verdict>,
    /// The likeliest first; during the first search each keeps the place at which it was found.
    pub remedies: Vec<Remedy>,
    is_complete: bool,
}

type SearchProgress = (f64, Option<Verdict>, Vec<Remedy>);

impl Attempt {
    pub fn is_under_way(&self) -> bool {
        self.search.is_some()
    }

    fn is_beside(&self) -> bool {
        self.search.as_ref().is_some_and(RunningTask::is_beside)
    }

    pub(crate) fn picture(&self) -> u64 {
        self.of.0
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) {
        let Some(search) = &mut self.search else { return };
        // A failed search ends with its remedies so far.
        let is_done = !matches!(search.advance(while_time), Ok(None));
        let (progress, before, remedies) = &search.seen;
        self.progress = *progress;
        if is_done || !self.is_complete {
            self.before.clone_from(before);
        }
        if is_done {
            self.remedies.clone_from(remedies);
            (self.is_complete, self.search) = (true, None);
        } else if !self.is_complete {
            self.remedies = in_places_of(&self.remedies, remedies.clone());
        }
    }
}

fn in_places_of(before: &[Remedy], mut found: Vec<Remedy>) -> Vec<Remedy> {
    let mut placed = Vec::with_capacity(found.len());
    for remedy in before {
        let again = found.iter().position(|other| other.first.cause.key == remedy.first.cause.key);
        placed.extend(again.map(|place| found.remove(place)));
    }
    placed.append(&mut found);
    placed
}

impl Session {
    pub fn want_trials(&mut self, filters: Vec<u32>) {
        self.trials.wanted = filters;
    }

    pub fn attempt(&self, filter: u32) -> Option<&Attempt> {
        self.trials.attempts.iter().find(|attempt| attempt.filter == filter)
    }

    pub fn is_trying(&self) -> bool {
        !self.trials.wanted.is_empty() && !self.trials.is_done
    }

    pub(crate) fn is_trying_here(&self) -> bool {
        self.is_trying() && !self.trials.attempts.iter().any(Attempt::is_beside)
    }

    pub(super) fn try_causes(&mut self, while_time: &mut dyn FnMut() -> bool) {
        let mut attempts = std::mem::take(&mut self.trials.attempts);
        let wanted = std::mem::take(&mut self.trials.wanted);
        attempts.retain(|attempt| wanted.contains(&attempt.filter) && attempt.of.0 == self.generation);
        // A diagnosis of an earlier setting has other likely causes.
        let is_free = self.job.is_none() && self.complete && !self.owes_diagnoses();
        let mut is_done = is_free;
        for &filter in wanted.iter().filter(|_| is_free) {
            let place = self.run().estimates().iter().position(|estimates| estimates.id() == filter);
            let Some(place) = place.filter(|&place| self.is_judged(place)) else {
                attempts.retain(|attempt| attempt.filter != filter);
                continue;
            };
            let at = attempts.iter().position(|attempt| attempt.filter == filter);
            if at.is_none_or(|at| self.is_outdated(&attempts[at])) {
                let before = at.map(|at| attempts.remove(at));
                attempts.extend(self.begin_attempt(filter, place, before));
            }
            let Some(attempt) = attempts.iter_mut().find(|attempt| attempt.filter == filter) else { continue };
            // The remedies of threads are complete: to take them needs no time.
            if attempt.is_beside() || attempt.is_under_way() && while_time() {
                attempt.advance(while_time);
            }
            is_done &= !attempt.is_under_way();
        }
        (self.trials.attempts, self.trials.wanted, self.trials.is_done) = (attempts, wanted, is_done);
    }

    fn is_judged(&self, place: usize) -> bool {
        self.diagnosis(place).is_some_and(|diagnosis| diagnosis.verdict.is_some()) && self.diagnostics().len() > place
    }

    fn is_outdated(&self, attempt: &Attempt) -> bool {
        let (done, before) = (self.run().done(), attempt.of.1);
        // While it plays, a search is worth its seconds again once the record is half as long again.
        !attempt.is_under_way() && if self.playing { done > before + before / 2 } else { done != before }
    }

    fn begin_attempt(&self, filter: u32, place: usize, before: Option<Attempt>) -> Option<Attempt> {
        let run = self.run();
        let (diagnostics, estimates) = (&self.diagnostics()[place], &run.estimates()[place]);
        let search = self.diagnosis(place)?.search(run.scenario(), place, diagnostics, estimates, run.record()).ok()?;
        let of = (self.generation, run.done());
        let look = |search: &Search| (search.progress(), search.before().cloned(), search.remedies());
        let search = RunningTask::begin(&*self.team, Priority::Causes, search, look);
        let (remedies, verdict, is_complete) =
            before.map_or((Vec::new(), None, false), |attempt| (attempt.remedies, attempt.before, attempt.is_complete));
        Some(Attempt { filter, of, search: Some(search), progress: 0.0, before: verdict, remedies, is_complete })
    }
}
