//! The innovations of each sensor, granule by granule.

use std::ops::Range;

use super::granule::{AFTER, BEFORE, GRANULE, first_in, pieces, samples_of};
use super::input::{self, GranuleInput, NearInput, WindowInput};
use super::series::Series;
use crate::judgement::diagnosis::innovations::{CROSS_LAGS, SensorInnovations, Sums, limited};
use crate::judgement::diagnosis::lagged::{add_near_products, sum_of};
use crate::judgement::diagnosis::parts::{self, PARTS};
use crate::{Estimates, Quantity, Record};

/// The innovations of all sensors, and the input.
#[derive(Debug)]
pub(super) struct LiveInnovations {
    /// The samples from the beginning of the last window to the last one that is taken in.
    known: Range<usize>,
    sensors: Vec<LiveSensor>,
    input: Series<GranuleInput>,
}

/// The normalised innovations ν of one sensor.
#[derive(Debug)]
struct LiveSensor {
    sensor: Quantity,
    /// ν² of every sample; NaN where nothing was measured.
    squares: Series<f64>,
    /// ν of every sample, limited; 0 where nothing was measured.
    values: Series<f64>,
    /// The sums of every granule. In those with the input, the mean of the granule's input is subtracted.
    granules: Series<Sums>,
}

/// ν of some samples, at most a granule of them, and of those before.
type Near = [f64; BEFORE + GRANULE];

impl LiveInnovations {
    /// No innovations yet, before the sample `start`.
    pub(super) fn new(estimates: &Estimates, start: usize) -> Self {
        let one = |&sensor: &Quantity| LiveSensor {
            sensor,
            squares: Series::starting_at(start),
            values: Series::starting_at(start),
            granules: Series::starting_at(first_in(start)),
        };
        let sensors = estimates.sensors().iter().map(one).collect();
        Self { known: start..start, sensors, input: Series::starting_at(first_in(start)) }
    }

    /// Whether the next window can begin with this sample: it needs no forgotten sample, and skips none.
    pub(super) fn reaches(&self, start: usize) -> bool {
        (self.known.start..=self.known.end).contains(&start)
    }

    /// ν of some samples of each sensor, limited.
    pub(super) fn values(&self, samples: &Range<usize>) -> impl Iterator<Item = &[f64]> {
        self.sensors.iter().map(|one| one.values.items(samples.clone()))
    }

    /// Takes in the new samples of a window, and forgets those before it.
    pub(super) fn follow(&mut self, window: &Range<usize>, estimates: &Estimates, record: &Record) {
        let kept = record.forgotten();
        let Self { known, sensors, input } = self;
        *known = window.start..known.end.max(window.end);
        input.skip_to(first_in(window.start));
        let before = input.end();
        while (input.end() + 1) * GRANULE + AFTER <= window.end {
            input.push(GranuleInput::new(input.end(), record.input(), kept));
        }
        for (place, sensor) in sensors.iter_mut().enumerate() {
            sensor.take_in(place, window.end, estimates, kept);
            sensor.granules.skip_to(before);
            for number in before..input.end() {
                let (samples, near) = (samples_of(number), input.at(number).near(number, record.input(), kept));
                let values = sensor.values.items(samples.start - BEFORE..samples.end);
                let sums = sums(sensor.squares.items(samples), values, &near);
                sensor.granules.push(sums);
            }
            sensor.squares.forget_before(window.start);
            sensor.values.forget_before(window.start);
            sensor.granules.forget_before(window.start / GRANULE);
        }
        input.forget_before(window.start / GRANULE);
    }

    /// The innovations in each part of a window that has been followed.
    pub(super) fn by_part(&self, window: &Range<usize>, record: &Record) -> Vec<SensorInnovations> {
        let input = WindowInput::new(record.input(), record.forgotten(), window.clone(), &self.input);
        let mut by_part = vec![[Sums::default(); PARTS]; self.sensors.len()];
        for part in 0..PARTS {
            for piece in pieces(&parts::range(part, window), window) {
                let all = self.sensors.iter().zip(by_part.iter_mut().map(|by_part| &mut by_part[part]));
                match piece.granule.and_then(|number| Some((number, input.within_limits(number)?))) {
                    Some((number, of_granule)) => {
                        let (above, square) = (of_granule.mean() - input.mean(), input.square(of_granule));
                        all.for_each(|(sensor, sums)| add(sums, sensor.granules.at(number), above, square));
                    }
                    None => {
                        let near = input.near(&piece.samples);
                        let square = near[input::BEFORE..][..piece.samples.len()].iter().map(|f| f * f).sum();
                        all.for_each(|(sensor, sums)| {
                            add(sums, &sensor.sums(&piece.samples, window, &near), 0.0, square);
                        });
                    }
                }
            }
        }
        self.sensors.iter().zip(by_part).map(|(one, by_part)| SensorInnovations::new(one.sensor, by_part)).collect()
    }
}

impl LiveSensor {
    /// Takes in the innovations up to the sample with number `end`; the first sample that is kept has the number `kept`.
    fn take_in(&mut self, place: usize, end: usize, estimates: &Estimates, kept: usize) {
        let m = estimates.sensors().len();
        for k in self.values.end()..end.max(self.values.end()) {
            let (innovation, cov) = (estimates.innovation(k - kept), estimates.innovation_cov(k - kept));
            let value = innovation[place] / cov[place * (m + 1)].sqrt();
            self.squares.push(value * value);
            self.values.push(if value.is_nan() { 0.0 } else { limited(value) });
        }
    }

    /// The sums of some samples, at most a granule of them, without samples outside the window.
    fn sums(&self, samples: &Range<usize>, window: &Range<usize>, input: &NearInput) -> Sums {
        let mut near: Near = [0.0; BEFORE + GRANULE];
        let begin = samples.start.saturating_sub(BEFORE).max(window.start);
        let known = self.values.items(begin..samples.end);
        let from = BEFORE + begin - samples.start;
        near[from..from + known.len()].copy_from_slice(known);
        sums(self.squares.items(samples.clone()), &near[..BEFORE + samples.len()], input)
    }
}

/// The sums of some samples, at most a granule of them: from ν² of each, ν of each and of those before, and the input near them.
/// The sum of the input's squares stays 0 here: all sensors have the same one, so the caller adds it.
fn sums(squares: &[f64], near: &[f64], input: &NearInput) -> Sums {
    let values = &near[BEFORE..];
    let mut sums = Sums {
        count: f64::from(squares.iter().map(|square| u32::from(!square.is_nan())).sum::<u32>()),
        square: sum_of(squares, |square| if square.is_nan() { 0.0 } else { square }),
        sum: sum_of(values, |value| value),
        ..Sums::default()
    };
    add_near_products(&mut sums.products, values, near);
    add_near_products(&mut sums.cross, values, &input[..CROSS_LAGS - 1 + values.len()]);
    sums
}

/// Adds the sums of some samples, and `input_square`, the sum of the squares of their input. In `of`, the input has a
/// mean subtracted that is larger than the window's mean by `above`.
fn add(sums: &mut Sums, of: &Sums, above: f64, input_square: f64) {
    sums.count += of.count;
    sums.square += of.square;
    sums.sum += of.sum;
    for (sum, product) in sums.products.iter_mut().zip(&of.products) {
        *sum += product;
    }
    for (sum, cross) in sums.cross.iter_mut().zip(&of.cross) {
        *sum += cross + above * of.sum;
    }
    sums.input_square += input_square;
}
