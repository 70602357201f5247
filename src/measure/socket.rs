//! The sensors of the scenario on screen, whose readings come from a socket of this device.

use std::sync::Arc;

use egui::{Context, DragValue, Ui};
use kalmanscope_core::{Record, Scenario};

use super::Instrument;
use super::stream::Stream;
use crate::probe;
use crate::request::RawFile;
use crate::sensor::Connect;
use crate::theme::Palette;

/// The port that is offered first.
const PORT: u16 = 8765;

pub(super) struct Socket {
    connect: Connect,
    scenario: Scenario,
    port: u16,
    /// The readings that come, once it has begun.
    stream: Option<Stream>,
}

impl Socket {
    pub(super) fn new(connect: Connect, scenario: &Scenario) -> Self {
        Self { connect, scenario: scenario.clone(), port: PORT, stream: None }
    }
}

impl Instrument for Socket {
    fn name(&self) -> &'static str {
        "A socket"
    }

    fn beginning(&self) -> &'static str {
        "Connect"
    }

    fn ending(&self) -> &'static str {
        "Stop"
    }

    fn directions(&self) -> &'static [&'static str] {
        &[
            "A program on this device serves readings as a WebSocket: lines of CSV under a header, or JSON objects. The scenario's \
           filters follow them.",
        ]
    }

    fn settings_ui(&mut self, ui: &mut Ui) {
        let columns = Stream::columns(&self.scenario).join(", ");
        ui.label(format!("Known columns: {columns}. A sample every {} s (dt).", self.scenario.dt));
        ui.horizontal(|ui| {
            let label = ui.label("ws://localhost:");
            ui.spacing_mut().item_spacing.x = 0.0;
            let port = ui.add(DragValue::new(&mut self.port).range(1..=u16::MAX).speed(1.0)).labelled_by(label.id);
            probe::remember(ui.ctx(), "Port", port.rect);
        });
    }

    fn begins_watched(&self) -> bool {
        true
    }

    fn begin(&mut self, ctx: &Context) {
        let mut stream = Stream::new((self.connect)(&self.scenario, self.port), &self.scenario);
        stream.begin(ctx);
        self.stream = Some(stream);
    }

    fn end(&self) {
        self.stream.iter().for_each(Instrument::end);
    }

    fn refusal(&self) -> Option<String> {
        self.stream.as_ref().and_then(Instrument::refusal)
    }

    fn follow(&mut self) {
        self.stream.iter_mut().for_each(Instrument::follow);
    }

    fn watched(&self) -> Option<(&Scenario, &Arc<Record>)> {
        self.stream.as_ref().and_then(Instrument::watched)
    }

    fn few_ui(&mut self, ui: &mut Ui, palette: &Palette) {
        self.stream.iter_mut().for_each(|stream| stream.few_ui(ui, palette));
    }

    fn running_ui(&mut self, ui: &mut Ui, since: f64, palette: &Palette) {
        self.stream.iter_mut().for_each(|stream| stream.running_ui(ui, since, palette));
    }

    fn file(&self) -> Option<Result<RawFile, String>> {
        None
    }
}
