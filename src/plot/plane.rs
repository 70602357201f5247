//! The frame of every plot, and paths in it.

use egui::{Color32, Id, Rangef, Response, Shape, Stroke, TextStyle, Ui, Vec2};
use egui_plot::{AxisHints, GridInput, Line, Plot, PlotResponse, PlotTransform, PlotUi};

use super::axes::{LOG_TICKS_FADE, Side, log_tick, log_ticks, tick_inside, ticks};
use super::medium::{Medium, Y_AXIS, sense};
use crate::theme::Palette;

#[derive(Clone, Copy)]
pub(crate) struct Plane<'a> {
    pub(crate) key: &'a str,
    /// Of the horizontal and of the vertical axis; empty for none.
    pub(crate) labels: [&'a str; 2],
    /// Whether the values of an axis are logarithms to the base of ten; it is labelled with the numbers themselves.
    pub(crate) logarithmic: [bool; 2],
    pub(crate) has_x: bool,
}

/// Labels of ticks are opaque from this distance on \[points\].
const TICKS_FADE: Rangef = Rangef { min: 14.0, max: 18.0 };

impl<'a> Plane<'a> {
    pub(crate) const fn linear(key: &'a str, labels: [&'a str; 2]) -> Self {
        Self { key, labels, logarithmic: [false; 2], has_x: true }
    }

    pub(crate) fn plot<'p>(&self, ui: &mut Ui, palette: &Palette) -> Plot<'p> {
        // `egui_plot` has no setting for the type of its ticks: it takes that of the body.
        let small = TextStyle::Small.resolve(ui.style());
        ui.style_mut().text_styles.insert(TextStyle::Body, small);
        let Self { key, labels, logarithmic, has_x } = *self;
        let size = ui.available_size().max(Vec2::splat(1.0));
        let lengths = [size.x - Y_AXIS, size.y];
        let between = Medium::of(ui.ctx()).between_ticks();
        let axis = |axis: AxisHints<'p>, at: usize, side: Side| {
            let axis = if labels[at].is_empty() { axis } else { axis.label(labels[at].to_owned()) };
            if logarithmic[at] {
                axis.formatter(|mark, _| log_tick(mark)).label_spacing(LOG_TICKS_FADE)
            } else {
                axis.formatter(move |mark, range| tick_inside(mark, range, lengths[at], side)).label_spacing(TICKS_FADE)
            }
        };
        let spacer = |at: usize| {
            move |input: GridInput| {
                if logarithmic[at] {
                    log_ticks(input.bounds, size[at], between[at])
                } else {
                    ticks(input.bounds, size[at] / between[at])
                }
            }
        };
        Plot::new(key)
            .width(size.x)
            .height(size.y)
            .show_x(false)
            .show_y(false)
            .show_axes([has_x, true])
            .show_background(false)
            .sense(sense(ui))
            .custom_x_axes(vec![axis(AxisHints::new_x(), 0, Side::Bottom)])
            .custom_y_axes(vec![axis(AxisHints::new_y().min_thickness(Y_AXIS), 1, Side::Left)])
            .x_grid_spacer(spacer(0))
            .y_grid_spacer(spacer(1))
            .grid_color(palette.grid)
            .allow_scroll(false)
            .allow_double_click_reset(false)
            .label_formatter(|_| None)
    }

    pub(crate) fn show<R>(
        &self,
        ui: &mut Ui,
        palette: &Palette,
        range: Option<[(f64, f64); 2]>,
        draw: impl FnOnce(&mut PlotUi<'_>) -> R,
    ) -> PlotResponse<R> {
        let id = Id::unique(("zoomed", self.key));
        let zoomed = ui.data(|data| data.get_temp(id)).unwrap_or(false);
        let plot = self.plot(ui, palette).show(ui, |plot| {
            if let Some([x, y]) = range.filter(|_| !zoomed) {
                plot.set_plot_bounds_x(x.0..=x.1);
                plot.set_plot_bounds_y(y.0..=y.1);
            }
            draw(plot)
        });
        frame_ui(ui, &plot.transform, palette);
        let response = &plot.response;
        let zoomed = !response.double_clicked() && (zoomed || is_turned(response));
        ui.data_mut(|data| data.insert_temp(id, zoomed));
        response.ctx.accesskit_node_builder(response.id, |node| node.set_label(format!("Plot of the {}", self.key)));
        plot
    }
}

pub(super) fn is_turned(response: &Response) -> bool {
    response.drag_started() || (response.hovered() && response.ctx.input(|i| i.zoom_delta() != 1.0))
}

pub(super) fn frame_ui(ui: &Ui, transform: &PlotTransform, palette: &Palette) {
    let frame = transform.frame();
    let corners = [frame.left_top(), frame.left_bottom(), frame.right_bottom()];
    ui.painter().add(Shape::line(corners.to_vec(), Stroke::new(1.0, palette.grid)));
}

/// Limits points, in widths and heights of the plot from its middle: in single precision their squares overflow.
const FARTHEST: f64 = 1e6;

/// Limits points in the first frame, before a plot has bounds.
const FARTHEST_AT_FIRST: f64 = 1e12;

/// A point, or one in its direction that is far outside the plot, where it can be drawn.
pub(crate) fn drawable(plot: &PlotUi<'_>, point: [f64; 2]) -> [f64; 2] {
    let bounds = plot.plot_bounds();
    std::array::from_fn(|axis| {
        let (low, high) = (bounds.min()[axis], bounds.max()[axis]);
        // Halves first: the sum of two large ends overflows.
        let (middle, most) = (0.5 * low + 0.5 * high, FARTHEST * (high - low));
        let (middle, most) = if most > 0.0 && most.is_finite() { (middle, most) } else { (0.0, FARTHEST_AT_FIRST) };
        point[axis].clamp(middle - most, middle + most)
    })
}

const SHADES: usize = 6;

pub(crate) fn aged_path(plot: &mut PlotUi<'_>, path: &[[f64; 2]], color: Color32, width: f32) {
    let length = path.len().div_ceil(SHADES).max(1);
    for shade in (0..SHADES).rev() {
        // Each part begins with the last point of the one before, so that there is no gap between shades.
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
