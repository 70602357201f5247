//! Samples of a filter with logarithms in its state, in the channels' units.

use crate::mathematics::engine::belief::Belief;
use crate::mathematics::engine::logarithms::convert;
use crate::samples::sink::Sample;

/// Memory to [convert] samples.
#[derive(Clone, Debug)]
pub(super) struct InUnits {
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
    /// The memory for n components and a number of sensors; `None` where no component is a logarithm.
    pub(super) fn new(logarithms: &[usize], n: usize, sensors: usize) -> Option<Box<Self>> {
        let belief = Belief { mean: vec![0.0; n], cov: vec![0.0; n * n] };
        let (unit, gain, prior) = (vec![1.0; n], vec![0.0; n * sensors], belief.clone());
        (!logarithms.is_empty()).then(|| Box::new(Self { logarithms: logarithms.to_vec(), unit, belief, prior, gain }))
    }

    /// The same sample in the channels' units; `None` where a number is not finite in them.
    #[cold]
    pub(super) fn convert<'a>(&'a mut self, sample: Sample<'a>) -> Option<Sample<'a>> {
        let Self { logarithms, unit, belief, prior, gain } = self;
        if !sample.prior_mean.is_empty() {
            convert(logarithms, unit, [sample.prior_mean, sample.prior_cov], prior);
        }
        convert(logarithms, unit, [sample.mean, sample.cov], belief);
        gain.copy_from_slice(sample.gain);
        for column in gain.chunks_exact_mut(unit.len()) {
            column.iter_mut().zip(&*unit).for_each(|(entry, unit)| *entry *= unit);
        }
        let is_finite = [&belief.mean, &belief.cov, gain].into_iter().flatten().all(|number| number.is_finite());
        let sample = Sample { mean: &belief.mean, cov: &belief.cov, gain, ..sample };
        let has_prior = !sample.prior_mean.is_empty();
        is_finite.then_some(if has_prior { sample.with_prior(prior) } else { sample })
    }
}
