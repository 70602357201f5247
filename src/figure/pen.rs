//! The widths of a figure's lines.

use egui::Shape;

/// The finest and the boldest curve of the views on a screen, which is the truth \[points\].
const ON_SCREEN: [f32; 2] = [1.6, 4.0];

/// Gives lines the widths of a figure: those of a screen differ too much for paper.
pub(super) struct Pen {
    /// The widths of the finest and of the boldest curve \[points of the canvas\].
    curves: [f32; 2],
}

impl Pen {
    pub(super) fn new(curves: [f32; 2]) -> Self {
        Self { curves }
    }

    /// The width in the figure of a line with the width `on_screen`. Lines finer than any curve, such as those of the
    /// grid, stay finer.
    fn width(&self, on_screen: f32) -> f32 {
        let ([fine, bold], [least, most]) = (self.curves, ON_SCREEN);
        let share = ((on_screen - least) / (most - least)).min(1.0);
        if share < 0.0 { fine * on_screen / least } else { fine + (bold - fine) * share }
    }

    pub(super) fn redraw(&self, shape: &mut Shape) {
        let width = match shape {
            Shape::Vec(shapes) => return shapes.iter_mut().for_each(|shape| self.redraw(shape)),
            Shape::Circle(circle) => &mut circle.stroke.width,
            Shape::Ellipse(ellipse) => &mut ellipse.stroke.width,
            Shape::LineSegment { stroke, .. } => &mut stroke.width,
            Shape::Path(path) => &mut path.stroke.width,
            Shape::Rect(rect) => &mut rect.stroke.width,
            Shape::QuadraticBezier(curve) => &mut curve.stroke.width,
            Shape::CubicBezier(curve) => &mut curve.stroke.width,
            Shape::Noop | Shape::Text(_) | Shape::Mesh(_) | Shape::Band(_) | Shape::Callback(_) => return,
        };
        *width = self.width(*width);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_keep_their_order() {
        let pen = Pen::new([0.5, 0.75]);
        let widths = [0.0, 0.7, 1.0, 1.6, 2.4, 4.0, 9.0].map(|width| pen.width(width));
        assert!(widths.windows(2).all(|pair| pair[0] <= pair[1]), "{widths:?}");
        assert_eq!((widths[0], widths[3], widths[5], widths[6]), (0.0, 0.5, 0.75, 0.75));
    }
}
