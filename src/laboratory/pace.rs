//! How often a map is drawn while its rows come.

use egui::Context;
use web_time::Duration;

/// The shares of the cells that the first pictures have: every sixteenth and every eighth each way.
const FIRST: [usize; 2] = [256, 64];

/// The time between two other pictures: drawing takes processor time from computing the map.
const BETWEEN: Duration = Duration::from_millis(200);

/// Wakes the screen as rows come: at once for the first pictures and the last, else a few times a second.
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
        self.cells / FIRST[0]
    }

    /// Notes that the rows of some cells have come.
    pub fn take(&mut self, cells: usize, ctx: &Context) {
        if self.is_picture(cells) {
            ctx.request_repaint();
        } else {
            ctx.request_repaint_after(BETWEEN);
        }
    }

    /// Whether these cells complete one of the pictures that are shown at once.
    fn is_picture(&mut self, cells: usize) -> bool {
        let before = self.come;
        self.come += cells;
        let completes = |share| (before + 1..=self.come).contains(&(self.cells / share));
        FIRST.into_iter().any(completes) || self.come >= self.cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_pictures_and_the_last_come_at_once() {
        let pictures = |portions: &[usize]| {
            let mut pace = Pace::new(640);
            portions.iter().map(|&cells| pace.is_picture(cells)).collect::<Vec<_>>()
        };
        assert_eq!(pictures(&[1, 1, 7, 1, 9, 600, 21]), [false, true, false, true, false, false, true]);
        assert_eq!(pictures(&[20, 600, 20]), [true, false, true]);
        assert_eq!(pictures(&[640]), [true]);
    }
}
