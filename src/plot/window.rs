//! The part of a record on a plot, and its scale.

use std::hash::Hash;

use egui::Vec2;

use super::frame::Y_AXIS;

#[derive(Clone, Copy)]
pub(crate) struct Window {
    /// Beginning and end \[s\].
    pub(crate) times: (f64, f64),
    pub(crate) values: Option<(f64, f64)>,
    pub(crate) size: Vec2,
}

impl Window {
    pub(crate) fn columns(&self) -> usize {
        ((self.size.x - Y_AXIS) as usize).max(16)
    }

    /// The scale of the screen. The vertical axis shows `range` unless the user has chosen another.
    pub(crate) fn scale(&self, range: Option<(f64, f64)>) -> Option<Scale> {
        let per = |(low, high): (f64, f64), length: f32| f64::from(length) / (high - low);
        Some(Scale { x: per(self.times, self.size.x), y: per(self.values.or(range)?, self.size.y) })
    }

    pub(crate) fn key(&self) -> impl Hash + use<> {
        let bits = |(low, high): (f64, f64)| [low.to_bits(), high.to_bits()];
        (bits(self.times), self.values.map(bits), self.size.x.to_bits(), self.size.y.to_bits())
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Scale {
    pub(crate) x: f64,
    pub(crate) y: f64,
}
