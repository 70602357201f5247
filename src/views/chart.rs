//! Anything over time: bands, dots and lines in one plot on the common axis.

use std::cell::OnceCell;
use std::sync::Arc;

use egui::{Color32, Id, RichText, Ui, Vec2, Vec2b};
use egui_plot::{AxisHints, LineStyle, Plot, VLine};

use super::ViewContext;
use super::kept::kept;
use super::layer::{Drawn, Layer, Window};
use super::ticks::{tick, ticks};
use crate::command::Command;
use crate::session::Mode;

/// Ticks' labels are drawn in full from this distance on \[points\].
const TICKS_FADE: egui::Rangef = egui::Rangef { min: 14.0, max: 18.0 };

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
        let followed = axis.followed(session);
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
            .custom_x_axes(vec![
                AxisHints::new_x()
                    .label(time_label)
                    .formatter(|mark, _| tick(mark.value, mark.step_size))
                    .label_spacing(TICKS_FADE),
            ])
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
        let drawn: OnceCell<Arc<Drawn>> = OnceCell::new();
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
            let make = || Drawn::new(&self.layers, record, &window, self.least);
            let drawn = drawn.get_or_init(|| kept(plot.ctx(), id, (context.version, window.key()), make));
            if axis.follows {
                plot.set_plot_bounds_x(followed.0..=followed.1);
                if let Some((low, high)) = drawn.range {
                    plot.set_plot_bounds_y(low..=high);
                }
            }
            drawn.show(plot);
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
