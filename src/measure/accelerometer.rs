//! The accelerometer: something that the device is fixed to swings.

use std::f64::consts::TAU;
use std::rc::Rc;
use std::sync::Arc;

use egui::{Context, RichText, Ui, Vec2};
use kalmanscope_core::free_decay::Decay;
use kalmanscope_core::{Record, Scenario};
use kalmanscope_diagnosis::with_band;

use super::health::Health;
use super::live::{Band, LiveFilter};
use super::{CURVE, Instrument, SensorWords, large_ui, waiting_ui};
use crate::request::RawFile;
use crate::sensor::{Acceleration, ReadingQueue, SensorDevice, SensorReading as _};
use crate::spark::Spark;
use crate::text::fixed;
use crate::theme::Palette;

const DRAWN: usize = 1200;

const APART: f32 = 18.0;

const FILE: &str = "measured-here.csv";

pub(super) struct Accelerometer {
    device: Rc<dyn SensorDevice<Acceleration>>,
    readings: ReadingQueue<Acceleration>,
    live: LiveFilter,
    health: Health,
}

impl Accelerometer {
    pub(super) fn new(device: Rc<dyn SensorDevice<Acceleration>>) -> Self {
        let (readings, live, health) = (ReadingQueue::default(), LiveFilter::default(), Health::default());
        Self { device, readings, live, health }
    }

    fn remarks_ui(&self, ui: &mut Ui, palette: &Palette) {
        if self.live.rests {
            ui.label("It is at rest: you can stop.");
        }
        if let Some(sentence) = self.health.sentence() {
            ui.colored_label(palette.warning, sentence);
        }
    }
}

const WORDS: SensorWords = SensorWords {
    name: "It swings",
    // iOS asks for permission at the click on this button.
    beginning: "Start measuring",
    ending: "Stop and identify",
    directions: &[
        "Fix the phone, or the sensor, to what swings: hang it on a spring or a rubber band, clamp it to the end of a ruler, lay it on a plank \
             between two chairs.",
        "Begin, wait for two seconds, pull it aside, let go, and wait until it rests.",
    ],
};

impl Instrument for Accelerometer {
    of_device!();

    fn begin(&mut self, ctx: &Context) {
        *self = Self::new(Rc::clone(&self.device));
        self.device.begin(ctx, &self.readings);
    }

    fn follow(&mut self) {
        let told = self.readings.readings();
        self.live.follow(&told.readings);
        self.health.follow(&told.readings);
    }

    fn watched(&self) -> Option<(&Scenario, &Arc<Record>)> {
        self.live.watched()
    }

    fn few_ui(&mut self, ui: &mut Ui, palette: &Palette) {
        ui.spacing_mut().item_spacing.x = APART;
        estimates_ui(ui, self.live.estimates(), palette);
        self.remarks_ui(ui, palette);
    }

    fn running_ui(&mut self, ui: &mut Ui, since: f64, palette: &Palette) {
        let told = self.readings.readings();
        let (Some(first), Some(last)) = (told.readings.first(), told.readings.last()) else {
            waiting_ui(ui, since, "Waiting for the accelerometer …", &self.device.hint());
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
        let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), CURVE), egui::Sense::hover());
        Spark::new(&values).paint(ui.painter(), rect, palette.text);
        let rate = if seconds > 0.0 { (count - 1) as f64 / seconds } else { 0.0 };
        let full = if count >= Acceleration::MOST { " It is full." } else { "" };
        estimates_ui(ui, self.live.estimates(), palette);
        self.remarks_ui(ui, palette);
        ui.label(format!("{} s, {} readings a second.{full}", fixed(seconds, 1), fixed(rate, 1)));
    }

    fn file(&self) -> Option<Result<RawFile, String>> {
        let decays = Decay::alike(&self.readings.readings().readings).map_err(|reason| reason.to_string());
        let file = |bytes| RawFile { name: FILE.to_owned(), bytes, is_measured: true };
        Some(decays.map(|decays| file(Decay::file(&decays).into_bytes())))
    }
}

fn estimates_ui(ui: &mut Ui, estimates: Option<[Band; 2]>, palette: &Palette) {
    let Some([frequency, damping]) = estimates else {
        ui.label(
            RichText::new("Pull it aside and let go: frequency and damping come while it swings.").color(palette.weak),
        );
        return;
    };
    let hertz = Band { mean: frequency.mean / TAU, band: frequency.band / TAU };
    let percent = Band { mean: 100.0 * damping.mean, band: 100.0 * damping.band };
    for (Band { mean, band }, unit) in [(hertz, "Hz"), (percent, "% damping")] {
        large_ui(ui, with_band(mean, band, unit), palette);
    }
}
