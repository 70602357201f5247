//! The page's graphics processor, in its own worker.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::{Rc, Weak};
use std::sync::Arc;

use egui::Context;
use js_sys::Array;
use kalmanscope::team::{Cells, Computer, Finding, Graphics, Handle, Lost, Rows};
use kalmanscope_worker::{cells_message, portion_of, rows};
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::spawn_local;
use web_sys::MessageEvent;
use web_time::{Duration, Instant};

use super::adapter;
use super::worker::{Program, Worker};

const FIRST: usize = 64;

const PORTION: Duration = Duration::from_millis(200);
const MOST: usize = 1 << 14;

/// The graphics processor. The search begins with the first map.
pub(super) struct Processor {
    software: bool,
    state: Rc<RefCell<State>>,
}

struct State {
    is_asked: bool,
    finding: Finding,
    worker: Option<Worker>,
    name: Arc<str>,
    number: u32,
    task: Option<Given>,
    ctx: Context,
}

struct Given {
    order: Vec<usize>,
    next: usize,
    given: usize,
    portion: usize,
    begun: Instant,
    rows: VecDeque<Rows>,
    has_left: bool,
    has_given_up: bool,
}

impl Processor {
    pub(super) fn new(software: bool) -> Self {
        let state = State {
            is_asked: false,
            finding: Finding::Searching,
            worker: None,
            name: Arc::from(""),
            number: 0,
            task: None,
            ctx: Context::default(),
        };
        Self { software, state: Rc::new(RefCell::new(state)) }
    }
}

impl Graphics for Processor {
    fn find(&self, ctx: &Context) -> Finding {
        let mut state = self.state.borrow_mut();
        state.ctx = ctx.clone();
        if !std::mem::replace(&mut state.is_asked, true) {
            spawn_local(start(Rc::clone(&self.state), self.software));
        }
        state.finding.clone()
    }

    fn found(&self) -> Finding {
        self.state.borrow().finding.clone()
    }

    fn cells(&self, cells: &Cells, ctx: &Context) -> Option<Handle<Rows>> {
        let mut state = self.state.borrow_mut();
        state.ctx = ctx.clone();
        state.number += 1;
        let number = state.number;
        state.worker.as_ref()?.tell(&cells_message(number, &cells.runner));
        state.task = Some(Given {
            order: cells.order.clone(),
            next: 0,
            given: 0,
            portion: FIRST,
            begun: Instant::now(),
            rows: VecDeque::new(),
            has_left: false,
            has_given_up: false,
        });
        state.feed();
        let working = Working { state: Rc::clone(&self.state), number };
        Some(Handle::new(move || working.take()))
    }
}

struct Working {
    state: Rc<RefCell<State>>,
    number: u32,
}

impl Working {
    fn take(&self) -> Result<Option<Rows>, Lost> {
        let mut state = self.state.borrow_mut();
        let is_present = state.number == self.number;
        let task = state.task.as_mut().filter(|_| is_present).ok_or(Lost)?;
        let rows = task.rows.pop_front();
        if rows.is_none() && task.has_given_up { Err(Lost) } else { Ok(rows) }
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        let mut state = self.state.borrow_mut();
        if state.number == self.number {
            state.task = None;
        }
    }
}

impl State {
    fn feed(&mut self) {
        let (Some(worker), Some(task)) = (&self.worker, &mut self.task) else { return };
        let end = (task.next + task.portion).min(task.order.len());
        let cells = &task.order[task.next..end];
        if cells.is_empty() {
            task.has_given_up |= task.has_left;
        } else {
            worker.tell(&Array::of3(&"more".into(), &self.number.into(), &portion_of(cells)));
            (task.given, task.next, task.begun) = (cells.len(), end, Instant::now());
        }
    }

    fn take(&mut self, part: &JsValue) {
        let (Some(task), Some((cells, numbers))) = (&mut self.task, rows(part)) else { return };
        task.has_left |= cells.len() < task.given;
        let by = Computer::Graphics(Arc::clone(&self.name));
        task.rows.push_back(Rows { cells, numbers, by });
        let factor = PORTION.as_secs_f64() / task.begun.elapsed().as_secs_f64().max(1e-3);
        task.portion = ((task.portion as f64 * factor.clamp(0.25, 8.0)) as usize).clamp(FIRST, MOST);
    }

    fn miss(&mut self, reason: String) {
        log::info!("Maps are computed by workers: {reason}");
        self.finding = Finding::Absent(reason);
        self.ctx.request_repaint();
    }

    fn give_up(&mut self) {
        if let Some(task) = &mut self.task {
            task.has_given_up = true;
        }
    }

    /// Does without the worker from now on.
    fn lose(&mut self, reason: String) {
        log::warn!("The graphics processor is not used: {reason}");
        // Before it was ready, nothing has been lost.
        self.finding = match self.finding {
            Finding::Ready => Finding::Lost(reason),
            _ => Finding::Absent(reason),
        };
        self.give_up();
    }
}

/// Starts the worker, if the browser offers a processor. Without one, this saves most of the work of a start.
async fn start(state: Rc<RefCell<State>>, software: bool) {
    let offer = adapter::ask(software).await;
    let mut present = state.borrow_mut();
    match offer.and_then(|()| Worker::new(0, Program::Graphics, listener(&state, software))) {
        Ok(worker) => present.worker = Some(worker),
        Err(reason) => present.miss(reason),
    }
}

fn listener(state: &Rc<RefCell<State>>, software: bool) -> impl FnMut(Result<MessageEvent, String>) + 'static {
    let state: Weak<RefCell<State>> = Rc::downgrade(state);
    move |event| {
        let Some(state) = state.upgrade() else { return };
        let mut state = state.borrow_mut();
        let words: Array = match event {
            Ok(event) => event.data().unchecked_into(),
            Err(reason) => {
                state.lose(reason);
                return state.ctx.request_repaint();
            }
        };
        let text = |at: u32| words.get(at).as_string().unwrap_or_default();
        let is_present = words.get(1).as_f64() == Some(f64::from(state.number));
        match text(0).as_str() {
            "ready" => {
                if let Some(worker) = &state.worker {
                    worker.tell(&Array::of2(&"graphics".into(), &software.into()));
                }
            }
            "graphics" => {
                state.name = Arc::from(text(1));
                state.finding = Finding::Ready;
            }
            "no graphics" => {
                state.miss(text(1));
                if let Some(worker) = &mut state.worker {
                    worker.end();
                }
            }
            "part" if is_present => {
                state.take(&words.get(2));
                state.feed();
            }
            "refused" if is_present => state.give_up(),
            "part" | "refused" => {}
            // An ensemble that cannot be used, a device that is lost, a panic.
            "failed" if is_present => state.give_up(),
            _ => state.lose(text(2)),
        }
        state.ctx.request_repaint();
    }
}
