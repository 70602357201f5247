//! The team of the desktop: the threads of this machine, and its graphics processor.

use std::cell::OnceCell;
use std::num::NonZero;
use std::rc::Rc;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use egui::Context;
use kalmanscope::team::{CellBatch, CellRows, Computer, Finding, Graphics, Handle, Priority, Team};
use kalmanscope_gpu::{Gpu, GpuError, Software};
use kalmanscope_lab::{Threads, WorkParts, WorkStep, WorkToken};

struct DesktopTeam {
    threads: Option<Threads>,
    processor: Rc<Processor>,
    ctx: Context,
}

pub(super) fn team(software: Software, ctx: &Context) -> Rc<dyn Team> {
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    // One processor is left to the frames; of two it would be half of all.
    let count = if processors > 2 { processors - 1 } else { processors };
    let threads = Threads::new(count, 1).map_err(|error| log::warn!("Long work stays in the frames: {error}"));
    Rc::new(DesktopTeam { threads: threads.ok(), processor: Rc::new(Processor::new(software)), ctx: ctx.clone() })
}

impl Team for DesktopTeam {
    fn threads(&self) -> Option<(&Threads, &Context)> {
        self.threads.as_ref().map(|threads| (threads, &self.ctx))
    }

    fn graphics(&self) -> Option<Rc<dyn Graphics>> {
        Some(Rc::<Processor>::clone(&self.processor))
    }
}

/// The cells of a portion: enough to fill a processor, and few enough for a picture soon.
const PORTION: usize = 1024;

pub(super) struct Processor {
    software: Software,
    state: Arc<AdapterState>,
    thread: OnceCell<Option<(Threads, WorkParts<()>)>>,
}

struct AdapterState {
    gpu: Mutex<Option<Gpu>>,
    found: Mutex<Finding>,
}

impl Processor {
    pub(super) fn new(software: Software) -> Self {
        let state = AdapterState { gpu: Mutex::new(None), found: Mutex::new(Finding::Searching) };
        Self { software, state: Arc::new(state), thread: OnceCell::new() }
    }

    /// The thread, which the first call starts. `None` if the system gives none.
    fn thread(&self, ctx: &Context) -> Option<&Threads> {
        let begin = || {
            let (software, state, ctx) = (self.software, Arc::clone(&self.state), ctx.clone());
            let search = move |_| {
                state.search(software);
                WorkStep::End
            };
            let team = Threads::new(1, 0);
            let team = team.map_err(|error| *lock(&self.state.found) = Finding::Absent(error.to_string())).ok()?;
            let search = team.begin(Priority::Map, [search], move |_| ctx.request_repaint());
            Some((team, search))
        };
        self.thread.get_or_init(begin).as_ref().map(|(team, _)| team)
    }
}

impl Drop for Processor {
    /// Waits for the thread if it has found a processor: some drivers crash if the program ends while they are used. A search
    /// is not waited for, since it may never end.
    fn drop(&mut self) {
        let serves = self.found() == Finding::Ready;
        if let Some((team, _)) = self.thread.take().flatten()
            && serves
        {
            team.end();
        }
    }
}

impl Graphics for Processor {
    fn find(&self, ctx: &Context) -> Finding {
        self.thread(ctx);
        self.found()
    }

    fn found(&self) -> Finding {
        lock(&self.state.found).clone()
    }

    fn cells(&self, cells: &CellBatch, ctx: &Context) -> Option<Handle<CellRows>> {
        let (cells, state) = (cells.clone(), Arc::clone(&self.state));
        let mut next = 0;
        let step = move |wanted: WorkToken| {
            let some = next..(next + PORTION).min(cells.order.len());
            next = some.end;
            // The team does the cells that are not served, which are missing in the rows.
            state.rows(&cells, &cells.order[some], &wanted).map_or(WorkStep::Failed, WorkStep::Part)
        };
        let ctx = ctx.clone();
        Some(self.thread(&ctx.clone())?.begin(Priority::Map, [step], move |_| ctx.request_repaint()).into())
    }
}

impl AdapterState {
    fn search(&self, software: Software) {
        let finding = match pollster::block_on(Gpu::find(software)) {
            Ok(found) => {
                *lock(&self.gpu) = Some(found);
                Finding::Ready
            }
            Err(error) => {
                log::info!("Maps are computed by threads: {error}");
                Finding::Absent(error.to_string())
            }
        };
        *lock(&self.found) = finding;
    }

    fn rows(&self, all: &CellBatch, some: &[usize], wanted: &WorkToken) -> Option<CellRows> {
        let gpu = lock(&self.gpu);
        let gpu = gpu.as_ref().filter(|_| !some.is_empty() && Gpu::serves(&all.runner))?;
        match pollster::block_on(gpu.rows(&all.runner, some, &|| wanted.is_so())) {
            Ok((cells, numbers)) => {
                Some(CellRows { cells, numbers, by: Computer::Graphics(Arc::from(gpu.name.as_str())) })
            }
            Err(GpuError::Unwanted) => None,
            Err(error) => {
                log::warn!("The graphics processor has failed: {error}");
                *lock(&self.found) = Finding::Lost(error.to_string());
                None
            }
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
