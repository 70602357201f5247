//! A plot item that is painted and no more: it has no legend entry, answers no pointer and sets no bounds.

use std::ops::RangeInclusive;

use egui::{Color32, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotTransform};

pub(super) trait Paint {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>);
}

pub(super) struct Decoration<P> {
    base: PlotItemBase,
    paint: P,
}

impl<P: Paint> Decoration<P> {
    pub(super) fn new(name: &str, paint: P) -> Self {
        Self { base: PlotItemBase::new(name.to_owned()), paint }
    }
}

impl<P: Paint> PlotItem for Decoration<P> {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        self.paint.shapes(ui, transform, shapes);
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}
