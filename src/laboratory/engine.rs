//! The interface to run ensembles: by threads, workers of a page, slices of the frames, or a graphics processor.

use std::fmt;
use std::sync::Arc;

use egui::Context;
use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, EnsembleError};
use serde::{Deserialize, Serialize};

/// Runs ensembles.
pub trait Engine {
    /// Begins to run cells in the given order, and wakes the context when rows have come.
    ///
    /// # Errors
    /// [`EnsembleError`] where the source does not fit the ensemble.
    fn start(&self, task: Task<'_>, ctx: &Context) -> Result<Box<dyn Work>, EnsembleError>;

    /// The number of values on each axis of a new map, so that it is complete soon.
    fn usual_count(&self) -> usize;

    /// Whether a graphics processor was found. `None` if the engine uses none.
    fn graphics(&self) -> Option<Finding> {
        None
    }
}

/// The cells of an ensemble that are to be run.
#[derive(Clone)]
pub struct Task<'a> {
    /// The ensemble.
    pub ensemble: &'a Ensemble,
    /// The source of its samples.
    pub source: &'a Source,
    /// The cells.
    pub order: Vec<usize>,
    /// The precision of the rows.
    pub precision: Precision,
}

/// The precision of a map's numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// The fastest one: single precision if there is a graphics processor.
    #[default]
    Fastest,
    /// Double precision, by the processor.
    Double,
}

impl Precision {
    /// Whether it is the usual one.
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }
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
    /// The computer of these rows.
    pub by: Computer,
}

/// A computer of rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Computer {
    /// The program between two frames.
    Frames,
    /// This many threads.
    Threads(usize),
    /// This many workers of a page.
    Workers(usize),
    /// The graphics processor of this name, in single precision.
    Graphics(Arc<str>),
}

impl fmt::Display for Computer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let several = |n: usize| if n == 1 { "" } else { "s" };
        match self {
            Self::Frames => write!(f, "by this program between frames"),
            Self::Threads(n) => write!(f, "by {n} thread{}", several(*n)),
            Self::Workers(n) => write!(f, "by {n} worker{}", several(*n)),
            Self::Graphics(name) => write!(f, "in single precision by {name}"),
        }
    }
}

/// A graphics processor, if there is one.
pub trait Graphics {
    /// Whether it was found. The first call begins the search; the search's end wakes the context.
    fn find(&self, ctx: &Context) -> Finding;

    /// Whether it was found so far.
    fn found(&self) -> Finding;

    /// Begins to run cells. `None` if it cannot.
    fn start(&self, task: Task<'_>, ctx: &Context) -> Option<Box<dyn GraphicsWork>>;
}

/// The state of the search for a graphics processor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    /// Nothing yet.
    Searching,
    /// It was found.
    Ready,
    /// There is none, for this reason.
    Absent(String),
    /// There was one, and it has failed, for this reason.
    Lost(String),
}

/// Work on a graphics processor. It ends when it is dropped.
pub trait GraphicsWork {
    /// The rows that have come since the last call.
    ///
    /// # Errors
    /// [`GivenUp`] if no more will come.
    fn poll(&mut self) -> Result<Vec<Rows>, GivenUp>;
}

/// A graphics processor does not go on: it does not serve the map, or has been lost. [`Graphics::found`] says which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GivenUp;
