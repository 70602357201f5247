//! Sums of logarithms of the numbers of several runs.

use crate::mathematics::engine::number::{Mask, Number};
use crate::mathematics::gaussian_likelihood::LogSum;

/// A [`LogSum`] a lane.
#[derive(Clone, Debug)]
pub(super) struct LogProducts<T> {
    product: T,
    taken: Vec<f64>,
}

impl<T: Number> LogProducts<T> {
    /// The sums of no logarithms.
    pub(super) fn new() -> Self {
        Self { product: T::of(1.0), taken: vec![0.0; T::LANES] }
    }

    /// Adds the logarithm of a factor. `ln` computes it in a lane where the factor is too large or too small for a number.
    #[inline(always)]
    pub(super) fn add(&mut self, factor: T, ln: impl Fn(usize) -> f64) {
        let next = self.product * factor;
        let [low, high] = [*LogSum::RANGE.start(), *LogSum::RANGE.end()].map(T::of);
        let is_in_range = low.le(next) & next.le(high) & low.le(factor) & factor.le(high);
        if is_in_range.all() {
            self.product = next;
        } else {
            self.take_logarithms(factor, ln);
        }
    }

    #[cold]
    #[inline(never)]
    fn take_logarithms(&mut self, factor: T, ln: impl Fn(usize) -> f64) {
        for (lane, taken) in self.taken.iter_mut().enumerate() {
            let mut sum = LogSum { taken: *taken, product: self.product.lane(lane) };
            let own = factor.lane(lane);
            // As a history has it.
            sum.add(own, || if own.is_normal() { libm::log(own) } else { ln(lane) });
            *taken = sum.taken;
            self.product.set_lane(lane, sum.product);
        }
    }

    /// Adds other sums, and makes them empty.
    pub(super) fn absorb(&mut self, other: &mut Self) {
        let Self { product, taken } = other;
        // A product is in the range of factors.
        self.add(*product, |_| 0.0);
        self.taken.iter_mut().zip(&mut *taken).for_each(|(own, other)| *own += std::mem::take(other));
        *product = T::of(1.0);
    }

    /// The sum of a lane.
    pub(super) fn value(&self, lane: usize) -> f64 {
        LogSum { taken: self.taken[lane], product: self.product.lane(lane) }.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::engine::lanes::Lanes;

    #[test]
    fn sums_that_absorb_others_have_the_logarithms_of_all_factors() {
        let factor = |k: i32, lane: usize| libm::exp2(f64::from((k * (7 + lane as i32)) % 900 - 500));
        let (mut all, mut part) = (LogProducts::<Lanes<4>>::new(), LogProducts::new());
        let mut direct = [0.0; 4];
        for k in 0..600 {
            part.add(Lanes::from_lanes(|lane| factor(k, lane)), |lane| libm::log(factor(k, lane)));
            direct.iter_mut().enumerate().for_each(|(lane, sum)| *sum += libm::log(factor(k, lane)));
            if k % 3 == 0 {
                all.absorb(&mut part);
            }
        }
        all.absorb(&mut part);
        for (lane, direct) in direct.iter().enumerate() {
            assert!((all.value(lane) - direct).abs() < 1e-10 * direct.abs(), "{} for {direct}", all.value(lane));
            assert_eq!(part.value(lane), 0.0);
        }
    }
}
