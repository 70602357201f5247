//! A belief that widens once where the innovations grow at once.

use super::{Learnt, Readings, Recursion, Span, Wrapper};
use crate::engine::dynamics::Dynamics;
use crate::engine::filter::GaussianFilter;
use crate::engine::number::{Mask, Number};
use crate::engine::update::UpdateResult;
use crate::filter::jump::Jump;

/// A filter that adds its initial variances to Q, in lanes that jump, for one prediction.
pub struct Jumping<T> {
    jumps: Vec<Jump>,
    /// The diagonal of Q before a jump.
    narrow: Vec<T>,
}

impl<T: Number> Jumping<T> {
    pub fn of<P: Dynamics>(is_on: bool, filter: &GaussianFilter<T, P>) -> Option<Box<dyn Wrapper<T, P>>> {
        let n = filter.belief.size();
        let variances = |lane: usize| (0..n).map(|i| filter.belief.cov[i * n + i].lane(lane)).collect();
        let jumps = || (0..T::LANES).map(|lane| Jump::new(variances(lane))).collect();
        is_on.then(|| Box::new(Self { jumps: jumps(), narrow: vec![T::of(0.0); n] }) as _)
    }
}

impl<T: Number, P: Dynamics> Wrapper<T, P> for Jumping<T> {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<T>) {
        let Self { jumps, narrow } = self;
        let GaussianFilter { noise, design, .. } = inner.filter();
        let mut has_widened = false;
        for (lane, jump) in jumps.iter_mut().enumerate() {
            let Some(widening) = jump.widening() else { continue };
            if !std::mem::replace(&mut has_widened, true) {
                narrow.iter_mut().enumerate().for_each(|(i, variance)| *variance = *noise.variance(i));
            }
            // A force that is drawn again at each sample always has its full variance.
            let is_kept = |i: usize| design.white.is_none_or(|(place, _)| place != i);
            for (i, more) in widening.enumerate().filter(|(i, _)| is_kept(*i)) {
                let variance = noise.variance(i);
                variance.set_lane(lane, variance.lane(lane) + more);
            }
        }
        inner.predict(span);
        if has_widened {
            let noise = &mut inner.filter().noise;
            narrow.iter().enumerate().for_each(|(i, variance)| *noise.variance(i) = *variance);
        }
    }

    fn update(&mut self, inner: &mut dyn Recursion<T, P>, readings: Readings<'_, T>) -> UpdateResult<T> {
        let result = inner.update(readings);
        let has_measured = T::of(0.0).lt(result.measured);
        for (lane, jump) in self.jumps.iter_mut().enumerate().filter(|(lane, _)| has_measured.lane(*lane)) {
            jump.observe(result.nis.lane(lane), result.measured.lane(lane) as usize);
        }
        result
    }

    fn report<'a>(&'a self, learnt: &mut Learnt<'a, T>) {
        learnt.has_widened = self.jumps.iter().any(|jump| jump.has_widened);
    }
}
