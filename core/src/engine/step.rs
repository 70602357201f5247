//! From one sample to the next.

use super::number::Number;

/// A step from one sample to the next.
#[derive(Clone, Copy, Debug)]
pub struct Step<T> {
    /// The recorded force over mass at its beginning and at its end, linear in between \[m/s²\].
    pub forces: [T; 2],
    /// Whether they differ: else the force is held.
    pub has_slope: bool,
    /// The time that it takes \[s\].
    pub dt: f64,
}

impl<T: Number> Step<T> {
    /// The slope of the force over mass \[m/s³\].
    #[inline(always)]
    pub fn slope(&self) -> T {
        (self.forces[1] - self.forces[0]) * (1.0 / self.dt)
    }

    /// The two halves of the step.
    pub fn halves(&self) -> [Self; 2] {
        let [begin, end] = self.forces;
        let middle = begin + (end - begin) * 0.5;
        [[begin, middle], [middle, end]].map(|forces| Self { forces, dt: 0.5 * self.dt, ..*self })
    }
}
