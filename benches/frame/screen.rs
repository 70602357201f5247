//! The explorer without a screen: runs it frame by frame, and reports how long each part of a frame takes, and each phase of a long
//! case.

use eframe::App as _;
use egui::{Context, Pos2, RawInput, Rect, Theme, Vec2};
use kalmanscope::App;
use kalmanscope::layout::ViewLayout;
use kalmanscope::request::ViewKind;
use kalmanscope_core::Scenario;

use crate::clock::{Elapsed, Moment, peak_memory};

/// The size of the window \[points\].
const SIZE: Vec2 = Vec2::new(1280.0, 800.0);

pub(crate) const VIEWS: [ViewKind; 6] = [
    ViewKind::Oscillator,
    ViewKind::Parameters,
    ViewKind::States,
    ViewKind::Errors,
    ViewKind::Innovations,
    ViewKind::Consistency,
];

pub(crate) const PARTS: [&str; 4] = ["change", "logic", "ui", "triangles"];

/// The time that each of [`PARTS`] takes.
pub(crate) type Frame = [Elapsed; PARTS.len()];

pub(crate) struct Screen {
    pub(crate) app: App,
    ctx: Context,
    frame: eframe::Frame,
    frames: usize,
}

impl Screen {
    pub(crate) fn new(app: impl FnOnce(&Context) -> App) -> Self {
        let ctx = Context::default();
        kalmanscope::theme::install(&ctx);
        ctx.set_theme(Theme::Light);
        let mut app = app(&ctx);
        *app.layout_mut() = ViewLayout::column(&VIEWS);
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

/// The frames of one phase.
pub(crate) struct Phase {
    frames: Vec<Frame>,
}

impl Phase {
    /// Draws `frames` frames, each after a change that is given the frame's number.
    pub(crate) fn of(screen: &mut Screen, frames: usize, change: impl Fn(&mut App, usize, &mut RawInput)) -> Self {
        Self { frames: (0..frames).map(|i| screen.frame(|app, input| change(app, i, input))).collect() }
    }

    pub(crate) fn head() {
        let [change, logic, ui, triangles] = PARTS;
        println!(
            "{:<44} {:>6} {:>8} {:>8} {:>8} {:>8}   {change:>8} {logic:>8} {ui:>8} {triangles:>9} {:>10}",
            "longest frames [ms]", "frames", "wall max", "wall 99%", "CPU max", "CPU 99%", "peak [MB]"
        );
    }

    /// Prints the longest frame, the one that 99 % are shorter than, both in wall time and in the thread's processor time,
    /// and the parts of the frame that took the most processor time.
    pub(crate) fn print(&self, name: &str) {
        let wall = |frame: &Frame| frame.iter().map(|part| part.wall).sum::<f64>();
        let cpu = |frame: &Frame| frame.iter().map(|part| part.cpu).sum::<f64>();
        let [wall_99, wall_max] = upper(self.frames.iter().map(wall).collect());
        let [cpu_99, cpu_max] = upper(self.frames.iter().map(cpu).collect());
        let Some(longest) = self.frames.iter().max_by(|a, b| cpu(a).total_cmp(&cpu(b))) else { return };
        let [change, logic, ui, triangles] = longest.map(|part| part.cpu);
        let peak = peak_memory().map_or(String::new(), |peak| format!("{peak:.0}"));
        println!(
            "{name:<44} {:>6} {wall_max:>8.1} {wall_99:>8.1} {cpu_max:>8.1} {cpu_99:>8.1}   {change:>8.1} {logic:>8.1} {ui:>8.1} {triangles:>9.1} {peak:>10}",
            self.frames.len()
        );
    }
}

fn upper(mut times: Vec<f64>) -> [f64; 2] {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    [at(0.99), at(1.0)]
}
