//! A motion that begins again where the plant is plucked.

use super::{Recursion, Span, Wrapper};
use crate::engine::dynamics::Dynamics;
use crate::engine::number::Number;

/// A filter that widens its belief of the motion where a plant is plucked: parameters and augmentations are what they were.
///
/// ```text
/// P ← P + P₀ of displacements, velocities and hidden states, before the prediction over the time of a pluck
/// ```
///
/// The pull is an unknown force over a short time: it adds to the motion whatever was there before, about which nothing is known but its size.
pub struct Restarting {
    /// In rising order, from the first sample on \[s\].
    times: Vec<f64>,
    variances: Vec<(usize, f64)>,
}

impl Restarting {
    pub fn of<T: Number, P: Dynamics>(times: Vec<f64>, variances: Vec<(usize, f64)>) -> Option<Box<dyn Wrapper<T, P>>> {
        (!times.is_empty()).then(|| Box::new(Self { times, variances }) as _)
    }
}

impl<T: Number, P: Dynamics> Wrapper<T, P> for Restarting {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<T>) {
        let [before, after] = span.times.map(|end| self.times.partition_point(|time| *time <= end));
        if after > before {
            let count = (after - before) as f64;
            inner.filter().widen(self.variances.iter().map(|&(place, variance)| (place, T::of(count * variance))));
        }
        inner.predict(span);
    }
}
