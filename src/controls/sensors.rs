//! Which quantities are measured, and how noisily.

use egui::{Checkbox, Ui};
use kalmanscope_core::quantity::{Aspect, MAX_SENSORS};
use kalmanscope_core::{Quantity, Scenario, Sensor};

use super::number::Number;

pub(super) fn sensors_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let full = scenario.sensors.len() >= MAX_SENSORS;
    ui.horizontal_wrapped(|ui| {
        for quantity in scenario.plant.kind.quantities() {
            let mut measured = scenario.sensors.iter().any(|s| s.measures == quantity);
            let enabled = measured || !full;
            if ui.add_enabled(enabled, Checkbox::new(&mut measured, quantity.key())).changed() {
                if measured {
                    scenario.add_sensor(Sensor { measures: quantity, noise_std: usual_noise(quantity) });
                } else {
                    scenario.remove_sensor(quantity);
                }
            }
        }
    });
    for sensor in &mut scenario.sensors {
        let quantity = sensor.measures;
        let label = format!("{} noise ± σ", quantity.symbol());
        let name = format!("Noise of the {} sensor", quantity.key());
        Number {
            label: &label,
            name: &name,
            unit: quantity.unit(),
            range: noise_range(quantity),
            least: 0.0,
            logarithmic: true,
            hint: "True standard deviation of the sensor's noise; what each filter assumes is set with the filter",
        }
        .show(ui, &mut sensor.noise_std);
    }
    if scenario.sensors.is_empty() {
        ui.add_space(2.0);
        ui.weak("Nothing is measured: the filters only predict.");
    }
}

const fn usual_noise(quantity: Quantity) -> f64 {
    match quantity.aspect() {
        Aspect::Displacement => 0.01,
        Aspect::Velocity => 0.06,
        Aspect::Acceleration => 0.3,
    }
}

/// Three decades around the usual.
fn noise_range(quantity: Quantity) -> (f64, f64) {
    let usual = usual_noise(quantity);
    (usual / 30.0, usual * 30.0)
}
