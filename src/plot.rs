//! Drawing over time: series are reduced to pixel columns, these to marks, and the marks of a chart form one plot item.

pub(crate) mod axes;
pub(crate) mod cache;
pub(crate) mod chart;
mod coinciding;
mod cursor;
mod decoration;
pub(crate) mod handles;
pub(crate) mod heading;
mod item;
pub(crate) mod layers;
mod marks;
pub(crate) mod medium;
pub(crate) mod plane;
pub(crate) mod series;
pub(crate) mod strokes;
pub mod time_axis;
