//! Plots of one quantity over another: the frame that they share.

use egui::{Ui, Vec2};
use egui_plot::{AxisHints, Plot, PlotUi};

use super::ticks::{tick, ticks};
use crate::theme::Palette;

/// Draws a plot into all of `ui`. `range` is what it shows unless the user has zoomed, `[x, y]`, each low and high.
pub(super) fn plane_ui(
    ui: &mut Ui,
    key: &str,
    labels: [&str; 2],
    palette: &Palette,
    range: Option<[(f64, f64); 2]>,
    draw: impl FnOnce(&mut PlotUi<'_>),
) {
    let size = ui.available_size().max(Vec2::splat(1.0));
    let [x_label, y_label] = labels;
    let plot = Plot::new(key)
        .width(size.x)
        .height(size.y)
        .show_x(false)
        .show_y(false)
        .custom_x_axes(vec![AxisHints::new_x().label(x_label).formatter(|mark, _| tick(mark.value, mark.step_size))])
        .custom_y_axes(vec![
            AxisHints::new_y().label(y_label).formatter(|mark, _| tick(mark.value, mark.step_size)).min_thickness(44.0),
        ])
        .x_grid_spacer(move |input| ticks(input.bounds, size.x / 75.0))
        .y_grid_spacer(move |input| ticks(input.bounds, size.y / 34.0))
        .grid_color(palette.grid)
        .allow_scroll(false)
        .label_formatter(|_| None);
    let response = plot.show(ui, |plot| {
        if plot.auto_bounds().any()
            && let Some([x, y]) = range
        {
            plot.set_plot_bounds_x(x.0..=x.1);
            plot.set_plot_bounds_y(y.0..=y.1);
            plot.set_auto_bounds(true);
        }
        draw(plot);
    });
    let response = response.response;
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(format!("Plot of the {key}")));
}

/// A range around some values, with a margin; none without values.
pub(super) fn around(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values.filter(|x| x.is_finite()).map(|x| (x, x)).reduce(|(l, h), (x, _)| (l.min(x), h.max(x)))?;
    let margin = 0.08 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}
