//! Long work of the explorer in workers of the page: filters and imports, one per worker.

use std::cell::RefCell;
use std::rc::Rc;

use egui::Context;
use js_sys::Array;
use kalmanscope::elsewhere::{Elsewhere, FilterWork, LoadingWork, Lost, Report, SuggestWork, Work};
use kalmanscope_core::{Record, Scenario};
use kalmanscope_worker::{file_message, filter_message, loaded, suggest_message, suggestion, tape};
use wasm_bindgen::JsValue;

use super::member::Member;
use super::portions::Portions;
use super::{Team, muster};

/// The workers, for long work.
pub(super) struct Errands {
    pub(super) team: Rc<RefCell<Team>>,
    pub(super) ctx: Context,
}

/// Work in a worker.
pub(super) struct Errand {
    number: u32,
    /// The worker's number.
    member: u32,
    /// The message with the work, until it has been sent.
    message: Option<Array>,
    portions: Portions,
    /// The samples that the page has not asked for, or [`UNTIL_DONE`] for work with an outcome.
    left: usize,
    /// Parts that have come, as the worker has sent them.
    come: Array,
    ctx: Context,
}

/// The number of samples of work with an outcome: the page asks for more until the outcome comes.
const UNTIL_DONE: usize = usize::MAX;

impl Errand {
    /// Whether it is the work of a worker.
    pub(super) fn is_of(&self, member: &Member) -> bool {
        self.member == member.number()
    }

    /// Asks for a frame.
    pub(super) fn wake(&self) {
        self.ctx.request_repaint();
    }

    /// Asks its worker for more, if there is something to do.
    pub(super) fn feed(&mut self, member: &Member) {
        if !member.is_ready() {
            return;
        }
        if let Some(message) = self.message.take() {
            member.tell(&message);
        }
        while self.left > 0 && self.portions.want_more() {
            let count = self.portions.size().min(self.left);
            member.tell(&Array::of3(&"more".into(), &self.number.into(), &(count as u32).into()));
            self.portions.give();
            if self.left != UNTIL_DONE {
                self.left -= count;
            }
        }
    }

    /// Takes in a part that has taken its worker this time \[ms\], and asks for more.
    fn take(&mut self, part: &JsValue, taken: f64, member: &Member) {
        self.portions.take_back(taken);
        self.come.push(part);
        if self.left == UNTIL_DONE && part.as_f64().is_none() {
            self.left = 0;
            self.wake();
        }
        self.feed(member);
        if self.portions.is_empty() {
            self.wake();
        }
    }
}

impl Errands {
    /// Begins work. `message` makes the message that begins it, from its number; `read` reads a part.
    fn begin<T: 'static>(
        &self,
        left: usize,
        message: &dyn Fn(u32) -> Array,
        read: fn(&JsValue) -> Option<T>,
    ) -> Option<Box<dyn Work<T>>> {
        let number = self.send(left, message)?;
        Some(Box::new(InWorker { team: Rc::clone(&self.team), number, read }))
    }

    /// Gives a worker work. Returns its number.
    fn send(&self, left: usize, message: &dyn Fn(u32) -> Array) -> Option<u32> {
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
            message: Some(message(*number)),
            portions: Portions::new(),
            left,
            come: Array::new(),
            ctx: ctx.clone(),
        };
        errand.feed(member);
        errands.push(errand);
        Some(*number)
    }
}

impl Elsewhere for Errands {
    fn filter(&self, scenario: &Scenario, place: usize, record: &Record) -> Option<FilterWork> {
        self.begin(record.len(), &|number| filter_message(number, scenario, place, record), tape)
    }

    fn loading(&self, bytes: &[u8]) -> Option<LoadingWork> {
        self.begin(UNTIL_DONE, &|number| file_message(number, bytes), |part| report(part, loaded))
    }

    fn suggest(&self, scenario: &Scenario, record: &Record) -> Option<SuggestWork> {
        self.begin(UNTIL_DONE, &|number| suggest_message(number, scenario, record), |part| report(part, suggestion))
    }
}

/// The report in a message.
fn report<T>(part: &JsValue, outcome: impl FnOnce(&JsValue) -> Option<T>) -> Option<Report<T>> {
    part.as_f64().map(Report::Share).or_else(|| outcome(part).map(Report::Done))
}

/// Takes in the part of an errand in a message from a worker.
pub(super) fn take(errands: &mut [Errand], member: &Member, words: &Array) {
    let number = words.get(1).as_f64();
    // An errand that has been given up may have sent some.
    if let Some(errand) = errands.iter_mut().find(|errand| number == Some(f64::from(errand.number))) {
        errand.take(&words.get(2), words.get(3).as_f64().unwrap_or_default(), member);
    }
}

/// Work in a worker, and how its messages are read.
struct InWorker<T> {
    team: Rc<RefCell<Team>>,
    number: u32,
    read: fn(&JsValue) -> Option<T>,
}

impl<T> Work<T> for InWorker<T> {
    fn next(&mut self) -> Result<Option<T>, Lost> {
        let team = self.team.borrow();
        let errand = team.errands.iter().find(|errand| errand.number == self.number && team.broken.is_none());
        let next = errand.ok_or(Lost)?.come.shift();
        if next.is_undefined() { Ok(None) } else { (self.read)(&next).map(Some).ok_or(Lost) }
    }
}

impl<T> Drop for InWorker<T> {
    fn drop(&mut self) {
        give_up(&mut self.team.borrow_mut(), self.number);
    }
}

/// Ends the errand of this number.
fn give_up(team: &mut Team, number: u32) {
    let Team { members, errands, .. } = team;
    let Some(place) = errands.iter().position(|errand| errand.number == number) else { return };
    let errand = errands.swap_remove(place);
    let Some(place) = members.iter().position(|member| errand.is_of(member)) else { return };
    let member = &members[place];
    let is_alone = member.is_free() && !errands.iter().any(|errand| errand.is_of(member));
    if is_alone && errand.portions.is_stuck() {
        // Only dropping the worker stops it. Another one starts when there is work.
        members.swap_remove(place);
        return;
    }
    member.tell(&Array::of2(&"forget".into(), &number.into()));
    team.feed(place);
}
