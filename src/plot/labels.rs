//! The labels of levels, at the right end of their lines.

use egui::{Align2, Color32, Shape, TextStyle, Ui, pos2};
use egui_plot::PlotTransform;

use super::decoration::Paint;
use super::layers::Layer;

/// The distance of a label from the right edge and from its line \[points\].
const GAP: (f32, f32) = (4.0, 1.0);

pub(super) struct Labels {
    labels: Vec<(f64, &'static str, Color32)>,
    middle: f64,
}

impl Labels {
    pub(super) fn of(layers: &[Layer<'_>]) -> Self {
        let label = |layer: &Layer<'_>| match *layer {
            Layer::Level { value, color, label } if !label.is_empty() => Some((value, label, color)),
            _ => None,
        };
        let labels: Vec<(f64, &'static str, Color32)> = layers.iter().filter_map(label).collect();
        let middle = labels.iter().map(|(value, ..)| value).sum::<f64>() / labels.len().max(1) as f64;
        Self { labels, middle }
    }
}

impl Paint for Labels {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = *transform.frame();
        for &(value, text, color) in &self.labels {
            let y = transform.position_from_point_y(value);
            let galley = ui.painter().layout_no_wrap(text.to_owned(), TextStyle::Small.resolve(ui.style()), color);
            let below = (Align2::RIGHT_TOP, GAP.1);
            let above = (Align2::RIGHT_BOTTOM, -GAP.1);
            let places = if value < self.middle { [below, above] } else { [above, below] };
            let rects =
                places.map(|(align, gap)| align.anchor_size(pos2(frame.right() - GAP.0, y + gap), galley.size()));
            if let Some(rect) = rects.into_iter().find(|rect| frame.contains_rect(*rect)) {
                shapes.push(Shape::galley(rect.min, galley, color));
            }
        }
    }
}
