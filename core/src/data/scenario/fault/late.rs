//! Readings that come late, with the time of their arrival.

use std::collections::VecDeque;

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;

/// Limits the delay, in samples.
const MOST_SAMPLES: f64 = 100_000.0;

pub(super) static LATE: FaultInfo = FaultInfo {
    key: "late",
    name: "late readings",
    description: "each reading is that of so many seconds before, to the nearest sample",
    numbers: &[FaultNumber {
        key: "delay",
        name: "delay",
        scale: Scale::Seconds,
        usual: 0.05,
        slider: (0.0, 1.0),
        allowed: Allowed::AtLeast(0.0),
    }],
    sentence: "The readings of the @ sensor come {} late",
    act: |numbers, _| Box::new(Late { delay: numbers[0], waiting: VecDeque::new() }),
};

struct Late {
    delay: f64,
    waiting: VecDeque<f64>,
}

impl Act for Late {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        let samples = libm::round(self.delay / moment.dt).min(MOST_SAMPLES) as usize;
        self.waiting.push_back(reading);
        if self.waiting.len() > samples { self.waiting.pop_front().unwrap_or(f64::NAN) } else { f64::NAN }
    }
}
