//! Runs ensembles in slices of the frames, for platforms without threads.

use std::sync::Arc;

use egui::Context;
use kalmanscope_core::Task as _;
use kalmanscope_lab::{CellTask, EnsembleError, Runner};
use web_time::Duration;

use super::engine::{Computer, Engine, Rows, Task, Work};
use crate::session::Budget;

/// Runs cells in each frame for as long as a budget allows; a cell that takes longer goes on in the next frame.
pub struct Slices(pub Budget);

impl Slices {
    /// The slice of a frame that leaves time to draw it.
    pub const FRAME: Self = Self(Budget::Time(Duration::from_millis(8)));
}

impl Engine for Slices {
    fn start(&self, task: Task<'_>, ctx: &Context) -> Result<Box<dyn Work>, EnsembleError> {
        let runner = Arc::new(Runner::new(task.ensemble.clone(), task.source.clone())?);
        let (order, ctx) = (task.order, ctx.clone());
        Ok(Box::new(SlicedWork { runner, order, next: 0, cell: None, budget: self.0, ctx }))
    }

    fn usual_count(&self) -> usize {
        32
    }
}

struct SlicedWork {
    runner: Arc<Runner>,
    order: Vec<usize>,
    /// The place of the next cell in the order.
    next: usize,
    /// The next cell, if it is under way.
    cell: Option<CellTask>,
    budget: Budget,
    ctx: Context,
}

impl Work for SlicedWork {
    fn poll(&mut self) -> Vec<Rows> {
        let begin = self.next;
        let mut while_time = self.budget.slice();
        let mut numbers = Vec::new();
        while let Some(&cell) = self.order.get(self.next) {
            let mut work = self.cell.take().unwrap_or_else(|| CellTask::new(Arc::clone(&self.runner), cell));
            if !work.advance(&mut while_time) {
                self.cell = Some(work);
                break;
            }
            numbers.extend(work.finish());
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
