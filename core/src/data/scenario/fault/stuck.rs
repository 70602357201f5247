//! A reading that is told again and again.

use super::spells::{NUMBERS, Spells};
use super::{Act, FaultInfo, Moment};

pub(super) static STUCK: FaultInfo = FaultInfo {
    key: "stuck",
    name: "sticking",
    description: "for a share of the time the sensor tells its last reading again, in spells of a mean length",
    numbers: &NUMBERS,
    sentence: "For a share of {} of the time the @ sensor sticks, for {} on average",
    act: |numbers, random| Box::new(Stuck { spells: Spells::new(numbers[0], numbers[1], random), last: f64::NAN }),
};

struct Stuck {
    spells: Spells,
    last: f64,
}

impl Act for Stuck {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        if !self.spells.next(moment.dt) || self.last.is_nan() {
            self.last = reading;
        }
        self.last
    }
}
