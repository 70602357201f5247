//! Runs ensembles, long filters and imports in workers of the page, one a processor.

mod adapter;
mod errands;
mod graphics;
mod member;
mod portions;

use std::cell::RefCell;
use std::rc::{Rc, Weak};

use egui::Context;
use js_sys::{Array, Float64Array, Uint32Array};
use kalmanscope::elsewhere::Elsewhere;
use kalmanscope::laboratory::{Accelerated, Computer, Engine, Pace, Precision, Rows, Slices, Task, Work};
use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, EnsembleError, Runner};
use kalmanscope_worker::in_message;
use wasm_bindgen::JsCast as _;
use wasm_bindgen::closure::Closure;
use web_sys::MessageEvent;
use web_time::{Duration, Instant};

use errands::{Errand, Errands};
use member::{Member, Program};

/// Limits the workers, whatever the number of processors.
const MOST: usize = 8;

/// The time for which the page computes at once while it waits for its workers.
const PORTION: Duration = Duration::from_millis(8);

/// The cells that it computes at once, and the limit of their time \[s\].
const SIDE_BY_SIDE: usize = 8;
const LIGHT: f64 = 0.05;

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
        let is_light = |task: &Given| SIDE_BY_SIDE as f64 * task.runner.time_of_cell() < LIGHT;
        let mut task = self.task.iter().filter(|task| task.next < task.order.len());
        self.broken.is_none() && !self.members.iter().any(Member::is_ready) && task.any(is_light)
    }
}

/// The cells that are to be run.
struct Given {
    runner: Runner,
    ensemble: String,
    record: wasm_bindgen::JsValue,
    order: Vec<usize>,
    next: usize,
    rows: Vec<Rows>,
    pace: Pace,
    ctx: Context,
}

/// The browser's graphics processor, or a program in its place where that will do, and workers for what it does not serve.
pub(super) fn engine(workers: &Workers, software: bool) -> Box<dyn Engine> {
    Box::new(Accelerated::new(Rc::new(graphics::Processor::new(software)), Rc::new(workers.clone())))
}

/// Workers for long filters and imports.
pub(super) fn errands(workers: &Workers, ctx: &Context) -> Rc<dyn Elsewhere> {
    Rc::new(Errands { team: Rc::clone(&workers.0), ctx: ctx.clone() })
}

impl Engine for Workers {
    fn start(&self, task: Task<'_>, ctx: &Context) -> Result<Box<dyn Work>, EnsembleError> {
        let Task { ensemble, source, order, .. } = task;
        let task = Given {
            runner: Runner::new(ensemble.clone(), source.clone())?,
            ensemble: ensemble.to_json(),
            record: in_message(source),
            pace: Pace::new(order.len()),
            order,
            next: 0,
            rows: Vec::new(),
            ctx: ctx.clone(),
        };
        let job = begin(&self.0, task);
        let (ensemble, source) = (ensemble.clone(), source.clone());
        Ok(Box::new(WorkInWorkers { team: Rc::clone(&self.0), job, ensemble, source, instead: None }))
    }

    fn usual_count(&self) -> usize {
        if processors() > 2 { 64 } else { 48 }
    }
}

impl Given {
    /// Computes some cells.
    fn compute(&mut self) {
        let begun = Instant::now();
        while self.next < self.order.len() && begun.elapsed() < PORTION {
            let end = (self.next + SIDE_BY_SIDE).min(self.order.len());
            let cells = self.order[self.next..end].to_vec();
            let numbers = self.runner.rows(&cells);
            self.pace.take(cells.len(), &self.ctx);
            self.rows.push(Rows { cells, numbers, by: Computer::Frames });
            self.next = end;
        }
    }
}

struct WorkInWorkers {
    team: Rc<RefCell<Team>>,
    job: u32,
    ensemble: Ensemble,
    source: Source,
    /// The work in slices of the frames, where there can be no workers.
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
            let again = Task { ensemble, source, order: task.order, precision: Precision::Double };
            self.instead = Slices::FRAME.start(again, &task.ctx).ok();
            return task.rows;
        }
        team.task.as_mut().map(|task| std::mem::take(&mut task.rows)).unwrap_or_default()
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
    let Team { members, task, job, errands, .. } = &mut *present;
    if let Some(task) = task {
        members.iter_mut().for_each(|member| feed(member, errands, *job, task));
    }
    if present.needs_page() && !std::mem::replace(&mut present.is_bridged, true) {
        bridge(Rc::downgrade(team));
    }
    present.job
}

/// Sees to it that there are this many workers, as far as there are processors. Those that are busy with a long portion of a
/// map are replaced, unless there is an errand too.
fn muster(team: &Rc<RefCell<Team>>, present: &mut Team, count: usize) {
    let Team { members, errands, broken, .. } = present;
    if broken.is_some() {
        return;
    }
    members.retain(|member| !member.is_stuck() || errands.iter().any(|errand| errand.is_of(member)));
    while members.len() < processors().min(MOST).min(count) {
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
        let Team { members, job, task, errands, errand: _, broken, is_bridged: _ } = &mut *team;
        let by = Computer::Workers(members.len());
        let Some(member) = members.iter_mut().find(|member| member.number() == number) else { return };
        let words: Array = match event {
            Ok(event) => event.data().unchecked_into(),
            Err(reason) => {
                log::warn!("The page has no workers: {reason}");
                *broken = Some(reason);
                wake(task.as_ref(), errands);
                return;
            }
        };
        match words.get(0).as_string().as_deref() {
            Some("ready") => {
                member.set_ready();
                errands.iter_mut().filter(|errand| errand.is_of(member)).for_each(|errand| errand.feed(member));
            }
            Some("part") => errands::take(errands, member, &words),
            Some("rows") => {
                member.take_back();
                if words.get(1).as_f64() == Some(f64::from(*job))
                    && let Some(task) = task
                {
                    let cells = words.get(2).unchecked_into::<Uint32Array>().to_vec();
                    let cells: Vec<usize> = cells.into_iter().map(|cell| cell as usize).collect();
                    let numbers = words.get(3).unchecked_into::<Float64Array>().to_vec();
                    task.pace.take(cells.len(), &task.ctx);
                    task.rows.push(Rows { cells, numbers, by });
                }
            }
            _ => {
                let reason = words.get(2).as_string().unwrap_or_default();
                log::warn!("A worker of the page has failed: {reason}");
                *broken = Some(reason);
                wake(task.as_ref(), errands);
                return;
            }
        }
        if let Some(task) = task {
            feed(member, errands, *job, task);
        }
    }
}

/// Asks for a frame that sees what has become of all work.
fn wake(task: Option<&Given>, errands: &[Errand]) {
    if let Some(task) = task {
        task.ctx.request_repaint();
    }
    errands.iter().for_each(Errand::wake);
}

/// Gives a worker its next cells, if it has none waiting and no errand.
fn feed(member: &mut Member, errands: &[Errand], job: u32, task: &mut Given) {
    if errands.iter().any(|errand| errand.is_of(member)) {
        return;
    }
    while task.next < task.order.len() && member.wants_more() {
        if !member.knows(job) {
            let Given { ensemble, record, .. } = task;
            member.tell(&Array::of4(&"ensemble".into(), &job.into(), &(&*ensemble).into(), record));
            member.learn(job);
        }
        let end = (task.next + member.portion()).min(task.order.len());
        let cells: Vec<u32> = task.order[task.next..end].iter().map(|&cell| cell as u32).collect();
        member.give(&Array::of3(&"cells".into(), &job.into(), &Uint32Array::from(cells.as_slice())));
        task.next = end;
    }
}

fn processors() -> usize {
    web_sys::window().map_or(1, |window| window.navigator().hardware_concurrency() as usize).max(1)
}
