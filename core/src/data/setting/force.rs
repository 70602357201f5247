//! The numbers of the force of a simulation. Each serves where the force has its shape.

use super::Allowed;
use super::info::SettingInfo;
use crate::data::force::Force;
use crate::data::scenario::Scenario;

type Row = SettingInfo<Scenario>;

/// A row of a field of a shape, with its key and other data.
macro_rules! row {
    ($key:literal, $shape:ident.$field:ident, $($data:tt)*) => {
        SettingInfo {
            serves: |scenario, _| matches!(scenario.force, Force::$shape { .. }),
            hint: "The filters are told the force exactly",
            $($data)*
            ..SettingInfo::new(
                $key,
                |scenario| if let Force::$shape { $field, .. } = scenario.force { $field } else { f64::NAN },
                |scenario, value| {
                    if let Force::$shape { $field, .. } = &mut scenario.force {
                        *$field = value;
                    }
                },
            )
        }
    };
}

/// All numbers of all shapes.
pub static FORCE: [Row; 11] = [
    row! { "force.white_noise.std", WhiteNoise.std,
        name: "std of the force",
        label: |_| Some("± σ"),
        unit: "m/s²",
        allowed: Allowed::AtLeast(0.0),
        slider: (0.0, 50.0),
        is_varied: true,
    },
    row! { "force.sine.amplitude", Sine.amplitude,
        name: "amplitude of the force",
        label: |_| Some("amplitude"),
        unit: "m/s²",
        slider: (0.0, 50.0),
        is_varied: true,
    },
    row! { "force.sine.frequency", Sine.frequency,
        name: "frequency of the force",
        label: |_| Some("frequency"),
        unit: "rad/s",
        slider: (0.1, 30.0),
        is_varied: true,
    },
    row! { "force.chirp.amplitude", Chirp.amplitude,
        name: "amplitude of the force",
        label: |_| Some("amplitude"),
        unit: "m/s²",
        slider: (0.0, 50.0),
        is_varied: true,
    },
    row! { "force.chirp.from", Chirp.from,
        name: "first frequency of the force",
        label: |_| Some("from"),
        unit: "rad/s",
        slider: (0.1, 30.0),
    },
    row! { "force.chirp.to", Chirp.to,
        name: "last frequency of the force",
        label: |_| Some("to"),
        unit: "rad/s",
        slider: (0.1, 30.0),
    },
    row! { "force.chirp.sweep", Chirp.sweep,
        name: "time of a sweep",
        label: |_| Some("sweep time"),
        unit: "s",
        allowed: Allowed::Above(0.0),
        slider: (1.0, 60.0),
    },
    row! { "force.impulse_train.impulse", ImpulseTrain.impulse,
        name: "impulse of a blow",
        label: |_| Some("impulse"),
        unit: "m/s",
        slider: (0.0, 5.0),
        is_varied: true,
    },
    row! { "force.impulse_train.period", ImpulseTrain.period,
        name: "time between blows",
        label: |_| Some("every"),
        unit: "s",
        allowed: Allowed::Above(0.0),
        slider: (0.5, 30.0),
        is_varied: true,
    },
    row! { "force.step.amplitude", Step.amplitude,
        name: "amplitude of the force",
        label: |_| Some("amplitude"),
        unit: "m/s²",
        slider: (-50.0, 50.0),
        is_varied: true,
    },
    row! { "force.step.at", Step.at,
        name: "time of the force's step",
        label: |_| Some("at"),
        unit: "s",
        slider: (0.0, 60.0),
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setting::{Address, CHOICES_OF_SCENARIO};

    #[test]
    fn every_number_of_every_shape_is_read_and_set_at_its_address() {
        let shape = CHOICES_OF_SCENARIO.into_iter().find(|info| info.key == "force").unwrap();
        let mut found = 0;
        for place in 0..(shape.options)().len() {
            let mut scenario = Scenario::default();
            (shape.set)(&mut scenario, place);
            for info in &FORCE {
                let address = Address::parse(&scenario, info.key);
                assert_eq!(address.is_ok(), !(info.get)(&scenario).is_nan(), "{info:?} of {:?}", scenario.force);
                let Ok(address) = address else { continue };
                address.set(&mut scenario, 7.5);
                assert_eq!((address.get(&scenario), (info.get)(&scenario)), (7.5, 7.5), "{info:?}");
                found += 1;
            }
        }
        assert_eq!(found, FORCE.len(), "each serves in one shape");
    }
}
