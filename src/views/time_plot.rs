//! One channel over time: truth, measurement, each filter's estimate and its ±2σ band.

use std::ops::Range;

use egui::{Id, RichText, Ui, Vec2, Vec2b};
use egui_plot::{AxisHints, FilledArea, GridMark, Line, LineStyle, Plot, PlotUi, Points, VLine};
use kalmanscope_core::{Channel, Estimates, Quantity, Record};

use super::{TimeAxis, ViewContext};
use crate::command::Command;
use crate::series::{Column, central_range, reduce};
use crate::session::Mode;
use crate::text::fixed;

/// Share of the columns at either end that the vertical axis does not bend to: the first instants of a wide guess.
const OUTLIERS: f64 = 0.006;

/// Ticks' labels are drawn in full from this distance on \[points\].
const TICKS_FADE: egui::Rangef = egui::Rangef { min: 14.0, max: 18.0 };

/// Draws the channel's plot with its heading into all of `ui`. Returns the time that the user points at \[s\].
pub fn time_plot_ui(
    ui: &mut Ui,
    channel: Channel,
    context: &ViewContext<'_>,
    commands: &mut Vec<Command>,
) -> Option<f64> {
    heading_ui(ui, channel, context);
    let ViewContext { session, palette, axis, .. } = *context;
    let size = ui.available_size().max(Vec2::splat(1.0));
    let followed = TimeAxis::followed(session);
    let position = session.time();
    let show_position = session.mode() == Mode::Whole;
    let group = Id::unique("time");
    // The lowest plots name the axis for all.
    let time_label = if channel.is_parameter() || size.y < 130.0 { "" } else { "time [s]" };
    let plot = Plot::new(channel.key())
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
        let drawn = Drawn::new(channel, context, window, size.x);
        if axis.follows {
            plot.set_plot_bounds_x(window.0..=window.1);
            if let Some((low, high)) = drawn.vertical_range() {
                plot.set_plot_bounds_y(low..=high);
            }
        }
        drawn.draw(plot, context);
        if show_position {
            let line = VLine::new("playback", position).color(palette.weak).width(1.2);
            plot.vline(line.style(LineStyle::dashed_dense()).allow_hover(false));
        }
        plot.pointer_coordinate().filter(|_| plot.response().hovered()).map(|point| point.x)
    });
    let pointed = response.inner;
    let response = response.response;
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(format!("Plot of the {}", channel.name())));
    if response.double_clicked() {
        commands.push(Command::Follow);
    } else if response.drag_started() || (response.hovered() && response.ctx.input(|i| i.zoom_delta() != 1.0)) {
        commands.push(Command::Unfollow);
    }
    pointed
}

/// Name and unit at the left, values at the cursor or at playback at the right.
fn heading_ui(ui: &mut Ui, channel: Channel, context: &ViewContext<'_>) {
    let ViewContext { session, palette, shown, axis } = *context;
    let k = axis.readout(session);
    let decimals = decimals(channel);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        let symbol = RichText::new(channel.symbol()).family(crate::theme::strong()).size(15.0);
        ui.label(symbol);
        let unit = if channel.unit().is_empty() { String::new() } else { format!(" [{}]", channel.unit()) };
        if ui.available_width() > 400.0 {
            ui.weak(format!("{}{unit}", channel.name()));
        } else {
            ui.weak(unit);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for (place, estimates) in session.run().estimates().iter().enumerate().rev() {
                let Some(at) = estimates.place(channel).filter(|_| shown.filter(place) && k < estimates.len()) else {
                    continue;
                };
                let text = format!(
                    "{} ±{}",
                    fixed(estimates.mean(k)[at], decimals),
                    fixed(2.0 * estimates.std(k, at), decimals)
                );
                ui.label(RichText::new(text).small().color(palette.filter(place))).on_hover_text(estimates.name());
            }
            if let Some(truth) = session.run().record().truth(channel).and_then(|truth| truth.get(k)) {
                ui.label(RichText::new(fixed(*truth, decimals)).small().color(palette.truth)).on_hover_text("truth");
            }
        });
    });
}

fn decimals(channel: Channel) -> usize {
    match channel {
        Channel::Stiffness1 | Channel::Stiffness2 | Channel::Stiffness3 | Channel::Stiffness4 => 1,
        Channel::CubicStiffness | Channel::HysteresisBeta | Channel::HysteresisGamma => 1,
        Channel::NaturalFrequency | Channel::StoreyDamping => 3,
        _ if channel.unit() == "m/s" => 3,
        _ => 4,
    }
}

/// Multiples of 1, 2 or 5 times a power of ten, about `count` of them.
fn ticks((low, high): (f64, f64), count: f32) -> Vec<GridMark> {
    let rough = (high - low) / f64::from(count.max(2.0));
    if !rough.is_finite() || rough <= 0.0 {
        return Vec::new();
    }
    let decade = 10_f64.powf(rough.log10().floor());
    let step_size = [1.0, 2.0, 5.0].map(|m| m * decade).into_iter().find(|s| *s >= rough).unwrap_or(10.0 * decade);
    let (first, last) = ((low / step_size).ceil() as i64, (high / step_size).floor() as i64);
    (first..=last).map(|i| GridMark { value: i as f64 * step_size, step_size }).collect()
}

/// A tick's text, with just the digits that tell it from its neighbours.
fn tick(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    fixed(if value.abs() < 1e-3 * step { 0.0 } else { value }, decimals)
}

/// Everything of one plot, reduced to its pixel columns.
struct Drawn {
    truth: Vec<[f64; 2]>,
    measured: Vec<[f64; 2]>,
    filters: Vec<DrawnFilter>,
}

struct DrawnFilter {
    place: usize,
    mean: Vec<[f64; 2]>,
    times: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Drawn {
    fn new(channel: Channel, context: &ViewContext<'_>, window: (f64, f64), width: f32) -> Self {
        let ViewContext { session, shown, .. } = *context;
        let run = session.run();
        let record = run.record();
        let columns = (width as usize).max(16);
        let visible = samples_in(record, window, run.len());
        let truth = record.truth(channel).filter(|_| shown.truth);
        let measured = quantity(channel).and_then(|q| record.measured_quantity(q)).filter(|_| shown.measured);
        let filters = run.estimates().iter().enumerate().filter(|&(place, _)| shown.filter(place));
        Self {
            truth: truth.map_or(vec![], |truth| line(record, &reduce(visible.clone(), columns, |k| truth[k]))),
            measured: measured.map_or(vec![], |z| dots(record, &reduce(visible.clone(), columns / 2, |k| z[k]))),
            filters: filters
                .filter_map(|(place, estimates)| {
                    DrawnFilter::new(place, estimates, channel, record, visible.clone(), columns, shown.bands)
                })
                .collect(),
        }
    }

    /// All of the truth and the means, and the bands but for their outermost columns.
    fn vertical_range(&self) -> Option<(f64, f64)> {
        let whole = self.truth.iter().map(|p| p[1]);
        let means = self.filters.iter().flat_map(|f| f.mean.iter().map(|p| p[1]));
        let bands = self.filters.iter().flat_map(|f| f.low.iter().chain(&f.high).copied());
        let finite = |x: &f64| x.is_finite();
        let robust = central_range(means.chain(bands).filter(finite).collect(), OUTLIERS);
        let (low, high) = whole
            .filter(finite)
            .map(|x| (x, x))
            .chain(robust)
            .reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
            .or_else(|| central_range(self.measured.iter().map(|p| p[1]).collect(), OUTLIERS))?;
        let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
        Some((low - margin, high + margin))
    }

    /// Bands under measurements under truth under estimates.
    fn draw<'a>(self, plot: &mut PlotUi<'a>, context: &ViewContext<'_>) {
        let Self { truth, measured, filters } = self;
        let palette = context.palette;
        for DrawnFilter { place, times, low, high, .. } in &filters {
            if !times.is_empty() {
                let edge = egui::Stroke::new(0.7, palette.filter(*place).gamma_multiply(0.6));
                let band = FilledArea::new("±2σ", times, low, high).fill_color(palette.band(*place)).stroke(edge);
                plot.add(band.allow_hover(false));
            }
        }
        if !measured.is_empty() {
            let dots = Points::new("measured", measured).radius(1.3).color(palette.measured).allow_hover(false);
            plot.points(dots);
        }
        // Where all agree, each line still shows beside the narrower one above it.
        plot.line(Line::new("truth", truth).color(palette.truth).width(3.4).allow_hover(false));
        for DrawnFilter { place, mean, .. } in filters {
            let width = (2.8 - 1.2 * place as f32).max(1.2);
            plot.line(Line::new("estimate", mean).color(palette.filter(place)).width(width).allow_hover(false));
        }
    }
}

impl DrawnFilter {
    fn new(
        place: usize,
        estimates: &Estimates,
        channel: Channel,
        record: &Record,
        visible: Range<usize>,
        columns: usize,
        with_band: bool,
    ) -> Option<Self> {
        let at = estimates.place(channel)?;
        let visible = visible.start.min(estimates.len())..visible.end.min(estimates.len());
        let mean = |k: usize| estimates.mean(k)[at];
        let edge = |k: usize, sign: f64| mean(k) + sign * 2.0 * estimates.std(k, at);
        let (low, high) = if with_band {
            // Half the columns do for the smooth edges of a band.
            let low = reduce(visible.clone(), columns / 2, |k| edge(k, -1.0));
            (low, reduce(visible.clone(), columns / 2, |k| edge(k, 1.0)))
        } else {
            (vec![], vec![])
        };
        let same = low.len().min(high.len());
        Some(Self {
            place,
            mean: line(record, &reduce(visible, columns, mean)),
            times: low[..same].iter().map(|c| record.time(c.sample)).collect(),
            low: low[..same].iter().map(|c| c.low).collect(),
            high: high[..same].iter().map(|c| c.high).collect(),
        })
    }
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

fn dots(record: &Record, columns: &[Column]) -> Vec<[f64; 2]> {
    columns.iter().flat_map(|c| [[record.time(c.sample), c.low], [record.time(c.sample), c.high]]).collect()
}

/// The measurement that goes with a channel.
fn quantity(channel: Channel) -> Option<Quantity> {
    Quantity::ALL.into_iter().find(|q| q.channel() == Some(channel))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(bounds: (f64, f64), count: f32) -> Vec<f64> {
        ticks(bounds, count).iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn ticks_are_round_and_about_as_many_as_asked_for() {
        assert_eq!(values((0.0, 20.0), 5.0), [0.0, 5.0, 10.0, 15.0, 20.0]);
        assert_eq!(values((4.71, 6.3), 4.0), [5.0, 5.5, 6.0]);
        for (count, span) in [(2.0, 0.013), (5.0, 7.7), (9.0, 41_000.0)] {
            let found = values((-0.3 * span, 0.7 * span), count).len() as f32;
            assert!(found <= count + 1.0 && found >= count / 2.5 - 1.0, "{found} ticks instead of {count}");
        }
        assert!(values((1.0, 1.0), 5.0).is_empty() && values((f64::NEG_INFINITY, f64::INFINITY), 5.0).is_empty());
    }

    #[test]
    fn a_tick_has_the_digits_that_it_needs() {
        assert_eq!(
            [tick(0.05, 0.01), tick(-2.0, 1.0), tick(1e-19, 0.5), tick(30.0, 10.0)],
            ["0.05", "−2", "0.0", "30"]
        );
    }
}
