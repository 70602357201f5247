//! Drawing over time: series are reduced to pixel columns, these to marks, and the marks of a chart form one plot item.

mod cache;
pub(crate) mod cells;
pub(crate) mod chart;
pub(crate) mod charts;
mod columns;
mod cursor;
mod decoration;
mod drawing;
mod frame;
mod grid;
pub(crate) mod heading;
pub(crate) mod input;
mod item;
pub(crate) mod layers;
mod marks;
pub(crate) mod plane;
mod projection;
mod range;
pub(crate) mod series;
mod simplify;
mod strips;
pub(crate) mod strokes;
pub(crate) mod ticks;
pub mod time_axis;
mod turns;
mod window;
