//! Samples of a filter as numbers.

use kalmanscope_filters::{FilterError, Stop};

use crate::Estimates;
use crate::run::sink::{AssumedNoise, Sample, Sink};

/// Consecutive samples of one filter, for a history in another thread or worker. A history that takes them in has the
/// same bits as one that the filter writes to.
///
/// The first numbers are the count of samples, and the sample and the reason of a [`Stop`]; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape(Vec<f64>);

const HEAD: usize = 3;

const SCALARS: usize = 7;

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
    /// All its numbers.
    pub fn numbers(&self) -> &[f64] {
        &self.0
    }

    /// The tape with these numbers.
    pub fn from_numbers(numbers: Vec<f64>) -> Self {
        Self(numbers)
    }

    /// Appends its samples to a history. Returns their count and the stop, or none if they are not of the history's filter.
    pub(crate) fn play(&self, estimates: &mut Estimates) -> Option<(usize, Option<Stop>)> {
        let (&[count, at, reason], numbers) = self.0.split_first_chunk::<HEAD>()?;
        let (n, m) = (estimates.channels().len(), estimates.sensors().len());
        let count = count as usize;
        let width = numbers.len() / count.max(1);
        let plain = n + n * n + m + m * m + n * m + SCALARS;
        let weights = if estimates.weighs() { m } else { 0 };
        let plain = plain + weights;
        let has_noise = width == plain + n + 2 * m + 2;
        if width * count != numbers.len() || (count > 0 && width != plain && !has_noise) {
            return None;
        }
        for numbers in numbers.chunks_exact(width.max(1)) {
            let mut rest = numbers;
            let mut next = |size| rest.split_off(..size).unwrap_or_default();
            let (mean, cov, innovation) = (next(n), next(n * n), next(m));
            let (innovation_cov, gain, scalars) = (next(m * m), next(n * m), next(SCALARS));
            let weights = next(weights);
            let noise = has_noise.then(|| {
                let (process, sensors, uncertainty) = (next(n), next(m), next(m));
                let process_scale = next(2).try_into().unwrap_or([f64::NAN; 2]);
                AssumedNoise { process, sensors, uncertainty, process_scale }
            });
            let &[nis, determinant, ln_determinant, log_likelihood, effective_samples, earlier, widened] = scalars
            else {
                return None;
            };
            let mut sample =
                Sample { innovation, innovation_cov, gain, weights, noise, ..Sample::unmeasured(mean, cov) };
            (sample.nis, sample.determinant, sample.ln_determinant) = (nis, determinant, ln_determinant);
            (sample.log_likelihood, sample.effective_samples) = (log_likelihood, effective_samples);
            (sample.earlier, sample.has_widened) = (earlier as u32, widened != 0.0);
            estimates.push(&sample);
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
        let Sample { mean, cov, innovation, innovation_cov, gain, nis, determinant, .. } = *sample;
        let Self(numbers) = self;
        numbers[0] += 1.0;
        for part in [mean, cov, innovation, innovation_cov, gain] {
            numbers.extend_from_slice(part);
        }
        let widened = f64::from(u8::from(sample.has_widened));
        let earlier = f64::from(sample.earlier);
        numbers.extend([nis, determinant, sample.ln_determinant, sample.log_likelihood]);
        numbers.extend([sample.effective_samples, earlier, widened]);
        numbers.extend_from_slice(sample.weights);
        if let Some(AssumedNoise { process, sensors, uncertainty, process_scale }) = sample.noise {
            numbers.extend(process.iter().chain(sensors).chain(uncertainty).chain(&process_scale));
        }
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
