//! A constant error.

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;

pub(super) static BIAS: FaultInfo = FaultInfo {
    key: "bias",
    name: "bias",
    description: "reads too much by a constant, as an accelerometer that feels gravity",
    numbers: &[FaultNumber {
        key: "offset",
        name: "bias",
        scale: Scale::Unit,
        usual: 5.0,
        slider: (-30.0, 30.0),
        allowed: Allowed::Finite,
    }],
    sentence: "The @ sensor reads {} too much",
    act: |numbers, _| Box::new(Bias(numbers[0])),
};

struct Bias(f64);

impl Act for Bias {
    fn reading(&mut self, reading: f64, _: &Moment) -> f64 {
        reading + self.0
    }
}
