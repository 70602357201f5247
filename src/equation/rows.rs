//! The rows of an equation's parameters and internal states.

use egui::{Button, ComboBox, DragValue, Response, RichText, TextEdit, Ui, vec2};
use kalmanscope_core::equation::{AllowedSign, EquationSettings, Numbers, ParameterSettings, Symbol};

use crate::text::{parse, significant};

/// The widths of symbols, names, units, numbers and signs \[points\].
const WIDTHS: [f32; 5] = [40.0, 130.0, 56.0, 58.0, 110.0];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Done {
    pub(super) changed: bool,
    pub(super) accepted: bool,
}

pub(super) fn row_ui(ui: &mut Ui, symbol: &Symbol, settings: &mut EquationSettings, is_new: bool) -> Done {
    let shown = &symbol.shown;
    let mut done = Done::default();
    ui.horizontal_wrapped(|ui| {
        let height = ui.spacing().interact_size.y;
        let text = RichText::new(shown).size(15.0).strong();
        ui.add_sized(vec2(WIDTHS[0], height), egui::Label::new(text)).on_hover_text(&symbol.key);
        if let Some(channel) = symbol.known {
            let unit = Some(channel.unit()).filter(|unit| !unit.is_empty()).map(|unit| format!(" in {unit}"));
            ui.weak(format!("{}{}, as in all plants", channel.name(), unit.unwrap_or_default()));
            return;
        }
        let usual = ParameterSettings::default();
        let before = settings.parameter(&symbol.key).unwrap_or(&usual);
        let mut now = before.clone();
        if is_new {
            done.accepted = offer_ui(ui, shown, height);
        } else {
            done.changed = words_ui(ui, symbol, &mut now);
        }
        done.changed |= numbers_ui(ui, symbol, &mut now);
        let is_touched = now != *before;
        if is_touched || done.accepted {
            let one = settings.parameter_mut(&symbol.key);
            *one = now;
            if done.accepted {
                // A file then names it.
                one.guess.get_or_insert(1.0);
            }
        }
    });
    done
}

/// The button that makes a new symbol a parameter, in the place of name and unit. Returns whether it was clicked.
fn offer_ui(ui: &mut Ui, shown: &str, height: f32) -> bool {
    let width = WIDTHS[1] + WIDTHS[2] + ui.spacing().item_spacing.x;
    let button = ui.add_sized(vec2(width, height), Button::new("Make it a parameter"));
    label(&button, format!("Make {shown} a parameter"));
    button.clicked()
}

fn words_ui(ui: &mut Ui, symbol: &Symbol, one: &mut ParameterSettings) -> bool {
    let Symbol { shown, is_parameter, .. } = symbol;
    let mut name = one.name.clone().unwrap_or_default();
    let usual = if *is_parameter { "name" } else { "internal state" };
    let done = word_ui(ui, &mut name, usual, WIDTHS[1], format!("Name of {shown}"));
    one.name = Some(name).filter(|name| !name.is_empty());
    done | word_ui(ui, &mut one.unit, "unit", WIDTHS[2], format!("Unit of {shown}"))
}

fn numbers_ui(ui: &mut Ui, symbol: &Symbol, one: &mut ParameterSettings) -> bool {
    let Symbol { shown, is_parameter, .. } = symbol;
    let Numbers { mut mean, mut std, range: [mut low, mut high] } = one.numbers(*is_parameter);
    let mut done = false;
    let mut number = |ui: &mut Ui, word: &str, name: String, value: &mut f64| {
        ui.weak(word);
        let before = *value;
        done |= number_ui(ui, value, name);
        *value != before
    };
    if number(ui, "guess", format!("Guess of {shown}"), &mut mean) {
        one.guess = Some(mean);
    }
    if number(ui, "±", format!("σ of the guess of {shown}"), &mut std) {
        one.std = Some(std.max(0.0));
    }
    if *is_parameter {
        let from = number(ui, "from", format!("Least {shown}"), &mut low);
        if number(ui, "to", format!("Largest {shown}"), &mut high) | from {
            one.range = Some([low, high]);
        }
        done |= sign_ui(ui, &mut one.sign, shown);
    }
    done
}

fn word_ui(ui: &mut Ui, word: &mut String, hint: &str, width: f32, name: String) -> bool {
    let field = ui.add(TextEdit::singleline(word).hint_text(hint).desired_width(width).char_limit(40));
    label(&field, name);
    field.lost_focus()
}

/// A number. Returns whether its change is complete: not while it is dragged.
fn number_ui(ui: &mut Ui, value: &mut f64, name: String) -> bool {
    let speed = 0.01 * value.abs().max(0.1);
    let field = DragValue::new(value)
        .speed(speed)
        .custom_formatter(|x, _| significant(x, 5))
        .custom_parser(parse)
        .update_while_editing(false);
    let response = ui.add_sized(vec2(WIDTHS[3], ui.spacing().interact_size.y), field);
    label(&response, name);
    let is_at_once = response.changed() && !response.dragged() && !response.has_focus();
    response.drag_stopped() || response.lost_focus() || is_at_once
}

fn sign_ui(ui: &mut Ui, sign: &mut AllowedSign, shown: &str) -> bool {
    let before = *sign;
    let words = [
        (AllowedSign::Any, "any sign"),
        (AllowedSign::NotNegative, "not negative"),
        (AllowedSign::Positive, "positive"),
    ];
    let text = words.iter().find(|(one, _)| one == sign).map_or("", |(_, word)| word);
    let combo = ComboBox::from_id_salt(("sign", shown)).selected_text(text).width(WIDTHS[4]).show_ui(ui, |ui| {
        for (one, word) in words {
            ui.selectable_value(sign, one, word);
        }
    });
    label(&combo.response, format!("Sign of {shown}"));
    *sign != before
}

fn label(response: &Response, name: String) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}
