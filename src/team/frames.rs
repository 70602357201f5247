//! Runs cells in slices of the frames, for platforms without threads and workers.

use std::sync::Arc;

use egui::Context;
use kalmanscope_core::Task as _;
use kalmanscope_lab::CellTask;
use web_time::Duration;

use super::{Cells, Computer, Handle, Rows, Team};
use crate::session::Budget;

/// Runs cells in each frame for as long as a budget allows; a cell that takes longer continues in the next frame.
pub struct Frames(pub Budget);

impl Frames {
    /// The slice of a frame that leaves time to draw it.
    pub const FRAME: Self = Self(Budget::Time(Duration::from_millis(8)));
}

impl Team for Frames {
    fn cells(&self, cells: &Cells, ctx: &Context) -> Option<Handle<Rows>> {
        let Self(budget) = *self;
        let (Cells { runner, order, .. }, ctx) = (cells.clone(), ctx.clone());
        // The place of the next cell in the order, and that cell if it is under way.
        let (mut next, mut under_way) = (0, None);
        let mut is_over = false;
        Some(Handle::new(move || {
            // After the rows of a slice comes nothing until the next frame.
            if std::mem::take(&mut is_over) {
                return Ok(None);
            }
            let begin = next;
            let mut while_time = budget.slice();
            let mut numbers = Vec::new();
            while let Some(&cell) = order.get(next) {
                let mut task = under_way.take().unwrap_or_else(|| CellTask::new(Arc::clone(&runner), cell));
                if !task.advance(&mut while_time) {
                    under_way = Some(task);
                    break;
                }
                numbers.extend(task.finish());
                next += 1;
                if !while_time() {
                    break;
                }
            }
            if next < order.len() {
                ctx.request_repaint();
            }
            is_over = next > begin;
            Ok(is_over.then(|| Rows { cells: order[begin..next].to_vec(), numbers, by: Computer::Frames }))
        }))
    }
}
