//! Anything over time: bands, dots and lines in one plot on the common axis.

use std::ops::Range;

use egui::{Color32, Id, RichText, Stroke, Ui, Vec2, Vec2b};
use egui_plot::{AxisHints, FilledArea, HLine, Line, LineStyle, Plot, PlotUi, Points, VLine};
use kalmanscope_core::Record;

use super::ticks::{tick, ticks};
use super::{TimeAxis, ViewContext};
use crate::command::Command;
use crate::series::{Column, central_range, reduce};
use crate::session::Mode;

/// Share of the columns at either end that the vertical axis does not bend to: the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// Ticks' labels are drawn in full from this distance on \[points\].
const TICKS_FADE: egui::Rangef = egui::Rangef { min: 14.0, max: 18.0 };

/// A quantity at every sample, NaN where there is none.
pub(super) type Series<'a> = Box<dyn Fn(usize) -> f64 + 'a>;

/// One thing that a chart shows; the first are the lowest.
pub(super) enum Layer<'a> {
    /// What is between two series.
    Band { low: Series<'a>, high: Series<'a>, len: usize, color: Color32 },
    /// Single values.
    Dots { value: Series<'a>, len: usize, color: Color32 },
    /// A line. `bounds` says whether the vertical axis must hold all of it, outliers too.
    Line { value: Series<'a>, len: usize, color: Color32, width: f32, dashed: bool, bounds: bool },
    /// The same value at all times.
    Level { value: f64, color: Color32 },
}

/// A value in a chart's heading.
pub(super) struct Readout {
    pub(super) text: String,
    pub(super) color: Color32,
    pub(super) hint: String,
}

/// What one chart shows.
pub(super) struct Chart<'a> {
    /// Unique among all charts on screen.
    pub(super) key: String,
    /// What is told to those who cannot see it.
    pub(super) title: String,
    pub(super) symbol: String,
    pub(super) name: String,
    pub(super) unit: &'static str,
    pub(super) readouts: Vec<Readout>,
    pub(super) layers: Vec<Layer<'a>>,
    /// Whether this chart names the axis for those above it.
    pub(super) names_time: bool,
    /// The least that the vertical axis shows.
    pub(super) least: Option<(f64, f64)>,
}

impl Chart<'_> {
    /// Draws the chart with its heading into all of `ui`. Returns the time that the user points at \[s\].
    pub(super) fn show(self, ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) -> Option<f64> {
        heading_ui(ui, &self.symbol, &self.name, self.unit, &self.readouts);
        let ViewContext { session, palette, axis, .. } = *context;
        let size = ui.available_size().max(Vec2::splat(1.0));
        let followed = TimeAxis::followed(session);
        let position = session.time();
        let show_position = session.mode() == Mode::Whole;
        let group = Id::unique("time");
        let time_label = if self.names_time && size.y >= 130.0 { "time [s]" } else { "" };
        let plot = Plot::new(&self.key)
            .width(size.x)
            .height(size.y)
            .show_x(false)
            .show_y(false)
            .link_axis(group, Vec2b::new(true, false))
            .link_cursor(group, Vec2b::new(true, false))
            .custom_x_axes(vec![AxisHints::new_x().label(time_label).label_spacing(TICKS_FADE)])
            .custom_y_axes(vec![
                AxisHints::new_y()
                    .formatter(|mark, _| tick(mark.value, mark.step_size))
                    .min_thickness(44.0)
                    .label_spacing(TICKS_FADE),
            ])
            .x_grid_spacer(move |input| ticks(input.bounds, size.x / 75.0))
            .y_grid_spacer(move |input| ticks(input.bounds, size.y / 34.0))
            .grid_color(palette.grid)
            .boxed_zoom_pointer_button(egui::PointerButton::Primary)
            .pan_pointer_button(egui::PointerButton::Secondary)
            .allow_scroll(false)
            .allow_double_click_reset(false)
            .label_formatter(|_| None);
        let response = plot.show(ui, |plot| {
            let bounds = plot.plot_bounds();
            let window = if axis.follows { followed } else { (bounds.min()[0], bounds.max()[0]) };
            let record = session.run().record();
            let drawn: Vec<Drawn> =
                self.layers.iter().map(|layer| Drawn::new(layer, record, window, (size.x as usize).max(16))).collect();
            if axis.follows {
                plot.set_plot_bounds_x(window.0..=window.1);
                if let Some((low, high)) = vertical_range(&drawn, self.least) {
                    plot.set_plot_bounds_y(low..=high);
                }
            }
            for layer in drawn {
                layer.draw(plot);
            }
            if show_position {
                let line = VLine::new("playback", position).color(palette.weak).width(1.2);
                plot.vline(line.style(LineStyle::dashed_dense()).allow_hover(false));
            }
            plot.pointer_coordinate().filter(|_| plot.response().hovered()).map(|point| point.x)
        });
        let pointed = response.inner;
        let response = response.response;
        response.ctx.accesskit_node_builder(response.id, |node| node.set_label(format!("Plot of the {}", self.title)));
        if response.double_clicked() {
            commands.push(Command::Follow);
        } else if response.drag_started() || (response.hovered() && response.ctx.input(|i| i.zoom_delta() != 1.0)) {
            commands.push(Command::Unfollow);
        }
        pointed
    }
}

/// Name and unit at the left, values at the cursor or at playback at the right.
pub(super) fn heading_ui(ui: &mut Ui, symbol: &str, name: &str, unit: &str, readouts: &[Readout]) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        ui.label(RichText::new(symbol).family(crate::theme::strong()).size(15.0));
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let named = ui.available_width() > 200.0 + 75.0 * readouts.len() as f32;
        ui.weak(if named { format!("{name}{unit}") } else { unit });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for Readout { text, color, hint } in readouts.iter().rev() {
                ui.label(RichText::new(text).small().color(*color)).on_hover_text(hint);
            }
        });
    });
}

/// A layer, reduced to its pixel columns.
enum Drawn {
    Band { times: Vec<f64>, low: Vec<f64>, high: Vec<f64>, color: Color32 },
    Dots { points: Vec<[f64; 2]>, color: Color32 },
    Line { points: Vec<[f64; 2]>, color: Color32, width: f32, dashed: bool, bounds: bool },
    Level { value: f64, color: Color32 },
}

impl Drawn {
    fn new(layer: &Layer<'_>, record: &Record, window: (f64, f64), columns: usize) -> Self {
        match layer {
            Layer::Band { low, high, len, color } => {
                // Half the columns do for the smooth edges of a band.
                let visible = samples_in(record, window, *len);
                let low = reduce(visible.clone(), columns / 2, low);
                let high = reduce(visible, columns / 2, high);
                let same = low.len().min(high.len());
                Self::Band {
                    times: low[..same].iter().map(|c| record.time(c.sample)).collect(),
                    low: low[..same].iter().map(|c| c.low).collect(),
                    high: high[..same].iter().map(|c| c.high).collect(),
                    color: *color,
                }
            }
            Layer::Dots { value, len, color } => {
                let reduced = reduce(samples_in(record, window, *len), columns / 2, value);
                let both = |c: &Column| [[record.time(c.sample), c.low], [record.time(c.sample), c.high]];
                Self::Dots { points: reduced.iter().flat_map(both).collect(), color: *color }
            }
            Layer::Line { value, len, color, width, dashed, bounds } => Self::Line {
                points: line(record, &reduce(samples_in(record, window, *len), columns, value)),
                color: *color,
                width: *width,
                dashed: *dashed,
                bounds: *bounds,
            },
            Layer::Level { value, color } => Self::Level { value: *value, color: *color },
        }
    }

    fn draw(self, plot: &mut PlotUi<'_>) {
        match self {
            Self::Band { times, low, high, color } => {
                if !times.is_empty() {
                    let edge = Stroke::new(0.7, color.gamma_multiply(0.6));
                    let band = FilledArea::new("band", &times, &low, &high);
                    plot.add(band.fill_color(color.gamma_multiply(0.22)).stroke(edge).allow_hover(false));
                }
            }
            Self::Dots { points, color } => {
                plot.points(Points::new("dots", points).radius(1.3).color(color).allow_hover(false));
            }
            Self::Line { points, color, width, dashed, .. } => {
                let style = if dashed { LineStyle::dashed_dense() } else { LineStyle::Solid };
                plot.line(Line::new("line", points).color(color).width(width).style(style).allow_hover(false));
            }
            Self::Level { value, color } => {
                let style = LineStyle::dashed_dense();
                plot.hline(HLine::new("level", value).color(color).width(1.0).style(style).allow_hover(false));
            }
        }
    }
}

/// All of the lines that count, and the rest but for its outermost columns; dots only where there is nothing else.
fn vertical_range(drawn: &[Drawn], least: Option<(f64, f64)>) -> Option<(f64, f64)> {
    let (mut whole, mut robust, mut dots) = (Vec::new(), Vec::new(), Vec::new());
    for layer in drawn {
        match layer {
            Drawn::Band { low, high, .. } => robust.extend(low.iter().chain(high)),
            Drawn::Line { points, bounds: true, .. } => whole.extend(points.iter().map(|p| p[1])),
            Drawn::Line { points, .. } => robust.extend(points.iter().map(|p| p[1])),
            Drawn::Dots { points, .. } => dots.extend(points.iter().map(|p| p[1])),
            Drawn::Level { .. } => {}
        }
    }
    let robust = central_range(robust.into_iter().filter(|x| x.is_finite()).collect(), OUTLIERS);
    let all = whole.into_iter().filter(|x| x.is_finite()).map(|x| (x, x)).chain(robust).chain(least);
    let (low, high) =
        all.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))).or_else(|| central_range(dots, OUTLIERS))?;
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Some((low - margin, high + margin))
}

/// The samples that the window shows, one more at either side, as far as there are any.
fn samples_in(record: &Record, (from, to): (f64, f64), len: usize) -> Range<usize> {
    let index = |time: f64| ((time - record.time(0)) / record.dt()).clamp(0.0, len as f64);
    let first = index(from).floor() as usize;
    let last = (index(to).ceil() as usize + 1).min(len);
    first.saturating_sub(1).min(last)..last
}

/// A line through the extremes of each column, in the order in which they come.
fn line(record: &Record, columns: &[Column]) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(2 * columns.len());
    for column in columns {
        let x = record.time(column.sample);
        let (first, second) = if column.rising { (column.low, column.high) } else { (column.high, column.low) };
        points.push([x, first]);
        if first != second {
            points.push([x, second]);
        }
    }
    points
}
