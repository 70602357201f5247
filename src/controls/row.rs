//! The control of a setting, from its row.

use egui::{Align, Checkbox, ComboBox, DragValue, Layout, PopupCloseBehavior, Ui};
use kalmanscope_core::setting::{Allowed, ChoiceInfo, Edit, SettingInfo};
use kalmanscope_core::{FilterSettings, Scenario};

use super::Edits;
use super::highlight::highlight_ui;
use super::number::{Named, NumberField};
use crate::text::sentence;
use crate::widgets::named;

pub(super) fn filter_row_ui(
    ui: &mut Ui,
    info: &SettingInfo<FilterSettings>,
    filter: &FilterSettings,
    edits: &mut Edits<'_>,
) {
    let key = filter.address(info.key);
    let label = (info.label)(filter).unwrap_or(info.name);
    let serves = (info.serves)(filter, &edits.scenario.plant.kind);
    let mut value = (info.get)(filter);
    if info.allowed == Allowed::Flag && !serves {
        value = 0.0;
    }
    let name = match info.allowed {
        Allowed::Flag => format!("{}: {label}", filter.name),
        Allowed::Whole(..) => format!("{} {label}", filter.name),
        _ => format!("{} {}", filter.name, info.name),
    };
    ui.add_enabled_ui(serves, |ui| {
        highlight_ui(ui, &key, |ui| control_ui(ui, info, label, Named { text: &name, key: &key }, &mut value));
    });
    edits.set_other(&key, (info.get)(filter), value);
}

pub(super) fn scenario_row_ui(ui: &mut Ui, info: &SettingInfo<Scenario>, edits: &mut Edits<'_>) {
    let value = scenario_number_ui(ui, info, edits.scenario, info.allowed.least());
    edits.set_other(info.key, (info.get)(edits.scenario), value);
}

pub(super) fn scenario_number_ui(ui: &mut Ui, info: &SettingInfo<Scenario>, scenario: &Scenario, least: f64) -> f64 {
    let (label, name) = ((info.label)(scenario).unwrap_or(info.name), sentence(info.name));
    let mut value = (info.get)(scenario);
    let number = NumberField { least, ..NumberField::of(info, label, name.as_str().into()) };
    highlight_ui(ui, info.key, |ui| number.ui(ui, &mut value));
    value
}

pub(super) fn choice_row_ui<T>(
    ui: &mut Ui,
    info: &ChoiceInfo<T>,
    (of, key): (&T, &str),
    name: &str,
    edits: &mut Edits<'_>,
) {
    let (options, now) = ((info.options)(), (info.get)(of));
    let mut chosen = now;
    let summary = options.get(now).map_or("", |option| option.name);
    list_ui(ui, (info.label, info.hint), summary, name, PopupCloseBehavior::CloseOnClick, &mut |ui| {
        for (place, option) in options.iter().enumerate() {
            let label = ui.selectable_value(&mut chosen, place, option.name);
            if !option.hint.is_empty() {
                label.on_hover_text(option.hint);
            }
        }
    });
    if chosen != now {
        edits.change.edit(Edit::new(key, (info.value)(chosen)));
    }
}

pub(super) fn list_ui(
    ui: &mut Ui,
    (label, hint): (&str, &str),
    summary: &str,
    name: &str,
    closes: PopupCloseBehavior,
    list: &mut dyn FnMut(&mut Ui),
) {
    ui.horizontal(|ui| {
        ui.label(label).on_hover_text(hint);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let combo = ComboBox::from_id_salt(name).selected_text(summary).width(140.0).close_behavior(closes);
            let combo = combo.show_ui(ui, |ui| list(ui));
            named(combo.response, name);
        });
    });
}

fn control_ui<T>(ui: &mut Ui, info: &SettingInfo<T>, label: &str, name: Named<'_>, value: &mut f64) {
    let (low, high) = info.slider;
    let control = match info.allowed {
        Allowed::Flag => {
            let mut is_on = *value != 0.0;
            let control = ui.add(Checkbox::new(&mut is_on, label));
            *value = f64::from(u8::from(is_on));
            control
        }
        Allowed::Whole(..) => {
            let mut whole = *value as i64;
            // A number from a file beyond the range stays until it is dragged.
            let field = DragValue::new(&mut whole).range(low as i64..=high as i64).clamp_existing_to_range(false);
            let row = ui.horizontal(|ui| {
                ui.label(label).on_hover_text(info.hint);
                ui.add(field)
            });
            *value = whole as f64;
            row.inner
        }
        _ => return NumberField::of(info, label, name).ui(ui, value),
    };
    named(control, name.text).on_hover_text(info.hint);
}
