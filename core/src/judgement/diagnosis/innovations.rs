//! One pass over the innovations of each sensor: sums by part of the record, from which the tests take their statistics.

use std::ops::Range;

use super::lagged::add_products;
use super::parts::{self, Chosen, PARTS};
use super::periodogram::Periodogram;
use crate::{Estimates, Quantity, Record};

/// The lags of an autocorrelation: 0 to 20 samples.
pub(crate) const LAGS: usize = 21;

/// The lags of a cross-correlation with the input: from 4 samples before it to 15 after it.
pub(crate) const CROSS_LAGS: usize = 20;

/// The lag of the first of them.
pub(crate) const FIRST_CROSS_LAG: i32 = -4;

/// Limits a normalised innovation, and the input in units of its root mean square, in correlations: so that one reading does
/// not dominate them.
pub(crate) const LARGEST: f64 = 5.0;

/// The normalised innovations `ν = e / √S` of one sensor.
#[derive(Clone, Debug)]
pub(crate) struct SensorInnovations {
    pub(crate) sensor: Quantity,
    pub(crate) by_part: [Sums; PARTS],
    /// The periodogram of the kept samples, once they are known.
    pub(crate) periodogram: Periodogram,
}

/// The sums of one part.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    /// Measurements.
    pub(crate) count: f64,
    /// Sum of ν².
    pub(crate) square: f64,
    /// Sum of ν, limited.
    pub(crate) sum: f64,
    /// Sums of the products of ν with ν l samples before, both limited.
    pub(crate) products: [f64; LAGS],
    /// Sums of ν times the input at each lag, both limited.
    pub(crate) cross: [f64; CROSS_LAGS],
    /// Sum of the squares of the input.
    pub(crate) input_square: f64,
}

impl SensorInnovations {
    /// The pass over all sensors of some estimates. With each come the limited ν of all samples; 0 where nothing was
    /// measured.
    pub(crate) fn of_all(estimates: &Estimates, record: &Record, samples: &Range<usize>) -> Vec<(Self, Vec<f64>)> {
        let first = samples.start;
        let m = estimates.sensors().len();
        let input = limited_input(record, samples);
        let mut all: Vec<(Quantity, [Sums; PARTS], Vec<f64>)> = estimates
            .sensors()
            .iter()
            .map(|&sensor| (sensor, [Sums::default(); PARTS], vec![0.0; samples.len()]))
            .collect();
        for part in 0..PARTS {
            for k in parts::range(part, samples) {
                let (innovation, cov) = (estimates.innovation(k), estimates.innovation_cov(k));
                for (i, (_, by_part, values)) in all.iter_mut().enumerate() {
                    let value = innovation[i] / cov[i * (m + 1)].sqrt();
                    if value.is_nan() {
                        continue;
                    }
                    let sums = &mut by_part[part];
                    sums.count += 1.0;
                    sums.square += value * value;
                    let limited = limited(value);
                    sums.sum += limited;
                    values[k - first] = limited;
                }
            }
        }
        let spare = input.iter().any(|&f| f != 0.0);
        all.into_iter()
            .map(|(sensor, mut by_part, values)| {
                for (part, sums) in by_part.iter_mut().enumerate() {
                    let range = parts::range(part, &(0..samples.len()));
                    add_products(&mut sums.products, &values, &values, range.clone(), 0);
                    if spare {
                        sums.input_square = input[range.clone()].iter().map(|f| f * f).sum();
                        add_products(&mut sums.cross, &values, &input, range, FIRST_CROSS_LAG);
                    }
                }
                (Self::new(sensor, by_part), values)
            })
            .collect()
    }

    /// The sums of one sensor, without a periodogram.
    pub(crate) fn new(sensor: Quantity, by_part: [Sums; PARTS]) -> Self {
        Self { sensor, by_part, periodogram: Periodogram::default() }
    }

    /// The number of measurements in some parts.
    pub(crate) fn count(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].count)
    }

    /// The mean of ν² over some parts; NaN without a measurement.
    pub(crate) fn level(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].square) / self.count(chosen)
    }

    /// The mean of ν over some parts, limited.
    pub(crate) fn mean(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].sum) / self.count(chosen)
    }

    /// r at the lags 1 to 20 over some parts; zeros where there is nothing but zeros.
    pub(crate) fn autocorrelation(&self, chosen: &Chosen) -> [f64; LAGS - 1] {
        let product = |lag: usize| parts::sum(chosen, |part| self.by_part[part].products[lag]);
        let square = product(0);
        // The samples before a part may be larger than all in it.
        std::array::from_fn(|i| if square > 0.0 { (product(i + 1) / square).clamp(-1.0, 1.0) } else { 0.0 })
    }

    /// The correlation of ν with the input at each lag over some parts; zeros without an input.
    pub(crate) fn cross_correlation(&self, chosen: &Chosen) -> [f64; CROSS_LAGS] {
        let square = parts::sum(chosen, |part| self.by_part[part].products[0]);
        let input = parts::sum(chosen, |part| self.by_part[part].input_square);
        let scale = (square * input).sqrt();
        std::array::from_fn(|lag| {
            let product = || parts::sum(chosen, |part| self.by_part[part].cross[lag]);
            if scale > 0.0 { (product() / scale).clamp(-1.0, 1.0) } else { 0.0 }
        })
    }
}

/// ν in correlations.
pub(crate) fn limited(value: f64) -> f64 {
    value.clamp(-LARGEST, LARGEST)
}

/// The input without its mean, limited to five times its root mean square.
fn limited_input(record: &Record, samples: &Range<usize>) -> Vec<f64> {
    let input = &record.input()[samples.clone()];
    let count = input.len().max(1) as f64;
    let mean = input.iter().sum::<f64>() / count;
    let rms = (input.iter().map(|f| (f - mean) * (f - mean)).sum::<f64>() / count).sqrt();
    input.iter().map(|f| (f - mean).clamp(-LARGEST * rms, LARGEST * rms)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judgement::diagnosis::parts::ALL;

    #[test]
    fn a_part_after_a_much_louder_one_is_correlated_by_one_at_most() {
        // ν = 5 in the first part and 1e-40 in the others, with an input of the same kind.
        let mut by_part = [Sums::default(); PARTS];
        for (part, sums) in by_part.iter_mut().enumerate() {
            let (size, before) = if part == 0 { (5.0, 5.0) } else { (1e-40, if part == 1 { 5.0 } else { 1e-40 }) };
            sums.products = [size * before; LAGS];
            sums.products[0] = size * size;
            (sums.cross, sums.input_square) = ([-size * before; CROSS_LAGS], size * size);
        }
        let quiet = std::array::from_fn(|part| part > 0);
        let innovations = SensorInnovations::new(Quantity::DISPLACEMENT, by_part);
        for chosen in [ALL, quiet] {
            assert!(innovations.autocorrelation(&chosen).iter().all(|r| (r - 1.0).abs() < 1e-12));
            assert!(innovations.cross_correlation(&chosen).iter().all(|r| (r + 1.0).abs() < 1e-12));
        }
    }
}
