//! The posterior of one filter's parameters, which follows the session.

use std::sync::Arc;

use egui::Context;
use kalmanscope_core::{Channel, Record, Scenario, Task as _};
use kalmanscope_lab::posterior::{NoPosterior, Posterior, Sampled, Solutions};

use super::choice::{is_same_but_for_names, part_of};
use crate::session::{Budget, Session};
use crate::team::{Lost, Priority, Running, Team};

/// The search begins once the scenario and the time have not changed for this time \[s\].
const STILL: f64 = 0.35;

#[derive(Clone)]
struct Subject {
    filter: u32,
    of: Scenario,
    record: Option<Arc<Record>>,
    /// The sample, and its time \[s\].
    sample: usize,
    time: f64,
}

impl Subject {
    fn of(session: &Session, filter: u32) -> Option<Self> {
        let run = session.run();
        let of = part_of(run.scenario(), &[filter]);
        let record = run.source().record().filter(|_| session.is_measured()).map(Arc::clone);
        let sample = session.index().min(run.record().len().checked_sub(1)?);
        let time = run.record().time(sample);
        (!of.filters.is_empty()).then_some(Self { filter, of, record, sample, time })
    }

    fn is_of_same(&self, other: &Self) -> bool {
        let is_same_record = match [&self.record, &other.record] {
            [Some(one), Some(other)] => Arc::ptr_eq(one, other),
            [None, None] => true,
            _ => false,
        };
        is_same_record && self.filter == other.filter && is_same_but_for_names(&self.of, &other.of)
    }

    fn is_same(&self, other: &Self) -> bool {
        (self.sample, self.time) == (other.sample, other.time) && self.is_of_same(other)
    }

    fn search(&self, team: &dyn Team, session: &Session) -> Result<Running<Posterior>, NoPosterior> {
        let record = session.run().record().part(0..self.sample + 1);
        let posterior = Posterior::new(&self.of, 0, &record)?;
        Ok(match team.posterior(&self.of, &record) {
            Some(worker) => Running::in_worker(worker, posterior, Posterior::progress),
            None => Running::begin(team, Priority::Seeds, posterior, Posterior::progress),
        })
    }
}

pub struct Shown {
    subject: Subject,
    pub sampled: Sampled,
    pub solutions: Option<(Channel, Solutions)>,
    pub is_of_now: bool,
}

impl Shown {
    pub fn filter(&self) -> u32 {
        self.subject.filter
    }

    /// The sample up to which they know the record, and its time \[s\].
    pub fn last(&self) -> (usize, f64) {
        (self.subject.sample, self.subject.time)
    }
}

struct WatchedSubject {
    subject: Subject,
    key: (u64, usize),
    /// The time since when it has been there \[s\].
    since: f64,
}

#[derive(Default)]
pub struct Posteriors {
    pub chosen: Option<u32>,
    seen: Option<WatchedSubject>,
    search: Option<Running<Posterior>>,
    pub shown: Option<Shown>,
    pub problem: Option<String>,
}

impl Posteriors {
    pub fn choose(&mut self, chosen: Option<u32>) {
        *self = Self { chosen, ..Self::default() };
    }

    pub fn progress(&self) -> Option<f64> {
        self.search.as_ref().map(|search| search.seen)
    }

    /// Stops a search. Returns whether there was one.
    pub fn cancel(&mut self) -> bool {
        let has_stopped = self.search.is_some();
        if has_stopped {
            self.choose(None);
        }
        has_stopped
    }

    pub(super) fn follow(&mut self, team: &dyn Team, session: &Session, budget: Budget, ctx: &Context) {
        let Some(filter) = self.chosen else { return };
        let (now, key) = (ctx.input(|input| input.time), (session.generation(), session.index()));
        if self.seen.as_ref().is_none_or(|seen| seen.key != key) && !self.watch(session, filter, key, now) {
            return self.choose(None);
        }
        if self.search.is_none() && !self.is_done() {
            self.begin(team, session, now, ctx);
        }
        self.go_on(budget, ctx);
    }

    fn watch(&mut self, session: &Session, filter: u32, key: (u64, usize), now: f64) -> bool {
        let Some(subject) = Subject::of(session, filter) else { return false };
        match &mut self.seen {
            Some(seen) if seen.subject.is_same(&subject) => seen.key = key,
            seen => {
                (self.search, self.problem) = (None, None);
                self.shown = self.shown.take().filter(|shown| shown.subject.is_of_same(&subject));
                if let Some(shown) = &mut self.shown {
                    shown.is_of_now = shown.subject.is_same(&subject);
                }
                *seen = Some(WatchedSubject { subject, key, since: now });
            }
        }
        true
    }

    fn is_done(&self) -> bool {
        self.problem.is_some() || self.shown.as_ref().is_some_and(|shown| shown.is_of_now)
    }

    fn begin(&mut self, team: &dyn Team, session: &Session, now: f64, ctx: &Context) {
        let Some(WatchedSubject { subject, since, .. }) = &self.seen else { return };
        if session.run().samples() > Session::LONGEST_WHOLE + 1 {
            let count = session.run().samples();
            return self.fail(format!("The record has {count} samples: too many to run it for every point."));
        }
        if session.playing() || session.behind() || ctx.input(|input| input.pointer.any_down()) {
            return;
        }
        let left = since + STILL - now;
        if left > 0.0 {
            return ctx.request_repaint_after(std::time::Duration::from_secs_f64(left));
        }
        match subject.search(team, session) {
            Ok(search) => self.search = Some(search),
            Err(reason) => self.fail(format!("There is no posterior: {reason}.")),
        }
    }

    fn go_on(&mut self, budget: Budget, ctx: &Context) {
        let Some(search) = &mut self.search else { return };
        match search.advance(&mut budget.slice()) {
            Ok(None) if search.is_beside() => {}
            Ok(None) => ctx.request_repaint(),
            Ok(Some(sampled)) => {
                self.search = None;
                match (sampled, &self.seen) {
                    (Some(sampled), Some(WatchedSubject { subject, .. })) => {
                        let (subject, solutions) = (subject.clone(), sampled.solutions());
                        self.shown = Some(Shown { subject, sampled, solutions, is_of_now: true });
                    }
                    _ => self.fail(
                        "There is no posterior: no guess within the initial belief explains the record.".to_owned(),
                    ),
                }
            }
            Err(Lost) => self.fail("The search has stopped: its thread has failed.".to_owned()),
        }
    }

    fn fail(&mut self, problem: String) {
        (self.search, self.shown) = (None, None);
        self.problem = Some(problem);
    }
}
