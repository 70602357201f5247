//! The sensors and their noise.

use egui::{Button, Checkbox, ComboBox, Ui};
use kalmanscope_core::scenario::{Fault, FaultNumber, MAX_SENSORS};
use kalmanscope_core::{Quantity, Scenario, Sensor};
use kalmanscope_lab::next_sensor::measurable;

use super::Edits;
use super::highlight::highlight_ui;
use super::number::NumberField;
use crate::text::sentence;
use crate::widgets::named;

const FEW: usize = 12;

fn is_measured(scenario: &Scenario, quantity: Quantity) -> bool {
    scenario.sensors.iter().any(|sensor| sensor.measures == quantity)
}

pub(super) fn sensors_ui(ui: &mut Ui, edits: &mut Edits<'_>) {
    let scenario = edits.scenario;
    let full = scenario.sensors.len() >= MAX_SENSORS;
    let offered = measurable(scenario);
    ui.horizontal_wrapped(|ui| {
        // A chain has too many quantities to show all; those without a sensor are in a list.
        let shown = offered.iter().filter(|quantity| offered.len() <= FEW || is_measured(scenario, **quantity));
        for &quantity in shown.collect::<Vec<_>>() {
            let mut measured = is_measured(scenario, quantity);
            let enabled = measured || !full;
            if ui.add_enabled(enabled, Checkbox::new(&mut measured, quantity.key())).changed() {
                if measured {
                    edits.change.put_sensor(Sensor::new(quantity, usual_noise(quantity)));
                } else {
                    edits.change.remove_sensor(quantity);
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
            named(combo.response, "Add a sensor");
            if let Some(quantity) = chosen {
                edits.change.put_sensor(Sensor::new(quantity, usual_noise(quantity)));
            }
        }
    });
    for sensor in &scenario.sensors {
        let quantity = sensor.measures;
        let label = format!("{} noise ± σ", quantity.symbol());
        let name = format!("Noise of the {} sensor", quantity.key());
        let number = NumberField {
            label: &label,
            name: name.as_str().into(),
            unit: quantity.unit(),
            range: (usual_noise(quantity) / 30.0, usual_noise(quantity) * 30.0),
            least: 0.0,
            logarithmic: true,
            hint: "True standard deviation of the sensor's noise; each filter has its own assumption among its settings",
        };
        let path = format!("sensors.{}.noise_std", quantity.key());
        let mut std = sensor.noise_std;
        highlight_ui(ui, &path, |ui| number.ui(ui, &mut std));
        edits.set_other(&path, sensor.noise_std, std);
        faults_ui(ui, sensor, edits);
    }
    if scenario.sensors.is_empty() {
        ui.add_space(2.0);
        ui.weak("Nothing is measured: the filters only predict.");
    }
}

fn usual_noise(quantity: Quantity) -> f64 {
    quantity.aspect().info().usual_noise
}

pub(super) fn faults_ui(ui: &mut Ui, sensor: &Sensor, edits: &mut Edits<'_>) {
    let quantity = sensor.measures;
    for fault in sensor.faults.families().collect::<Vec<_>>() {
        let info = fault.info();
        let gone = ui.horizontal(|ui| {
            ui.label(format!("{} {}", quantity.symbol(), info.name)).on_hover_text(sentence(info.description));
            let name = format!("Remove {} of the {} sensor", info.name, quantity.key());
            let remove = named(ui.add(Button::new("×").frame(false)).on_hover_text(&name), name);
            remove.clicked()
        });
        if gone.inner {
            let mut changed = *sensor;
            changed.faults.remove(fault);
            edits.change.put_sensor(changed);
            continue;
        }
        let numbers = sensor.faults.numbers(fault).unwrap_or_default();
        for (number, value) in info.numbers.iter().zip(numbers) {
            number_ui(ui, (sensor.measures, fault, number), *value, edits);
        }
    }
    let offered: Vec<Fault> = Fault::ALL.into_iter().filter(|fault| sensor.faults.numbers(*fault).is_none()).collect();
    let words = format!("{} faults", quantity.symbol());
    let mut chosen = None;
    let combo = ComboBox::from_id_salt(&words).selected_text(format!("Add a fault of {}", quantity.symbol())).show_ui(
        ui,
        |ui| {
            for fault in offered {
                let option = ui.selectable_value(&mut chosen, Some(fault), fault.info().name);
                option.on_hover_text(sentence(fault.info().description));
            }
        },
    );
    let name = format!("Add a fault of the {} sensor", quantity.key());
    named(combo.response, name);
    if let Some(fault) = chosen {
        let mut changed = *sensor;
        changed.faults.add(fault, quantity);
        edits.change.put_sensor(changed);
    }
}

fn number_ui(ui: &mut Ui, (quantity, fault, info): (Quantity, Fault, &FaultNumber), value: f64, edits: &mut Edits<'_>) {
    let path = fault.address(quantity, info);
    let name = format!("{} of the {} sensor", sentence(info.name), quantity.key());
    let size = info.scale.size(quantity);
    let number = NumberField {
        label: info.key,
        name: super::number::Named { text: &name, key: &path },
        unit: info.scale.unit(quantity),
        range: (info.slider.0 * size, info.slider.1 * size),
        least: info.allowed.least(),
        logarithmic: false,
        hint: fault.info().description,
    };
    let mut now = value;
    highlight_ui(ui, &path, |ui| number.ui(ui, &mut now));
    edits.set_other(&path, value, if info.allowed.is_whole() { now.round() } else { now });
}
