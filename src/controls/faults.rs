//! Faults of a sensor, besides white noise.

use egui::{Button, ComboBox, Ui};
use kalmanscope_core::Sensor;
use kalmanscope_core::scenario::{Fault, FaultNumber};

use super::lit::lit;
use super::number::Number;
use crate::text::sentence;

pub(super) fn faults_ui(ui: &mut Ui, sensor: &mut Sensor) {
    let quantity = sensor.measures;
    for fault in sensor.faults.families().collect::<Vec<_>>() {
        let info = fault.info();
        let gone = ui.horizontal(|ui| {
            ui.label(format!("{} {}", quantity.symbol(), info.name)).on_hover_text(sentence(info.description));
            let name = format!("Remove {} of the {} sensor", info.name, quantity.key());
            let remove = ui.add(Button::new("×").frame(false)).on_hover_text(&name);
            remove.ctx.accesskit_node_builder(remove.id, |node| node.set_label(name));
            remove.clicked()
        });
        if gone.inner {
            sensor.faults.remove(fault);
            continue;
        }
        let numbers = sensor.faults.numbers_mut(fault).unwrap_or_default();
        for (number, value) in info.numbers.iter().zip(numbers) {
            number_ui(ui, sensor.measures, fault, number, value);
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
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(name));
    if let Some(fault) = chosen {
        sensor.faults.add(fault, quantity);
    }
}

fn number_ui(
    ui: &mut Ui,
    quantity: kalmanscope_core::Quantity,
    fault: Fault,
    info: &'static FaultNumber,
    value: &mut f64,
) {
    let path = fault.address(quantity, info);
    let name = format!("{} of the {} sensor", sentence(info.name), quantity.key());
    let size = info.scale.size(quantity);
    let number = Number {
        label: info.key,
        name: super::number::Named { text: &name, key: &path },
        unit: info.scale.unit(quantity),
        range: (info.slider.0 * size, info.slider.1 * size),
        least: info.allowed.least(),
        logarithmic: false,
        hint: fault.info().description,
    };
    lit(ui, &path, |ui| number.show(ui, value));
    if info.allowed.is_whole() {
        *value = value.round();
    }
}
