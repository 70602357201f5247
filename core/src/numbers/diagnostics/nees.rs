//! The normalised estimation error squared, which compares the covariance with the errors.

use super::chi_squared;
use super::totals::Totals;
use crate::mathematics::engine::belief::ErrorSquare;
use crate::mathematics::engine::level::Baseline;

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
    /// Begins again, for errors of the channels at `places`, in ascending order.
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

    /// Takes in a sample: the errors of these channels, and the mean and n × n covariance of all n channels.
    #[inline]
    pub(super) fn push(&mut self, errors: &[f64], mean: &[f64], cov: &[f64]) {
        let Self { square, values, totals, inside, limits } = self;
        let (square, degrees) = of_errors(square, errors, mean, cov);
        values.push(square);
        totals.push(square, degrees);
        *inside += u32::from(degrees > 0 && square <= limits[degrees as usize - 1]);
    }

    /// The share of samples below the 95 % quantile of their degrees of freedom; NaN without any.
    pub(super) fn coverage(&self) -> f64 {
        f64::from(self.inside) / f64::from(self.totals.whole().samples)
    }
}

/// The square of some errors and its degrees of freedom: NaN and zero where there is none.
#[inline]
pub(crate) fn of_errors(square: &mut ErrorSquare<f64>, errors: &[f64], mean: &[f64], cov: &[f64]) -> (f64, u32) {
    errors.iter().enumerate().for_each(|(at, error)| square.errors[at] = *error);
    let (sum, degrees) = square.of::<_, false>(Baseline, [mean, cov]);
    if degrees > 0.0 { (sum, degrees as u32) } else { (f64::NAN, 0) }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!((both.totals.whole().degrees, both.inside), (2, 1));
        assert_eq!(nees(&[1], &[2.0], &cov, 2).values, [4.0 / 3.0], "one channel's variance, not its share of P⁻¹");
    }

    #[test]
    fn channels_known_for_certain_do_not_count() {
        let cov = [4.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 3.0];
        let some = nees(&[0, 1, 2], &[1.0, 7.0, 2.0], &cov, 3);
        assert!((some.values[0] - 11.0 / 8.0).abs() < 1e-15);
        assert_eq!(some.totals.whole().degrees, 2);
        let none = nees(&[1], &[7.0], &cov, 3);
        assert!(none.values[0].is_nan() && none.totals.whole().samples == 0);
    }

    #[test]
    fn an_estimate_that_is_right_to_the_last_bit_is_consistent() {
        for n in [1, 4] {
            let mut nees = Nees::default();
            nees.restart(0..n);
            let cov: Vec<f64> = (0..n * n).map(|i| if i % (n + 1) == 0 { 1e-78 } else { 0.0 }).collect();
            nees.push(&vec![-6.9e-18; n], &vec![0.04; n], &cov);
            // A sample at which the oscillator passes through zero is not special.
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
