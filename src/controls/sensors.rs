//! The sensors and their noise.

use egui::{Checkbox, ComboBox, Ui};
use kalmanscope_core::scenario::MAX_SENSORS;
use kalmanscope_core::{Aspect, InputKind, Quantity, Scenario, Sensor};

use super::faults::faults_ui;
use super::lit::lit;
use super::number::Number;

/// Limits the quantities that are all shown with a check box.
const FEW: usize = 12;

fn is_measured(scenario: &Scenario, quantity: Quantity) -> bool {
    scenario.sensors.iter().any(|sensor| sensor.measures == quantity)
}

pub(super) fn sensors_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let full = scenario.sensors.len() >= MAX_SENSORS;
    let offered = offered(scenario);
    ui.horizontal_wrapped(|ui| {
        // A chain has too many quantities to show all; those without a sensor are in a list.
        let shown = offered.iter().filter(|quantity| offered.len() <= FEW || is_measured(scenario, **quantity));
        for &quantity in shown.collect::<Vec<_>>() {
            let mut measured = is_measured(scenario, quantity);
            let enabled = measured || !full;
            if ui.add_enabled(enabled, Checkbox::new(&mut measured, quantity.key())).changed() {
                if measured {
                    scenario.add_sensor(Sensor::new(quantity, usual_noise(quantity)));
                } else {
                    scenario.remove_sensor(quantity);
                }
            }
        }
        if offered.len() > FEW && !full {
            let mut chosen = None;
            let combo = ComboBox::from_id_salt("add sensor").selected_text("Add a sensor").show_ui(ui, |ui| {
                for &quantity in offered.iter().filter(|quantity| !is_measured(scenario, **quantity)) {
                    ui.selectable_value(&mut chosen, Some(quantity), quantity.key());
                }
            });
            ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Add a sensor"));
            if let Some(quantity) = chosen {
                scenario.add_sensor(Sensor::new(quantity, usual_noise(quantity)));
            }
        }
    });
    for sensor in &mut scenario.sensors {
        let quantity = sensor.measures;
        let label = format!("{} noise ± σ", quantity.symbol());
        let name = format!("Noise of the {} sensor", quantity.key());
        let number = Number {
            label: &label,
            name: (&name).into(),
            unit: quantity.unit(),
            range: noise_range(quantity),
            least: 0.0,
            logarithmic: true,
            hint: "True standard deviation of the sensor's noise; each filter has its own assumption among its settings",
        };
        let path = format!("sensors.{}.noise_std", quantity.key());
        lit(ui, &path, |ui| number.show(ui, &mut sensor.noise_std));
        faults_ui(ui, sensor);
    }
    if scenario.sensors.is_empty() {
        ui.add_space(2.0);
        ui.weak("Nothing is measured: the filters only predict.");
    }
}

fn usual_noise(quantity: Quantity) -> f64 {
    quantity.aspect().info().usual_noise
}

fn offered(scenario: &Scenario) -> Vec<Quantity> {
    let (kind, input) = (scenario.plant.kind, scenario.input);
    let is_told_apart = |quantity: &Quantity| match quantity.aspect() {
        aspect if aspect == Aspect::TOTAL_ACCELERATION => input == InputKind::GroundAcceleration,
        aspect if aspect == Aspect::DRIFT => quantity.mass() > 0,
        _ => true,
    };
    let measured = |quantity: &Quantity| scenario.sensors.iter().any(|sensor| sensor.measures == *quantity);
    kind.quantities().filter(|quantity| is_told_apart(quantity) || measured(quantity)).collect()
}

fn noise_range(quantity: Quantity) -> (f64, f64) {
    let usual = usual_noise(quantity);
    (usual / 30.0, usual * 30.0)
}
