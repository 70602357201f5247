//! Readings that are taken a little before or after the time that is told.

use super::{Act, FaultInfo, FaultNumber, Scale};
use crate::data::setting::Allowed;
use crate::mathematics::random::Normal;

pub(super) static JITTER: FaultInfo = FaultInfo {
    key: "jitter",
    name: "jitter",
    description: "each reading is taken at another time than is told: up to so many steps before or after, uniformly, along a \
                  parabola through the last three values",
    numbers: &[FaultNumber {
        key: "spread",
        name: "spread in steps",
        scale: Scale::Pure,
        usual: 0.5,
        slider: (0.0, 1.0),
        allowed: Allowed::Within(0.0, 1.0),
    }],
    sentence: "The @ sensor reads up to {} steps before or after the time that it tells",
    act: |numbers, random| Box::new(Jitter { spread: numbers[0], random, last: [None; 2] }),
};

struct Jitter {
    spread: f64,
    random: Normal,
    /// The value before the last one, and the last one.
    last: [Option<f64>; 2],
}

impl Act for Jitter {
    fn exact(&mut self, exact: f64) -> f64 {
        let shift = self.spread * (2.0 * self.random.uniform() - 1.0);
        let [before, last] = self.last;
        self.last = [last, Some(exact)];
        let slope = last.map_or(0.0, |last| exact - last);
        let curvature = last.zip(before).map_or(0.0, |(last, before)| exact - 2.0 * last + before);
        exact + shift * slope + 0.5 * shift * (shift + 1.0) * curvature
    }
}
