//! The posterior of one filter's parameters, which follows the session.

use std::sync::Arc;

use egui::Context;
use kalmanscope_core::{Record, Scenario, Task as _};
use kalmanscope_lab::posterior::{NoPosterior, Posterior, Sampled};

use super::choice::{is_same_but_for_names, part_of};
use crate::session::{Budget, Session};
use crate::team::{Lost, Priority, Running, Team};

/// The search begins once the scenario and the time have not changed for so long \[s\].
const STILL: f64 = 0.35;

/// A filter, a record, and the sample up to which the posterior knows it.
#[derive(Clone)]
struct Subject {
    filter: u32,
    /// The scenario with the filter alone.
    of: Scenario,
    /// Where the record is given.
    record: Option<Arc<Record>>,
    /// The sample, and its time \[s\].
    sample: usize,
    time: f64,
}

impl Subject {
    /// The subject of a session; `None` if it lacks the filter.
    fn of(session: &Session, filter: u32) -> Option<Self> {
        let run = session.run();
        let of = part_of(run.scenario(), &[filter]);
        let record = run.source().record().filter(|_| session.is_measured()).map(Arc::clone);
        let sample = session.index().min(run.record().len().checked_sub(1)?);
        let time = run.record().time(sample);
        (!of.filters.is_empty()).then_some(Self { filter, of, record, sample, time })
    }

    /// Whether another one is of the same filter and record.
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
        Ok(Running::begin(team, Priority::Seeds, posterior, Posterior::progress))
    }
}

/// Points of the posterior on screen.
pub struct Shown {
    subject: Subject,
    sampled: Sampled,
    /// Whether they are of the time on screen.
    is_of_now: bool,
}

impl Shown {
    /// The filter's id.
    pub fn filter(&self) -> u32 {
        self.subject.filter
    }

    /// The points.
    pub fn sampled(&self) -> &Sampled {
        &self.sampled
    }

    /// The sample up to which they know the record, and its time \[s\].
    pub fn last(&self) -> (usize, f64) {
        (self.subject.sample, self.subject.time)
    }

    /// Whether that is the time on screen.
    pub fn is_of_now(&self) -> bool {
        self.is_of_now
    }
}

/// The posterior of the filter that the user has chosen.
#[derive(Default)]
pub struct Posteriors {
    /// The id of the filter.
    chosen: Option<u32>,
    /// The subject on screen, and the time since when it has been there \[s\].
    seen: Option<(Subject, f64)>,
    search: Option<Running<Posterior>>,
    /// Whether the subject has been searched, with whatever result.
    is_done: bool,
    shown: Option<Shown>,
    problem: Option<String>,
}

impl Posteriors {
    /// The id of the filter whose posterior is wanted.
    pub fn chosen(&self) -> Option<u32> {
        self.chosen
    }

    /// Takes over a choice.
    pub fn choose(&mut self, chosen: Option<u32>) {
        *self = Self { chosen, ..Self::default() };
    }

    /// The share of a search that is done, from 0 to 1.
    pub fn progress(&self) -> Option<f64> {
        self.search.as_ref().map(|search| *search.seen())
    }

    /// The points on screen.
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// Why there are none.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Follows the session while its view is on screen.
    pub(super) fn follow(&mut self, team: &dyn Team, session: &Session, budget: Budget, ctx: &Context) {
        let Some(filter) = self.chosen else { return };
        let now = ctx.input(|input| input.time);
        let Some(subject) = Subject::of(session, filter) else {
            return self.choose(None);
        };
        if !self.seen.as_ref().is_some_and(|(seen, _)| seen.is_same(&subject)) {
            (self.search, self.problem, self.is_done) = (None, None, false);
            self.shown = self.shown.take().filter(|shown| shown.subject.is_of_same(&subject));
            if let Some(shown) = &mut self.shown {
                shown.is_of_now = shown.subject.is_same(&subject);
                self.is_done = shown.is_of_now;
            }
            self.seen = Some((subject, now));
        }
        if !self.is_done && self.search.is_none() {
            self.begin(team, session, now, ctx);
        }
        self.go_on(budget, ctx);
    }

    fn begin(&mut self, team: &dyn Team, session: &Session, now: f64, ctx: &Context) {
        let Some((subject, since)) = &self.seen else { return };
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
                (self.search, self.is_done) = (None, true);
                match (sampled, &self.seen) {
                    (Some(sampled), Some((subject, _))) => {
                        self.shown = Some(Shown { subject: subject.clone(), sampled, is_of_now: true });
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
        (self.search, self.shown, self.is_done) = (None, None, true);
        self.problem = Some(problem);
    }
}
