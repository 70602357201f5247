//! The less common settings of a filter: its plant, its propagation, logarithms, learning, the size of its ensemble.

use egui::{Checkbox, ComboBox, DragValue, Ui};
use kalmanscope_core::{Channel, FilterKind, FilterSettings, PlantKind, Propagation, Sensor, augment};

use super::lit::lit;

/// Limits the members of an ensemble to what a frame can compute.
const MOST_MEMBERS: usize = 2000;

/// Limits the guesses that filters run from side by side.
const MOST_GUESSES: usize = 8;

/// The less common settings of a filter.
pub(super) fn options_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: PlantKind, sensors: &[Sensor]) {
    egui::CollapsingHeader::new("Options").id_salt(("options", filter.id)).show_unindented(ui, |ui| {
        plant_ui(ui, filter);
        augment_ui(ui, filter, filter.plant.unwrap_or(truth), sensors);
        guesses_ui(ui, filter, filter.plant.unwrap_or(truth));
        if [FilterKind::KF, FilterKind::EKF, FilterKind::IEKF, FilterKind::RBPF].contains(&filter.kind) {
            lit(ui, &filter.address("propagation"), |ui| propagation_ui(ui, filter));
        }
        let FilterSettings {
            id, name, kind, log_parameters, substeps, iterations, ensemble_size, adaptation, smoother, guesses, ..
        } = filter;
        let hint = "Divide each prediction into so many steps: for plants that are not linear, and few samples a period";
        whole_ui(ui, "steps a sample", &format!("{name} steps a sample"), substeps, (1, 20), hint);
        if *kind == FilterKind::IEKF {
            let hint = "Limit of the linearisations of the sensors in one update";
            whole_ui(ui, "iterations", &format!("{name} iterations"), iterations, (1, 20), hint);
        }
        if kind.is_sampled() {
            let hint = "More are more exact, and slower";
            let label = if kind.info().has_own_likelihood { "particles" } else { "members" };
            lit(ui, &format!("filters#{id}.ensemble_size"), |ui| {
                whole_ui(ui, label, &format!("{name} {label}"), ensemble_size, (2, MOST_MEMBERS), hint);
            });
        }
        let check = |ui: &mut Ui, value: &mut bool, text: &str, hint: &str| {
            let response = ui.add(Checkbox::new(value, text)).on_hover_text(hint);
            response.ctx.accesskit_node_builder(response.id, |node| node.set_label(format!("{name}: {text}")));
        };
        let hint = "Estimate the logarithms of frequency, damping and stiffness, which then stay positive";
        check(ui, log_parameters, "logarithms of positive parameters", hint);
        *smoother &= !kind.is_sampled();
        if !kind.is_sampled() && *guesses == 1 {
            let hint = "In the whole record also show, dashed, what is known of each instant in the light of all that came \
                        after it: Rauch, Tung and Striebel (1965)";
            lit(ui, &format!("filters#{id}.smoother"), |ui| check(ui, smoother, "hindsight", hint));
        }
        lit(ui, &format!("filters#{id}.adaptation.sensor_noise"), |ui| {
            check(ui, &mut adaptation.sensor_noise, "learn R from the innovations", "Akhlaghi, Zhou and Huang (2017)");
        });
        check(ui, &mut adaptation.process_noise, "learn Q from the innovations", "Akhlaghi, Zhou and Huang (2017)");
    });
}

/// The guesses of ωₙ that filters begin from side by side, where ωₙ is estimated and no smoother needs a single filter.
fn guesses_ui(ui: &mut Ui, filter: &mut FilterSettings, plant: PlantKind) {
    let frequency = Channel::NATURAL_FREQUENCY;
    let is_guessed = plant.channels().contains(&frequency) && !filter.knows(frequency) && !filter.smoother;
    if !is_guessed || filter.initial_mean[frequency] <= 0.0 {
        filter.guesses = 1;
        return;
    }
    let FilterSettings { id, name, guesses, .. } = filter;
    let hint = "Filters side by side from so many guesses of ωₙ, from 0.14 to 7.4 times the initial mean; the likeliest so far \
                is shown";
    lit(ui, &format!("filters#{id}.guesses"), |ui| {
        whole_ui(ui, "guesses of ωₙ", &format!("{name} guesses"), guesses, (1, MOST_GUESSES), hint);
    });
}

/// The augmentations that the filter estimates.
fn augment_ui(ui: &mut Ui, filter: &mut FilterSettings, plant: PlantKind, sensors: &[Sensor]) {
    let FilterSettings { id, name, augment, .. } = filter;
    let biases = sensors.iter().map(|sensor| sensor.measures.bias());
    let offered: Vec<Channel> = augment::OF_INPUT.into_iter().chain(biases).collect();
    let summary = if augment.is_empty() {
        "nothing".to_owned()
    } else {
        augment.iter().map(|channel| channel.symbol()).collect::<Vec<_>>().join(", ")
    };
    let hint = "Properties of the input and the sensors that the filter estimates too: gain, offset, a force that \
         changes slowly (u) or is another one at each sample (w: wind, traffic), bias";
    ui.horizontal(|ui| {
        ui.label("estimates also").on_hover_text(hint);
        let combo = ComboBox::from_id_salt(("augment", *id)).selected_text(summary).show_ui(ui, |ui| {
            for channel in offered {
                let mut on = augment.contains(&channel);
                let text = format!("{} {}", channel.symbol(), channel.name());
                if ui.checkbox(&mut on, text).changed() {
                    augment.retain(|c| *c != channel);
                    augment.extend(on.then_some(channel));
                }
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("{name} augmentations")));
    });
    // A removed sensor's bias goes too, and so does that of a quantity that the plant lacks.
    augment.retain(|channel| augment::of(plant).any(|c| c == *channel));
}

fn plant_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    let FilterSettings { id, name, plant, .. } = filter;
    let text = |plant: Option<PlantKind>| plant.map_or("as the truth", PlantKind::name);
    ui.horizontal(|ui| {
        ui.label("its plant").on_hover_text("What the filter takes the truth for");
        let combo = ComboBox::from_id_salt(("plant", *id)).selected_text(text(*plant)).show_ui(ui, |ui| {
            for kind in std::iter::once(None).chain(PlantKind::ALL.map(Some)) {
                ui.selectable_value(plant, kind, text(kind));
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("{name} plant")));
    });
}

fn propagation_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    let FilterSettings { id, name, propagation, .. } = filter;
    let text = |propagation: Propagation| match propagation {
        Propagation::LocalLinearisation => "local linearisation",
        Propagation::RungeKutta => "Runge-Kutta",
        Propagation::Euler => "Euler",
    };
    ui.horizontal(|ui| {
        ui.label("its steps").on_hover_text("How the mean moves from sample to sample");
        let combo = ComboBox::from_id_salt(("steps", *id)).selected_text(text(*propagation)).show_ui(ui, |ui| {
            for way in Propagation::ALL {
                ui.selectable_value(propagation, way, text(way));
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("{name} steps")));
    });
}

fn whole_ui(ui: &mut Ui, label: &str, name: &str, value: &mut usize, (least, most): (usize, usize), hint: &str) {
    ui.horizontal(|ui| {
        ui.label(label).on_hover_text(hint);
        let field = ui.add(DragValue::new(value).range(least..=most)).on_hover_text(hint);
        field.ctx.accesskit_node_builder(field.id, |node| node.set_label(name.to_owned()));
    });
}
