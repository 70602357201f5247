//! Sums by part of a record, from which the tests take their statistics: of innovations, and of errors where the truth is known.

use std::ops::Range;

use kalmanscope_core::internals::{mapped, places};
use kalmanscope_core::{Channel, Estimates, Quantity, Record};

use super::periodogram::Periodogram;

/// The number of parts that a record is judged in, so that one sudden change does not decide for the whole.
pub(crate) const PARTS: usize = 10;

pub(crate) fn range_of(part: usize, samples: &Range<usize>) -> Range<usize> {
    let end = |part: usize| samples.start + part * samples.len() / PARTS;
    end(part)..end(part + 1)
}

pub(crate) type Chosen = [bool; PARTS];

pub(crate) const ALL: Chosen = [true; PARTS];

pub(crate) fn sum_over(chosen: &Chosen, of: impl Fn(usize) -> f64) -> f64 {
    (0..PARTS).filter(|&part| chosen[part]).map(of).sum()
}

pub(crate) const LAGS: usize = 21;

/// The lags of a cross-correlation with the input: from 4 samples before it to 15 after it.
pub(crate) const CROSS_LAGS: usize = 20;

pub(crate) const FIRST_CROSS_LAG: i32 = -4;

#[derive(Clone, Debug)]
pub(crate) struct ChannelErrors {
    pub(crate) channel: Channel,
    pub(crate) by_part: [ChannelErrorSums; PARTS],
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ChannelErrorSums {
    pub(crate) count: f64,
    pub(crate) square: f64,
    pub(crate) product: f64,
    pub(crate) inside: f64,
}

impl ChannelErrors {
    pub(super) fn of_all(samples: &Range<usize>, estimates: &Estimates, record: &Record) -> Vec<Self> {
        let of = |(place, &channel): (usize, &Channel)| {
            let truth = record.truth(channel)?;
            let (means, variances) = (estimates.canonical_means(place), estimates.variances(place));
            // The first error of a part follows the last one of the part before.
            let mut last = 0.0;
            let by_part = std::array::from_fn(|part| {
                let mut sums = ChannelErrorSums::default();
                let uncertain = range_of(part, samples).filter(|&k| variances[k] != 0.0);
                let errors = uncertain.map(|k| (means[k] - truth[k]) / variances[k].sqrt());
                for error in errors.filter(|error| !error.is_nan()) {
                    sums.count += 1.0;
                    sums.square += error * error;
                    sums.product += error * last;
                    sums.inside += if error.abs() <= 2.0 { 1.0 } else { 0.0 };
                    last = error;
                }
                sums
            });
            by_part.iter().any(|sums| sums.count > 0.0).then_some(Self { channel, by_part })
        };
        estimates.channels().iter().enumerate().filter_map(of).collect()
    }

    /// The mean of (e/σ)² over some parts; NaN where the truth is not known there.
    pub(crate) fn level(&self, chosen: &Chosen) -> f64 {
        sum_over(chosen, |part| self.by_part[part].square) / self.count(chosen)
    }

    pub(crate) fn count(&self, chosen: &Chosen) -> f64 {
        sum_over(chosen, |part| self.by_part[part].count)
    }

    pub(crate) fn coverage(&self, chosen: &Chosen) -> f64 {
        sum_over(chosen, |part| self.by_part[part].inside) / self.count(chosen)
    }

    /// The number of independent errors, by their correlation ρ from one sample to the next:
    /// ```text
    /// n (1 - ρ²) / (1 + ρ²)
    /// ```
    /// Source: Bartlett (1946), On the theoretical specification and sampling properties of autocorrelated time-series.
    pub(crate) fn independent(&self, chosen: &Chosen) -> f64 {
        let square = sum_over(chosen, |part| self.by_part[part].square);
        let product = sum_over(chosen, |part| self.by_part[part].product);
        let correlation = if square > 0.0 { (product / square).clamp(0.0, 0.999_999) } else { 0.0 };
        let squared = correlation * correlation;
        (self.count(chosen) * (1.0 - squared) / (1.0 + squared)).max(1.0)
    }
}

/// Limits normalised innovations, and the input over its root mean square, in correlations: one reading must not dominate.
pub(crate) const LARGEST: f64 = 5.0;

/// The normalised innovations `ν = e / √S` of one sensor.
#[derive(Clone, Debug)]
pub(crate) struct SensorInnovations {
    pub(crate) sensor: Quantity,
    pub(crate) by_part: [InnovationSums; PARTS],
    pub(crate) periodogram: Periodogram,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InnovationSums {
    pub(crate) count: f64,
    pub(crate) square: f64,
    pub(crate) sum: f64,
    pub(crate) products: [f64; LAGS],
    pub(crate) cross: [f64; CROSS_LAGS],
    pub(crate) input_square: f64,
}

impl SensorInnovations {
    /// Of all sensors in a window of kept samples, before their periodograms; and ν of each one, limited, 0 where nothing was measured.
    pub(super) fn of_all(window: &Range<usize>, estimates: &Estimates, record: &Record) -> (Vec<Self>, Vec<Vec<f64>>) {
        // Zeros stand for the numbers outside a window.
        let input =
            [vec![0.0; INPUT_BEFORE], limited_input(&record.input()[window.clone()]), vec![0.0; AFTER]].concat();
        let first = window.start + record.forgotten();
        let m = estimates.sensors().len();
        let of = |(place, &sensor): (usize, &Quantity)| {
            let normalised =
                |k: usize| estimates.innovation(k)[place] / estimates.innovation_cov(k)[place * (m + 1)].sqrt();
            let values: Vec<f64> = window.clone().map(normalised).collect();
            let limited = mapped(&values, &|value| if value.is_nan() { 0.0 } else { value.clamp(-LARGEST, LARGEST) });
            let before = [&[0.0; BEFORE][..], &limited].concat();
            let by_part = std::array::from_fn(|part| {
                let range = range_of(part, &(0..values.len()));
                let input_square = sum_of(&input[INPUT_BEFORE..][range.clone()], |f| f * f);
                let mut sums = InnovationSums { input_square, ..InnovationSums::default() };
                for Range { start, end } in granules(range, first) {
                    for value in values[start..end].iter().filter(|value| !value.is_nan()) {
                        sums.count += 1.0;
                        sums.square += value * value;
                    }
                    let limited = &limited[start..end];
                    sums.sum += limited.iter().sum::<f64>();
                    add_products(&mut sums.products, limited, &before[start..end + BEFORE]);
                    add_products(&mut sums.cross, limited, &input[start..end + CROSS_LAGS - 1]);
                }
                sums
            });
            (Self { sensor, by_part, periodogram: Periodogram::default() }, limited)
        };
        estimates.sensors().iter().enumerate().map(of).unzip()
    }

    pub(crate) fn count(&self, chosen: &Chosen) -> f64 {
        sum_over(chosen, |part| self.by_part[part].count)
    }

    /// The mean of ν² over some parts; NaN without a measurement.
    pub(crate) fn level(&self, chosen: &Chosen) -> f64 {
        sum_over(chosen, |part| self.by_part[part].square) / self.count(chosen)
    }

    pub(crate) fn mean(&self, chosen: &Chosen) -> f64 {
        sum_over(chosen, |part| self.by_part[part].sum) / self.count(chosen)
    }

    /// r at the lags 1 to 20 over some parts; zeros where there is nothing but zeros.
    pub(crate) fn autocorrelation(&self, chosen: &Chosen) -> [f64; LAGS - 1] {
        let product = |lag: usize| sum_over(chosen, |part| self.by_part[part].products[lag]);
        let square = product(0);
        // The samples before a part may be larger than all in it.
        std::array::from_fn(|i| if square > 0.0 { (product(i + 1) / square).clamp(-1.0, 1.0) } else { 0.0 })
    }

    /// The first lag \[samples\] at which a sensor has readings, and r there: 1 unless it reads at every few samples only.
    pub(crate) fn first_correlation(&self, chosen: &Chosen) -> (usize, f64) {
        (1..).zip(self.autocorrelation(chosen)).find(|(_, r)| *r != 0.0).unwrap_or((1, 0.0))
    }

    pub(crate) fn cross_correlation(&self, chosen: &Chosen) -> [f64; CROSS_LAGS] {
        let square = sum_over(chosen, |part| self.by_part[part].products[0]);
        let input = sum_over(chosen, |part| self.by_part[part].input_square);
        let scale = (square * input).sqrt();
        std::array::from_fn(|lag| {
            let product = || sum_over(chosen, |part| self.by_part[part].cross[lag]);
            if scale > 0.0 { (product() / scale).clamp(-1.0, 1.0) } else { 0.0 }
        })
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Pair {
    pub(crate) places: [usize; 2],
    pub(crate) count: f64,
    /// `r_l = Σ ν_k μ_(k - l) / √(Σ ν² Σ μ²)` at the lags 0 to 20 of the second sensor's μ, and the other way round.
    pub(crate) correlation: [[f64; LAGS]; 2],
}

impl Pair {
    /// Without accelerometers: a force that R includes moves other sensors a step later, for which a white force is tried.
    pub(super) fn of_all(sensors: &[SensorInnovations], series: &[Vec<f64>], ranges: &[Range<usize>]) -> Vec<Self> {
        let of_force = [Quantity::ACCELERATION.aspect(), Quantity::TOTAL_ACCELERATION.aspect()];
        let moving = places(series.len(), &|place| !of_force.contains(&sensors[place].sensor.aspect()));
        let pairs = moving.iter().enumerate().flat_map(|(k, &i)| moving[k + 1..].iter().map(move |&j| [i, j]));
        pairs.map(|places| Self::new(places, series, ranges)).collect()
    }

    fn new(places: [usize; 2], series: &[Vec<f64>], ranges: &[Range<usize>]) -> Self {
        let (mut count, mut squares, mut products) = (0.0, [0.0; 2], [[0.0; LAGS]; 2]);
        for range in ranges {
            let both = places.map(|place| &series[place][range.clone()]);
            count += both[0].iter().zip(both[1]).filter(|(a, b)| **a != 0.0 && **b != 0.0).count() as f64;
            for (side, products) in products.iter_mut().enumerate() {
                squares[side] += sum_of(both[side], |value| value * value);
                let before = [&[0.0; BEFORE][..], both[1 - side]].concat();
                add_products(products, both[side], &before);
            }
        }
        let scale = libm::sqrt(squares[0] * squares[1]);
        let r = |product: f64| if scale > 0.0 { (product / scale).clamp(-1.0, 1.0) } else { 0.0 };
        Self { places, count, correlation: products.map(|side| side.map(r)) }
    }
}

const BEFORE: usize = LAGS - 1;
const AFTER: usize = FIRST_CROSS_LAG.unsigned_abs() as usize;
const INPUT_BEFORE: usize = CROSS_LAGS - 1 - AFTER;

/// Less its mean, up to a multiple of its root mean square.
fn limited_input(values: &[f64]) -> Vec<f64> {
    let count = values.len().max(1) as f64;
    let mean = sum_of(values, |f| f) / count;
    let limit = LARGEST * (sum_of(values, |f| (f - mean) * (f - mean)) / count).sqrt();
    mapped(values, &|f| (f - mean).max(-limit).min(limit))
}

/// Samples are added up in groups that begin with sample 16 i of the run: sums of few numbers lose fewer digits.
fn granules(samples: Range<usize>, first: usize) -> impl Iterator<Item = Range<usize>> {
    const SIZE: usize = 16;
    let (start, end) = (first + samples.start, first + samples.end);
    let of = move |i: usize| start.max(SIZE * i) - first..end.min(SIZE * (i + 1)) - first;
    (start / SIZE..end.div_ceil(SIZE)).map(of)
}

/// The sum of a function of each value; four side by side, for vector instructions.
fn sum_of(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let (chunks, rest) = values.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for chunk in chunks {
        for (sum, value) in sums.iter_mut().zip(chunk) {
            *sum += of(*value);
        }
    }
    sums.iter().sum::<f64>() + rest.iter().map(|value| of(*value)).sum::<f64>()
}

/// Adds `Σ a_k b_(k + N - 1 - i)` to sum i: b begins `N - 1` samples before the partner of `a[0]` at the first lag.
fn add_products<const N: usize>(sums: &mut [f64; N], a: &[f64], b: &[f64]) {
    let mut reversed = [0.0; N];
    for (a, b) in a.iter().zip(b.array_windows::<N>()) {
        for (sum, b) in reversed.iter_mut().zip(b) {
            *sum += a * b;
        }
    }
    for (sum, added) in sums.iter_mut().zip(reversed.iter().rev()) {
        *sum += added;
    }
}
