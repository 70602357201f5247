//! The team of the desktop: the threads of this machine, and its graphics processor.

use std::num::NonZero;
use std::rc::Rc;
use std::thread;

use egui::Context;
use kalmanscope::team::{Graphics, Team};
use kalmanscope_gpu::Software;
use kalmanscope_lab::Threads;

use super::graphics::Processor;

struct Desktop {
    threads: Option<Threads>,
    processor: Rc<Processor>,
    ctx: Context,
}

pub(super) fn team(software: Software, ctx: &Context) -> Rc<dyn Team> {
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    let count = if processors > 2 { processors - 1 } else { processors };
    let threads = Threads::new(count, 1).map_err(|error| log::warn!("Long work stays in the frames: {error}"));
    Rc::new(Desktop { threads: threads.ok(), processor: Rc::new(Processor::new(software)), ctx: ctx.clone() })
}

impl Team for Desktop {
    fn threads(&self) -> Option<(&Threads, &Context)> {
        self.threads.as_ref().map(|threads| (threads, &self.ctx))
    }

    fn graphics(&self) -> Option<Rc<dyn Graphics>> {
        Some(Rc::<Processor>::clone(&self.processor))
    }
}

#[cfg(test)]
mod tests;
