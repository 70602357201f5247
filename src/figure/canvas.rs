//! The context in which a figure's parts are drawn, and their shapes.

use egui::emath::TSTransform;
use egui::epaint::ClippedShape;
use egui::{Context, Pos2, RawInput, Rect, Shape, Theme, Ui, Vec2, ViewportId};

use super::format::TYPE;
use super::pen::Pen;
use crate::plot::medium::Medium;
use crate::theme;

/// The number of passes after which nothing moves any more: sizes of tables, ranges of axes.
const PASSES: usize = 4;

/// Pixels per point: letters are placed on whole ones.
const DENSITY: f32 = 4.0;

pub(super) struct Canvas {
    ctx: Context,
    pen: Pen,
}

pub(super) struct Part {
    /// The shapes of the part; its left upper corner is the origin.
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

    pub(super) fn ctx(&self) -> &Context {
        &self.ctx
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

impl Part {
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

pub(super) fn extent(shapes: &[ClippedShape]) -> Vec2 {
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
