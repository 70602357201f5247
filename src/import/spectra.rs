//! The spectrum of the first sensor before and after the conditioning.

use egui::{Color32, Ui};
use egui_plot::{Legend, Line, Plot};
use kalmanscope_core::{Record, Spectrogram};

use crate::theme::Palette;

/// The mean power of a record's first sensor over frequency: Hz and dB.
pub(super) fn spectrum(record: &Record) -> Vec<[f64; 2]> {
    let Some(spectrogram) = Spectrogram::new(record, 0, record.len()) else { return Vec::new() };
    let count = spectrogram.decibels.len().max(1) as f64;
    let rows = spectrogram.decibels.first().map_or(0, Vec::len);
    let mean =
        |row: usize| spectrogram.decibels.iter().map(|column| 10_f64.powf(0.1 * f64::from(column[row]))).sum::<f64>();
    let hertz = spectrogram.resolution / std::f64::consts::TAU;
    (1..rows).map(|row| [row as f64 * hertz, 10.0 * (mean(row) / count).max(1e-12).log10()]).collect()
}

/// Both in one small plot.
pub(super) fn spectra_ui(ui: &mut Ui, before: &[[f64; 2]], after: &[[f64; 2]], palette: &Palette) {
    let line = |name: &str, points: &[[f64; 2]], color: Color32| {
        Line::new(name.to_owned(), points.to_vec()).color(color).width(1.5)
    };
    let plot = Plot::new("spectra of the import").height(110.0).legend(Legend::default()).show_grid(true);
    let plot = plot
        .x_axis_label("frequency [Hz]")
        .y_axis_label("power [dB]")
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false);
    let response = plot.show(ui, |plot| {
        plot.line(line("before", before, palette.weak));
        plot.line(line("after", after, palette.truth));
    });
    let response = response.response;
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label("Plot of the spectrum before and after"));
}
