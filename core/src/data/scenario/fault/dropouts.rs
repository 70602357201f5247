//! Readings that are missing.

use super::spells::{NUMBERS, Spells};
use super::{Act, FaultInfo, Moment};

pub(super) static DROPOUTS: FaultInfo = FaultInfo {
    key: "dropouts",
    name: "dropouts",
    description: "a share of the readings is missing, in spells of a mean length; 0 s makes each independent of the others",
    numbers: &NUMBERS,
    sentence: "A share of {} of the @ readings is missing, for {} on average",
    act: |numbers, random| Box::new(Dropouts(Spells::new(numbers[0], numbers[1], random))),
};

struct Dropouts(Spells);

impl Act for Dropouts {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        if self.0.next(moment.dt) { f64::NAN } else { reading }
    }
}
