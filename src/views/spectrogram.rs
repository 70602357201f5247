//! Power over time and frequency, with the frequencies that filters estimate.

use egui::{Color32, ColorImage, Id, TextureHandle, TextureOptions, Ui, Vec2b};
use egui_plot::{Line, PlotImage, PlotPoint, PlotPoints};
use kalmanscope_core::{Channel, Spectrogram};

use crate::plot::cache::cached;
use crate::plot::plane::Plane;
use crate::request::Request;
use crate::theme::sequential;
use crate::view::{View, ViewContext};

const RANGE: f32 = 60.0;
const POINTS: usize = 600;

pub(super) static VIEW: View = View {
    name: "Spectrogram",
    help: [
        "The power of the first sensor's measurements over time and frequency, light where there is much: 60 dB from dark to light.",
        "Lines are the natural frequencies that the filters estimate: they should lie on a light ridge.",
        "A ridge without a line is a mode that the model lacks; a line without a ridge is wrong.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, _requests: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, axis, .. } = *context;
    let run = session.run();
    let record = run.record();
    let Some(quantity) = record.sensors().first() else {
        ui.weak("Nothing is measured.");
        return None;
    };
    let Some((of, spectrogram)) = session.spectrogram() else {
        let is_behind = session.is_spectrogram_behind();
        ui.weak(if is_behind { "The spectrogram is being computed." } else { "There are too few samples yet." });
        return None;
    };
    let drawn =
        cached(ui.ctx(), Id::unique("spectrogram"), (of, quantity.key()), || Some(Some(picture(ui, spectrogram))));
    let (texture, [from, to, _, top]) = drawn.as_ref().as_ref()?;
    let (from, to, top) = (*from, *to, *top);
    let followed = axis.followed(session);
    let label = format!("{} [Hz]", quantity.symbol());
    let plot = Plane::linear("spectrogram", ["time [s]", &label])
        .plot(ui, context.palette)
        .link_axis(Id::unique("time"), Vec2b::new(true, false))
        .link_cursor(Id::unique("time"), Vec2b::new(true, false))
        .show_grid(false);
    let response = plot.show(ui, |plot| {
        if axis.follows {
            plot.set_plot_bounds_x(followed.0..=followed.1);
            plot.set_plot_bounds_y(0.0..=top);
        }
        let center = PlotPoint::new(0.5 * (from + to), 0.5 * top);
        let size = egui::vec2((to - from) as f32, top as f32);
        plot.image(PlotImage::new("power", texture.id(), center, size));
        for (_, estimates) in context.filters() {
            let Some(at) = estimates.place(Channel::NATURAL_FREQUENCY) else { continue };
            let step = (estimates.len() / POINTS).max(1);
            let point = |k: usize| [record.time(k), estimates.canonical_mean(k, at) / std::f64::consts::TAU];
            let points: PlotPoints<'_> = (0..estimates.len()).step_by(step).map(point).collect();
            let color = context.color(estimates);
            plot.line(
                Line::new("ground", points.points().iter().map(|p| [p.x, p.y]).collect::<Vec<_>>())
                    .color(Color32::WHITE)
                    .width(3.5),
            );
            plot.line(Line::new(estimates.name(), points).color(color).width(2.0));
        }
        plot.pointer_coordinate().filter(|_| plot.response().hovered()).map(|point| point.x)
    });
    response
        .response
        .ctx
        .accesskit_node_builder(response.response.id, |node| node.set_label("Plot of the spectrogram"));
    response.inner
}

fn picture(ui: &Ui, spectrogram: &Spectrogram) -> (TextureHandle, [f64; 4]) {
    let (columns, rows) = (spectrogram.decibels.len(), spectrogram.decibels[0].len());
    let pixel = |place: usize| {
        let (row, column) = (rows - 1 - place / columns, place % columns);
        sequential(1.0 + spectrogram.decibels[column][row] / RANGE)
    };
    let image = ColorImage::new([columns, rows], (0..columns * rows).map(pixel).collect());
    let texture = ui.ctx().load_texture("spectrogram", image, TextureOptions::LINEAR);
    let half = 0.5 * spectrogram.step;
    let end = spectrogram.start + (columns - 1) as f64 * spectrogram.step;
    let hertz = spectrogram.resolution / std::f64::consts::TAU;
    (texture, [spectrogram.start - half, end + half, 0.0, (rows as f64 - 0.5) * hertz])
}
