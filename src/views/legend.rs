//! The legend that all plots share; a click shows or hides.

use egui::{Button, Color32, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo};

use kalmanscope_core::Channel;

use crate::session::Session;
use crate::theme::Palette;

/// What is drawn.
#[derive(Clone, Debug, PartialEq, Hash)]
pub struct Shown {
    /// The truth.
    pub truth: bool,
    /// The measurements.
    pub measured: bool,
    /// The ±2σ bands.
    pub bands: bool,
    /// The channels that there are charts of, or none for all.
    pub only: Vec<Channel>,
    hidden_filters: Vec<usize>,
}

impl Default for Shown {
    fn default() -> Self {
        Self { truth: true, measured: true, bands: true, only: Vec::new(), hidden_filters: Vec::new() }
    }
}

impl Shown {
    /// Those of `channels` that are wanted; all where none is, since a view is not left empty.
    pub fn channels(&self, channels: Vec<Channel>) -> Vec<Channel> {
        let wanted: Vec<Channel> = channels.iter().copied().filter(|channel| self.only.contains(channel)).collect();
        if wanted.is_empty() { channels } else { wanted }
    }

    /// Whether the filter at `place` is drawn.
    pub fn filter(&self, place: usize) -> bool {
        !self.hidden_filters.contains(&place)
    }

    /// Shows the filter at `place`, or hides it.
    pub fn toggle_filter(&mut self, place: usize) {
        if self.filter(place) {
            self.hidden_filters.push(place);
        } else {
            self.hidden_filters.retain(|&p| p != place);
        }
    }
}

#[derive(Clone, Copy)]
enum Mark {
    Line,
    Dots,
    Band,
}

/// One row of entries with `add_contents` at its end, and below it why a filter has stopped, or what else there is to know of it.
pub fn legend_ui(
    ui: &mut Ui,
    session: &Session,
    shown: &mut Shown,
    palette: &Palette,
    add_contents: impl FnOnce(&mut Ui),
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 12.0;
        if entry(ui, "truth", Mark::Line, palette.truth, shown.truth) {
            shown.truth = !shown.truth;
        }
        if entry(ui, "measured", Mark::Dots, palette.weak, shown.measured) {
            shown.measured = !shown.measured;
        }
        for (place, estimates) in session.run().estimates().iter().enumerate() {
            if entry(ui, estimates.name(), Mark::Band, palette.filter(place), shown.filter(place)) {
                shown.toggle_filter(place);
            }
        }
        if entry(ui, "±2σ", Mark::Band, palette.weak, shown.bands) {
            shown.bands = !shown.bands;
        }
        if !shown.only.is_empty() {
            let symbols: Vec<&str> = shown.only.iter().map(|channel| channel.symbol()).collect();
            let all = Button::new(format!("only {} ×", symbols.join(", "))).small();
            if ui.add(all).on_hover_text("Click to show all quantities").clicked() {
                shown.only.clear();
            }
        }
        add_contents(ui);
    });
    let record = session.run().record();
    if let Some(stop) = session.run().truth_stop() {
        let time = record.time_of(stop.sample);
        ui.colored_label(palette.warning, format!("The record ends before {time:.2} s: {}.", stop.reason));
    }
    for estimates in session.run().estimates() {
        let name = estimates.name();
        if let Some(stop) = estimates.stop() {
            let time = record.time_of(stop.sample);
            ui.colored_label(palette.warning, format!("{name} stopped at {time:.2} s: {}.", stop.reason));
        }
        if let Some(remark) = estimates.remarks().last() {
            let time = record.time_of(remark.sample);
            ui.weak(format!("{name} from {time:.2} s: {}.", remark.what));
        }
    }
    if let Some(problem) = session.problem() {
        ui.colored_label(palette.warning, problem);
    }
}

fn entry(ui: &mut Ui, name: &str, mark: Mark, color: Color32, on: bool) -> bool {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text_color = if on { ui.visuals().text_color() } else { ui.visuals().weak_text_color().gamma_multiply(0.6) };
    let galley = ui.painter().layout_no_wrap(name.to_owned(), font, text_color);
    let size = Vec2::new(galley.size().x + 26.0, 20.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, on, format!("Show {name}")));
    let color = if on { color } else { color.gamma_multiply(0.3) };
    let sample = egui::Rect::from_center_size(rect.left_center() + Vec2::new(10.0, 0.0), Vec2::new(20.0, 10.0));
    let painter = ui.painter();
    match mark {
        Mark::Line => {
            painter.hline(sample.x_range(), sample.center().y, Stroke::new(2.0, color));
        }
        Mark::Dots => {
            for (x, y) in [(0.2, 0.7), (0.5, 0.25), (0.8, 0.6)] {
                painter.circle_filled(sample.lerp_inside(egui::vec2(x, y)), 1.6, color);
            }
        }
        Mark::Band => {
            painter.rect_filled(sample, 2.0, color.gamma_multiply(0.25));
            painter.hline(sample.x_range(), sample.center().y, Stroke::new(2.0, color));
        }
    }
    painter.galley(egui::pos2(rect.left() + 26.0, rect.center().y - galley.size().y / 2.0), galley, text_color);
    if response.has_focus() {
        painter.rect_stroke(rect.expand(2.0), 3.0, ui.visuals().selection.stroke, StrokeKind::Outside);
    }
    response.on_hover_text(if on { "Click to hide" } else { "Click to show" }).clicked()
}
