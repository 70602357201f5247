//! The window in which this device measures something that swings or rings.

mod health;
mod live;
mod sound;
mod swing;

use egui::{Align2, Button, Context, Key, RichText, Ui, Vec2, Window};

use sound::Listener;
use swing::Swing;

use crate::probe;
use crate::request::{RawFile, Request};
use crate::sensor::Sensors;
use crate::text::sentence;
use crate::theme::Palette;

/// The width of the window, if there is room \[points\].
const WIDTH: f32 = 460.0;

/// The height of the curve that shows the readings \[points\].
const CURVE: f32 = 120.0;

/// A sensor is still silent after this time \[s\].
const PATIENCE: f64 = 3.0;

/// The size of the estimates \[points\].
const LARGE: f32 = 26.0;

/// A way to measure with one sensor of the device.
trait Instrument {
    /// Its name for the choice among several.
    fn name(&self) -> &'static str;

    /// The words of the button that begins.
    fn beginning(&self) -> &'static str;

    /// What to do, in sentences.
    fn directions(&self) -> &'static [&'static str];

    /// Forgets what was measured, and begins.
    fn begin(&mut self, ctx: &Context);

    fn end(&self);

    /// Why the sensor tells nothing.
    fn refusal(&self) -> Option<String>;

    /// Shows what has come in, `since` seconds after the beginning.
    fn running_ui(&mut self, ui: &mut Ui, since: f64, palette: &Palette);

    /// The file of what was measured, or the reason why nothing can be identified.
    fn file(&self) -> Result<RawFile, String>;
}

/// A measurement.
pub(crate) struct Measure {
    instruments: Vec<Box<dyn Instrument>>,
    /// The place of the instrument that the user has chosen.
    chosen: usize,
    stage: Stage,
}

enum Stage {
    /// It waits for the user.
    Ready,
    /// It measures since this time of the screen \[s\].
    Running(f64),
    /// It has ended with nothing to identify, for this reason.
    Failed(String),
}

impl Measure {
    /// A measurement with one of some sensors. `None` if there are none.
    pub(crate) fn new(sensors: &Sensors) -> Option<Self> {
        let Sensors { accelerometer, microphone } = sensors.clone();
        let swing = accelerometer.map(|device| Box::new(Swing::new(device)) as Box<dyn Instrument>);
        let listener = microphone.map(|device| Box::new(Listener::new(device)) as Box<dyn Instrument>);
        let instruments: Vec<_> = swing.into_iter().chain(listener).collect();
        (!instruments.is_empty()).then_some(Self { instruments, chosen: 0, stage: Stage::Ready })
    }

    /// Shows the window. Returns whether it stays open.
    pub(crate) fn ui(&mut self, ctx: &Context, palette: &Palette, requests: &mut Vec<Request>) -> bool {
        let width = (ctx.content_rect().width() - 48.0).clamp(1.0, WIDTH);
        let window = Window::new("Measure with this device").collapsible(false).resizable(false);
        let shown = window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).show(ctx, |ui| {
            ui.set_width(width);
            self.contents_ui(ui, palette, requests)
        });
        let stays = shown.and_then(|shown| shown.inner).unwrap_or(true);
        let stays = stays && !ctx.input(|input| input.key_pressed(Key::Escape));
        if !stays {
            self.instruments[self.chosen].end();
        }
        stays
    }

    fn contents_ui(&mut self, ui: &mut Ui, palette: &Palette, requests: &mut Vec<Request>) -> bool {
        match &self.stage {
            Stage::Ready => {
                self.choice_ui(ui);
                let instrument = &mut self.instruments[self.chosen];
                instrument.directions().iter().for_each(|text| _ = ui.label(*text));
                ui.label(RichText::new("Nothing leaves this device.").small().color(palette.weak));
                let [begin, close] = buttons_ui(ui, instrument.beginning(), "Close");
                if begin {
                    instrument.begin(ui.ctx());
                    self.stage = Stage::Running(ui.input(|input| input.time));
                }
                !close
            }
            Stage::Running(since) => {
                let instrument = &mut self.instruments[self.chosen];
                if let Some(refusal) = instrument.refusal() {
                    instrument.end();
                    self.stage = Stage::Failed(refusal);
                    return true;
                }
                instrument.running_ui(ui, ui.input(|input| input.time) - since, palette);
                ui.ctx().request_repaint_after(std::time::Duration::from_millis(100));
                let [stop, close] = buttons_ui(ui, "Stop and identify", "Cancel");
                if !stop {
                    return !close;
                }
                instrument.end();
                match instrument.file() {
                    Ok(file) => requests.push(Request::ImportFile(Box::new(file))),
                    Err(reason) => self.stage = Stage::Failed(sentence(&reason)),
                }
                matches!(self.stage, Stage::Failed(_))
            }
            Stage::Failed(reason) => {
                ui.colored_label(palette.warning, format!("{reason}."));
                let [again, close] = buttons_ui(ui, "Again", "Close");
                if again {
                    self.stage = Stage::Ready;
                }
                !close
            }
        }
    }

    /// The choice among several instruments.
    fn choice_ui(&mut self, ui: &mut Ui) {
        if self.instruments.len() < 2 {
            return;
        }
        ui.horizontal(|ui| {
            for (place, instrument) in self.instruments.iter().enumerate() {
                let choice = ui.selectable_value(&mut self.chosen, place, instrument.name());
                probe::remember(ui.ctx(), instrument.name(), choice.rect);
            }
        });
        ui.add_space(4.0);
    }
}

/// Says that no reading has come yet, and after a while what may be the reason.
fn waiting_ui(ui: &mut Ui, since: f64, text: &str, hint: &str) {
    if since < PATIENCE {
        ui.label(text);
    } else {
        ui.label(format!("No reading has come yet. {hint}"));
    }
}

/// An estimate, large enough for a hall.
fn large_ui(ui: &mut Ui, text: String, palette: &Palette) {
    ui.label(RichText::new(text).size(LARGE).color(palette.text));
}

/// Two buttons; says which is clicked.
fn buttons_ui(ui: &mut Ui, first: &str, second: &str) -> [bool; 2] {
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        [first, second].map(|text| {
            let button = ui.add(Button::new(text));
            probe::remember(ui.ctx(), text, button.rect);
            button.clicked()
        })
    })
    .inner
}
