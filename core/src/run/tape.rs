//! Samples of a filter as numbers.

use kalmanscope_filters::{FilterError, Stop};

use crate::Estimates;
use crate::run::sink::{SCALARS, Sample, Sink, parts, sample_of, scalars};

/// Consecutive samples of one filter, for a history in another thread or worker, which has the same bits.
///
/// The first numbers are the count of samples, and the sample and the reason of a [`Stop`]; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape(
    /// All its numbers.
    pub Vec<f64>,
);

/// Every reason to stop; its place is its number.
const REASONS: [FilterError; 8] = [
    FilterError::TooLarge,
    FilterError::NotFinite,
    FilterError::IndefiniteCovariance,
    FilterError::SingularInnovation,
    FilterError::IndefiniteInnovation,
    FilterError::ImpossibleMeasurement,
    FilterError::InfiniteMeasurement,
    FilterError::UndefinedForce,
];

impl Default for Tape {
    fn default() -> Self {
        Self(vec![0.0, f64::NAN, f64::NAN])
    }
}

impl Tape {
    /// Appends its samples to a history. Returns their count and the stop, or none if they are not of the history's filter.
    pub(crate) fn play(&self, estimates: &mut Estimates) -> Option<(usize, Option<Stop>)> {
        let (&[count, at, reason], numbers) = self.0.split_first_chunk()?;
        let (n, m) = (estimates.channels().len(), estimates.sensors().len());
        let (count, weights) = (count as usize, if estimates.weighs { m } else { 0 });
        let width = numbers.len() / count.max(1);
        let plain = [n, n * n, 0, 0, m, m * m, n * m, weights, 0, 0, 0];
        let noisy = [n, n * n, 0, 0, m, m * m, n * m, weights, n, m, m];
        let has_width = |sizes: &[usize; 11]| count == 0 || width == sizes.iter().sum::<usize>() + SCALARS;
        let sizes = [plain, noisy].into_iter().find(has_width).filter(|_| width * count == numbers.len())?;
        for numbers in numbers.chunks_exact(width.max(1)) {
            let mut rest = numbers;
            let parts = sizes.map(|size| rest.split_off(..size).unwrap_or_default());
            estimates.push(&sample_of(parts, rest.try_into().ok()?, sizes == noisy));
        }
        let stop = REASONS.get(reason as usize).filter(|_| !reason.is_nan());
        let stop = stop.map(|&reason| Stop { sample: at as usize, reason });
        if let Some(stop) = stop {
            estimates.stop_at(stop);
        }
        Some((count, stop))
    }
}

impl Sink for Tape {
    fn push(&mut self, sample: &Sample<'_>) {
        let Self(numbers) = self;
        numbers[0] += 1.0;
        parts(sample).into_iter().for_each(|part| numbers.extend_from_slice(part));
        numbers.extend(scalars(sample));
    }

    fn stop_at(&mut self, stop: Stop) {
        let reason = REASONS.iter().position(|reason| *reason == stop.reason);
        self.0[1] = stop.sample as f64;
        self.0[2] = reason.map_or(f64::NAN, |reason| reason as f64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pass, Run, Scenario};
    use kalmanscope_filters::Robust;

    #[test]
    fn weights_go_along_with_or_without_learnt_noise() {
        for learns in [false, true] {
            let mut scenario = Scenario { duration: 4.0, ..Scenario::default() };
            scenario.filters[0].robust = Robust::MIXTURE;
            scenario.filters[0].adaptation.process_noise = learns;
            let mut run = Run::new(&scenario).expect("it can be run");
            run.finish();
            let whole = &run.estimates()[0];
            let mut pass = Pass::new(&scenario, 0, run.record()).expect("it can be run");
            let mut tape = Tape::default();
            pass.follow(run.record(), usize::MAX, &mut tape);
            let mut played = Pass::history(&scenario, 0).expect("it can be run");
            assert_eq!(tape.play(&mut played), Some((whole.len(), None)));
            assert!(whole.weights(0).iter().all(|weight| weight.is_nan()), "the first sample has no update");
            played.forget(100);
            for k in 100..whole.len() {
                assert_eq!(played.weights(k - 100), whole.weights(k), "{k}");
                assert!(whole.weights(k).iter().all(|weight| (0.0..=1.0).contains(weight)), "{k}");
            }
            assert_eq!(run.estimates()[1].weights(5), [0.0; 0]);
        }
    }
}
