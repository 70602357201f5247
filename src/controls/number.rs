//! One number: a label with symbol and unit, a slider and a field to drag, scroll or type in.

use egui::{
    Align, DragValue, Id, Layout, PointerButton, Response, Slider, SliderClamping, Stroke, Ui, Vec2, Widget as _, lerp,
};

use kalmanscope_core::setting::SettingInfo;

use crate::probe::remember;
use crate::text::{in_hertz, parse, significant};
use crate::widgets::{hover_text, named};

const LABEL_WIDTH: f32 = 100.0;
/// The distance of a remark below a number from the left, that of the slider \[points\].
pub(super) const REMARK: f32 = LABEL_WIDTH + 7.0;
const FIELD_WIDTH: f32 = 58.0;
const UNIT_WIDTH: f32 = 36.0;

const DECADES: f64 = 5.0;

#[derive(Clone, Copy, Debug)]
pub struct Named<'a> {
    pub text: &'a str,
    /// The key: the setting's address where the name has that of a filter, which may change.
    pub key: &'a str,
}

impl<'a> From<&'a str> for Named<'a> {
    fn from(text: &'a str) -> Self {
        Self { text, key: text }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct NumberField<'a> {
    pub label: &'a str,
    pub name: Named<'a>,
    pub unit: &'a str,
    pub range: (f64, f64),
    pub least: f64,
    pub logarithmic: bool,
    pub hint: &'a str,
}

impl<'a> NumberField<'a> {
    pub(super) fn of<T>(info: &'a SettingInfo<T>, label: &'a str, name: Named<'a>) -> Self {
        let SettingInfo { unit, allowed, slider, is_logarithmic, hint, .. } = *info;
        Self { label, name, unit, range: slider, least: allowed.least(), logarithmic: is_logarithmic, hint }
    }

    pub fn ui(&self, ui: &mut Ui, value: &mut f64) {
        let Self { label, name, unit, range: (low, high), least, logarithmic, hint } = *self;
        let Named { text, key } = name;
        let initial = initial(ui, key, *value);
        ui.horizontal(|ui| {
            let size = Vec2::new(LABEL_WIDTH, ui.spacing().interact_size.y);
            ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                ui.set_min_width(LABEL_WIDTH);
                let changed = *value != initial;
                let label = ui.add(egui::Label::new(label).truncate()).on_hover_text(hint);
                if changed {
                    // A bar marks a changed number.
                    let x = label.rect.left() - 5.0;
                    ui.painter().vline(x, label.rect.y_range(), Stroke::new(2.0, ui.visuals().selection.bg_fill));
                }
            });
            let spacing = ui.spacing().item_spacing.x;
            let rail = (ui.available_width() - FIELD_WIDTH - UNIT_WIDTH - 2.0 * spacing).max(40.0);
            ui.spacing_mut().slider_width = rail;
            let slider = Slider::new(value, low..=high)
                .logarithmic(logarithmic)
                .smallest_positive(smallest(low, high))
                // A number of a file may lie beyond the slider: showing it must not change it.
                .clamping(SliderClamping::Never)
                .show_value(false)
                .ui(ui);
            let slider = hover_text(slider, &|| format!("{hint}\nDouble click: back to {}", significant(initial, 5)));
            let slider = named(slider, text);
            remember(ui.ctx(), text, slider.rect);
            reset(&slider, value, initial);
            let size = Vec2::new(FIELD_WIDTH, ui.spacing().interact_size.y);
            let field = hover_text(ui.add_sized(size, drag_value(value, low, high)), &|| usage(initial));
            let field = named(field, format!("{text}, value"));
            scroll(ui, &field, value, step(*value, low, high));
            reset(&field, value, initial);
            let label = ui.weak(unit);
            tell_hertz(label, *value, unit, "That is");
        });
        limit_ui(ui, value, least, f64::INFINITY, key, unit);
    }
}

pub(super) fn limit_ui(ui: &mut Ui, value: &mut f64, least: f64, most: f64, key: &str, unit: &str) {
    let id = Id::unique(("limited", key));
    let now = ui.input(|input| input.time);
    // Not `clamp`, which keeps NaN and panics where the limits are crossed.
    let limited = value.max(least).min(most);
    if *value != limited {
        let which = if *value < least { "at least" } else { "at most" };
        ui.data_mut(|data| data.insert_temp(id, (now, format!("{which} {} {unit}", significant(limited, 5)))));
        *value = limited;
    }
    if let Some((since, text)) =
        ui.data(|data| data.get_temp::<(f64, String)>(id)).filter(|(since, _)| now - since < SAID)
    {
        ui.horizontal(|ui| {
            ui.add_space(REMARK);
            ui.colored_label(ui.visuals().warn_fg_color, egui::RichText::new(text.trim_end()).small());
        });
        ui.ctx().request_repaint_after_secs((since + SAID - now) as f32);
    }
}

/// The time for which a correction is reported \[s\].
const SAID: f64 = 4.0;

pub fn field_ui<'a>(
    ui: &mut Ui,
    value: &mut f64,
    least: f64,
    scale: f64,
    name: impl Into<Named<'a>>,
    hint: &str,
) -> Response {
    let Named { text, key } = name.into();
    let initial = initial(ui, key, *value);
    let size = Vec2::new(ui.available_width(), ui.spacing().interact_size.y);
    let field = ui.add_sized(size, drag_value(value, 0.0, scale));
    let field = hover_text(field, &|| format!("{hint}\n{}", usage(initial)));
    let field = named(field, text);
    remember(ui.ctx(), text, field.rect);
    scroll(ui, &field, value, step(*value, 0.0, scale));
    reset(&field, value, initial);
    *value = value.max(least);
    field
}

pub fn std_field_ui(ui: &mut Ui, value: &mut f64, least: f64, scale: f64, name: Named<'_>, hint: &str) {
    let rect = field_ui(ui, value, least, scale, name, hint).rect;
    let share = 1.0 + (*value / scale).log10() / DECADES;
    if share > 0.0 {
        let rail = rect.x_range().shrink(3.0);
        let end = lerp(rail.min..=rail.max, share.min(1.0) as f32);
        let stroke =
            Stroke::new(2.0, ui.visuals().selection.bg_fill.gamma_multiply(if ui.is_enabled() { 0.8 } else { 0.3 }));
        ui.painter().hline(rail.min..=end, rect.bottom() - 2.0, stroke);
    }
}

pub(super) fn tell_hertz(response: Response, value: f64, unit: &str, words: &str) {
    if unit == "rad/s" {
        hover_text(response, &|| format!("{words} {}", in_hertz(value, unit).unwrap_or_default()));
    }
}

pub fn begin_anew(ctx: &egui::Context) {
    // A count in the keys, since the names of all numbers on screen are not known here.
    ctx.data_mut(|data| *data.get_temp_mut_or_default::<u64>(Id::unique("numbers' beginning")) += 1);
}

fn initial(ui: &Ui, key: &str, value: f64) -> f64 {
    ui.data_mut(|data| {
        let beginning: u64 = data.get_temp(Id::unique("numbers' beginning")).unwrap_or_default();
        *data.get_temp_mut_or_insert_with(Id::unique(("initial", beginning, key)), || value)
    })
}

fn reset(control: &Response, value: &mut f64, initial: f64) {
    let twice = control.ctx.input(|input| input.pointer.button_double_clicked(PointerButton::Primary));
    if twice && control.enabled() && control.contains_pointer() {
        *value = initial;
        control.surrender_focus();
    }
}

/// The wheel changes the number that is being edited, or with Alt the one under the pointer; else it scrolls the page.
fn scroll(ui: &Ui, field: &Response, value: &mut f64, step: f64) {
    if !field.enabled() || !field.contains_pointer() {
        return;
    }
    let typing = field.has_focus();
    let turned = ui.input_mut(|input| {
        // The turn of the wheel is taken, so that the panel does not scroll with it.
        let wanted = typing || input.modifiers.alt;
        if wanted { std::mem::take(&mut input.smooth_scroll_delta).y } else { 0.0 }
    });
    if turned != 0.0 {
        *value += f64::from(turned) * 0.2 * step;
    }
}

fn usage(initial: f64) -> String {
    format!("Drag, Alt and wheel, or click to type. Double click: back to {}", significant(initial, 5))
}

fn drag_value(value: &mut f64, low: f64, high: f64) -> DragValue<'_> {
    let speed = step(*value, low, high);
    DragValue::new(value)
        .speed(speed)
        .custom_formatter(|x, _| significant(x, 5))
        .custom_parser(parse)
        // Each digit that is typed would begin a run: 1, then 12, then 120.
        .update_while_editing(false)
}

/// The change per point of dragging, proportional to the value, so that a long drag spans decades.
fn step(value: f64, low: f64, high: f64) -> f64 {
    0.01 * value.abs().max(smallest(low, high))
}

fn smallest(low: f64, high: f64) -> f64 {
    if low > 0.0 { low } else { high * 1e-5 }
}
