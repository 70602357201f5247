//! Runs ensembles, long filters and imports in workers of the page, one a processor.

mod adapter;
mod errands;
mod given;
mod graphics;
mod member;
mod portions;

use std::cell::RefCell;
use std::rc::{Rc, Weak};

use egui::Context;
use js_sys::{Array, Float64Array, Uint32Array};
use kalmanscope::elsewhere::Elsewhere;
use kalmanscope::laboratory::{Accelerated, Computer, Engine, Precision, Rows, Slices, Task, Work};
use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, EnsembleError};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::closure::Closure;
use web_sys::MessageEvent;

use errands::{Errand, Errands};
use given::Given;
use member::{Member, Program};

/// Limits the workers, for any number of processors.
const MOST: usize = 8;

/// The workers that serve all maps and errands. They are started with the first one.
#[derive(Clone, Default)]
pub(super) struct Workers(Rc<RefCell<Team>>);

#[derive(Default)]
struct Team {
    members: Vec<Member>,
    /// The number of the present job.
    job: u32,
    task: Option<Given>,
    /// Errands, and the number of the last one.
    errands: Vec<Errand>,
    errand: u32,
    /// The reason why there can be no workers.
    broken: Option<String>,
    /// Whether the page computes until they are ready.
    is_bridged: bool,
}

impl Team {
    /// Whether there are light cells to compute and no worker is ready yet.
    fn needs_page(&self) -> bool {
        let is_light = self.task.as_ref().is_some_and(Given::is_light);
        self.broken.is_none() && !self.members.iter().any(Member::is_ready) && is_light
    }

    /// Gives a worker by its place its next cells, if it has none waiting and no errand.
    fn feed(&mut self, place: usize) {
        let Self { members, job, task, errands, .. } = self;
        let (Some(member), Some(task)) = (members.get_mut(place), task) else { return };
        if !errands.iter().any(|errand| errand.is_of(member)) {
            task.feed(member, *job, full());
        }
    }

    /// Ends a worker that has failed, by its place. Its errands are lost, and others go on. A worker that has cells of a map, or
    /// never was ready, ends the use of all workers: another one might fail at the same cells.
    fn lose(&mut self, place: usize, reason: String) {
        log::warn!("A worker of the page has failed: {reason}");
        let Self { members, task, errands, broken, .. } = self;
        let member = &mut members[place];
        let is_of_errand = errands.iter().any(|errand| errand.is_of(member));
        if !(is_of_errand && member.is_ready() && member.is_free()) {
            *broken = Some(reason);
        }
        // The next frame notices the loss.
        task.iter().for_each(Given::wake);
        errands.iter().for_each(Errand::wake);
        errands.retain(|errand| !errand.is_of(member));
        member.end();
    }
}

/// The browser's graphics processor, or a software adapter if that is accepted, and workers for maps that it does not
/// serve.
pub(super) fn engine(workers: &Workers, software: bool) -> Box<dyn Engine> {
    Box::new(Accelerated::new(Rc::new(graphics::Processor::new(software)), Rc::new(workers.clone())))
}

/// Workers for long filters and imports.
pub(super) fn errands(workers: &Workers, ctx: &Context) -> Rc<dyn Elsewhere> {
    Rc::new(Errands { team: Rc::clone(&workers.0), ctx: ctx.clone() })
}

impl Engine for Workers {
    fn start(&self, task: Task<'_>, ctx: &Context) -> Result<Box<dyn Work>, EnsembleError> {
        let (ensemble, source) = (task.ensemble.clone(), task.source.clone());
        let job = begin(&self.0, Given::new(task, ctx)?);
        Ok(Box::new(WorkInWorkers { team: Rc::clone(&self.0), job, ensemble, source, instead: None }))
    }

    fn usual_count(&self) -> usize {
        if processors() > 2 { 64 } else { 48 }
    }
}

struct WorkInWorkers {
    team: Rc<RefCell<Team>>,
    job: u32,
    ensemble: Ensemble,
    source: Source,
    /// The work in slices of the frames, if there can be no workers.
    instead: Option<Box<dyn Work>>,
}

impl Work for WorkInWorkers {
    fn poll(&mut self) -> Vec<Rows> {
        if let Some(instead) = &mut self.instead {
            return instead.poll();
        }
        let mut team = self.team.borrow_mut();
        if team.job != self.job {
            return Vec::new();
        }
        if team.broken.is_some()
            && let Some(task) = team.task.take()
        {
            let Self { ensemble, source, .. } = &*self;
            let (rows, order, ctx) = task.end();
            let again = Task { ensemble, source, order, precision: Precision::Double };
            self.instead = Slices::FRAME.start(again, &ctx).ok();
            return rows;
        }
        team.task.as_mut().map(Given::take_rows).unwrap_or_default()
    }
}

impl Drop for WorkInWorkers {
    fn drop(&mut self) {
        let mut team = self.team.borrow_mut();
        if team.job == self.job {
            team.task = None;
        }
    }
}

/// Gives the workers another task. Those that are busy with a long portion of the one before are replaced. Returns the job's
/// number.
fn begin(team: &Rc<RefCell<Team>>, task: Given) -> u32 {
    let mut present = team.borrow_mut();
    present.job += 1;
    present.task = Some(task);
    muster(team, &mut present, MOST);
    (0..present.members.len()).for_each(|place| present.feed(place));
    if present.needs_page() && !std::mem::replace(&mut present.is_bridged, true) {
        bridge(Rc::downgrade(team));
    }
    present.job
}

/// Starts workers until there are `count`, or one per processor. Replaces a worker that is stuck in a long portion of a
/// map, unless it also has an errand.
fn muster(team: &Rc<RefCell<Team>>, present: &mut Team, count: usize) {
    let Team { members, errands, broken, .. } = present;
    if broken.is_some() {
        return;
    }
    let is_needed = |member: &Member| errands.iter().any(|errand| errand.is_of(member));
    members.retain(|member| !member.is_over() && (!member.is_stuck() || is_needed(member)));
    while members.len() < full().min(count) {
        let number = free_number(members);
        match Member::new(number, Program::Page, listener(team, number)) {
            Ok(member) => members.push(member),
            Err(reason) => {
                *broken = Some(reason);
                break;
            }
        }
    }
}

/// Computes cells on the page, a portion between two events of it, until the first worker is ready.
fn bridge(team: Weak<RefCell<Team>>) {
    let go_on = move || {
        let Some(present) = team.upgrade() else { return };
        let mut present = present.borrow_mut();
        present.is_bridged = present.needs_page();
        if present.is_bridged {
            present.task.iter_mut().for_each(Given::compute);
            bridge(team);
        }
    };
    let window = web_sys::window();
    let soon = Closure::once_into_js(go_on);
    if let Some(Err(error)) = window.map(|it| it.set_timeout_with_callback(soon.unchecked_ref())) {
        log::warn!("The page waits for its workers: {error:?}");
    }
}

fn free_number(members: &[Member]) -> u32 {
    members.iter().map(Member::number).max().map_or(0, |number| number + 1)
}

/// Answers the messages of one worker.
fn listener(team: &Rc<RefCell<Team>>, number: u32) -> impl FnMut(Result<MessageEvent, String>) + 'static {
    let team = Rc::downgrade(team);
    move |event| {
        let Some(team) = team.upgrade() else { return };
        let mut team = team.borrow_mut();
        let Team { members, job, task, errands, .. } = &mut *team;
        let by = Computer::Workers(members.len());
        let is_it = |member: &Member| member.number() == number && !member.is_over();
        let Some(place) = members.iter().position(is_it) else { return };
        let member = &mut members[place];
        let words: Array = match event {
            Ok(event) => event.data().unchecked_into(),
            Err(reason) => return team.lose(place, reason),
        };
        match words.get(0).as_string().as_deref() {
            Some("ready") => {
                member.set_ready();
                errands.iter_mut().filter(|errand| errand.is_of(member)).for_each(|errand| errand.feed(member));
            }
            Some("part") => errands::take(errands, member, &words),
            Some("rows") => {
                member.take_back(words.get(4).as_f64().unwrap_or_default());
                if words.get(1).as_f64() == Some(f64::from(*job))
                    && let Some(task) = task
                {
                    let cells = words.get(2).unchecked_into::<Uint32Array>().to_vec();
                    let cells = cells.into_iter().map(|cell| cell as usize).collect();
                    let numbers = words.get(3).unchecked_into::<Float64Array>().to_vec();
                    task.put(Rows { cells, numbers, by });
                }
            }
            _ => return team.lose(place, words.get(2).as_string().unwrap_or_default()),
        }
        team.feed(place);
    }
}

/// The number of workers with enough work for all.
fn full() -> usize {
    processors().min(MOST)
}

fn processors() -> usize {
    web_sys::window().map_or(1, |window| window.navigator().hardware_concurrency() as usize).max(1)
}
