//! The explorer without a window: every view of a scenario, frame by frame, with a pointer and keys.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;

use eframe::App as _;
use egui::{
    Context, Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, RawInput, Rect, Theme, TouchPhase, Vec2,
};
use kalmanscope::App;
use kalmanscope::layout::ViewLayout;
use kalmanscope::request::ViewKind;
use kalmanscope::session::{Budget, Mode, RecordFile};
use kalmanscope_core::Scenario;

use crate::dice::Dice;
use crate::findings::stage;
use crate::way::Measured;

/// The size of the window, in which each view has room \[points\].
const SIZE: Vec2 = Vec2::new(1280.0, 8000.0);

/// The budget of a frame, in pieces of work so that it is the same on every machine.
const BUDGET: Budget = Budget::Pieces(2);

/// Limits the frames in which a picture is to be complete. Longer ones are left incomplete.
const FRAMES: usize = 80;

struct Screen {
    app: App,
    ctx: Context,
    frame: eframe::Frame,
    frames: usize,
}

impl Screen {
    fn new() -> Self {
        let ctx = Context::default();
        kalmanscope::theme::install(&ctx);
        ctx.set_theme(Theme::Light);
        ctx.enable_accesskit();
        let scenario = Scenario { duration: 1.0, ..Scenario::default() };
        let mut app = App::with_scenario(scenario).expect("the first scenario can be run");
        app.session_mut().set_budget(BUDGET);
        *app.layout_mut() = ViewLayout::column(&ViewKind::ALL);
        Self { app, ctx, frame: eframe::Frame::_new_kittest(), frames: 0 }
    }

    fn open(&mut self, scenario: Scenario) {
        let session = self.app.session_mut();
        session.set_scenario(scenario);
        session.play_from_start();
    }

    fn frame(&mut self, size: Vec2, events: Vec<Event>) {
        let Self { app, ctx, frame, frames } = self;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, size)),
            time: Some(*frames as f64 / 60.0),
            events,
            ..RawInput::default()
        };
        *frames += 1;
        // A panic continues after the frame: textures that nobody takes would panic too.
        let mut drawn = Ok(());
        let mut output = ctx.run_ui(input, |root| {
            drawn = catch_unwind(AssertUnwindSafe(|| {
                app.logic(root.ctx(), frame);
                app.ui(root, frame);
            }));
        });
        output.textures_delta.clear();
        if let Err(panic) = drawn {
            resume_unwind(panic);
        }
        ctx.tessellate(output.shapes, output.pixels_per_point);
    }
}

/// Shows a scenario as one that a link brings, whole and live, and then a measured record.
pub(crate) fn show(scenario: &Scenario, measured: Option<Measured>, dice: &mut Dice) {
    let mut screen = stage("opening the explorer", Screen::new);
    let modes = if dice.one_in(2) { [Mode::Whole, Mode::Live] } else { [Mode::Live, Mode::Whole] };
    stage("opening a scenario", || screen.open(scenario.clone()));
    modes.into_iter().for_each(|mode| play(&mut screen, mode, dice));
    if let Some(Measured { bytes, read, scenario }) = measured {
        let file =
            RecordFile { name: "case.csv".to_owned(), hash: kalmanscope_core::import::hash(&bytes), table: read.table };
        screen.app.session_mut().keep_file(Arc::new(file));
        stage("opening a record", || screen.open(scenario));
        play(&mut screen, Mode::Whole, dice);
    }
    stage("closing the explorer", || drop(screen));
}

/// Plays frames until all is computed, with the pointer here and there.
fn play(screen: &mut Screen, mode: Mode, dice: &mut Dice) {
    stage("choosing the mode", || {
        let session = screen.app.session_mut();
        session.set_mode(mode);
        session.seek(dice.pick(&[0.0, 0.01, 1.0, 1e9]));
    });
    // The work between two drawn frames is that of frames, without the drawing.
    for _ in 0..FRAMES {
        stage("a slice", || screen.app.session_mut().advance(0.1));
        if !screen.app.session().behind() {
            break;
        }
    }
    let sizes = [SIZE, SIZE, if dice.one_in(4) { Vec2::new(390.0, 844.0) } else { SIZE }];
    for size in sizes {
        let events = events(size, dice);
        stage("a frame", || screen.frame(size, events));
    }
    stage("the screen in words", || drop(screen.app.screen_text()));
}

fn events(size: Vec2, dice: &mut Dice) -> Vec<Event> {
    let pos = Pos2::new(dice.below(size.x as usize) as f32, dice.below(size.y as usize) as f32);
    let mut events = vec![Event::PointerMoved(pos)];
    let modifiers = Modifiers::NONE;
    match dice.below(6) {
        0 => events.extend([true, false].map(|pressed| {
            let button = PointerButton::Primary;
            Event::PointerButton { pos, button, pressed, modifiers }
        })),
        1 => events.push(Event::MouseWheel {
            unit: MouseWheelUnit::Line,
            delta: Vec2::new(0.0, 3.0),
            phase: TouchPhase::Move,
            source: egui::MouseWheelSource::Unknown,
            modifiers: Modifiers::CTRL,
        }),
        2 => {
            let key = dice.pick(&[Key::Space, Key::ArrowRight, Key::ArrowLeft, Key::Home, Key::End, Key::A, Key::B]);
            events.push(Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers });
        }
        _ => {}
    }
    events
}
