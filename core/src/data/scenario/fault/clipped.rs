//! Readings beyond a limit are at the limit.

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;

pub(super) static CLIPPED: FaultInfo = FaultInfo {
    key: "clipped",
    name: "clipping",
    description: "readings beyond ± a limit are at the limit",
    numbers: &[FaultNumber {
        key: "limit",
        name: "limit",
        scale: Scale::Unit,
        usual: 10.0,
        slider: (1.0, 100.0),
        allowed: Allowed::AtLeast(0.0),
    }],
    sentence: "The @ sensor reads no more than ±{}",
    act: |numbers, _| Box::new(Clipped(numbers[0])),
};

struct Clipped(f64);

impl Act for Clipped {
    fn reading(&mut self, reading: f64, _: &Moment) -> f64 {
        // NaN stays.
        if reading.abs() > self.0 { libm::copysign(self.0, reading) } else { reading }
    }
}
