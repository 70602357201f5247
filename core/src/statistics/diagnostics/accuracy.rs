//! The errors of estimates against a known truth, channel by channel.

use kalmanscope_filters::Channel;
use kalmanscope_filters::engine::number::Number;

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
    pub(crate) known: T,
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

#[cfg(test)]
mod tests {
    use kalmanscope_filters::engine::belief::ErrorSquare;
    use kalmanscope_filters::engine::level::Baseline;

    fn nees<const N: usize>(places: [usize; N], errors: [f64; N], cov: &[f64]) -> (f64, f64) {
        let mut square = ErrorSquare::new(places.to_vec());
        square.errors.copy_from_slice(&errors);
        square.of::<_, false>(Baseline, [&vec![0.0; cov.len().isqrt()], cov])
    }

    #[test]
    fn a_hand_case() {
        // P = [4, 2; 2, 3], det 8, P⁻¹ = [3, -2; -2, 4]/8; e = (1, 2): (3 - 8 + 16)/8.
        let cov = [4.0, 2.0, 2.0, 3.0];
        let (sum, degrees) = nees([0, 1], [1.0, 2.0], &cov);
        assert!((sum - 11.0 / 8.0).abs() < 1e-15 && degrees == 2.0);
        assert_eq!(nees([1], [2.0], &cov), (4.0 / 3.0, 1.0), "one channel's variance, not its share of P⁻¹");
        // Channels that are known for certain do not count.
        let cov = [4.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 3.0];
        assert_eq!(nees([0, 1, 2], [1.0, 7.0, 2.0], &cov), (sum, degrees));
        assert_eq!(nees([1], [7.0], &cov).1, 0.0);
    }

    #[test]
    fn an_estimate_that_is_right_to_the_last_bit_is_consistent() {
        for n in [1, 4] {
            let cov: Vec<f64> = (0..n * n).map(|i| if i % (n + 1) == 0 { 1e-78 } else { 0.0 }).collect();
            let mut square = ErrorSquare::new((0..n).collect());
            for mean in [0.04, 0.0] {
                square.errors.fill(-6.9e-18);
                let (sum, degrees) = square.of::<_, false>(Baseline, [&vec![mean; n], &cov]);
                assert!(sum < n as f64 && degrees > 0.0, "{sum} {degrees}");
            }
        }
    }

    #[test]
    fn four_channels_and_more_take_the_same_steps() {
        let a = nalgebra::Matrix5::from_fn(|i, j| libm::sin(1.0 + (3 * i + 5 * j * j) as f64));
        let cov = a * a.transpose() + nalgebra::Matrix5::identity();
        let (four, errors) = (cov.fixed_view::<4, 4>(0, 0).into_owned(), [0.3, -1.0, 2.0, 0.1]);
        let [fast, slow] = [four.as_slice(), cov.as_slice()].map(|cov| nees([0, 1, 2, 3], errors, cov).0.to_bits());
        assert_eq!(fast, slow);
    }

    #[test]
    fn samples_without_a_factor_or_an_error_are_left_out() {
        for (errors, cov) in [
            ([1.0, 1.0], [1.0, 1.0, 1.0, 1.0]),
            ([1.0, 1.0], [1.0, 2.0, 2.0, 1.0]),
            ([1.0, f64::NAN], [1.0, 0.0, 0.0, 1.0]),
        ] {
            assert_eq!(nees([0, 1], errors, &cov).1, 0.0, "{errors:?} {cov:?}");
        }
    }
}
