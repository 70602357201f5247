//! The rows of an ensemble, as far as they are known.

use crate::Ensemble;
use crate::ensemble::{stand_in, widest};

/// The rows of some cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// The cells.
    pub cells: Vec<usize>,
    /// Their rows, one after the other.
    pub rows: Vec<f64>,
}

/// The rows of an ensemble's cells, filled in any order.
#[derive(Clone, Debug)]
pub struct EnsembleRows {
    counts: Vec<usize>,
    width: usize,
    rows: Vec<f64>,
    known: Vec<bool>,
    done: usize,
}

impl EnsembleRows {
    /// An empty sheet.
    pub fn new(ensemble: &Ensemble) -> Self {
        let (cells, width) = (ensemble.cells(), ensemble.width());
        let rows = vec![f64::NAN; cells * width];
        Self { counts: ensemble.counts(), width, rows, known: vec![false; cells], done: 0 }
    }

    /// Fills in the rows of some cells, one after the other.
    pub fn fill(&mut self, cells: &[usize], rows: &[f64]) {
        for (at, &cell) in cells.iter().enumerate() {
            let Some(row) = rows.get(at * self.width..(at + 1) * self.width) else { return };
            self.rows[cell * self.width..(cell + 1) * self.width].copy_from_slice(row);
            self.done += usize::from(!self.known[cell]);
            self.known[cell] = true;
        }
    }

    /// The row of a cell, if it is known.
    pub fn row(&self, cell: usize) -> Option<&[f64]> {
        self.known.get(cell)?.then(|| &self.rows[cell * self.width..(cell + 1) * self.width])
    }

    /// The row of a cell, or else that of the finest known cell that stands in for it in a picture.
    pub fn shown(&self, cell: usize) -> Option<&[f64]> {
        let mut stride = 1;
        while stride <= widest(&self.counts) {
            if let Some(row) = self.row(stand_in(&self.counts, cell, stride)) {
                return Some(row);
            }
            stride *= 2;
        }
        None
    }

    /// A hash of all rows, to compare platforms.
    pub fn checksum(&self) -> u64 {
        // NaN has many bit patterns.
        let bits = |number: &f64| if number.is_nan() { u64::MAX } else { number.to_bits() };
        self.rows.iter().fold(0, |sum: u64, number| sum.rotate_left(5) ^ bits(number))
    }

    /// The number of values on each axis.
    pub fn counts(&self) -> &[usize] {
        &self.counts
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// The number of cells that are known.
    pub fn done(&self) -> usize {
        self.done
    }

    /// Whether every cell is known.
    pub fn is_complete(&self) -> bool {
        self.done == self.known.len()
    }

    /// Whether every cell is known or has one that stands in for it.
    pub fn covers_all(&self) -> bool {
        let stride = widest(&self.counts);
        let coarse = |cell: &usize| stand_in(&self.counts, *cell, stride) == *cell;
        (0..self.len()).filter(coarse).all(|cell| self.known[cell])
    }

    /// The cells of an order that are not known yet.
    pub fn missing<'a>(&'a self, order: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
        order.iter().copied().filter(|&cell| !self.known[cell])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plan;
    use crate::ensemble::coarse_to_fine;
    use kalmanscope_core::{Axis, Scenario};
    use kalmanscope_diagnosis::Measure;

    #[test]
    fn a_coarse_picture_is_complete_long_before_the_fine_one() {
        let axes = ["filters.EKF.fading=1:1.2:40", "filters.EKF.eta=0:1:20"];
        let axes = axes.iter().map(|text| Axis::parse(text).unwrap()).collect();
        let plan = Plan { filters: vec![0], measures: vec![Measure::NIS, Measure::NEES], axes, ..Plan::default() };
        let ensemble = Ensemble::new(Scenario::default(), plan).unwrap();
        let mut sheet = EnsembleRows::new(&ensemble);
        let order = ensemble.coarse_to_fine();
        assert!(sheet.shown(0).is_none() && !sheet.covers_all());
        let mut covered = None;
        for (at, &cell) in order.iter().enumerate() {
            let [x, y] = ensemble.places(cell)[..] else { panic!("two axes") };
            sheet.fill(&[cell], &[x as f64, y as f64]);
            covered = covered.or(sheet.covers_all().then_some(at + 1));
        }
        assert_eq!(covered, Some(5 * 3));
        assert!(sheet.is_complete() && sheet.missing(&order).next().is_none());
        assert_eq!(sheet.row(ensemble.cell(&[39, 19])), Some(&[39.0, 19.0][..]));
        let mut coarse = EnsembleRows::new(&ensemble);
        coarse.fill(&order[..15], &vec![7.0; 30]);
        assert_eq!(coarse.missing(&order).count(), 785);
        assert!((0..800).all(|cell| coarse.shown(cell) == Some(&[7.0, 7.0][..])));
    }

    #[test]
    fn every_cell_comes_once() {
        for counts in [&[1][..], &[7], &[128, 128], &[5, 3], &[1, 9], &[4, 3, 2], &[256, 1], &[]] {
            let mut order = coarse_to_fine(counts);
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..counts.iter().product()), "{counts:?}");
        }
    }

    #[test]
    fn the_beginning_covers_the_grid() {
        let counts = [128, 128];
        let order = coarse_to_fine(&counts);
        let stride = widest(&counts);
        assert_eq!(stride, 16);
        let first: Vec<usize> = order[..64].to_vec();
        for cell in 0..128 * 128 {
            assert!(first.contains(&stand_in(&counts, cell, stride)));
        }
        assert!(order[64..256].iter().all(|&cell| cell % 8 == 0 && (cell / 128) % 8 == 0));
    }

    #[test]
    fn a_line_of_cells_is_halved_again_and_again() {
        assert_eq!(coarse_to_fine(&[9]), [0, 2, 4, 6, 8, 1, 3, 5, 7]);
    }
}
