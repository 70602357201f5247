//! Figures: the views on screen, drawn again for paper or a slide, as SVG.
//!
//! The views draw themselves in their own context, with a white ground, type of one size and thin lines. Their
//! shapes become SVG, which needs neither a screen nor a graphics card.

mod arrange;
mod canvas;
mod svg;

use egui::Vec2;

use crate::request::{FigureFormat, ViewKind};
use crate::view::ViewContext;
use arrange::arrange;
use canvas::Part;

pub struct Figure {
    parts: Vec<Part>,
    /// Width and height \[points of the canvas\].
    size: Vec2,
    scale: f32,
}

impl Figure {
    pub fn new(context: &ViewContext<'_>, rows: &[Vec<ViewKind>], format: FigureFormat) -> Self {
        arrange(context, rows, format)
    }

    /// Width and height \[mm\].
    pub fn millimetres(&self) -> [f32; 2] {
        [self.size.x, self.size.y].map(|length| length * self.scale * canvas::MILLIMETRES_PER_POINT)
    }

    pub fn svg(&self) -> String {
        svg::svg(self)
    }
}
