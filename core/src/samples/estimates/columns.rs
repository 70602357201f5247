//! Whole columns of a filter's history: one number at every kept sample.

use super::Estimates;

/// Each column begins with the first sample that is kept, and has [`Estimates::len`] numbers. `channel` and `sensor` are
/// places in [`Estimates::channels`] and [`Estimates::sensors`]: like an index into a slice, one beyond the last panics.
///
/// ```
/// use kalmanscope_core::{Channel, Run, Scenario};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut run = Run::new(&Scenario { duration: 1.0, ..Scenario::default() })?;
/// run.finish();
/// let ekf = &run.estimates()[0];
/// let wn = ekf.place(Channel::NATURAL_FREQUENCY).ok_or("the filter estimates it")?;
/// let upper: Vec<f64> = ekf.means(wn).zip(ekf.stds(wn)).map(|(mean, std)| mean + 2.0 * std).collect();
/// assert_eq!(upper.len(), 101);
/// assert_eq!(upper[100], ekf.mean(100)[wn] + 2.0 * ekf.std(100, wn));
/// # Ok(())
/// # }
/// ```
impl Estimates {
    /// The mean of one channel, as in [`Self::mean`]. [`Self::canonical_means`] has those in canonical form.
    pub fn means(&self, channel: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator + '_ {
        (0..self.len()).map(move |k| self.mean(k)[channel])
    }

    /// The standard deviation of one channel. [`Self::variances`] has the squares.
    pub fn stds(&self, channel: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator + '_ {
        self.variances(channel).iter().map(|variance| variance.sqrt())
    }

    /// The innovation e of one sensor in its unit; NaN where it measured nothing.
    pub fn innovations(&self, sensor: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator + '_ {
        (0..self.len()).map(move |k| self.innovation(k)[sensor])
    }

    /// The standard deviation of the innovation of one sensor, by S; NaN where it measured nothing.
    pub fn innovation_stds(&self, sensor: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator + '_ {
        let diagonal = sensor * (self.sensors.len() + 1);
        (0..self.len()).map(move |k| self.innovation_cov(k)[diagonal].sqrt())
    }

    /// The gain K of one channel by one sensor: the change of the mean per unit of innovation. NaN where matrices have
    /// been dropped ([`Self::drop_matrices`]).
    pub fn gains(
        &self,
        channel: usize,
        sensor: usize,
    ) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator + '_ {
        let n = self.channels.len();
        (0..self.len()).map(move |k| match self.gain(k) {
            [] => f64::NAN,
            gain => gain[sensor * n..][..n][channel],
        })
    }

    /// The log likelihood of the measurements, as in [`Self::log_likelihood`]; NaN where there was none.
    pub fn log_likelihoods(&self) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator + '_ {
        (0..self.len()).map(|k| self.log_likelihood(k))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Run, Scenario};

    #[test]
    fn columns_have_the_numbers_of_each_sample() {
        let mut run = Run::new(&Scenario { duration: 1.0, ..Scenario::default() }).unwrap();
        run.advance_to(80);
        run.forget(30);
        let estimates = &run.estimates()[1];
        let (n, m) = (estimates.channels().len(), estimates.sensors().len());
        assert_eq!((n, m, estimates.len(), estimates.forgotten()), (4, 2, 50, 30));
        let same = |column: &mut dyn Iterator<Item = f64>, of: &dyn Fn(usize) -> f64| {
            let column: Vec<u64> = column.map(f64::to_bits).collect();
            assert_eq!(column, (0..50).map(|k| of(k).to_bits()).collect::<Vec<_>>());
        };
        for i in 0..n {
            same(&mut estimates.means(i), &|k| estimates.mean(k)[i]);
            same(&mut estimates.stds(i), &|k| estimates.std(k, i));
            for j in 0..m {
                same(&mut estimates.gains(i, j), &|k| estimates.gain(k)[j * n + i]);
            }
        }
        for j in 0..m {
            same(&mut estimates.innovations(j), &|k| estimates.innovation(k)[j]);
            same(&mut estimates.innovation_stds(j), &|k| estimates.innovation_cov(k)[j * m + j].sqrt());
        }
        same(&mut estimates.log_likelihoods(), &|k| estimates.log_likelihood(k));
    }

    #[test]
    fn gains_that_are_dropped_are_not_numbers() {
        let mut run = Run::new(&Scenario { duration: 0.2, ..Scenario::default() }).unwrap();
        run.finish();
        let mut estimates = run.estimates()[0].clone();
        assert!(estimates.gains(0, 1).skip(1).all(|gain| gain != 0.0 && gain.is_finite()));
        estimates.drop_matrices();
        let gains: Vec<f64> = estimates.gains(0, 1).collect();
        assert!(gains[..20].iter().all(|gain| gain.is_nan()) && gains.len() == 21 && !gains[20].is_nan());
    }
}
