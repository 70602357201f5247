//! The innovations of each sensor: sums by part of the record, from which the tests take their statistics.

use std::ops::Range;

use kalmanscope_core::internals::{mapped, places};
use kalmanscope_core::{Estimates, Quantity, Record};

use super::parts::{self, AFTER, BEFORE, CROSS_LAGS, Chosen, GRANULE, LAGS, PARTS, Piece, Series, first_in, pieces};
use super::periodogram::Periodogram;

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
    pub(crate) fn new(sensor: Quantity, by_part: [InnovationSums; PARTS]) -> Self {
        Self { sensor, by_part, periodogram: Periodogram::default() }
    }

    pub(crate) fn count(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].count)
    }

    /// The mean of ν² over some parts; NaN without a measurement.
    pub(crate) fn level(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].square) / self.count(chosen)
    }

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

    /// The first lag \[samples\] at which a sensor has readings, and r there: 1 unless it reads at every few samples only.
    pub(crate) fn first_correlation(&self, chosen: &Chosen) -> (usize, f64) {
        (1..).zip(self.autocorrelation(chosen)).find(|(_, r)| *r != 0.0).unwrap_or((1, 0.0))
    }

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

#[derive(Debug)]
pub(super) struct LiveInnovations {
    known: Range<usize>,
    sensors: Vec<LiveSensor>,
}

#[derive(Debug)]
struct LiveSensor {
    sensor: Quantity,
    /// ν of every sample; NaN where nothing was measured.
    values: Series<f64>,
    /// The sums of whole granules. In those with the input, its first number in the granule is subtracted.
    granules: Series<InnovationSums>,
}

impl LiveInnovations {
    pub(super) fn new(estimates: &Estimates, start: usize) -> Self {
        let (values, granules) = (Series::starting_at(start), Series::starting_at(first_in(start)));
        let one = |&sensor: &Quantity| LiveSensor { sensor, values: values.clone(), granules: granules.clone() };
        Self { known: start..start, sensors: mapped(estimates.sensors(), &one) }
    }

    pub(super) fn reaches(&self, start: usize) -> bool {
        (self.known.start..=self.known.end).contains(&start)
    }

    /// ν of some samples of each sensor, limited; 0 where nothing was measured.
    pub(super) fn values(&self, samples: &Range<usize>) -> Vec<Vec<f64>> {
        let of = |one: &LiveSensor| mapped(one.values.items(samples.clone()), &|value| limited(*value));
        mapped(&self.sensors, &of)
    }

    pub(super) fn extend(&mut self, window: &Range<usize>, estimates: &Estimates, record: &Record) {
        self.known = window.start..self.known.end.max(window.end);
        let m = self.sensors.len();
        for (place, LiveSensor { values, .. }) in self.sensors.iter_mut().enumerate() {
            for k in values.end() - record.forgotten()..(window.end.max(values.end())) - record.forgotten() {
                values.push(estimates.innovation(k)[place] / estimates.innovation_cov(k)[place * (m + 1)].sqrt());
            }
        }
    }

    pub(super) fn follow(&mut self, window: &Range<usize>, record: &Record) {
        let input = Input::new(window, record);
        for LiveSensor { values, granules, .. } in &mut self.sensors {
            granules.follow(window, |samples| {
                let mut sums = InnovationSums::default();
                sums.add_samples(values, samples, &Input { mean: input.at(samples.start), ..input });
                sums
            });
            values.forget_before(window.start);
        }
    }

    pub(super) fn by_part(&self, window: &Range<usize>, record: &Record) -> Vec<SensorInnovations> {
        let input = Input::new(window, record).centred();
        let of_part = |sensor: &LiveSensor, part: usize| {
            let range = parts::range(part, window);
            let mut sums = InnovationSums { input_square: input.square(&range), ..InnovationSums::default() };
            for Piece { samples, granule } in pieces(&range, window) {
                match granule.and_then(|number| sensor.granules.get(number)).filter(|_| !input.is_limited(&samples)) {
                    Some(granule) => sums.add(granule, input.at(samples.start) - input.mean),
                    None => sums.add_samples(&sensor.values, &samples, &input),
                }
            }
            sums
        };
        let one = |of: &LiveSensor| SensorInnovations::new(of.sensor, std::array::from_fn(|part| of_part(of, part)));
        mapped(&self.sensors, &one)
    }
}

impl InnovationSums {
    fn add_samples(&mut self, values: &Series<f64>, samples: &Range<usize>, input: &Input<'_>) {
        let begin = samples.start.saturating_sub(BEFORE).max(input.first);
        let known = values.items(begin..samples.end);
        let mut near = [0.0; BEFORE + GRANULE];
        for (near, value) in near[BEFORE + begin - samples.start..].iter_mut().zip(known) {
            *near = limited(*value);
        }
        let values = &near[BEFORE..][..samples.len()];
        for value in known[samples.start - begin..].iter().filter(|value| !value.is_nan()) {
            self.count += 1.0;
            self.square += value * value;
        }
        self.sum += values.iter().sum::<f64>();
        add_products(&mut self.products, values, &near);
        add_products(&mut self.cross, values, &input.near(samples));
    }

    /// Adds those of a granule, from whose input a number was subtracted that is larger than the window's mean by `above`.
    fn add(&mut self, of: &Self, above: f64) {
        self.count += of.count;
        self.square += of.square;
        self.sum += of.sum;
        for (sum, product) in self.products.iter_mut().zip(&of.products) {
            *sum += product;
        }
        for (sum, cross) in self.cross.iter_mut().zip(&of.cross) {
            *sum += cross + above * of.sum;
        }
    }
}

fn limited(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(-LARGEST, LARGEST) }
}

const INPUT_BEFORE: usize = CROSS_LAGS - 1 - AFTER;

#[derive(Clone, Copy)]
struct Input<'a> {
    values: &'a [f64],
    first: usize,
    mean: f64,
    limit: f64,
}

impl<'a> Input<'a> {
    fn new(window: &Range<usize>, record: &'a Record) -> Self {
        let values = &record.input()[window.start - record.forgotten()..window.end - record.forgotten()];
        Self { values, first: window.start, mean: 0.0, limit: f64::INFINITY }
    }

    fn centred(self) -> Self {
        let count = self.values.len().max(1) as f64;
        let mean = sum_of(self.values, |f| f) / count;
        let limit = LARGEST * (sum_of(self.values, |f| (f - mean) * (f - mean)) / count).sqrt();
        Self { mean, limit, ..self }
    }

    fn at(&self, sample: usize) -> f64 {
        self.values[sample - self.first]
    }

    fn of(&self, value: f64) -> f64 {
        (value - self.mean).max(-self.limit).min(self.limit)
    }

    fn square(&self, samples: &Range<usize>) -> f64 {
        sum_of(&self.values[samples.start - self.first..samples.end - self.first], |f| self.of(f) * self.of(f))
    }

    fn is_limited(&self, samples: &Range<usize>) -> bool {
        let near = &self.values[samples.start - INPUT_BEFORE - self.first..samples.end + AFTER - self.first];
        near.iter().map(|f| u32::from((f - self.mean).abs() > self.limit)).sum::<u32>() > 0
    }

    /// The input that the products of some samples reach, at most a granule of them; 0 outside the window.
    fn near(&self, samples: &Range<usize>) -> [f64; INPUT_BEFORE + GRANULE + AFTER] {
        let mut near = [0.0; INPUT_BEFORE + GRANULE + AFTER];
        let begin = samples.start.saturating_sub(INPUT_BEFORE).max(self.first) - self.first;
        let end = (samples.end + AFTER - self.first).min(self.values.len());
        let skipped = INPUT_BEFORE + self.first + begin - samples.start;
        for (near, f) in near[skipped..].iter_mut().zip(&self.values[begin..end]) {
            *near = self.of(*f);
        }
        near
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::{ALL, FIRST_CROSS_LAG};
    use kalmanscope_core::{Run, Scenario};

    #[test]
    fn every_part_has_the_sums_of_its_samples() {
        let mut run = Run::new(&Scenario { duration: 4.0, ..Scenario::default() }).unwrap();
        run.finish();
        let (estimates, record, window) = (&run.estimates()[0], run.record(), 7..333);
        let mut live = LiveInnovations::new(estimates, window.start);
        live.extend(&window, estimates, record);
        let (values, direct) = (live.values(&window), live.by_part(&window, record));
        live.follow(&window, record);
        let input = &record.input()[window.clone()];
        let mean = input.iter().sum::<f64>() / input.len() as f64;
        let rms = (input.iter().map(|f| (f - mean) * (f - mean)).sum::<f64>() / input.len() as f64).sqrt();
        let input: Vec<f64> = input.iter().map(|f| (f - mean).clamp(-LARGEST * rms, LARGEST * rms)).collect();
        for (one, values) in [direct, live.by_part(&window, record)].iter().flat_map(|all| all.iter().zip(&values)) {
            for (part, sums) in one.by_part.iter().enumerate() {
                let range = parts::range(part, &(0..window.len()));
                let product = |others: &[f64], lag: i64| {
                    let one = |k: usize| Some(values[k] * others.get(usize::try_from(k as i64 - lag).ok()?)?);
                    range.clone().filter_map(one).sum::<f64>()
                };
                let of_lags = (0..).zip(&sums.products).map(|(lag, sum)| (*sum, product(values, lag)));
                let of_input =
                    (i64::from(FIRST_CROSS_LAG)..).zip(&sums.cross).map(|(lag, sum)| (*sum, product(&input, lag)));
                let others = [
                    (sums.count, range.len() as f64),
                    (sums.sum, values[range.clone()].iter().sum()),
                    (sums.square, product(values, 0)),
                    (sums.input_square, input[range.clone()].iter().map(|f| f * f).sum()),
                ];
                for (sum, plain) in of_lags.chain(of_input).chain(others) {
                    assert!((sum - plain).abs() < 1e-9 * (1.0 + plain.abs()), "part {part}: {sum}, not {plain}");
                }
            }
        }
    }

    #[test]
    fn a_part_after_a_much_louder_one_is_correlated_by_one_at_most() {
        let mut by_part = [InnovationSums::default(); PARTS];
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
