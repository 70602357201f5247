//! The equation of a plant of one's own.

use egui::{Id, RichText, TextEdit, Ui};
use kalmanscope_core::equation::{Equation, EquationSettings};
use kalmanscope_core::{PlantKind, Scenario};

/// The equation that one begins with: the linear oscillator.
const FIRST: &str = "x'' + 2 ζ ωₙ x' + ωₙ² x = f";

/// Limits the characters of an equation.
const LENGTH: usize = 1000;

/// The name in the list of plants.
pub(super) const NAME: &str = "equation of your own";

/// The plant that one begins with.
pub(super) fn first() -> Option<PlantKind> {
    PlantKind::of_equation(&EquationSettings::new(FIRST)).ok()
}

/// A field for the equation, if the plant has one of its own. It is the plant's once it is left, or with Enter; a fault is said
/// below while it is typed.
pub(super) fn equation_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let Some(settings) = scenario.plant.kind.own_equation().map(Equation::settings) else { return };
    let id = Id::unique("equation of the plant");
    let draft: Option<String> = ui.data(|data| data.get_temp(id));
    let mut text = draft.unwrap_or_else(|| settings.equation.clone());
    let field = ui.add(
        TextEdit::multiline(&mut text).desired_width(f32::INFINITY).desired_rows(2).char_limit(LENGTH).return_key(None),
    );
    ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("Equation of motion"));
    let is_done = field.lost_focus() || field.has_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    let is_typed = field.has_focus() || field.changed();
    ui.data_mut(|data| {
        if is_typed {
            data.insert_temp(id, text.clone());
        } else {
            data.remove_temp::<String>(id);
        }
    });
    let typed = EquationSettings { equation: text.trim().to_owned(), parameters: settings.parameters.clone() };
    if typed.equation == settings.equation {
        hint_ui(ui);
        return;
    }
    match typed.checked() {
        // A parameter that is no longer there has no numbers.
        Ok(kept) if is_done => match PlantKind::of_equation(&kept) {
            Ok(kind) => scenario.set_plant(kind),
            Err(error) => fault_ui(ui, &error.to_string()),
        },
        Ok(_) => hint_ui(ui),
        Err(error) => fault_ui(ui, &error.to_string()),
    }
}

fn hint_ui(ui: &mut Ui) {
    let hint = "x'' or ẍ, z' = … for an internal state, f for the force over mass; every other name is a parameter; sin, cos, tan, \
                exp, log, sqrt, abs, sign, tanh; several equations are apart by ;";
    ui.label(RichText::new("Enter takes it").small().weak()).on_hover_text(hint);
}

fn fault_ui(ui: &mut Ui, fault: &str) {
    ui.colored_label(ui.visuals().warn_fg_color, RichText::new(fault).small());
}
