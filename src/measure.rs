//! The window in which this device measures something that swings or rings.

macro_rules! of_device {
    () => {
        fn words(&self) -> &'static SensorWords {
            &WORDS
        }

        fn end(&self) {
            self.device.end();
        }

        fn refusal(&self) -> Option<String> {
            self.readings.refusal()
        }
    };
}

mod accelerometer;
mod health;
mod live;
mod sound;
mod stream;

use std::sync::Arc;
use std::time::Duration;

use egui::{Align2, Button, Context, Key, Label, RichText, Ui, Vec2, Window};
use kalmanscope_core::{Record, Scenario};

use accelerometer::Accelerometer;
use sound::Listener;
use stream::Stream;

use crate::probe::Remembered as _;
use crate::request::{RawFile, Request};
use crate::sensor::Sensors;
use crate::text::sentence;
use crate::theme::Palette;
use crate::widgets::primary;

const WIDTH: f32 = 460.0;

const CURVE: f32 = 120.0;

/// A sensor is still silent after this time \[s\].
const PATIENCE: f64 = 3.0;

const AT_LEAST: Duration = Duration::from_millis(100);

const LARGE: f32 = 26.0;

struct SensorWords {
    name: &'static str,
    beginning: &'static str,
    ending: &'static str,
    directions: &'static [&'static str],
}

trait Instrument {
    fn words(&self) -> &'static SensorWords;

    fn begin(&mut self, ctx: &Context);

    fn end(&self);

    fn refusal(&self) -> Option<String>;

    fn follow(&mut self) {}

    fn watched(&self) -> Option<(&Scenario, &Arc<Record>)> {
        None
    }

    fn few_ui(&mut self, _: &mut Ui, _: &Palette) {}

    fn running_ui(&mut self, ui: &mut Ui, since: f64, palette: &Palette);

    /// The file to be imported, or why nothing can be identified. `None` if the record that is watched is all there is.
    fn file(&self) -> Option<Result<RawFile, String>>;
}

pub(crate) struct Measure {
    instruments: Vec<Box<dyn Instrument>>,
    chosen: usize,
    stage: MeasureStage,
    is_watched: bool,
    shown: Option<Scenario>,
}

pub(crate) enum News {
    Another(Box<Scenario>, Arc<Record>),
    Longer(Arc<Record>),
}

enum MeasureStage {
    Ready,
    /// It measures since this time of the screen \[s\].
    Running(f64),
    Failed(String),
}

impl Measure {
    pub(crate) fn new(sensors: &Sensors) -> Option<Self> {
        let Sensors { accelerometer, microphone, stream } = sensors.clone();
        let swing = accelerometer.map(|device| Box::new(Accelerometer::new(device)) as Box<dyn Instrument>);
        let listener = microphone.map(|device| Box::new(Listener::new(device)) as Box<dyn Instrument>);
        let stream = stream.map(|(device, scenario)| Box::new(Stream::new(device, &scenario)) as Box<dyn Instrument>);
        let instruments: Vec<_> = stream.into_iter().chain(swing).chain(listener).collect();
        (!instruments.is_empty()).then_some(Self {
            instruments,
            chosen: 0,
            stage: MeasureStage::Ready,
            is_watched: false,
            shown: None,
        })
    }

    pub(crate) fn begin_watched(&mut self, ctx: &Context) {
        self.instruments[self.chosen].begin(ctx);
        self.stage = MeasureStage::Running(ctx.input(|input| input.time));
        self.is_watched = true;
    }

    pub(crate) fn follow(&mut self) -> Option<News> {
        let Self { instruments, chosen, stage, is_watched, shown } = self;
        if !matches!(stage, MeasureStage::Running(_)) {
            return None;
        }
        let instrument = &mut instruments[*chosen];
        instrument.follow();
        let (scenario, record) = instrument.watched().filter(|_| *is_watched)?;
        if shown.as_ref() == Some(scenario) {
            return Some(News::Longer(Arc::clone(record)));
        }
        *shown = Some(scenario.clone());
        Some(News::Another(Box::new(scenario.clone()), Arc::clone(record)))
    }

    pub(crate) fn is_watched(&self) -> bool {
        self.is_watched && matches!(self.stage, MeasureStage::Running(_))
    }

    pub(crate) fn strip_ui(&mut self, ui: &mut Ui, palette: &Palette, requests: &mut Vec<Request>) -> bool {
        let instrument = &mut self.instruments[self.chosen];
        if let Some(refusal) = instrument.refusal() {
            self.fail(refusal);
            return true;
        }
        let buttons = ui.horizontal_wrapped(|ui| {
            instrument.few_ui(ui, palette);
            two_buttons_ui(ui, [instrument.words().ending, "Larger"], palette)
        });
        ui.ctx().request_repaint_after(AT_LEAST);
        let [stop, larger] = buttons.inner;
        self.is_watched = !larger;
        !stop || self.stop(requests)
    }

    fn stop(&mut self, requests: &mut Vec<Request>) -> bool {
        match self.instruments[self.chosen].file() {
            Some(Err(reason)) => {
                self.fail(sentence(&reason));
                return true;
            }
            Some(Ok(file)) => requests.push(Request::ImportFile(Box::new(file))),
            None => {}
        }
        self.instruments[self.chosen].end();
        false
    }

    fn fail(&mut self, reason: String) {
        self.instruments[self.chosen].end();
        self.stage = MeasureStage::Failed(reason);
        self.is_watched = false;
    }

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
            MeasureStage::Ready => {
                self.choice_ui(ui);
                let instrument = &mut self.instruments[self.chosen];
                instrument.words().directions.iter().for_each(|text| _ = ui.label(*text));
                ui.label(RichText::new("Nothing leaves this device.").small().color(palette.weak));
                let [begin, close] = buttons_ui(ui, [instrument.words().beginning, "Close"], palette);
                if begin {
                    instrument.begin(ui.ctx());
                    self.is_watched = false;
                    self.shown = None;
                    self.stage = MeasureStage::Running(ui.input(|input| input.time));
                }
                !close
            }
            MeasureStage::Running(since) => {
                let instrument = &mut self.instruments[self.chosen];
                if let Some(refusal) = instrument.refusal() {
                    self.fail(refusal);
                    return true;
                }
                // A silent sensor asks for no frames, but its silence must be said.
                ui.ctx().request_repaint_after(AT_LEAST);
                // Above the numbers, so that it stays where it is while sentences come and go.
                let [stop, close] = buttons_ui(ui, [instrument.words().ending, "Cancel"], palette);
                instrument.running_ui(ui, ui.input(|input| input.time) - since, palette);
                if instrument.watched().is_some() {
                    let watch = ui.button("Watch the filters").remembered("Watch the filters");
                    self.is_watched |= watch.clicked();
                }
                if stop { self.stop(requests) } else { !close }
            }
            MeasureStage::Failed(reason) => {
                ui.colored_label(palette.warning, format!("{reason}."));
                let [again, close] = buttons_ui(ui, ["Again", "Close"], palette);
                if again {
                    self.stage = MeasureStage::Ready;
                }
                !close
            }
        }
    }

    fn choice_ui(&mut self, ui: &mut Ui) {
        if self.instruments.len() < 2 {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            for (place, instrument) in self.instruments.iter().enumerate() {
                let name = instrument.words().name;
                ui.selectable_value(&mut self.chosen, place, name).remembered(name);
            }
        });
        ui.add_space(4.0);
    }
}

fn waiting_ui(ui: &mut Ui, since: f64, text: &str, hint: &str) {
    if since < PATIENCE {
        ui.label(text);
    } else {
        ui.label(format!("No reading has come yet. {hint}"));
    }
}

fn large_ui(ui: &mut Ui, text: String, palette: &Palette) {
    ui.add(Label::new(RichText::new(text).size(LARGE).color(palette.text)).extend());
}

fn buttons_ui(ui: &mut Ui, texts: [&str; 2], palette: &Palette) -> [bool; 2] {
    ui.add_space(6.0);
    ui.horizontal(|ui| two_buttons_ui(ui, texts, palette)).inner
}

fn two_buttons_ui(ui: &mut Ui, [first, second]: [&str; 2], palette: &Palette) -> [bool; 2] {
    [(first, primary(first, palette)), (second, Button::new(second))].map(|(text, button)| {
        let button = ui.add(button).remembered(text);
        button.clicked()
    })
}
