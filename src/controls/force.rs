//! The input.

use egui::Ui;
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::{CHOICES_OF_SCENARIO, FORCE};

use super::row::{choice_row_ui, scenario_row_ui};
use crate::text::sentence;

pub(super) fn force_ui(ui: &mut Ui, scenario: &mut Scenario) {
    for info in CHOICES_OF_SCENARIO {
        choice_row_ui(ui, info, scenario, &sentence(info.name));
    }
    for info in &FORCE {
        if (info.serves)(scenario, scenario.plant.kind) {
            scenario_row_ui(ui, info, scenario, info.allowed.least());
        }
    }
}
