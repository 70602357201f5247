//! Readings in whole steps.

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;

pub(super) static QUANTISED: FaultInfo = FaultInfo {
    key: "quantised",
    name: "coarse steps",
    description: "readings are rounded to whole steps, as by a converter with few bits",
    numbers: &[FaultNumber {
        key: "step",
        name: "step",
        scale: Scale::Unit,
        usual: 5.0,
        slider: (0.1, 50.0),
        allowed: Allowed::Above(0.0),
    }],
    sentence: "The @ sensor reads in steps of {}",
    act: |numbers, _| Box::new(Quantised(numbers[0])),
};

struct Quantised(f64);

impl Act for Quantised {
    fn reading(&mut self, reading: f64, _: &Moment) -> f64 {
        let steps = libm::round(reading / self.0);
        // A step that is small beyond measure changes nothing.
        if steps.is_infinite() { reading } else { steps * self.0 }
    }
}
