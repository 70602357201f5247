//! Which quantities are measured, and how noisily.

use egui::Ui;
use kalmanscope_core::{Quantity, Scenario, Sensor};

use super::number::Number;

pub(super) fn sensors_ui(ui: &mut Ui, scenario: &mut Scenario) {
    ui.horizontal(|ui| {
        for quantity in Quantity::ALL {
            let mut measured = scenario.sensors.iter().any(|s| s.measures == quantity);
            if ui.checkbox(&mut measured, quantity.key()).changed() {
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
    match quantity {
        Quantity::Displacement => 0.01,
        Quantity::Velocity => 0.06,
        Quantity::Acceleration => 0.3,
    }
}

/// Three decades around the usual.
fn noise_range(quantity: Quantity) -> (f64, f64) {
    let usual = usual_noise(quantity);
    (usual / 30.0, usual * 30.0)
}
