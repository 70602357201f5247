//! The explorer without a screen: runs it frame by frame, and says how long each part of a frame takes.

use eframe::App as _;
use egui::{Context, Pos2, RawInput, Rect, Theme, Vec2};
use kalmanscope::App;
use kalmanscope::layout::Layout;
use kalmanscope::request::ViewKind;
use kalmanscope_core::Scenario;

use crate::clock::{Elapsed, Moment};

/// The size of the window \[points\].
const SIZE: Vec2 = Vec2::new(1280.0, 800.0);

/// The six views of all cases.
pub(crate) const VIEWS: [ViewKind; 6] = [
    ViewKind::Oscillator,
    ViewKind::Parameters,
    ViewKind::States,
    ViewKind::Errors,
    ViewKind::Innovations,
    ViewKind::Consistency,
];

/// The parts of a frame.
pub(crate) const PARTS: [&str; 4] = ["change", "logic", "ui", "triangles"];

/// The time that each of [`PARTS`] takes.
pub(crate) type Frame = [Elapsed; PARTS.len()];

/// The explorer and its window.
pub(crate) struct Screen {
    pub(crate) app: App,
    ctx: Context,
    frame: eframe::Frame,
    frames: usize,
}

impl Screen {
    /// A window of an explorer that `app` makes.
    pub(crate) fn new(app: impl FnOnce(&Context) -> App) -> Self {
        let ctx = Context::default();
        kalmanscope::theme::install(&ctx);
        ctx.set_theme(Theme::Light);
        let mut app = app(&ctx);
        *app.layout_mut() = Layout::column(&VIEWS);
        Self { app, ctx, frame: eframe::Frame::_new_kittest(), frames: 0 }
    }

    /// Changes something, then draws a frame.
    pub(crate) fn frame(&mut self, change: impl FnOnce(&mut App, &mut RawInput)) -> Frame {
        let Self { app, ctx, frame, frames } = self;
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE)),
            time: Some(*frames as f64 / 60.0),
            ..RawInput::default()
        };
        *frames += 1;
        let mut times = Frame::default();
        let begin = Moment::now();
        change(app, &mut input);
        times[0] = begin.elapsed();
        let mut output = ctx.run_ui(input, |root| {
            let begin = Moment::now();
            app.logic(root.ctx(), frame);
            times[1] += begin.elapsed();
            let begin = Moment::now();
            app.ui(root, frame);
            times[2] += begin.elapsed();
        });
        output.textures_delta.clear();
        let begin = Moment::now();
        std::hint::black_box(ctx.tessellate(output.shapes, output.pixels_per_point));
        times[3] = begin.elapsed();
        times
    }
}

/// Edits the scenario as the controls do.
pub(crate) fn edit(app: &mut App, edit: impl FnOnce(&mut Scenario)) {
    let mut scenario = app.session().scenario().clone();
    edit(&mut scenario);
    app.session_mut().set_scenario(scenario);
}
