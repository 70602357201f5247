//! Time, part, band, and the distance of the samples.

use egui::Ui;
use kalmanscope_core::import::Time;
use kalmanscope_core::{Hold, InputKind, PlantKind};

use super::choices::{choice_ui, number_ui, optional_ui, whole_ui};
use super::draft::Draft;
use crate::equation;
use crate::theme::Palette;

pub(super) fn meaning_ui(ui: &mut Ui, draft: &mut Draft) {
    ui.horizontal_wrapped(|ui| {
        if draft.mapping.time.column.is_none() {
            let mut rate = draft.mapping.time.rate.unwrap_or(0.0);
            ui.label("samples in a second");
            number_ui(ui, "Sample rate", &mut rate, 0.5);
            ui.label("Hz");
            draft.mapping.time = Time { rate: (rate > 0.0).then_some(rate), ..Time::default() };
            ui.separator();
        }
        ui.label("the input is");
        let kinds = [
            (Some(InputKind::Force), "a force over mass".to_owned()),
            (Some(InputKind::GroundAcceleration), "the ground's acceleration".to_owned()),
            (None, "nothing: it was not recorded".to_owned()),
        ];
        let mut kind = Some(draft.input).filter(|_| !draft.mapping.no_input);
        if choice_ui(ui, "Kind of input", &mut kind, &kinds) {
            draft.set_input(kind);
        }
        let holds =
            [(Hold::First, "linear between samples".to_owned()), (Hold::Zero, "held between samples".to_owned())];
        choice_ui(ui, "Hold of the input", &mut draft.hold, &holds);
        ui.separator();
        ui.label("the filters assume");
        let own = if draft.plant.own_equation().is_some() { Some(draft.plant) } else { equation::first() };
        let plants = PlantKind::ALL.into_iter().chain(own).map(|kind| (kind, kind.name().to_owned()));
        let plants: Vec<_> = plants.collect();
        choice_ui(ui, "Plant of the record", &mut draft.plant, &plants);
    });
}

/// The shortest step that can be asked for \[s\].
const SHORTEST: f64 = 1e-6;

pub(super) fn conditioning_ui(ui: &mut Ui, draft: &mut Draft, palette: &Palette) {
    let made = draft.outcome().and_then(Result::ok);
    let end = made.map_or(10.0, |imported| imported.record.time(imported.record.len().saturating_sub(1)));
    let dt = made.map_or(0.01, |imported| imported.record.dt());
    let nyquist = 0.5 / dt;
    let has_clocks = made.is_some_and(|imported| imported.record.clocks().is_some());
    egui::CollapsingHeader::new("Part, band and rate").id_salt("conditioning").show(ui, |ui| {
        let mapping = &mut draft.mapping;
        if has_clocks || mapping.time.even {
            let hint = "The samples are equally spaced, and only their times are not";
            ui.checkbox(&mut mapping.time.even, "at even steps").on_hover_text(hint);
        }
        // It stays while the steps are too short for a record.
        if has_clocks || mapping.time.dt.is_some() {
            ui.horizontal_wrapped(|ui| optional_ui(ui, "steps of", &mut mapping.time.dt, (dt, 0.01 * dt), "s"));
            mapping.time.dt.iter_mut().for_each(|dt| *dt = dt.max(SHORTEST));
        }
        ui.horizontal_wrapped(|ui| {
            optional_ui(ui, "from", &mut mapping.from, (0.0, 0.1), "s");
            optional_ui(ui, "to", &mut mapping.to, (end, 0.1), "s");
        });
        ui.horizontal_wrapped(|ui| {
            let mut on = mapping.band.is_some();
            let hint = "Butterworth filters of the fourth order, run forward and backward over input and sensors: nothing is shifted";
            if ui.checkbox(&mut on, "band-pass").on_hover_text(hint).changed() {
                mapping.band = on.then_some([0.0, 0.5 * nyquist]);
            }
            if let Some([low, high]) = &mut mapping.band {
                number_ui(ui, "Band from [Hz]", low, 0.1);
                ui.label("to");
                number_ui(ui, "Band to [Hz]", high, 0.1);
                ui.label("Hz");
            }
        });
        ui.horizontal_wrapped(|ui| {
            ui.label("keep one of every").on_hover_text("After a low-pass below the new Nyquist frequency");
            whole_ui(ui, "Keep one of every", &mut mapping.every, 1..=1000);
            ui.label("samples;  steps in place of one").on_hover_text(
                "The input is interpolated as a band-limited signal, measurements are missing in between: for few samples in a period",
            );
            whole_ui(ui, "Steps in place of one", &mut mapping.interpolate, 1..=8);
        });
        if let Some(spectra) = draft.spectra() {
            spectra.ui(ui, palette);
        }
    });
}
