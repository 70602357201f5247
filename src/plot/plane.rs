//! The frame of plots of one quantity over another.

use egui::{Color32, Id, Shape, Stroke, Ui, Vec2};
use egui_plot::{AxisHints, GridInput, Line, Plot, PlotUi};

use super::axes::{LOG_TICKS_FADE, Side, log_tick, log_ticks, tick_inside, ticks};
use super::medium::{Y_AXIS, sense};
use crate::theme::Palette;

#[derive(Clone, Copy, PartialEq, Eq)]
enum AxisScale {
    Linear,
    Logarithmic,
}

/// Draws a plot into all of `ui`. It shows `range`, `[x, y]`, each low and high, unless the user has zoomed; a double
/// click restores it.
pub(crate) fn plane_ui(
    ui: &mut Ui,
    key: &str,
    labels: [&str; 2],
    palette: &Palette,
    range: Option<[(f64, f64); 2]>,
    draw: impl FnOnce(&mut PlotUi<'_>),
) {
    scaled_plane_ui(ui, key, labels, (palette, AxisScale::Linear), range, draw);
}

/// [`plane_ui`] of logarithms to the base of ten, also in `range`; the axes are labelled with the numbers themselves.
/// Returns the result of `draw`.
pub(crate) fn log_plane_ui<R>(
    ui: &mut Ui,
    key: &str,
    labels: [&str; 2],
    palette: &Palette,
    range: Option<[(f64, f64); 2]>,
    draw: impl FnOnce(&mut PlotUi<'_>) -> R,
) -> R {
    scaled_plane_ui(ui, key, labels, (palette, AxisScale::Logarithmic), range, draw)
}

fn scaled_plane_ui<R>(
    ui: &mut Ui,
    key: &str,
    [x_label, y_label]: [&str; 2],
    (palette, scale): (&Palette, AxisScale),
    range: Option<[(f64, f64); 2]>,
    draw: impl FnOnce(&mut PlotUi<'_>) -> R,
) -> R {
    let size = ui.available_size().max(Vec2::splat(1.0));
    let axis = |axis: AxisHints<'static>, length: f32, side: Side| match scale {
        AxisScale::Linear => axis.formatter(move |mark, range| tick_inside(mark, range, length, side)),
        AxisScale::Logarithmic => axis.formatter(|mark, _| log_tick(mark)).label_spacing(LOG_TICKS_FADE),
    };
    let spacer = move |length: f32, apart: f32| {
        move |input: GridInput| match scale {
            AxisScale::Linear => ticks(input.bounds, length / apart),
            AxisScale::Logarithmic => log_ticks(input.bounds, length, apart),
        }
    };
    let plot = Plot::new(key)
        .width(size.x)
        .height(size.y)
        .show_x(false)
        .show_y(false)
        .show_background(false)
        .sense(sense(ui))
        .custom_x_axes(vec![axis(AxisHints::new_x().label(x_label.to_owned()), size.x - Y_AXIS, Side::Bottom)])
        .custom_y_axes(vec![axis(
            AxisHints::new_y().label(y_label.to_owned()).min_thickness(Y_AXIS),
            size.y,
            Side::Left,
        )])
        .x_grid_spacer(spacer(size.x, 75.0))
        .y_grid_spacer(spacer(size.y, 34.0))
        .grid_color(palette.grid)
        .allow_scroll(false)
        .allow_double_click_reset(false)
        .label_formatter(|_| None);
    let id = Id::unique(("zoomed", key));
    let mut zoomed = ui.data(|data| data.get_temp(id)).unwrap_or(false);
    let response = plot.show(ui, |plot| {
        if let Some([x, y]) = range.filter(|_| !zoomed) {
            plot.set_plot_bounds_x(x.0..=x.1);
            plot.set_plot_bounds_y(y.0..=y.1);
        }
        draw(plot)
    });
    let inner = response.inner;
    let frame = response.transform.frame();
    let corners = [frame.left_top(), frame.left_bottom(), frame.right_bottom()];
    ui.painter().add(Shape::line(corners.to_vec(), Stroke::new(1.0, palette.grid)));
    let response = response.response;
    if response.double_clicked() {
        zoomed = false;
    } else if response.drag_started() || (response.hovered() && response.ctx.input(|i| i.zoom_delta() != 1.0)) {
        zoomed = true;
    }
    ui.data_mut(|data| data.insert_temp(id, zoomed));
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(format!("Plot of the {key}")));
    inner
}

/// Limits the distance of points from the middle of a plot, in its widths and heights: positions on screen are in
/// single precision, and their squares overflow.
const FARTHEST: f64 = 1e6;

/// Limits points in the first frame, before a plot has bounds.
const FARTHEST_AT_FIRST: f64 = 1e12;

/// A point, or one in its direction that is far outside the plot, where it can be drawn.
pub(crate) fn drawable(plot: &PlotUi<'_>, point: [f64; 2]) -> [f64; 2] {
    let bounds = plot.plot_bounds();
    std::array::from_fn(|axis| {
        let (low, high) = (bounds.min()[axis], bounds.max()[axis]);
        let (middle, most) = (0.5 * low + 0.5 * high, FARTHEST * (high - low));
        let (middle, most) = if most > 0.0 && most.is_finite() { (middle, most) } else { (0.0, FARTHEST_AT_FIRST) };
        point[axis].clamp(middle - most, middle + most)
    })
}

const SHADES: usize = 6;

pub(crate) fn aged_path(plot: &mut PlotUi<'_>, path: &[[f64; 2]], color: Color32, width: f32) {
    let length = path.len().div_ceil(SHADES).max(1);
    for shade in (0..SHADES).rev() {
        let part = path.get(shade * length..path.len().min((shade + 1) * length + 1)).unwrap_or_default();
        if part.len() > 1 {
            let color = color.gamma_multiply(1.0 - shade as f32 / (SHADES as f32 + 0.8));
            let part: Vec<[f64; 2]> = part.iter().map(|point| drawable(plot, *point)).collect();
            plot.line(Line::new("path", part).color(color).width(width).allow_hover(false));
        }
    }
}

pub(crate) fn around(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values.filter(|x| x.is_finite()).map(|x| (x, x)).reduce(|(l, h), (x, _)| (l.min(x), h.max(x)))?;
    let margin = 0.08 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}
