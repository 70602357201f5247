//! The context in which a figure's parts are drawn, and their shapes.

use egui::emath::TSTransform;
use egui::epaint::ClippedShape;
use egui::{Context, Pos2, RawInput, Rect, Shape, Theme, Ui, Vec2, ViewportId};

use crate::plot::medium::Medium;
use crate::request::FigureFormat;
use crate::theme;

/// The number of passes after which nothing moves any more: sizes of tables, ranges of axes.
const PASSES: usize = 4;

/// Pixels per point: letters are placed on whole ones.
const DENSITY: f32 = 4.0;

pub(super) struct Canvas {
    pub(super) ctx: Context,
    pen: Pen,
}

pub(super) struct FigurePart {
    pub(super) shapes: Vec<ClippedShape>,
    pub(super) to: TSTransform,
}

impl Canvas {
    pub(super) fn new(pen: Pen) -> Self {
        let ctx = Context::default();
        theme::install(&ctx);
        theme::level_text(&ctx, TYPE);
        ctx.set_theme(Theme::Light);
        ctx.all_styles_mut(|style| {
            style.animation_time = 0.0;
            style.spacing.item_spacing.y = 3.0;
        });
        Medium::Figure.set(&ctx);
        Self { ctx, pen }
    }

    pub(super) fn draw(&self, size: Vec2, mut add: impl FnMut(&mut Ui)) -> Vec<ClippedShape> {
        let screen = Rect::from_min_size(Pos2::ZERO, size);
        let mut shapes = Vec::new();
        for _ in 0..PASSES {
            let mut input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
            input.viewports.entry(ViewportId::ROOT).or_default().native_pixels_per_point = Some(DENSITY);
            let mut output = self.ctx.run_ui(input, |ui| add(ui));
            // The glyphs are taken from the context when they are needed.
            output.textures_delta.clear();
            shapes = output.shapes;
        }
        for clipped in &mut shapes {
            self.pen.redraw(&mut clipped.shape);
            clipped.clip_rect = beyond(clipped.clip_rect, screen);
        }
        shapes
    }
}

impl FigurePart {
    pub(super) fn at(place: Pos2, scaling: f32, shapes: Vec<ClippedShape>) -> Self {
        Self { shapes, to: TSTransform::new(place.to_vec2(), scaling) }
    }
}

/// Extends limits that end with the ground: letters of an axis may reach beyond it a little.
fn beyond(limits: Rect, ground: Rect) -> Rect {
    let mut limits = limits;
    for axis in 0..2 {
        if limits.min[axis] <= ground.min[axis] {
            limits.min[axis] -= TYPE;
        }
        if limits.max[axis] >= ground.max[axis] {
            limits.max[axis] += TYPE;
        }
    }
    limits
}

pub(crate) fn extent(shapes: &[ClippedShape]) -> Vec2 {
    let mut extent = Vec2::ZERO;
    shapes.iter().for_each(|clipped| extend(&clipped.shape, &mut extent));
    extent
}

fn extend(shape: &Shape, extent: &mut Vec2) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| extend(shape, extent)),
        Shape::Text(text) => *extent = extent.max(text.visual_bounding_rect().max.to_vec2()),
        _ => {}
    }
}

pub(super) const MILLIMETRES_PER_POINT: f32 = 25.4 / 72.0;

/// The size of type on the canvas \[points of the canvas\]. Views are laid out for type of about this size.
pub(super) const TYPE: f32 = 12.0;

pub(super) struct Geometry {
    pub(super) width: f32,
    /// Height over width. `None` if the contents determine the height.
    pub(super) aspect: Option<f32>,
    pub(super) type_size: f32,
    /// The width of the finest and of the boldest curve \[points\].
    pub(super) curves: [f32; 2],
    pub(super) is_narrow: bool,
}

impl Geometry {
    pub(super) fn of(format: FigureFormat) -> Self {
        let paper = |millimetres: f32, is_narrow| Self {
            width: millimetres / MILLIMETRES_PER_POINT,
            aspect: None,
            type_size: 8.0,
            curves: [0.5, 0.75],
            is_narrow,
        };
        match format {
            FigureFormat::Column => paper(84.0, true),
            FigureFormat::Page => paper(174.0, false),
            FigureFormat::Slide => {
                Self { width: 960.0, aspect: Some(9.0 / 16.0), type_size: 18.0, curves: [2.0, 4.0], is_narrow: false }
            }
        }
    }
}

impl FigureFormat {
    pub const ALL: [Self; 3] = [Self::Column, Self::Page, Self::Slide];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Column => "Paper, 84 mm",
            Self::Page => "Paper, 174 mm",
            Self::Slide => "Slide, 16:9",
        }
    }

    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Column => "84mm",
            Self::Page => "174mm",
            Self::Slide => "slide",
        }
    }
}

/// The finest and the boldest curve of the views on a screen, which is the truth \[points\].
const ON_SCREEN: [f32; 2] = [1.6, 4.0];

pub(super) struct Pen {
    curves: [f32; 2],
}

impl Pen {
    pub(super) fn new(curves: [f32; 2]) -> Self {
        Self { curves }
    }

    /// Lines finer than any curve, such as those of the grid, stay finer.
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
