//! The sensors of a scenario, with readings from another device.

use std::rc::Rc;
use std::sync::Arc;

use egui::{Context, Ui};
use kalmanscope_core::import::Mapping;
use kalmanscope_core::record::{LiveError, LiveRecord};
use kalmanscope_core::{Quantity, Record, Scenario};
use kalmanscope_sources::StreamRow;

use super::live::NAME;
use super::{Instrument, SensorWords, waiting_ui};
use crate::request::RawFile;
use crate::sensor::{ReadingQueue, SensorDevice};
use crate::text::fixed;
use crate::theme::Palette;

/// A sample waits this time for late readings where they come out of order, or one sensor has none \[s\].
const WAIT: f64 = 0.1;

pub(super) struct Stream {
    device: Rc<dyn SensorDevice<StreamRow>>,
    scenario: Scenario,
    readings: ReadingQueue<StreamRow>,
    live: LiveRecord,
    record: Arc<Record>,
    /// The readings that have come, those that were refused, and why the last one was.
    taken: usize,
    refused: usize,
    refusal: Option<LiveError>,
    /// The times of the first reading and of the last one \[s\].
    times: Option<[f64; 2]>,
    has_ended: bool,
}

impl Stream {
    pub(super) fn new(device: Rc<dyn SensorDevice<StreamRow>>, of: &Scenario) -> Self {
        let mut scenario = of.clone();
        scenario.record = Some(Mapping { file: NAME.to_owned(), ..Mapping::default() });
        let sensors: Vec<Quantity> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
        let live = LiveRecord::new(scenario.dt, scenario.input, scenario.hold, sensors).waiting(WAIT).prompt();
        let record = live.so_far();
        let (readings, taken, refused, refusal) = (ReadingQueue::default(), 0, 0, None);
        Self { device, scenario, readings, live, record, taken, refused, refusal, times: None, has_ended: false }
    }

    fn sentences(&self) -> Vec<String> {
        let mut said = Vec::new();
        if let Some(reason) = &self.refusal {
            said.push(format!("{} of {} readings are left out; of the last one {reason}.", self.refused, self.taken));
        }
        if self.has_ended {
            said.push("The source has ended.".to_owned());
        }
        let repeated = self.live.repeated();
        if repeated > 0 {
            said.push(format!("{repeated} readings are left out: another one of their sensor has their time."));
        }
        said
    }
}

const WORDS: SensorWords = SensorWords {
    name: "Sensors of a scenario",
    beginning: "Start measuring",
    ending: "Stop",
    directions: &["Readings come from the source that was named at the start, and the scenario's filters follow them."],
};

impl Instrument for Stream {
    of_device!();

    fn begin(&mut self, ctx: &Context) {
        *self = Self::new(Rc::clone(&self.device), &self.scenario);
        self.device.begin(ctx, &self.readings);
    }

    fn follow(&mut self) {
        let Self { readings, live, record, taken, refused, refusal, times, has_ended, .. } = self;
        // They are kept in the record.
        let told = {
            let mut all = readings.readings();
            *has_ended = all.has_ended;
            std::mem::take(&mut all.readings)
        };
        for StreamRow { time, input, readings } in &told {
            match live.take(*time, *input, readings) {
                Ok(()) => *times = Some(times.map_or([*time; 2], |[first, last]| [first, last.max(*time)])),
                Err(reason) => (*refused, *refusal) = (*refused + 1, Some(reason)),
            }
        }
        *taken += told.len();
        if *has_ended {
            live.finish();
        }
        live.update(record);
    }

    fn watched(&self) -> Option<(&Scenario, &Arc<Record>)> {
        (!self.record.is_empty()).then_some((&self.scenario, &self.record))
    }

    fn few_ui(&mut self, ui: &mut Ui, palette: &Palette) {
        let Some([first, last]) = self.times else {
            ui.label(format!("Waiting for readings … {}", self.device.hint()));
            return;
        };
        let rate = (self.taken - self.refused).saturating_sub(1) as f64 / (last - first).max(f64::MIN_POSITIVE);
        ui.label(format!("{} s, {} readings a second.", fixed(last - first, 1), fixed(rate, 1)));
        for sentence in self.sentences() {
            ui.colored_label(palette.warning, sentence);
        }
    }

    fn running_ui(&mut self, ui: &mut Ui, since: f64, palette: &Palette) {
        if self.times.is_none() {
            waiting_ui(ui, since, "Waiting for readings …", &self.device.hint());
            return;
        }
        self.few_ui(ui, palette);
    }

    fn file(&self) -> Option<Result<RawFile, String>> {
        None
    }
}
