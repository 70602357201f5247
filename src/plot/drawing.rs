//! The drawing of a chart in one window, from its layers down to the marks of a frame.

use std::ops::Range;

use egui_plot::PlotUi;
use kalmanscope_core::Record;

use super::coinciding::drawn_runs;
use super::decoration::Decoration;
use super::item::{DrawingItem, Grid, PaintedShapes};
use super::layers::{Layer, LayerColumns, Window, unbroken, value_range};
use super::marks::Mark;

#[derive(Default)]
pub(crate) struct Drawing {
    marks: Vec<Mark>,
    painted: PaintedShapes,
    pub(crate) range: Option<(f64, f64)>,
}

impl Drawing {
    pub(crate) fn new(layers: &[Layer<'_>], record: &Record, window: &Window, least: Option<(f64, f64)>) -> Self {
        let columns: Vec<LayerColumns> = layers.iter().map(|layer| LayerColumns::new(layer, record, window)).collect();
        let range = value_range(layers.iter().zip(&columns), least);
        // Without a range there are no values to draw.
        let marks = window.scale(range).map_or(Vec::new(), |scale| {
            let runs = drawn_runs(layers, &columns, record, scale);
            let of_layer = |((layer, columns), runs): ((&Layer<'_>, &LayerColumns), Vec<Range<usize>>)| {
                let parts = runs.into_iter().flat_map(|run| unbroken(columns, run));
                parts.filter_map(|run| Mark::new(layer, columns, run, record, scale)).collect::<Vec<_>>()
            };
            layers.iter().zip(&columns).zip(runs).flat_map(of_layer).collect()
        });
        Self { range, marks, painted: PaintedShapes::default() }
    }

    pub(crate) fn show<'a>(&'a self, grid: Grid, plot: &mut PlotUi<'a>) {
        plot.add(Decoration::new("drawing", DrawingItem::new(grid, &self.marks, &self.painted)));
    }

    pub(super) fn marks(&self) -> &[Mark] {
        &self.marks
    }
}
