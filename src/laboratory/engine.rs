//! The interface to run ensembles: by threads, workers of a page, or slices of the frames.

use egui::Context;
use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, EnsembleError};

/// Runs ensembles.
pub trait Engine {
    /// Begins to run cells in the given order, and wakes the context when rows have come.
    ///
    /// # Errors
    /// [`EnsembleError`] where the source does not fit the ensemble.
    fn start(
        &self,
        ensemble: &Ensemble,
        source: &Source,
        order: Vec<usize>,
        ctx: &Context,
    ) -> Result<Box<dyn Work>, EnsembleError>;

    /// The number of values on each axis of a new map, so that it is complete soon.
    fn usual_count(&self) -> usize;
}

/// The work on one ensemble. It ends when it is dropped.
pub trait Work {
    /// The rows that have come since the last call.
    fn poll(&mut self) -> Vec<Rows>;
}

/// The rows of some cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// The cells.
    pub cells: Vec<usize>,
    /// Their rows, one after the other.
    pub numbers: Vec<f64>,
}
