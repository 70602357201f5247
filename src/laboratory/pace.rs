//! How often a map is drawn while its rows come.

use egui::Context;
use web_time::Duration;

/// The share of the cells that a first picture has: every eighth each way.
const FIRST: usize = 64;

/// The time between two other pictures: drawing takes processors from what computes the map.
const BETWEEN: Duration = Duration::from_millis(200);

/// Wakes the screen as rows come: at once for the first picture and the last, else a few times a second.
pub struct Pace {
    cells: usize,
    come: usize,
}

impl Pace {
    /// The pace of a map with this number of cells to compute.
    pub fn new(cells: usize) -> Self {
        Self { cells, come: 0 }
    }

    /// The number of cells of the first picture.
    pub fn first(&self) -> usize {
        self.cells / FIRST
    }

    /// Notes that the rows of some cells have come.
    pub fn take(&mut self, cells: usize, ctx: &Context) {
        let (before, first) = (self.come, self.first());
        self.come += cells;
        if (before < first && first <= self.come) || self.come >= self.cells {
            ctx.request_repaint();
        } else {
            ctx.request_repaint_after(BETWEEN);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    #[test]
    fn the_first_picture_and_the_last_come_at_once() {
        assert_eq!(waits(&[9]), [BETWEEN]);
        assert_eq!(waits(&[9, 1]), [BETWEEN, Duration::ZERO]);
        assert_eq!(waits(&[640]), [Duration::ZERO]);
    }

    /// The delays until the next picture that are asked for while the rows of 640 cells come in these portions.
    fn waits(portions: &[usize]) -> Vec<Duration> {
        let (ctx, waits) = (Context::default(), Arc::new(Mutex::new(Vec::new())));
        let told = Arc::clone(&waits);
        ctx.set_request_repaint_callback(move |info| told.lock().unwrap().push(info.delay));
        let mut pace = Pace::new(640);
        portions.iter().for_each(|&cells| pace.take(cells, &ctx));
        waits.lock().unwrap().clone()
    }
}
