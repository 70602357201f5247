//! Runs ensembles in the frames themselves, a slice of each, where there are no threads.

use egui::Context;
use kalmanscope_lab::{EnsembleError, Runner};
use web_time::Duration;

use super::engine::{Computer, Engine, Rows, Task, Work};
use crate::session::Budget;

/// Runs as many cells in each frame as a budget allows, at least one.
pub struct Slices(pub Budget);

impl Slices {
    /// The slice of a frame that leaves time to draw it.
    pub const FRAME: Self = Self(Budget::Time(Duration::from_millis(8)));
}

impl Engine for Slices {
    fn start(&self, task: Task<'_>, ctx: &Context) -> Result<Box<dyn Work>, EnsembleError> {
        let runner = Runner::new(task.ensemble.clone(), task.source.clone())?;
        Ok(Box::new(SlicedWork { runner, order: task.order, next: 0, budget: self.0, ctx: ctx.clone() }))
    }

    fn usual_count(&self) -> usize {
        32
    }
}

struct SlicedWork {
    runner: Runner,
    order: Vec<usize>,
    next: usize,
    budget: Budget,
    ctx: Context,
}

impl Work for SlicedWork {
    fn poll(&mut self) -> Vec<Rows> {
        let begin = self.next;
        let mut while_time = self.budget.slice();
        let mut numbers = Vec::new();
        while let Some(&cell) = self.order.get(self.next) {
            numbers.extend(self.runner.rows(&[cell]));
            self.next += 1;
            if !while_time() {
                break;
            }
        }
        if self.next < self.order.len() {
            self.ctx.request_repaint();
        }
        let cells = self.order[begin..self.next].to_vec();
        if cells.is_empty() { Vec::new() } else { vec![Rows { cells, numbers, by: Computer::Frames }] }
    }
}
