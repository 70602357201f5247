//! Noise whose size changes.

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;

pub(super) static CHANGING: FaultInfo = FaultInfo {
    key: "changing",
    name: "changing noise",
    description: "noise of another size from a time on",
    numbers: &[
        FaultNumber {
            key: "at",
            name: "time of the change",
            scale: Scale::Seconds,
            usual: 20.0,
            slider: (0.0, 60.0),
            allowed: Allowed::Finite,
        },
        FaultNumber {
            key: "factor",
            name: "factor on the noise",
            scale: Scale::Pure,
            usual: 5.0,
            slider: (0.1, 30.0),
            allowed: Allowed::AtLeast(0.0),
        },
    ],
    sentence: "From {} on the noise of the @ sensor is {} times as large",
    act: |numbers, _| Box::new(Changing { at: numbers[0], factor: numbers[1] }),
};

struct Changing {
    at: f64,
    factor: f64,
}

impl Act for Changing {
    fn noise(&mut self, noise: f64, moment: &Moment) -> f64 {
        if moment.time >= self.at { self.factor * noise } else { noise }
    }
}
