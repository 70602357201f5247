//! The microphone: something that was struck rings.

use std::rc::Rc;

use egui::{Context, RichText, Ui, Vec2};
use kalmanscope_core::free_decay::Ring;
use kalmanscope_core::import::wav;

use super::{CURVE, Instrument, SensorWords, large_ui, waiting_ui};
use crate::request::RawFile;
use crate::sensor::{ReadingQueue, SensorDevice, SensorReading as _, Sound};
use crate::spark::Spark;
use crate::text::fixed;
use crate::theme::Palette;

/// The time between two searches for a ring, and the length of the searched sound \[s\].
const LOOK: f64 = 1.0;
const LOOKED_AT: f64 = 12.0;

/// The length of the drawn sound \[s\], and the number of its points.
const DRAWN: f64 = 8.0;
const POINTS: usize = 600;

const FILE: &str = "heard-here.wav";

pub(super) struct Listener {
    device: Rc<dyn SensorDevice<Sound>>,
    readings: ReadingQueue<Sound>,
    looked: usize,
    ring: Option<Ring>,
}

impl Listener {
    pub(super) fn new(device: Rc<dyn SensorDevice<Sound>>) -> Self {
        Self { device, readings: ReadingQueue::default(), looked: 0, ring: None }
    }

    fn sound(&self) -> Result<RawFile, String> {
        let told = self.readings.readings();
        let rate = told.rate.unwrap_or_default();
        let samples: Vec<f64> = told.readings.iter().map(|x| f64::from(*x)).collect();
        Ring::in_samples(rate, &samples)
            .ok_or("no ringing tone was found: it must be louder than the room, and fade".to_owned())?;
        let bytes = wav(rate as u32, &told.readings).map_err(|error| error.to_string())?;
        Ok(RawFile { name: FILE.to_owned(), bytes, is_measured: true })
    }
}

const WORDS: SensorWords = SensorWords {
    name: "It rings",
    beginning: "Start listening",
    ending: "Stop and identify",
    directions: &[
        "Take something that rings when it is struck: a glass, a tuning fork, a bell, a ruler on the edge of a table.",
        "Begin, be still for a second, strike it once beside the microphone, and wait until it is silent.",
    ],
};

impl Instrument for Listener {
    of_device!();

    fn begin(&mut self, ctx: &Context) {
        *self = Self::new(Rc::clone(&self.device));
        self.device.begin(ctx, &self.readings);
    }

    fn running_ui(&mut self, ui: &mut Ui, since: f64, palette: &Palette) {
        let told = self.readings.readings();
        let (Some(rate), false) = (told.rate, told.readings.is_empty()) else {
            waiting_ui(ui, since, "Waiting for the microphone …", &self.device.hint());
            return;
        };
        let count = told.readings.len();
        let latest = |seconds: f64| &told.readings[count.saturating_sub((seconds * rate) as usize)..];
        if (count - self.looked.min(count)) as f64 >= LOOK * rate {
            self.looked = count;
            let samples: Vec<f64> = latest(LOOKED_AT).iter().map(|x| f64::from(*x)).collect();
            // The last ring stays on screen when a look finds none.
            self.ring = Ring::in_samples(rate, &samples).or(self.ring);
        }
        let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), CURVE), egui::Sense::hover());
        Spark::new(&outline(latest(DRAWN))).paint(ui.painter(), rect, palette.text);
        match &self.ring {
            Some(ring) => {
                large_ui(ui, format!("{} Hz", fixed(ring.pitch, 1)), palette);
                ui.label(format!("It has rung for {} s.", fixed(ring.part[1] - ring.part[0], 2)));
            }
            None => _ = ui.label(RichText::new("Strike it once: its pitch comes while it rings.").color(palette.weak)),
        }
        let full = if count >= Sound::MOST { " It is full." } else { "" };
        ui.label(format!("{} s, {} samples a second.{full}", fixed(count as f64 / rate, 1), fixed(rate, 0)));
    }

    fn file(&self) -> Option<Result<RawFile, String>> {
        Some(self.sound())
    }
}

fn outline(samples: &[Sound]) -> Vec<f64> {
    let ends = |piece: &[Sound]| {
        let [low, high] =
            piece.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)]);
        [f64::from(low), f64::from(high)]
    };
    samples.chunks(samples.len().div_ceil(POINTS).max(1)).flat_map(ends).collect()
}
