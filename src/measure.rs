//! The window in which this device measures a free decay.

mod live;

use std::f64::consts::TAU;

use egui::{Align2, Button, Context, Key, RichText, Ui, Vec2, Window};
use kalmanscope_core::import::Decay;

use live::{Band, Live};

use crate::motion::{Accelerometer, MOST, Readings};
use crate::probe;
use crate::request::{RawFile, Request};
use crate::spark::Spark;
use crate::text::{fixed, significant};
use crate::theme::Palette;

/// The width of the window, if there is room \[points\].
const WIDTH: f32 = 460.0;

/// The device is still silent after this time \[s\].
const PATIENCE: f64 = 3.0;

/// The readings that are drawn.
const DRAWN: usize = 1200;

/// The size of the estimates \[points\].
const LARGE: f32 = 26.0;

/// The file of a measurement.
const FILE: &str = "measured-here.csv";

/// A measurement.
pub(crate) struct Measure {
    readings: Readings,
    live: Live,
    stage: Stage,
}

enum Stage {
    /// It waits for the user.
    Ready,
    /// It measures since this time of the screen \[s\].
    Running(f64),
    /// It has ended without a decay, for this reason.
    Failed(String),
}

impl Measure {
    pub(crate) fn new() -> Self {
        Self { readings: Readings::default(), live: Live::default(), stage: Stage::Ready }
    }

    /// Shows the window. Returns whether it stays open.
    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        device: &dyn Accelerometer,
        palette: &Palette,
        requests: &mut Vec<Request>,
    ) -> bool {
        let width = (ctx.content_rect().width() - 48.0).clamp(1.0, WIDTH);
        let window = Window::new("Measure with this device").collapsible(false).resizable(false);
        let shown = window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).show(ctx, |ui| {
            ui.set_width(width);
            self.contents_ui(ui, device, palette, requests)
        });
        let stays = shown.and_then(|shown| shown.inner).unwrap_or(true);
        let stays = stays && !ctx.input(|input| input.key_pressed(Key::Escape));
        if !stays {
            device.end();
        }
        stays
    }

    fn contents_ui(
        &mut self,
        ui: &mut Ui,
        device: &dyn Accelerometer,
        palette: &Palette,
        requests: &mut Vec<Request>,
    ) -> bool {
        match &self.stage {
            Stage::Ready => {
                ui.label(
                    "Fix the device to what swings: hang it on a spring or a rubber band, clamp it to the end of a ruler, lay it on a \
                     plank between two chairs.",
                );
                ui.label("Begin, wait for two seconds, pull it aside, let go, and wait until it rests.");
                ui.label(RichText::new("Nothing leaves this device.").small().color(palette.weak));
                let [begin, close] = buttons_ui(ui, "Begin to measure", "Close");
                if begin {
                    (self.readings, self.live) = (Readings::default(), Live::default());
                    device.begin(ui.ctx(), &self.readings);
                    self.stage = Stage::Running(ui.input(|input| input.time));
                }
                !close
            }
            Stage::Running(since) => {
                let since = ui.input(|input| input.time) - since;
                let refusal = self.readings.told().refusal.clone();
                if let Some(refusal) = refusal {
                    device.end();
                    self.stage = Stage::Failed(refusal);
                    return true;
                }
                self.running_ui(ui, since, palette);
                ui.ctx().request_repaint_after(std::time::Duration::from_millis(100));
                let [stop, close] = buttons_ui(ui, "Stop and identify", "Cancel");
                if stop {
                    device.end();
                    return self.identify(requests);
                }
                !close
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

    /// What has come so far.
    fn running_ui(&mut self, ui: &mut Ui, since: f64, palette: &Palette) {
        let told = self.readings.told();
        self.live.follow(&told.readings);
        let (Some(first), Some(last)) = (told.readings.first(), told.readings.last()) else {
            let text = if since < PATIENCE {
                "Waiting for the accelerometer …"
            } else {
                "No reading has come yet. Computers have no accelerometer; a phone has one, and the browser may ask for permission."
            };
            ui.label(text);
            return;
        };
        let (count, seconds) = (told.readings.len(), last[0] - first[0]);
        let drawn = &told.readings[count.saturating_sub(DRAWN)..];
        // The axis that moves most; gravity is the same everywhere.
        let spread = |axis: usize| {
            let ends = drawn.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], reading| {
                [low.min(reading[axis]), high.max(reading[axis])]
            });
            ends[1] - ends[0]
        };
        let axis = (1..4).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).unwrap_or(1);
        let values: Vec<f64> = drawn.iter().map(|reading| reading[axis]).collect();
        let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), 120.0), egui::Sense::hover());
        Spark::new(&values).paint(ui.painter(), rect, palette.text);
        let rate = if seconds > 0.0 { (count - 1) as f64 / seconds } else { 0.0 };
        let full = if count >= MOST { " It is full." } else { "" };
        estimates_ui(ui, self.live.estimates(), palette);
        if self.live.rests() {
            ui.label("It is at rest: there is nothing more to learn.");
        }
        ui.label(format!("{} s, {} readings a second.{full}", fixed(seconds, 1), fixed(rate, 1)));
    }

    /// Hands the decay over to the import. Returns whether the window stays open.
    fn identify(&mut self, requests: &mut Vec<Request>) -> bool {
        let decay = Decay::of(&self.readings.told().readings);
        match decay {
            Ok(decay) => {
                let file = RawFile { name: FILE.to_owned(), bytes: decay.csv().into_bytes() };
                requests.push(Request::ImportFile(Box::new(file)));
                false
            }
            Err(reason) => {
                self.stage = Stage::Failed(crate::text::sentence(&reason.to_string()));
                true
            }
        }
    }
}

/// What is known while it swings, large enough for a hall.
fn estimates_ui(ui: &mut Ui, estimates: Option<[Band; 2]>, palette: &Palette) {
    let Some([frequency, damping]) = estimates else {
        ui.label(
            RichText::new("Pull it aside and let go: frequency and damping come while it swings.").color(palette.weak),
        );
        return;
    };
    let hertz = Band { mean: frequency.mean / TAU, band: frequency.band / TAU };
    let percent = Band { mean: 100.0 * damping.mean, band: 100.0 * damping.band };
    for (band, unit) in [(hertz, "Hz"), (percent, "% damping")] {
        let text = format!("{} ± {} {unit}", significant(band.mean, 4), significant(band.band, 1));
        ui.label(RichText::new(text).size(LARGE).color(palette.text));
    }
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
