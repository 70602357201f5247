//! Readings that are far off.

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;
use crate::mathematics::random::Normal;

/// The numbers of both families: the share of the readings, and the least and the largest error.
const NUMBERS: [FaultNumber; 3] = [
    FaultNumber {
        key: "share",
        name: "share of outliers",
        scale: Scale::Pure,
        usual: 0.1,
        slider: (0.0, 0.5),
        allowed: Allowed::Within(0.0, 1.0),
    },
    FaultNumber {
        key: "from",
        name: "least outlier",
        scale: Scale::Sigma,
        usual: 10.0,
        slider: (0.0, 100.0),
        allowed: Allowed::AtLeast(0.0),
    },
    FaultNumber {
        key: "to",
        name: "largest outlier",
        scale: Scale::Sigma,
        usual: 30.0,
        slider: (0.0, 100.0),
        allowed: Allowed::AtLeast(0.0),
    },
];

pub(super) static OUTLIERS: FaultInfo = FaultInfo {
    key: "outliers",
    name: "outliers",
    description: "a share of the readings is off by some standard deviations, to either side",
    numbers: &NUMBERS,
    sentence: "A share of {} of the @ readings is off by {} to {}",
    act: |numbers, random| Box::new(Outliers { numbers: *numbers, is_one_sided: false, random }),
};

pub(super) static OUTLIERS_ABOVE: FaultInfo = FaultInfo {
    key: "outliers_above",
    name: "outliers upwards",
    description: "the same, to the positive side only",
    numbers: &NUMBERS,
    sentence: "A share of {} of the @ readings is too high by {} to {}",
    act: |numbers, random| Box::new(Outliers { numbers: *numbers, is_one_sided: true, random }),
};

struct Outliers {
    numbers: [f64; 3],
    is_one_sided: bool,
    random: Normal,
}

impl Act for Outliers {
    fn reading(&mut self, reading: f64, moment: &Moment) -> f64 {
        let [share, from, to] = self.numbers;
        // The same draws for every sample, so that a larger share has the outliers of a smaller one.
        let [chance, size, side] = [(); 3].map(|()| self.random.uniform());
        if chance > share {
            return reading;
        }
        let error = moment.noise_std * (from + (to - from) * size);
        if self.is_one_sided || side > 0.5 { reading + error } else { reading - error }
    }
}
