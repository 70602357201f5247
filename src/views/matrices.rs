//! Predict and update of one sample, in numbers.

use egui::{Align, Grid, Layout, RichText, ScrollArea, Ui};
use kalmanscope_core::{Estimates, Record};

use crate::request::Request;
use crate::text::significant;
use crate::theme;
use crate::view::{View, ViewContext};

/// Width of a column, fixed so that the table does not move while its numbers change \[points\].
const COLUMN: f32 = 66.0;

pub(super) static VIEW: View = View {
    name: "Predict and update",
    help: [
        "One sample in numbers: the belief before, the prediction, the measurements, the belief after the update.",
        "Predicting carries mean and covariance over a step and widens σ; updating moves the mean by K e and narrows σ.",
        "Step with the button (→) and follow how each number leads to the next.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, axis, .. } = *context;
    let k = axis.readout(session);
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        for (_, estimates) in context.filters().filter(|(_, estimates)| k < estimates.len()) {
            let record = session.run().record();
            let number = record.forgotten() + k;
            let title = format!("{}, sample {number}, t = {:.3} s", estimates.name(), record.time(k));
            ui.label(RichText::new(title).family(theme::strong()).color(context.color(estimates)));
            if number == 0 {
                ui.weak("The initial belief: nothing has been predicted or measured yet.");
            } else if k == 0 {
                ui.weak("The sample before is no longer kept.");
            }
            channels_ui(ui, estimates, k, context);
            sensors_ui(ui, estimates, record, k, context);
            ui.add_space(8.0);
        }
    });
    None
}

fn header_ui(ui: &mut Ui, names: &[&str]) {
    for name in names {
        right_aligned_ui(ui, RichText::new(*name).small().weak());
    }
    ui.end_row();
}

fn channels_ui(ui: &mut Ui, estimates: &Estimates, k: usize, context: &ViewContext<'_>) {
    let (n, m) = (estimates.channels().len(), estimates.sensors().len());
    let (gain, e, s) = (estimates.gain(k), estimates.innovation(k), estimates.innovation_cov(k));
    // K e and K S Kᵀ of the sensors with a measurement.
    let delivered = |sensor: &usize| !e[*sensor].is_nan();
    let shift = |i: usize| (0..m).filter(delivered).map(|a| gain[a * n + i] * e[a]).sum::<f64>();
    let known = |i: usize| {
        let term = |a: usize, b: usize| gain[a * n + i] * s[a * m + b] * gain[b * n + i];
        (0..m).filter(delivered).flat_map(|a| (0..m).filter(delivered).map(move |b| term(a, b))).sum::<f64>()
    };
    Grid::new(("predict and update", estimates.id())).striped(true).min_col_width(COLUMN).spacing([10.0, 3.0]).show(
        ui,
        |ui| {
            let gains: Vec<String> = estimates.sensors().iter().map(|q| format!("K for e({})", q.symbol())).collect();
            let mut names = vec!["", "y before", "± σ", "y⁻ predicted", "± σ⁻", "+ K e", "y after", "± σ"];
            names.extend(gains.iter().map(String::as_str));
            header_ui(ui, &names);
            for (i, channel) in estimates.channels().iter().enumerate() {
                let (mean, std) = (estimates.mean(k)[i], estimates.std(k, i));
                let predicted_std = (std * std + known(i)).sqrt();
                name_ui(ui, channel.symbol(), context.unit(channel.unit()), channel.name());
                let before = k.checked_sub(1);
                number_ui(ui, before.map(|k| estimates.mean(k)[i]));
                number_ui(ui, before.map(|k| estimates.std(k, i)));
                number_ui(ui, before.map(|_| mean - shift(i)));
                number_ui(ui, before.map(|_| predicted_std));
                number_ui(ui, before.map(|_| shift(i)));
                number_ui(ui, Some(mean));
                number_ui(ui, Some(std));
                for sensor in 0..m {
                    number_ui(ui, before.map(|_| gain[sensor * n + i]));
                }
                ui.end_row();
            }
        },
    );
}

fn sensors_ui(ui: &mut Ui, estimates: &Estimates, record: &Record, k: usize, context: &ViewContext<'_>) {
    let m = estimates.sensors().len();
    if record.forgotten() + k == 0 || m == 0 {
        return;
    }
    Grid::new(("sensors", estimates.id())).striped(true).min_col_width(COLUMN).spacing([10.0, 3.0]).show(ui, |ui| {
        header_ui(ui, &["", "z measured", "h(y⁻) expected", "e = z − h(y⁻)", "√S", "e / √S"]);
        for (sensor, quantity) in estimates.sensors().iter().enumerate() {
            let z = record.measured_quantity(*quantity).map(|z| z[k]);
            let e = estimates.innovation(k)[sensor];
            let std = estimates.innovation_cov(k)[sensor * (m + 1)].sqrt();
            name_ui(ui, quantity.symbol(), context.unit(quantity.unit()), quantity.key());
            for value in [z, z.map(|z| z - e), Some(e), Some(std), Some(e / std)] {
                number_ui(ui, value);
            }
            ui.end_row();
        }
    });
    let (nis, log_likelihood) = (estimates.nis()[k], estimates.log_likelihood(k));
    ui.weak(format!("NIS {} · log likelihood {}", significant(nis, 4), significant(log_likelihood, 4)));
}

fn number_ui(ui: &mut Ui, value: Option<f64>) {
    let text = value.map_or(String::new(), |x| significant(x, 4));
    right_aligned_ui(ui, RichText::new(text).monospace().size(12.0));
}

fn right_aligned_ui(ui: &mut Ui, text: RichText) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(text));
}

fn name_ui(ui: &mut Ui, symbol: &str, unit: &str, name: &str) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(symbol).on_hover_text(name);
        if !unit.is_empty() {
            ui.label(RichText::new(format!("[{unit}]")).small().weak());
        }
    });
}
