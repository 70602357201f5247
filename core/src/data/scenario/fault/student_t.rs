//! Noise by Student's distribution: many small errors, a few large ones.

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;
use crate::mathematics::random::Normal;

/// Source: Student (1908), The probable error of a mean: a standard normal number over the root of χ²/ν.
pub(super) static STUDENT_T: FaultInfo = FaultInfo {
    key: "student_t",
    name: "Student's noise",
    description: "noise by Student's distribution, whose scale is noise_std: the fewer degrees of freedom, the more large errors",
    numbers: &[FaultNumber {
        key: "freedom",
        name: "degrees of freedom",
        scale: Scale::Pure,
        usual: 3.0,
        slider: (1.0, 30.0),
        allowed: Allowed::Whole(1, 1000),
    }],
    sentence: "The noise of the @ sensor is Student's, with {} degrees of freedom",
    act: |numbers, random| Box::new(StudentT { freedom: numbers[0], random }),
};

struct StudentT {
    freedom: f64,
    random: Normal,
}

impl Act for StudentT {
    fn noise(&mut self, noise: f64, _: &Moment) -> f64 {
        let squares: f64 = (0..libm::round(self.freedom) as usize).map(|_| self.random.sample()).map(|x| x * x).sum();
        noise / (squares / self.freedom).sqrt().max(f64::MIN_POSITIVE)
    }
}
