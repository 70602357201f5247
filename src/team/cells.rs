//! Cells of an ensemble to be run, their rows, and the graphics processor that runs some.

use std::fmt;
use std::sync::Arc;

use egui::Context;
use kalmanscope_lab::{Priority, Runner};
use serde::{Deserialize, Serialize};

use super::Handle;

#[derive(Clone)]
pub struct Cells {
    pub runner: Arc<Runner>,
    pub order: Vec<usize>,
    pub precision: Precision,
    pub priority: Priority,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    #[default]
    Fastest,
    Double,
}

impl Precision {
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    pub cells: Vec<usize>,
    pub numbers: Vec<f64>,
    pub by: Computer,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Computer {
    Frames,
    Threads(usize),
    Workers(usize),
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

pub trait Graphics {
    /// Whether it was found. The first call begins the search; the search's end wakes the context.
    fn find(&self, ctx: &Context) -> Finding;

    fn found(&self) -> Finding;

    fn cells(&self, cells: &Cells, ctx: &Context) -> Option<Handle<Rows>>;
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finding {
    Searching,
    Ready,
    Absent(String),
    /// There was one, and it has failed, for this reason.
    Lost(String),
}
