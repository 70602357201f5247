//! Runs maps on the graphics processor, on a thread of their own.

use std::cell::OnceCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use egui::Context;
use kalmanscope::laboratory::{Computer, Finding, GivenUp, Graphics, GraphicsWork, Rows, Task};
use kalmanscope_gpu::{Gpu, GpuError, Software};
use kalmanscope_lab::Runner;

/// The cells of the first portion: enough for a first picture.
const FIRST: usize = 64;

/// The aim for the time of a portion, and the limit of its cells.
const PORTION: Duration = Duration::from_millis(150);
const MOST: usize = 1 << 14;

/// The graphics processor of this machine. The search begins with the first map.
pub(super) struct Processor {
    software: Software,
    found: Arc<Mutex<Finding>>,
    jobs: OnceCell<Option<(Sender<Job>, JoinHandle<()>)>>,
}

/// The cells of a map.
struct Job {
    runner: Runner,
    order: Vec<usize>,
    rows: Sender<Rows>,
    is_wanted: Arc<AtomicBool>,
    ctx: Context,
}

impl Processor {
    /// A processor, or a software adapter if that is accepted.
    pub(super) fn new(software: Software) -> Self {
        Self { software, found: Arc::new(Mutex::new(Finding::Searching)), jobs: OnceCell::new() }
    }

    /// The queue of the thread, which the first call starts. `None` if the system gives no thread.
    fn jobs(&self, ctx: &Context) -> Option<&Sender<Job>> {
        let begin = || {
            let (sender, jobs) = mpsc::channel();
            let (software, found, ctx) = (self.software, Arc::clone(&self.found), ctx.clone());
            let thread = thread::Builder::new().name("graphics".to_owned());
            match thread.spawn(move || serve(software, &found, &jobs, &ctx)) {
                Ok(thread) => Some((sender, thread)),
                Err(error) => {
                    set(&self.found, Finding::Absent(error.to_string()));
                    None
                }
            }
        };
        self.jobs.get_or_init(begin).as_ref().map(|(sender, _)| sender)
    }
}

impl Drop for Processor {
    /// Waits for the thread if it has found a processor: some drivers crash if the program ends while they are used. A search
    /// is not waited for, since it may never end.
    fn drop(&mut self) {
        let serves = self.found() == Finding::Ready;
        if let Some((sender, thread)) = self.jobs.take().flatten() {
            drop(sender);
            if serves {
                thread.join().ok();
            }
        }
    }
}

impl Graphics for Processor {
    fn find(&self, ctx: &Context) -> Finding {
        self.jobs(ctx);
        self.found()
    }

    fn found(&self) -> Finding {
        self.found.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn start(&self, task: Task<'_>, ctx: &Context) -> Option<Box<dyn GraphicsWork>> {
        let runner = Runner::new(task.ensemble.clone(), task.source.clone()).ok()?;
        let (sender, rows) = mpsc::channel();
        let is_wanted = Arc::new(AtomicBool::new(true));
        let job = Job { runner, order: task.order, rows: sender, is_wanted: Arc::clone(&is_wanted), ctx: ctx.clone() };
        self.jobs(ctx)?.send(job).ok()?;
        Some(Box::new(Working { rows, is_wanted }))
    }
}

struct Working {
    rows: Receiver<Rows>,
    is_wanted: Arc<AtomicBool>,
}

impl GraphicsWork for Working {
    fn poll(&mut self) -> Result<Vec<Rows>, GivenUp> {
        let mut all = Vec::new();
        loop {
            match self.rows.try_recv() {
                Ok(rows) => all.push(rows),
                // The thread has ended. Hands over the last rows before reporting that.
                Err(TryRecvError::Disconnected) if all.is_empty() => return Err(GivenUp),
                Err(_) => return Ok(all),
            }
        }
    }
}

impl Drop for Working {
    fn drop(&mut self) {
        self.is_wanted.store(false, Ordering::Relaxed);
    }
}

fn set(found: &Mutex<Finding>, finding: Finding) {
    *found.lock().unwrap_or_else(PoisonError::into_inner) = finding;
}

/// Looks for the processor, then serves jobs until the queue is closed.
fn serve(software: Software, found: &Mutex<Finding>, jobs: &Receiver<Job>, ctx: &Context) {
    let gpu = pollster::block_on(Gpu::find(software));
    let gpu = match gpu {
        Ok(gpu) => gpu,
        Err(error) => {
            log::info!("Maps are computed by threads: {error}");
            return set(found, Finding::Absent(error.to_string()));
        }
    };
    set(found, Finding::Ready);
    ctx.request_repaint();
    let name: Arc<str> = Arc::from(gpu.name());
    while let Ok(job) = jobs.recv() {
        if let Err(error) = work(&gpu, &name, &job)
            && error != GpuError::Unwanted
        {
            log::warn!("The graphics processor has failed: {error}");
            set(found, Finding::Lost(error.to_string()));
            job.ctx.request_repaint();
            return;
        }
        // Dropping the job closes its channel, so that the receiver learns that no more rows come.
        let ctx = job.ctx.clone();
        drop(job);
        ctx.request_repaint();
    }
}

/// Runs the cells of a job, few at first for a picture, then more.
fn work(gpu: &Gpu, name: &Arc<str>, job: &Job) -> Result<(), GpuError> {
    if !Gpu::serves(&job.runner) {
        return Ok(());
    }
    let is_wanted = || job.is_wanted.load(Ordering::Relaxed);
    let (mut next, mut portion) = (0, FIRST);
    while next < job.order.len() {
        let cells = job.order[next..(next + portion).min(job.order.len())].to_vec();
        let begin = Instant::now();
        next += cells.len();
        // Threads compute the cells that are missing in the rows, after this job has ended.
        let (cells, numbers) = pollster::block_on(gpu.rows(&job.runner, &cells, &is_wanted))?;
        if job.rows.send(Rows { cells, numbers, by: Computer::Graphics(Arc::clone(name)) }).is_err() {
            return Ok(());
        }
        job.ctx.request_repaint();
        let factor = PORTION.as_secs_f64() / begin.elapsed().as_secs_f64().max(1e-6);
        portion = ((portion as f64 * factor.clamp(0.25, 8.0)) as usize).clamp(FIRST, MOST);
    }
    Ok(())
}
