//! Anything over time: bands, dots and lines in one plot on the common axis.

use std::cell::OnceCell;
use std::sync::Arc;

use egui::{Align2, Color32, CursorIcon, Id, Sense, TextStyle, Ui, Vec2, Vec2b, pos2};
use egui_plot::PlotTransform;

use super::cache::{cached, in_turn};
use super::cursor::{Cursors, cursor_gestures, filter_at, lens_ui, time_text};
use super::decoration::{gap_shapes, strip_shapes};
use super::handles::{PlotHandle, handles_ui};
use super::heading::{Readout, heading_ui};
use super::layers::{Drawing, Layer, Window};
use super::medium::{Medium, cells_ui};
use super::notes::{Note, note_shapes};
use super::plane::{Plane, frame_ui, is_turned};
use super::series::PlotSeries;
use super::sheet::{Sheet, SheetColumn, readouts};
use super::time_axis::PlotInput;
use crate::request::Request;
use crate::trouble::Gap;

#[derive(Default)]
pub(crate) struct Chart<'a> {
    pub(crate) key: String,
    pub(crate) title: String,
    pub(crate) symbol: String,
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) columns: Vec<SheetColumn<'a>>,
    pub(crate) readouts: Option<Vec<Readout>>,
    pub(crate) layers: Vec<Layer<'a>>,
    pub(crate) bands: Vec<Layer<'a>>,
    pub(crate) handles: Vec<PlotHandle<'a>>,
    pub(crate) least: Option<(f64, f64)>,
    pub(crate) notes: Vec<Note>,
    /// Whether the axis fits the later part of a run, so that the wide band of a guess does not scale it.
    pub(crate) settles: bool,
    /// Whether the values are logarithms to the base of ten; the axis is labelled with the numbers themselves.
    pub(crate) logarithmic: bool,
}

pub(crate) struct Curve<'a> {
    pub(crate) line: PlotSeries<'a>,
    pub(crate) band: Option<PlotSeries<'a>>,
    pub(crate) width: f32,
}

pub(crate) struct ChartResponse {
    pub(crate) pointed: Option<f64>,
    pub(crate) alone: bool,
}

impl<'a> Chart<'a> {
    pub(crate) fn aside(&mut self, aside: impl Fn(usize) -> Option<String> + 'a) {
        let last = self.columns.pop();
        self.columns.extend(last.map(|column| column.with_aside(aside)));
    }

    pub(crate) fn into_sheet(self) -> Sheet<'a> {
        Sheet { title: self.title, unit: self.unit, columns: self.columns }
    }

    fn ui(self, ui: &mut Ui, input: &PlotInput<'_>, last_row: bool, requests: &mut Vec<Request>) -> ChartResponse {
        let medium = Medium::of(ui.ctx());
        let readouts: Vec<Readout> = match medium {
            Medium::Screen | Medium::Film => {
                self.readouts.unwrap_or_else(|| readouts(&self.columns, input.axis.readout(input.session)))
            }
            Medium::Figure => Vec::new(),
        };
        let time = time_text(input, input.axis.shown_time(input.session));
        let time = Readout::new(format!("t\u{a0}{time}"), Color32::TRANSPARENT, String::new());
        let symbol = heading_ui(ui, &self.symbol, &self.name, self.unit, &readouts);
        let alone =
            symbol.interact(Sense::click()).on_hover_text("Click to show this plot alone, or all again").clicked();
        let PlotInput { session, palette, axis, version, .. } = *input;
        let gaps = Gap::all(session);
        let size = ui.available_size().max(Vec2::splat(1.0));
        let layers: Vec<Layer<'_>> = self.bands.into_iter().chain(self.layers).collect();
        let followed = axis.followed(session);
        let group = Id::unique("time");
        let has_room = size.y >= 150.0 || medium == Medium::Figure;
        let time_label = if last_row && has_room { "time [s]" } else { "" };
        let plane =
            Plane { key: &self.key, labels: [time_label, ""], logarithmic: [false, self.logarithmic], has_x: last_row };
        let plot = plane
            .plot(ui, palette)
            .link_axis(group, Vec2b::new(true, false))
            .link_cursor(group, Vec2b::new(true, false))
            .boxed_zoom_pointer_button(egui::PointerButton::Primary)
            .pan_pointer_button(egui::PointerButton::Secondary);
        let drawn: OnceCell<Arc<Drawing>> = OnceCell::new();
        let response = plot.show(ui, |plot| {
            let bounds = plot.plot_bounds();
            let [times, values] = [0, 1].map(|axis| (bounds.min()[axis], bounds.max()[axis]));
            let window = if axis.follows {
                Window { times: followed, values: None, size }
            } else {
                Window { times, values: Some(values), size }
            };
            let record = session.run().record();
            let id = Id::unique(("drawn", &self.key));
            let draw = || Drawing::new(&layers, record, &window, (self.least, self.settles));
            let make = || in_turn(plot.ctx(), id, session.budget(), draw);
            let drawn = drawn.get_or_init(|| cached(plot.ctx(), id, (version, window.key()), make));
            if axis.follows {
                plot.set_plot_bounds_x(followed.0..=followed.1);
                if let Some((low, high)) = drawn.range {
                    plot.set_plot_bounds_y(low..=high);
                }
            }
            plot.pointer_coordinate().filter(|_| plot.response().hovered()).map(|point| point.x)
        });
        let (pointed, transform) = (response.inner, response.transform);
        let mut shapes = Vec::new();
        gap_shapes(&gaps, &transform, palette, &mut shapes);
        strip_shapes(input, &transform, &mut shapes);
        drawn.get().iter().for_each(|drawn| drawn.shapes(ui, &transform, &mut shapes));
        note_shapes(&self.notes, ui, &transform, &mut shapes);
        Cursors::of(input, last_row, medium).shapes(ui, &transform, &mut shapes);
        ui.painter_at(*transform.frame()).extend(shapes);
        labels_ui(ui, &transform, &layers);
        frame_ui(ui, &transform, palette);
        let response = response.response;
        if medium != Medium::Screen {
            return ChartResponse { pointed: None, alone: false };
        }
        let marks = drawn.get().map_or(&[][..], |drawn| &drawn.marks[..]);
        let under = response.hover_pos().and_then(|position| filter_at(marks, &transform, position));
        let response = if under.is_some() { response.on_hover_cursor(CursorIcon::PointingHand) } else { response };
        let pointed = lens_ui(ui, &response, &transform, std::iter::once(&time).chain(&readouts)).or(pointed);
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
        } else if is_turned(&response) {
            requests.push(Request::Unfollow);
        }
        ChartResponse { pointed, alone }
    }
}

fn labels_ui(ui: &Ui, transform: &PlotTransform, layers: &[Layer<'_>]) {
    const ROOM: f32 = 16.0;
    let labels: Vec<(f64, &str, Color32)> = layers.iter().filter_map(Layer::label).collect();
    let middle = labels.iter().map(|(value, ..)| value).sum::<f64>() / labels.len().max(1) as f64;
    let frame = *transform.frame();
    for (value, text, color) in labels {
        let y = transform.position_from_point_y(value);
        let is_below = (value < middle && y < frame.bottom() - ROOM) || y < frame.top() + ROOM;
        let align = if is_below { Align2::RIGHT_TOP } else { Align2::RIGHT_BOTTOM };
        let font = TextStyle::Small.resolve(ui.style());
        ui.painter_at(frame).text(pos2(frame.right() - 4.0, y), align, text, font, color);
    }
}

pub(crate) fn charts_ui(
    ui: &mut Ui,
    charts: Vec<Chart<'_>>,
    input: &PlotInput<'_>,
    requests: &mut Vec<Request>,
) -> Option<f64> {
    let count = charts.len();
    let id = ui.scope_id().with("alone");
    // The plot that was shown alone may be gone with its sensor.
    let mut alone: Option<usize> = ui.data(|data| data.get_temp(id)).filter(|place| *place < count);
    let (first, shown) = alone.map_or((0, count), |place| (place, 1));
    let mut pointed = None;
    let mut charts = charts.into_iter().skip(first);
    cells_ui(ui, shown, &mut |ui, i, last_row| {
        let Some(chart) = charts.next() else { return };
        let response = chart.ui(ui, input, last_row, requests);
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
