//! A film: five seconds of a view as an animated GIF.
//!
//! The film sets the time of each picture and draws the view off the screen, without a graphics card. So a slow machine, a page and a
//! test make the same film.

mod changes;
mod encoding;
mod raster;

pub use changes::{Change, Color, Shades, UNCHANGED};
use egui::epaint::ClippedShape;
use egui::{Context, Frame, Margin, Pos2, RawInput, Rect, Theme, UiBuilder, Vec2, ViewportId};
use encoding::{Gif, Pictures, encoded};
use kalmanscope_core::{Task as _, Work};
use raster::{Textures, drawn};

use crate::figure::{extent, legend_ui};
use crate::plot::medium::Medium;
use crate::request::{Proportions, ViewKind};
use crate::session::Session;
use crate::team::{Lost, Priority, RunningTask};
use crate::theme::{self, Palette};
use crate::view::ViewContext;
use crate::views::view;

pub use encoding::LARGEST;

/// The pictures in a second, and those of five seconds.
const RATE: usize = 12;
const COUNT: usize = 5 * RATE;

/// The size of a picture \[pixels\]: half a screen wide. A view of text is as high as its text, within limits.
const WIDTH: f32 = 800.0;
const HEIGHT: f32 = 450.0;
const FLAT: f32 = 260.0;
const MARGIN: i8 = 8;
const AMPLE: f32 = 3000.0;
const LARGEST_TEXT: [f32; 2] = [1600.0, 1000.0];

/// The passes after which nothing of the first picture moves any more.
const PASSES: usize = 4;

pub(crate) struct Film {
    pub(crate) view: ViewKind,
    studio: Studio,
    /// The playback returns to `before`. The first picture shows `begin`, and each next one is `step` later \[s\].
    pub(crate) before: f64,
    begin: f64,
    step: f64,
    count: usize,
    pictures: Vec<Vec<Color>>,
    encoding: Option<RunningTask<Work<Gif>>>,
}

impl Film {
    /// A film of the playback from now on; where less than its length is left, of the last part of the record.
    pub(crate) fn new(view: ViewKind, session: &Session, theme: Theme) -> Self {
        let before = session.time() - session.run().record().time_of(0);
        let step = session.speed() / RATE as f64;
        let begin = before.min(session.end() - (COUNT - 1) as f64 * step).max(0.0);
        let count = COUNT.min(((session.end() - begin) / step + 1e-6) as usize + 1);
        Self { view, studio: Studio::new(theme), begin, step, before, count, pictures: Vec::new(), encoding: None }
    }

    /// The playback time after the record's start of the next picture; at the end, that to return to.
    pub(crate) fn time(&self) -> f64 {
        if self.is_over() { self.before } else { self.begin + self.pictures.len() as f64 * self.step }
    }

    fn is_over(&self) -> bool {
        self.pictures.len() == self.count || self.encoding.is_some()
    }

    pub(crate) fn progress(&self) -> f64 {
        // To make the file takes about a tenth of the time.
        let drawn = self.pictures.len() as f64 / self.count as f64;
        self.encoding.as_ref().map_or(0.9 * drawn, |encoding| 0.9 + 0.1 * encoding.seen)
    }

    /// Draws the next picture, or continues to make the file; at most one picture a frame.
    pub(crate) fn advance(&mut self, context: &ViewContext<'_>) -> Option<Gif> {
        let session = context.session;
        if !self.is_over() {
            if !session.behind() {
                let palette = Palette::of(self.studio.theme);
                let picture = context.without_marks(&palette, |context| self.studio.picture(self.view, context));
                self.pictures.push(picture);
            }
            return None;
        }
        let Self { studio, pictures, encoding, .. } = self;
        let encoding = encoding.get_or_insert_with(|| {
            let pictures = Pictures { size: studio.size, rate: RATE, all: std::mem::take(pictures) };
            RunningTask::begin(&**session.team(), Priority::Hand, encoded(pictures), Work::progress)
        });
        match encoding.advance(&mut session.budget().slice()) {
            Ok(made) => made,
            Err(Lost) => Some(Err("the thread that made it has failed".to_owned())),
        }
    }
}

struct Studio {
    ctx: Context,
    textures: Textures,
    theme: Theme,
    /// `[width, height]` in pixels, zero before the first picture.
    size: [usize; 2],
    drawn: usize,
}

impl Studio {
    fn new(theme: Theme) -> Self {
        let ctx = Context::default();
        theme::install(&ctx);
        ctx.set_theme(theme);
        ctx.all_styles_mut(|style| style.animation_time = 0.0);
        Medium::Film.set(&ctx);
        Self { ctx, textures: Textures::default(), theme, size: [0; 2], drawn: 0 }
    }

    fn picture(&mut self, kind: ViewKind, context: &ViewContext<'_>) -> Vec<Color> {
        if self.drawn == 0 {
            self.size = self.room(kind, context).map(|side| side as usize);
        }
        let size = self.size.map(|side| side as f32);
        let passes = if self.drawn == 0 { PASSES } else { 1 };
        (1..passes).for_each(|_| _ = self.pass(size, kind, context));
        let shapes = self.pass(size, kind, context);
        self.drawn += 1;
        let primitives = self.ctx.tessellate(shapes, 1.0);
        drawn(&primitives, &self.textures, context.palette.ground, self.size)
    }

    fn room(&mut self, kind: ViewKind, context: &ViewContext<'_>) -> [f32; 2] {
        if kind.is_text() {
            (1..PASSES).for_each(|_| _ = self.pass([WIDTH, AMPLE], kind, context));
            let text = extent(&self.pass([WIDTH, AMPLE], kind, context)) + Vec2::splat(2.0 * f32::from(MARGIN));
            return [text.x.clamp(WIDTH, LARGEST_TEXT[0]), text.y.clamp(FLAT, LARGEST_TEXT[1])].map(f32::ceil);
        }
        [WIDTH, if kind.proportions() == Proportions::Flat { FLAT } else { HEIGHT }]
    }

    fn pass(&mut self, size: [f32; 2], kind: ViewKind, context: &ViewContext<'_>) -> Vec<ClippedShape> {
        let time = Some(self.drawn as f64 / RATE as f64);
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, size.into()));
        let mut input = RawInput { screen_rect, time, ..RawInput::default() };
        input.viewports.entry(ViewportId::ROOT).or_default().native_pixels_per_point = Some(1.0);
        let output = self.ctx.run_ui(input, |ui| {
            Frame::new().inner_margin(Margin::same(MARGIN)).show(ui, |ui| {
                ui.set_min_size(ui.available_size());
                legend_ui(ui, context);
                // Plots take all of their room, from its upper corner on.
                let below = UiBuilder::new().max_rect(ui.available_rect_before_wrap());
                ui.scope_builder(below, |ui| view(kind).ui(ui, context, &mut Vec::new()));
            });
        });
        self.textures.take(output.textures_delta);
        output.shapes
    }
}
