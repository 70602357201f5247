//! Runs ensembles on the threads of this machine.

use std::num::NonZero;
use std::sync::Arc;
use std::thread;

use egui::Context;
use kalmanscope::laboratory::{Engine, Rows, Slices, Work};
use kalmanscope_core::Source;
use kalmanscope_lab::{Crew, Ensemble, EnsembleError, Runner};

/// Threads that serve all maps.
struct Threads(Crew);

/// Threads for the laboratory, or slices of the frames where the system gives no threads. One processor is left to the frames
/// where there are more than two.
pub(super) fn engine() -> Box<dyn Engine> {
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    let threads = if processors > 2 { processors - 1 } else { processors };
    match Crew::new(threads) {
        Ok(crew) => Box::new(Threads(crew)),
        Err(error) => {
            log::warn!("The laboratory has no threads: {error}");
            Box::new(Slices::FRAME)
        }
    }
}

impl Engine for Threads {
    fn start(
        &self,
        ensemble: &Ensemble,
        source: &Source,
        order: Vec<usize>,
        ctx: &Context,
    ) -> Result<Box<dyn Work>, EnsembleError> {
        let runner = Arc::new(Runner::new(ensemble.clone(), source.clone())?);
        let ctx = ctx.clone();
        Ok(Box::new(ThreadedWork(self.0.start(&runner, order, move || ctx.request_repaint()))))
    }

    fn usual_count(&self) -> usize {
        64
    }
}

struct ThreadedWork(kalmanscope_lab::Work);

impl Work for ThreadedWork {
    fn poll(&mut self) -> Vec<Rows> {
        self.0.poll().map(|slice| Rows { cells: slice.cells, numbers: slice.rows }).collect()
    }
}
