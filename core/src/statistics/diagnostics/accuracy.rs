//! The errors of estimates against a known truth: channel by channel, and compared with the covariance as their normalised square.

use std::ops::Range;

use kalmanscope_filters::Channel;
use kalmanscope_filters::engine::belief::ErrorSquare;
use kalmanscope_filters::engine::level::Baseline;
use kalmanscope_filters::engine::number::Number;
use kalmanscope_records::Record;

use super::chi_squared;
use super::totals::{RangeSums, Totals};
use crate::Estimates;

/// Limits the relative error of an estimate that has settled.
const SETTLED: f64 = 0.05;

/// The tally of a channel's errors over some samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorSums {
    /// Sum of the squared errors, in the channel's unit squared.
    pub squares: f64,
    /// The number of samples with a known truth.
    pub known: u32,
    /// The number of samples with the truth inside ±2σ.
    pub inside: u32,
}

impl ErrorSums {
    /// The root mean square error, in the channel's unit; NaN without a known truth.
    pub fn rmse(self) -> f64 {
        (self.squares / f64::from(self.known)).sqrt()
    }

    /// The share of samples with the truth inside ±2σ: 0.954 where the errors are normal and σ is right.
    pub fn coverage(self) -> f64 {
        f64::from(self.inside) / f64::from(self.known)
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Tracked<T> {
    pub(crate) channel: Channel,
    pub(crate) place: usize,
    squares: T,
    known: T,
    inside: T,
    /// The sample, from the run's beginning, since which the error is within [`SETTLED`]; the next one if the last is not.
    pub(crate) settled: T,
    pub(crate) recent: T,
    pub(crate) recent_known: T,
    pub(crate) largest_truth: T,
    pub(crate) first_error: T,
    pub(crate) error: T,
    pub(crate) initial_variance: T,
}

impl<T: Number> Tracked<T> {
    pub(crate) fn new(channel: Channel, place: usize, first: usize) -> Self {
        let (zero, none) = (T::of(0.0), T::of(f64::NAN));
        Self {
            channel,
            place,
            squares: zero,
            known: zero,
            inside: zero,
            settled: T::of(first as f64),
            recent: zero,
            recent_known: zero,
            largest_truth: zero,
            first_error: zero,
            error: none,
            initial_variance: none,
        }
    }

    #[inline(always)]
    pub(crate) fn take(&mut self, error: T, truth: T, variance: T, number: usize, is_recent: bool) {
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let (square, size, is_known) = (error * error, error.abs(), error.is_number());
        let (counted, count) = (T::select(is_known, square, zero), T::select(is_known, one, zero));
        self.first_error = T::select(is_known & self.known.le(zero), size, self.first_error);
        self.squares = self.squares + counted;
        self.known = self.known + count;
        self.inside = self.inside + T::select(square.le(variance * 4.0), one, zero);
        self.largest_truth = self.largest_truth.max(truth.abs());
        if is_recent {
            self.recent = self.recent + counted;
            self.recent_known = self.recent_known + count;
        }
        // An unknown error does not end a settled stretch; it only delays the beginning of the first one.
        let (now, next) = (T::of(number as f64), T::of((number + 1) as f64));
        let stays = size.le(truth.abs() * SETTLED) | (!is_known & self.settled.lt(now));
        self.settled = T::select(stays, self.settled, next);
    }

    #[inline(always)]
    pub(crate) fn total(&self, lane: usize) -> ErrorSums {
        let [squares, known, inside] = [self.squares, self.known, self.inside].map(|number| number.lane(lane));
        ErrorSums { squares, known: known as u32, inside: inside as u32 }
    }
}

/// Whether an error exceeds `limit` standard deviations, the truth, the first error and the initial uncertainty.
pub(crate) fn is_lost(rmse: f64, std: f64, limit: f64, seen: f64, initial_std: f64) -> bool {
    std > 0.0 && rmse > limit * std && rmse > seen.max(2.0 * initial_std)
}

/// The sign of the mirrored channels of a mean: -1 where the natural frequency is negative.
#[inline]
fn sign_of(mean: &[f64], frequency: Option<usize>) -> f64 {
    if frequency.is_some_and(|place| mean[place] < 0.0) { -1.0 } else { 1.0 }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Accuracy {
    pub(super) known: Vec<Tracked<f64>>,
    first: usize,
    frequency: Option<usize>,
    squares: Vec<RangeSums>,
    /// The errors of the last samples, a row each, in the filter's own form, and the sign that makes the last ones canonical.
    errors: Vec<f64>,
    sign: f64,
}

impl Accuracy {
    pub(super) fn restart(&mut self, estimates: &Estimates, record: &Record) {
        let Self { known, first, frequency, squares, errors, sign } = self;
        *first = estimates.forgotten();
        known.clear();
        let all = estimates.channels().iter().enumerate().filter(|(_, channel)| record.truth(**channel).is_some());
        known.extend(all.map(|(place, channel)| Tracked::new(*channel, place, *first)));
        *frequency = estimates.place(Channel::NATURAL_FREQUENCY);
        squares.resize_with(known.len(), RangeSums::default);
        squares.iter_mut().for_each(RangeSums::clear);
        errors.clear();
        errors.resize(known.len(), f64::NAN);
        *sign = 1.0;
    }

    /// In the filter's own form, a row for each. Channel by channel, since a channel's sums then stay in registers.
    pub(super) fn measure(&mut self, estimates: &Estimates, record: &Record, samples: Range<usize>) -> &[f64] {
        let Self { known, frequency, errors, sign, .. } = self;
        let width = known.len();
        errors.clear();
        errors.resize(width * samples.len(), f64::NAN);
        for (at, one) in known.iter().enumerate() {
            let truth = record.truth(one.channel).unwrap_or_default();
            let column = errors[at..].iter_mut().step_by(width);
            for (error, k) in column.zip(samples.clone()) {
                let mean = estimates.mean(k);
                let sign = if one.channel.is_mirrored() { sign_of(mean, *frequency) } else { 1.0 };
                *error = mean[one.place] - sign * truth[k];
            }
        }
        if let Some(last) = samples.last() {
            *sign = sign_of(estimates.mean(last), *frequency);
        }
        errors
    }

    pub(super) fn push(&mut self, estimates: &Estimates, record: &Record, samples: Range<usize>) -> &[f64] {
        self.measure(estimates, record, samples.clone());
        let Self { known, first, squares, errors, .. } = self;
        let width = known.len();
        for (at, (one, squares)) in known.iter_mut().zip(squares).enumerate() {
            let (mut tracked, truth) = (*one, record.truth(one.channel).unwrap_or_default());
            for (&error, k) in errors[at..].iter().step_by(width).zip(samples.clone()) {
                let variance = estimates.cov(k)[tracked.place * (estimates.channels().len() + 1)];
                tracked.take(error, truth[k], variance, *first + k, false);
                let ErrorSums { known, inside, .. } = tracked.total(0);
                squares.push(if error.is_nan() { 0.0 } else { error * error }, (known, inside));
            }
            *one = tracked;
        }
        errors
    }

    pub(super) fn error(&self, at: usize) -> f64 {
        let sign = if self.known[at].channel.is_mirrored() { self.sign } else { 1.0 };
        sign * self.errors[self.errors.len() - self.known.len() + at]
    }

    pub(super) fn settled(&self, at: usize) -> Option<usize> {
        let Tracked { settled, known, .. } = self.known[at];
        let (settled, end) = (settled as usize, self.first + self.squares[at].len());
        (known > 0.0 && settled < end).then_some(settled)
    }

    pub(super) fn remember(&mut self, before: &[Tracked<f64>]) {
        for (known, before) in self.known.iter_mut().zip(before).filter(|(_, before)| before.known > 0.0) {
            known.first_error = before.first_error;
            known.largest_truth = known.largest_truth.max(before.largest_truth);
            if known.settled == self.first as f64 {
                known.settled = known.settled.min(before.settled);
            }
        }
    }

    pub(super) fn place(&self, channel: Channel) -> Option<usize> {
        self.known.iter().position(|known| known.channel == channel)
    }

    pub(super) fn within(&self, at: usize, range: Range<usize>) -> ErrorSums {
        let (squares, (known, inside)) = self.squares[at].within(range, self.known[at].squares);
        ErrorSums { squares, known, inside }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Nees {
    square: ErrorSquare<f64>,
    pub(super) values: Vec<f64>,
    pub(super) totals: Totals,
    inside: u32,
    /// The 95 % quantile for one and more degrees of freedom.
    limits: Vec<f64>,
}

impl Nees {
    pub(super) fn restart(&mut self, new_places: impl Iterator<Item = usize>) {
        let Self { square, values, totals, inside, limits } = self;
        *square = ErrorSquare::new(new_places.collect());
        values.clear();
        totals.clear();
        *inside = 0;
        for degrees in limits.len()..square.places.len() {
            limits.push(chi_squared::quantile(0.95, degrees as u32 + 1).unwrap_or(f64::INFINITY));
        }
    }

    #[inline]
    pub(super) fn push(&mut self, errors: &[f64], mean: &[f64], cov: &[f64]) {
        let Self { square, values, totals, inside, limits } = self;
        square.errors.copy_from_slice(errors);
        let (sum, degrees) = square.of::<_, false>(Baseline, [mean, cov]);
        let (square, degrees) = if degrees > 0.0 { (sum, degrees as u32) } else { (f64::NAN, 0) };
        values.push(square);
        totals.push(square, degrees);
        *inside += u32::from(degrees > 0 && square <= limits[degrees as usize - 1]);
    }

    /// The share of samples below the 95 % quantile of their degrees of freedom; NaN without any.
    pub(super) fn coverage(&self) -> f64 {
        f64::from(self.inside) / f64::from(self.totals.whole.samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::sink::Sample;
    use crate::{FilterSettings, Scenario};
    use kalmanscope_filters::random::{Normal, Purpose};
    use kalmanscope_filters::{Hold, InputKind};

    const STD: f64 = 0.5;

    fn of(samples: impl IntoIterator<Item = [(f64, f64); 2]>) -> Accuracy {
        let channels = vec![Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
        let mut estimates = Estimates::new(&FilterSettings::default(), &Scenario::default(), Vec::new());
        let mut record = Record::empty(0.01, InputKind::Force, Hold::Zero, Vec::new(), channels);
        let mut accuracy = Accuracy::default();
        accuracy.restart(&estimates, &record);
        for (k, pairs) in samples.into_iter().enumerate() {
            let [frequency, damping] = pairs.map(|(mean, _)| mean);
            let cov: Vec<f64> = (0..16).map(|i| if i % 5 == 0 { STD * STD } else { 0.0 }).collect();
            estimates.append(&Sample::unmeasured(&[0.0, 0.0, frequency, damping], &cov));
            record.push(0.0, [], pairs.map(|(_, truth)| truth));
            accuracy.push(&estimates, &record, k..k + 1);
        }
        accuracy
    }

    fn settled(errors: &[f64]) -> Option<usize> {
        of(errors.iter().map(|error| [(4.0 + error, if error.is_nan() { f64::NAN } else { 4.0 }), (0.0, 0.0)]))
            .settled(0)
    }

    #[test]
    fn an_estimate_has_settled_from_when_on_it_is_near_the_truth_for_good() {
        let (near, far, unknown) = (0.199, -0.201, f64::NAN);
        for (errors, expected) in [
            (&[far, near, -near, 0.0][..], Some(1)),
            (&[near, near], Some(0)),
            (&[near, far, near], Some(2)),
            (&[near, near, far], None),
            (&[far, unknown], None),
            (&[far, unknown, near, unknown], Some(2)),
            (&[unknown, unknown], None),
            (&[], None),
        ] {
            assert_eq!(settled(errors), expected, "{errors:?}");
        }
    }

    #[test]
    fn errors_are_those_of_the_canonical_form() {
        let mirrored = of([[(-6.5, 6.0), (-0.04, 0.05)], [(-6.25, 6.0), (-0.03, 0.05)]]);
        assert_eq!((mirrored.error(0), mirrored.errors[0]), (0.25, -0.25));
        assert!((mirrored.error(1) + 0.02).abs() < 1e-15);
        assert!((mirrored.within(0, 0..2).squares - (0.25 + 0.0625)).abs() < 1e-15);
        assert_eq!(mirrored.settled(0), Some(1));
        let known = mirrored.known[0];
        assert_eq!((known.first_error, known.largest_truth), (0.5, 6.0));
    }

    #[test]
    fn normal_errors_are_inside_two_standard_deviations_as_often_as_they_should() {
        let mut normal = Normal::new(5, Purpose::Force);
        let accuracy = of((0..20_000).map(|_| [(7.0 + STD * normal.sample(), 7.0), (2.0, 0.0)]));
        let tally = accuracy.within(0, 0..20_000);
        // 0.9545 ± three standard deviations of a share of 20 000 samples.
        assert!((tally.coverage() - 0.9545).abs() < 0.0045, "{}", tally.coverage());
        assert!((tally.rmse() / STD - 1.0).abs() < 0.015, "{}", tally.rmse());
        assert_eq!(accuracy.within(1, 0..20_000), ErrorSums { squares: 80_000.0, known: 20_000, inside: 0 });
    }

    #[test]
    fn ranges_are_as_long_as_there_are_samples() {
        let accuracy = of([[(1.0, 0.0), (0.0, f64::NAN)], [(3.0, 0.0), (2.0, 0.0)], [(f64::NAN, 0.0), (0.0, 0.0)]]);
        assert_eq!(accuracy.within(0, 1..99), ErrorSums { squares: 9.0, known: 1, inside: 0 });
        assert_eq!(accuracy.within(1, 0..1), ErrorSums::default());
        assert!(accuracy.within(1, 0..1).rmse().is_nan() && accuracy.error(0).is_nan());
        assert_eq!(accuracy.within(1, 0..3).known, 2);
        assert_eq!(of([]).within(0, 0..5), ErrorSums::default());
    }

    fn nees(places: &[usize], errors: &[f64], cov: &[f64], n: usize) -> Nees {
        let mut nees = Nees::default();
        nees.restart(places.iter().copied());
        nees.push(errors, &vec![0.0; n], cov);
        nees
    }

    #[test]
    fn a_hand_case() {
        // P = [4, 2; 2, 3], det 8, P⁻¹ = [3, -2; -2, 4]/8; e = (1, 2): (3 - 8 + 16)/8.
        let cov = [4.0, 2.0, 2.0, 3.0];
        let both = nees(&[0, 1], &[1.0, 2.0], &cov, 2);
        assert!((both.values[0] - 11.0 / 8.0).abs() < 1e-15);
        assert_eq!((both.totals.whole.degrees, both.inside), (2, 1));
        assert_eq!(nees(&[1], &[2.0], &cov, 2).values, [4.0 / 3.0], "one channel's variance, not its share of P⁻¹");
    }

    #[test]
    fn channels_known_for_certain_do_not_count() {
        let cov = [4.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 3.0];
        let some = nees(&[0, 1, 2], &[1.0, 7.0, 2.0], &cov, 3);
        assert!((some.values[0] - 11.0 / 8.0).abs() < 1e-15);
        assert_eq!(some.totals.whole.degrees, 2);
        let none = nees(&[1], &[7.0], &cov, 3);
        assert!(none.values[0].is_nan() && none.totals.whole.samples == 0);
    }

    #[test]
    fn an_estimate_that_is_right_to_the_last_bit_is_consistent() {
        for n in [1, 4] {
            let mut nees = Nees::default();
            nees.restart(0..n);
            let cov: Vec<f64> = (0..n * n).map(|i| if i % (n + 1) == 0 { 1e-78 } else { 0.0 }).collect();
            nees.push(&vec![-6.9e-18; n], &vec![0.04; n], &cov);
            nees.push(&vec![-6.9e-18; n], &vec![0.0; n], &cov);
            assert!(nees.values.iter().all(|&square| square < n as f64), "{:?}", nees.values);
        }
    }

    #[test]
    fn four_channels_and_more_take_the_same_steps() {
        let a = nalgebra::Matrix5::from_fn(|i, j| libm::sin(1.0 + (3 * i + 5 * j * j) as f64));
        let cov = a * a.transpose() + nalgebra::Matrix5::identity();
        let errors = nalgebra::Vector5::new(0.3, -1.0, 2.0, 0.1, -0.7);
        let five = nees(&[0, 1, 2, 3, 4], errors.as_slice(), cov.as_slice(), 5).values[0];
        let direct = errors.dot(&(cov.try_inverse().unwrap() * errors));
        assert!((five / direct - 1.0).abs() < 1e-9, "{five} instead of {direct}");

        let four = cov.fixed_view::<4, 4>(0, 0).into_owned();
        let fast = nees(&[0, 1, 2, 3], &errors.as_slice()[..4], four.as_slice(), 4).values[0];
        let slow = nees(&[0, 1, 2, 3], &errors.as_slice()[..4], cov.as_slice(), 5).values[0];
        assert_eq!(fast.to_bits(), slow.to_bits());
    }

    #[test]
    fn samples_without_a_factor_or_an_error_are_left_out() {
        for (errors, cov) in [
            ([1.0, 1.0], [1.0, 1.0, 1.0, 1.0]),
            ([1.0, 1.0], [1.0, 2.0, 2.0, 1.0]),
            ([1.0, f64::NAN], [1.0, 0.0, 0.0, 1.0]),
        ] {
            let nees = nees(&[0, 1], &errors, &cov, 2);
            assert!(nees.values[0].is_nan() && nees.coverage().is_nan(), "{errors:?} {cov:?}");
        }
    }
}
