//! Noise that is correlated over time.

use super::{Act, FaultInfo, FaultNumber, Moment, Scale};
use crate::data::setting::Allowed;

/// A Gauss-Markov process: n ← a n + √(1 - a²) w, a = exp(-dt / τ). Source: Brown and Hwang (2012), *Introduction to Random
/// Signals and Applied Kalman Filtering*, section 2.7.
pub(super) static COLOURED: FaultInfo = FaultInfo {
    key: "coloured",
    name: "coloured noise",
    description: "noise of the same size that is correlated over a time (Gauss-Markov)",
    numbers: &[FaultNumber {
        key: "time",
        name: "correlation time",
        scale: Scale::Seconds,
        usual: 0.1,
        slider: (0.001, 10.0),
        allowed: Allowed::Above(0.0),
    }],
    sentence: "The noise of the @ sensor is correlated over {}",
    act: |numbers, _| Box::new(Coloured { time: numbers[0], last: None }),
};

struct Coloured {
    time: f64,
    last: Option<f64>,
}

impl Act for Coloured {
    fn noise(&mut self, noise: f64, moment: &Moment) -> f64 {
        let a = libm::exp(-moment.dt / self.time);
        let next = self.last.map_or(noise, |last| a * last + (1.0 - a * a).sqrt() * noise);
        self.last = Some(next);
        next
    }
}
