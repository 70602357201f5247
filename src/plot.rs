//! Drawing over time: series are reduced to pixel columns, and these are drawn as items of `egui_plot`.

pub(crate) mod axes;
pub(crate) mod cache;
pub(crate) mod chart;
mod cursor;
mod decoration;
pub(crate) mod handles;
pub(crate) mod heading;
pub(crate) mod layers;
pub(crate) mod medium;
pub(crate) mod notes;
pub(crate) mod plane;
pub(crate) mod series;
pub mod sheet;
mod simplify;
pub mod time_axis;
