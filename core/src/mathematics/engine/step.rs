//! From one sample to the next.

use super::number::Number;

/// A step from one sample to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<T> {
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
    pub(crate) fn slope(&self) -> T {
        (self.forces[1] - self.forces[0]) * (1.0 / self.dt)
    }

    /// The forces at its beginning, in its middle and at its end.
    #[inline(always)]
    pub(crate) fn thrice(&self) -> [T; 3] {
        let [begin, end] = self.forces;
        [begin, begin + (end - begin) * 0.5, end]
    }

    /// A part of the step, of this many that take the same time.
    pub(crate) fn part(&self, i: usize, parts: usize) -> Self {
        let [begin, end] = self.forces;
        let force = |i: usize| match i {
            0 => begin,
            i if i == parts => end,
            i => begin + (end - begin) * (i as f64 / parts as f64),
        };
        Self { forces: [force(i), force(i + 1)], dt: self.dt / parts as f64, ..*self }
    }
}
