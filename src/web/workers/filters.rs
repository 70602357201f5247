//! Runs long filters of the session in workers of the page, one a filter as far as there are workers.

use std::cell::RefCell;
use std::rc::Rc;

use egui::Context;
use js_sys::Array;
use kalmanscope::session::{Elsewhere, FilterWork, Lost};
use kalmanscope_core::{Record, Scenario, Tape};
use kalmanscope_worker::{filter_message, tape};

use super::member::Member;
use super::portions::Portions;
use super::{Team, feed, muster};

/// The workers, for filters.
pub(super) struct Filters {
    pub(super) team: Rc<RefCell<Team>>,
    pub(super) ctx: Context,
}

/// A filter in a worker.
pub(super) struct Errand {
    number: u32,
    /// The worker's number.
    member: u32,
    /// The message with the filter, until it has been sent.
    message: Option<Array>,
    portions: Portions,
    /// The number of samples that have not been asked for.
    left: usize,
    /// Samples that have come, as the worker has sent them.
    come: Array,
    ctx: Context,
}

impl Errand {
    /// Whether it is the work of a worker.
    pub(super) fn is_of(&self, member: &Member) -> bool {
        self.member == member.number()
    }

    /// Asks for a frame.
    pub(super) fn wake(&self) {
        self.ctx.request_repaint();
    }

    /// Asks its worker for more samples, if there are some to compute.
    pub(super) fn feed(&mut self, member: &Member) {
        if !member.is_ready() {
            return;
        }
        if let Some(message) = self.message.take() {
            member.tell(&message);
        }
        while self.left > 0 && self.portions.want_more() {
            let count = self.portions.size().min(self.left);
            member.tell(&Array::of3(&"samples".into(), &self.number.into(), &(count as u32).into()));
            self.portions.give();
            self.left -= count;
        }
    }
}

impl Elsewhere for Filters {
    fn start(&self, scenario: &Scenario, place: usize, record: &Record) -> Option<Box<dyn FilterWork>> {
        let Self { team, ctx } = self;
        let mut present = team.borrow_mut();
        let count = present.errands.len() + 1;
        muster(team, &mut present, count);
        let Team { members, errands, errand: number, broken, .. } = &mut *present;
        if broken.is_some() {
            return None;
        }
        let load = |member: &&Member| (errands.iter().filter(|it| it.is_of(member)).count(), !member.is_free());
        let member = members.iter().min_by_key(load)?;
        *number += 1;
        let mut errand = Errand {
            number: *number,
            member: member.number(),
            message: Some(filter_message(*number, scenario, place, record)),
            portions: Portions::new(),
            left: record.len(),
            come: Array::new(),
            ctx: ctx.clone(),
        };
        errand.feed(member);
        errands.push(errand);
        Some(Box::new(InWorker { team: Rc::clone(team), number: *number }))
    }
}

/// Takes in the samples of a message from a worker.
pub(super) fn take(errands: &mut [Errand], member: &Member, words: &Array) {
    let number = words.get(1).as_f64();
    // A filter that has been given up may have sent some.
    let Some(errand) = errands.iter_mut().find(|errand| number == Some(f64::from(errand.number))) else { return };
    errand.portions.take_back();
    errand.come.push(&words.get(2));
    errand.feed(member);
    if errand.portions.is_empty() {
        errand.wake();
    }
}

struct InWorker {
    team: Rc<RefCell<Team>>,
    number: u32,
}

impl FilterWork for InWorker {
    fn next(&mut self) -> Result<Option<Tape>, Lost> {
        let team = self.team.borrow();
        let errand = team.errands.iter().find(|errand| errand.number == self.number && team.broken.is_none());
        let next = errand.ok_or(Lost)?.come.shift();
        Ok((!next.is_undefined()).then(|| tape(next)))
    }
}

impl Drop for InWorker {
    fn drop(&mut self) {
        let mut team = self.team.borrow_mut();
        let Team { members, errands, task, job, .. } = &mut *team;
        let Some(place) = errands.iter().position(|errand| errand.number == self.number) else { return };
        let errand = errands.swap_remove(place);
        let Some(place) = members.iter().position(|member| errand.is_of(member)) else { return };
        let member = &mut members[place];
        let is_alone = member.is_free() && !errands.iter().any(|errand| errand.is_of(member));
        if is_alone && errand.portions.is_stuck() {
            // Nothing else stops it. Another one is started when there is work for it.
            members.swap_remove(place);
            return;
        }
        member.tell(&Array::of2(&"forget".into(), &self.number.into()));
        if let Some(task) = task {
            feed(member, errands, *job, task);
        }
    }
}
