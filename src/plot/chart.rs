//! Anything over time: bands, dots and lines in one plot on the common axis.

use std::cell::OnceCell;
use std::sync::Arc;

use egui::{Color32, CursorIcon, Id, Sense, Ui, Vec2, Vec2b};
use egui_plot::{AxisHints, Plot};

use super::axes::{LOG_TICKS_FADE, Side, log_tick, tick_inside};
use super::cache::{cached, in_turn};
use super::cursor::{Cursors, cursor_gestures, filter_at, lens_ui, time_text};
use super::decoration::{Decoration, Gaps, Labels, Strips};
use super::handles::{Handle, handles_ui};
use super::heading::{Readout, heading_ui};
use super::item::{Drawing, Grid};
use super::layers::{Layer, Window};
use super::medium::{Medium, Y_AXIS, cells_ui, sense};
use super::time_axis::PlotInput;
use crate::request::Request;
use crate::sheet::{Column, Sheet, readouts};
use crate::trouble::Gap;

/// Labels of ticks are opaque from this distance on \[points\].
const TICKS_FADE: egui::Rangef = egui::Rangef { min: 14.0, max: 18.0 };

#[derive(Default)]
pub(crate) struct Chart<'a> {
    pub(crate) key: String,
    pub(crate) title: String,
    pub(crate) symbol: String,
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) columns: Vec<Column<'a>>,
    pub(crate) readouts: Option<Vec<Readout>>,
    pub(crate) layers: Vec<Layer<'a>>,
    pub(crate) handles: Vec<Handle<'a>>,
    pub(crate) least: Option<(f64, f64)>,
    /// Whether the values are logarithms to the base of ten; the axis is labelled with the numbers themselves.
    pub(crate) logarithmic: bool,
}

pub(crate) struct ChartResponse {
    /// The time under the pointer \[s\].
    pub(crate) pointed: Option<f64>,
    pub(crate) alone: bool,
}

impl<'a> Chart<'a> {
    pub(crate) fn into_sheet(self) -> Sheet<'a> {
        Sheet { title: self.title, unit: self.unit, columns: self.columns }
    }

    pub(crate) fn show(
        self,
        ui: &mut Ui,
        input: &PlotInput<'_>,
        last_row: bool,
        requests: &mut Vec<Request>,
    ) -> ChartResponse {
        let shown = time_text(input, input.axis.shown_time(input.session));
        let time = Readout::new(format!("t\u{a0}{shown}"), Color32::TRANSPARENT, "time [s]".to_owned());
        let medium = Medium::of(ui.ctx());
        let readouts: Vec<Readout> = match medium {
            Medium::Screen => {
                let numbers = || readouts(&self.columns, input.axis.readout(input.session));
                std::iter::once(time).chain(self.readouts.unwrap_or_else(numbers)).collect()
            }
            Medium::Figure => Vec::new(),
        };
        let symbol = heading_ui(ui, &self.symbol, &self.name, self.unit, &readouts);
        let alone =
            symbol.interact(Sense::click()).on_hover_text("Click: this plot alone, or all of them again").clicked();
        let PlotInput { session, palette, visible, axis, version, .. } = *input;
        let strips = Strips::of(session, visible, palette);
        let gaps = Gap::all(session);
        let size = ui.available_size().max(Vec2::splat(1.0));
        let followed = axis.followed(session);
        let group = Id::unique("time");
        let has_room = size.y >= 150.0 || medium == Medium::Figure;
        let time_label = if last_row && has_room { "time [s]" } else { "" };
        let logarithmic = self.logarithmic;
        let values = AxisHints::new_y().min_thickness(Y_AXIS);
        let values = if logarithmic {
            values.formatter(|mark, _| log_tick(mark)).label_spacing(LOG_TICKS_FADE)
        } else {
            let inside = move |mark, range: &_| tick_inside(mark, range, size.y, Side::Left);
            values.formatter(inside).label_spacing(TICKS_FADE)
        };
        let [across, up] = medium.between_ticks();
        let grid = Grid {
            counts: (size.x / across, size.y / up),
            logarithmic: logarithmic.then_some(size.y),
            color: palette.grid,
        };
        let plot = Plot::new(&self.key)
            .width(size.x)
            .height(size.y)
            .show_x(false)
            .show_y(false)
            .show_axes([last_row, true])
            .show_background(false)
            .sense(sense(ui))
            .link_axis(group, Vec2b::new(true, false))
            .link_cursor(group, Vec2b::new(true, false))
            .custom_x_axes(vec![
                AxisHints::new_x()
                    .formatter(move |mark, range| tick_inside(mark, range, size.x - Y_AXIS, Side::Bottom))
                    .label(time_label)
                    .label_spacing(TICKS_FADE),
            ])
            .custom_y_axes(vec![values])
            .x_grid_spacer(move |axis| grid.times(axis.bounds))
            .y_grid_spacer(move |axis| grid.values(axis.bounds))
            .show_grid(false)
            .boxed_zoom_pointer_button(egui::PointerButton::Primary)
            .pan_pointer_button(egui::PointerButton::Secondary)
            .allow_scroll(false)
            .allow_double_click_reset(false)
            .label_formatter(|_| None);
        let drawn: OnceCell<Arc<Drawing>> = OnceCell::new();
        let response = plot.show(ui, |plot| {
            let bounds = plot.plot_bounds();
            let [times, values] = [0, 1].map(|axis| (bounds.min()[axis], bounds.max()[axis]));
            let pens = medium.density() * size;
            let window = if axis.follows {
                Window { times: followed, values: None, size: pens }
            } else {
                Window { times, values: Some(values), size: pens }
            };
            let record = session.run().record();
            let id = Id::unique(("drawn", &self.key));
            let draw = || Drawing::new(&self.layers, record, &window, self.least);
            let make = || in_turn(plot.ctx(), id, session.budget(), draw);
            let drawn = drawn.get_or_init(|| cached(plot.ctx(), id, (version, window.key()), make));
            if axis.follows {
                plot.set_plot_bounds_x(followed.0..=followed.1);
                if let Some((low, high)) = drawn.range {
                    plot.set_plot_bounds_y(low..=high);
                }
            }
            plot.add(Decoration::new("gaps", Gaps::of(&gaps, last_row, palette)));
            plot.add(Decoration::new("bad parts", strips));
            drawn.show(grid, plot);
            plot.add(Decoration::new("labels", Labels::of(&self.layers)));
            plot.add(Decoration::new("cursors", Cursors::of(input, last_row, medium)));
            plot.pointer_coordinate().filter(|_| plot.response().hovered()).map(|point| point.x)
        });
        let (pointed, transform) = (response.inner, response.transform);
        let response = response.response;
        if medium == Medium::Figure {
            return ChartResponse { pointed: None, alone: false };
        }
        let marks = drawn.get().map_or(&[][..], |drawn| &drawn.marks[..]);
        let under = response.hover_pos().and_then(|position| filter_at(marks, &transform, position));
        let response = if under.is_some() { response.on_hover_cursor(CursorIcon::PointingHand) } else { response };
        let pointed = lens_ui(ui, &response, &transform, &readouts).or(pointed);
        cursor_gestures(ui, &self.key, (&response, under), &transform, input, requests);
        handles_ui(ui, &self.key, &self.handles, &transform, input, requests);
        let inside = |time: f64| gaps.iter().find(|gap| gap.times.0 <= time && time <= gap.times.1);
        let response = match pointed.and_then(inside) {
            Some(gap) => response.on_hover_text_at_pointer(gap.words()),
            None => response,
        };
        response.ctx.accesskit_node_builder(response.id, |node| node.set_label(format!("Plot of the {}", self.title)));
        if response.double_clicked() {
            requests.push(Request::Follow);
        } else if response.drag_started() || (response.hovered() && response.ctx.input(|i| i.zoom_delta() != 1.0)) {
            requests.push(Request::Unfollow);
        }
        ChartResponse { pointed, alone }
    }
}

/// Fills `ui` with charts, or with the enlarged one. Returns the time under the pointer \[s\].
pub(crate) fn charts_ui(
    ui: &mut Ui,
    charts: Vec<Chart<'_>>,
    input: &PlotInput<'_>,
    requests: &mut Vec<Request>,
) -> Option<f64> {
    let count = charts.len();
    let id = ui.scope_id().with("alone");
    let mut alone: Option<usize> = ui.data(|data| data.get_temp(id)).filter(|place| *place < count);
    let (first, shown) = alone.map_or((0, count), |place| (place, 1));
    let mut pointed = None;
    let mut charts = charts.into_iter().skip(first);
    cells_ui(ui, shown, &mut |ui, i, last_row| {
        let Some(chart) = charts.next() else { return };
        let response = chart.show(ui, input, last_row, requests);
        pointed = response.pointed.or(pointed);
        if response.alone {
            alone = if alone.is_none() { Some(first + i) } else { None };
        }
    });
    ui.data_mut(|data| match alone {
        Some(place) => *data.get_temp_mut_or_default(id) = place,
        None => data.remove::<usize>(id),
    });
    pointed
}
