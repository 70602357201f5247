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
        let strides = std::iter::successors(Some(1), |stride| Some(2 * stride));
        let strides = strides.take_while(|stride| *stride <= widest(&self.counts));
        strides.map(|stride| stand_in(&self.counts, cell, stride)).find_map(|cell| self.row(cell))
    }

    /// A hash of all rows, to compare platforms.
    pub fn checksum(&self) -> u64 {
        // NaN has many bit patterns.
        let bits = |number: &f64| if number.is_nan() { u64::MAX } else { number.to_bits() };
        self.rows.iter().fold(0, |sum: u64, number| sum.rotate_left(5) ^ bits(number))
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
