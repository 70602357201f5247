//! One number: a label with symbol and unit, a slider and a field to type in.

use egui::{DragValue, Id, Rect, Response, Slider, SliderClamping, Ui, Vec2, Widget as _};

use crate::text::{parse, significant};

/// Width of the labels, so that all sliders stand in one line \[points\].
const LABEL_WIDTH: f32 = 112.0;
/// Width of the field with the value \[points\].
const FIELD_WIDTH: f32 = 62.0;
/// Width of the units \[points\].
const UNIT_WIDTH: f32 = 36.0;

/// What a number is and may be.
#[derive(Clone, Copy, Debug)]
pub struct Number<'a> {
    /// Name on screen.
    pub label: &'a str,
    /// Name that is unique on screen, for those who cannot see where it stands.
    pub name: &'a str,
    /// Unit, empty for a pure number.
    pub unit: &'a str,
    /// Ends of the slider.
    pub range: (f64, f64),
    /// The least that may be typed.
    pub least: f64,
    /// Whether equal steps of the slider are equal factors.
    pub logarithmic: bool,
    /// What it means.
    pub hint: &'a str,
}

impl Number<'_> {
    /// Shows a row with the number.
    pub fn show(&self, ui: &mut Ui, value: &mut f64) {
        let Self { label, name, unit, range: (low, high), least, logarithmic, hint } = *self;
        ui.horizontal(|ui| {
            fixed_width(ui, LABEL_WIDTH, |ui| {
                ui.add(egui::Label::new(label).truncate()).on_hover_text(hint);
            });
            let spacing = ui.spacing().item_spacing.x;
            let rail = (ui.available_width() - FIELD_WIDTH - UNIT_WIDTH - 2.0 * spacing).max(40.0);
            ui.spacing_mut().slider_width = rail;
            let slider = Slider::new(value, low..=high)
                .logarithmic(logarithmic)
                .smallest_positive(smallest(low, high))
                .clamping(SliderClamping::Never)
                .show_value(false)
                .ui(ui)
                .on_hover_text(hint);
            announce(&slider, name);
            remember(ui, name, slider.rect);
            let field =
                ui.add_sized(Vec2::new(FIELD_WIDTH, ui.spacing().interact_size.y), drag_value(value, low, high));
            announce(&field, &format!("{name}, value"));
            ui.weak(unit);
        });
        *value = value.max(least);
    }
}

/// A compact number in a table: only a field to drag or type in.
pub fn field(ui: &mut Ui, value: &mut f64, least: f64, scale: f64, name: &str, hint: &str) {
    let width = ui.available_width();
    let height = ui.spacing().interact_size.y;
    let field = ui.add_sized(Vec2::new(width, height), drag_value(value, 0.0, scale)).on_hover_text(hint);
    announce(&field, name);
    remember(ui, name, field.rect);
    *value = value.max(least);
}

/// Where the control of this name was drawn in the last frame.
pub fn rect_of(ctx: &egui::Context, name: &str) -> Option<Rect> {
    ctx.data(|data| data.get_temp(rect_id(name)))
}

fn drag_value(value: &mut f64, low: f64, high: f64) -> DragValue<'_> {
    // A drag moves small values finely and large ones coarsely.
    let speed = 0.01 * value.abs().max(smallest(low, high));
    DragValue::new(value)
        .speed(speed)
        .custom_formatter(|x, _| significant(x, 5))
        .custom_parser(parse)
        .update_while_editing(false)
}

fn smallest(low: f64, high: f64) -> f64 {
    if low > 0.0 { low } else { high * 1e-5 }
}

fn fixed_width(ui: &mut Ui, width: f32, add_contents: impl FnOnce(&mut Ui)) {
    let size = Vec2::new(width, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_min_width(width);
        add_contents(ui);
    });
}

fn announce(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

pub(crate) fn remember(ui: &Ui, name: &str, rect: Rect) {
    ui.data_mut(|data| data.insert_temp(rect_id(name), rect));
}

fn rect_id(name: &str) -> Id {
    Id::unique(("control", name))
}
