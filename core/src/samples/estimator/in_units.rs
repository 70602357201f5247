//! Samples of a filter with logarithms in its state, in the channels' units.

use crate::mathematics::engine::belief::Belief;
use crate::mathematics::engine::belief::convert;
use crate::samples::sink::Sample;

#[derive(Clone, Debug)]
pub(crate) struct InUnits {
    /// The places of logarithms.
    logarithms: Vec<usize>,
    /// The size of each component's unit in its channel's unit.
    unit: Vec<f64>,
    belief: Belief<f64>,
    prior: Belief<f64>,
    /// K, n × m.
    gain: Vec<f64>,
}

impl InUnits {
    pub(crate) fn new(logarithms: &[usize], n: usize, sensors: usize) -> Option<Box<Self>> {
        let belief = Belief { mean: vec![0.0; n], cov: vec![0.0; n * n] };
        let (unit, gain, prior) = (vec![1.0; n], vec![0.0; n * sensors], belief.clone());
        (!logarithms.is_empty()).then(|| Box::new(Self { logarithms: logarithms.to_vec(), unit, belief, prior, gain }))
    }

    /// A belief in the channels' units, in those of the state.
    pub(super) fn back(&mut self, mean: &[f64], cov: &[f64]) -> &Belief<f64> {
        let Self { logarithms, unit, belief, .. } = self;
        belief.mean.copy_from_slice(mean);
        belief.cov.copy_from_slice(cov);
        for &place in &*logarithms {
            unit[place] = mean[place];
            belief.mean[place] = libm::log(mean[place]);
        }
        for (column, by) in belief.cov.chunks_exact_mut(unit.len()).zip(&*unit) {
            column.iter_mut().zip(&*unit).for_each(|(entry, unit)| *entry /= unit * by);
        }
        belief
    }

    /// The same sample in the channels' units; `None` where a number is not finite in them.
    #[cold]
    pub(super) fn convert<'a>(&'a mut self, sample: Sample<'a>) -> Option<Sample<'a>> {
        let (sample, is_finite) = self.take(sample);
        is_finite.then_some(sample)
    }

    /// The same sample in the channels' units, and whether its numbers are finite in them.
    pub(crate) fn take<'a>(&'a mut self, sample: Sample<'a>) -> (Sample<'a>, bool) {
        let Self { logarithms, unit, belief, prior, gain } = self;
        if !sample.prior_mean.is_empty() {
            convert(logarithms, unit, [sample.prior_mean, sample.prior_cov], prior);
        }
        convert(logarithms, unit, [sample.mean, sample.cov], belief);
        let gain = &mut gain[..sample.gain.len()];
        gain.copy_from_slice(sample.gain);
        for column in gain.chunks_exact_mut(unit.len()) {
            column.iter_mut().zip(&*unit).for_each(|(entry, unit)| *entry *= unit);
        }
        let is_finite = belief.mean.iter().chain(&belief.cov).chain(&*gain).all(|number| number.is_finite());
        let sample = Sample { mean: &belief.mean, cov: &belief.cov, gain, ..sample };
        let has_prior = !sample.prior_mean.is_empty();
        (if has_prior { sample.with_prior(prior) } else { sample }, is_finite)
    }
}
