//! The line above the charts: seeds, parameter, and the progress.

use egui::{ComboBox, DragValue, Ui};

use super::{curves, population};
use crate::laboratory::{SEEDS, Seeds};
use crate::menu::{Closing, menu_ui};
use crate::request::Request;
use crate::view::ViewContext;

const USUAL: [usize; 4] = [100, 1000, 3000, 10_000];

pub(super) fn head_ui(ui: &mut Ui, context: &ViewContext<'_>, seeds: &Seeds, requests: &mut Vec<Request>) {
    let mut next = seeds.choice;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        let speed = (0.02 * next.seeds as f64).max(0.2);
        let number = ui.add(DragValue::new(&mut next.seeds).range(SEEDS).speed(speed).update_while_editing(false));
        let hint = "Runs with the seeds 1 up to this number: other noise each time";
        let number = number.on_hover_text(hint);
        number.ctx.accesskit_node_builder(number.id, |node| node.set_label("Seeds"));
        ui.weak("seeds");
        let button = menu_ui(ui, "…", Closing::AtOnce, |ui| {
            for count in USUAL {
                if ui.button(format!("{count} seeds")).clicked() {
                    next.seeds = count;
                }
            }
        });
        button.on_hover_text("Usual numbers of seeds");
        population::population_ui(ui, context, requests);
        if let Some(runs) = seeds.shown() {
            let curves = curves::of(ui.ctx(), seeds, runs, context);
            if let Some(shown) = curves.parameter {
                let combo = ComboBox::from_id_salt("parameter of the errors").selected_text(shown.symbol()).width(58.0);
                let combo = combo.show_ui(ui, |ui| {
                    for &channel in &curves.parameters {
                        if ui
                            .selectable_label(channel == shown, format!("{}, {}", channel.symbol(), channel.name()))
                            .clicked()
                        {
                            next.parameter = Some(channel);
                        }
                    }
                });
                ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Parameter of the errors"));
            }
        }
        let hint = "The verdict on each run too, which takes longer than the runs";
        let mut verdicts = next.verdicts || next.causes;
        if ui.checkbox(&mut verdicts, "verdicts").on_hover_text(hint).changed() {
            (next.verdicts, next.causes) = (verdicts, false);
        }
        let hint = "The first cause of each bad verdict too, which takes up to seconds a run";
        if ui.checkbox(&mut next.causes, "causes").on_hover_text(hint).changed() {
            next.verdicts |= next.causes;
        }
        if let Some([done, all]) = seeds.progress() {
            let is_stopped = seeds.state.is_stopped;
            if ui.button(if is_stopped { "Go on" } else { "Stop" }).clicked() {
                requests.push(Request::RunSeeds(is_stopped));
            }
            ui.weak(format!("{done} of {all}"));
        }
    });
    if next != seeds.choice {
        requests.push(Request::ChooseSeeds(next));
    }
}
