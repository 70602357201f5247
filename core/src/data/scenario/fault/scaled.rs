//! Another scale than that which was thought, or another sign.

use super::{Act, FaultInfo, FaultNumber, Scale};
use crate::data::setting::Allowed;

pub(super) static SCALED: FaultInfo = FaultInfo {
    key: "scaled",
    name: "wrong scale",
    description: "reads so many times what it should; a negative factor is a wrong sign",
    numbers: &[FaultNumber {
        key: "factor",
        name: "factor",
        scale: Scale::Pure,
        usual: 1.2,
        slider: (-2.0, 2.0),
        allowed: Allowed::Finite,
    }],
    sentence: "The @ sensor reads {} times what it should",
    act: |numbers, _| Box::new(Scaled(numbers[0])),
};

struct Scaled(f64);

impl Act for Scaled {
    fn exact(&mut self, exact: f64) -> f64 {
        self.0 * exact
    }
}
