//! The settings that the story of the run names: a few sliders, each as wide as the panel.

use egui::{Align, DragValue, Label, Layout, Slider, SliderClamping, Ui, Widget as _};
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::Address;
use kalmanscope_diagnosis::{Adjustable, Phrase, Story};

use super::Edits;
use crate::probe::remember;
use crate::text::{parse, sentence};
use crate::widgets::named;

const APART: f32 = 8.0;

pub(super) fn named_ui(ui: &mut Ui, edits: &mut Edits<'_>, story: &Story) -> bool {
    let scenario = edits.scenario;
    let mut shown: Vec<&str> = Vec::new();
    for setting in story.phrases().filter_map(Phrase::setting).chain(&story.aside) {
        let Ok(address) = Address::parse(scenario, &setting.address) else { continue };
        if shown.contains(&setting.address.as_str()) {
            continue;
        }
        shown.push(&setting.address);
        let name = name_of(scenario, setting, &address);
        if let Some(value) = setting_ui(ui, &setting.at(address.get(scenario)), &name) {
            edits.change.set_at(address, value);
        }
        ui.add_space(APART);
    }
    !shown.is_empty()
}

pub(crate) fn name_of(scenario: &Scenario, setting: &Adjustable, address: &Address) -> String {
    let name = setting.name().map_or_else(|| address.name.clone(), str::to_owned);
    let filter = scenario.filters.iter().find(|filter| setting.address.starts_with(&filter.address("")));
    let Some(filter) = filter else {
        let of_truth = address.channel.map(|channel| format!(" of true {}", channel.symbol())).unwrap_or_default();
        return sentence(name.strip_suffix(&of_truth).unwrap_or(&name));
    };
    let symbol = setting.address.rsplit('.').next().and_then(|key| kalmanscope_core::setting::symbol(scenario, key));
    let symbol = symbol.filter(|_| address.table.is_none());
    let name = symbol.map_or_else(|| sentence(&name), str::to_owned);
    if scenario.filters.len() > 1 { format!("{name} of {}", filter.name) } else { name }
}

pub(crate) fn first_number(text: &str) -> Option<f64> {
    text.split_whitespace().next().and_then(|number| parse(number.trim_end_matches('%')))
}

fn setting_ui(ui: &mut Ui, setting: &Adjustable, name: &str) -> Option<f64> {
    let (low, high) = setting.range;
    let mut shown = setting.shown;
    let row = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    let row = ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), |ui| {
        let of = setting.clone();
        let number =
            DragValue::new(&mut shown).range(low..=high).clamp_existing_to_range(false).speed((high - low) / 400.0);
        let number = number.custom_formatter(move |shown, _| of.showing(shown).to_string());
        let number = number.custom_parser(first_number);
        let field = named(ui.add(number), format!("{name}, value"));
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| ui.add(Label::new(name).truncate()));
        field
    });
    let field = row.inner;
    ui.spacing_mut().slider_width = ui.available_width();
    let slider = Slider::new(&mut shown, low..=high).clamping(SliderClamping::Never).show_value(false).ui(ui);
    let slider = named(slider, name);
    remember(ui.ctx(), name, slider.rect);
    (field.changed() || slider.changed()).then(|| setting.value(shown))
}

#[cfg(test)]
mod tests {
    use super::first_number;

    #[test]
    fn a_number_is_read_before_its_unit() {
        for (text, number) in
            [("36 %", Some(36.0)), ("75%", Some(75.0)), ("130 1/s²", Some(130.0)), ("x", None), ("", None)]
        {
            assert_eq!(first_number(text), number, "{text}");
        }
    }
}
