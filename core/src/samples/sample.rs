//! One sample of a filter's results.

use crate::mathematics::gaussian_likelihood;

/// One sample of a filter: its belief after the update, in the channels' units, and the results of the update. n
/// channels, m sensors.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Mean, n numbers.
    pub mean: &'a [f64],
    /// Covariance, n × n, symmetric to the last bit.
    pub cov: &'a [f64],
    /// Mean before the update, n numbers; empty unless the sink wants it ([`Sink::wants_prior`](crate::Sink::wants_prior)). At the first sample and where
    /// nothing was measured it is the mean.
    pub prior_mean: &'a [f64],
    /// Covariance before the update, n × n; empty unless the sink wants it.
    pub prior_cov: &'a [f64],
    /// The innovation e of each sensor in its unit, m numbers; NaN where a sensor measured nothing.
    pub innovation: &'a [f64],
    /// S, the covariance of e, m × m.
    pub innovation_cov: &'a [f64],
    /// K: for each sensor, the change of each channel by a unit of innovation; m × n.
    pub gain: &'a [f64],
    /// The readings of the step to this sample that one of the same sensor follows in it. e, S and K are those of the last one; NIS
    /// and det S count all.
    pub earlier: u32,
    /// Normalised innovation squared.
    pub nis: f64,
    /// det S over the sensors with a measurement; zero or infinite where it underflows or overflows.
    pub determinant: f64,
    /// For a particle filter, the logarithm of the mean likelihood of its particles; NaN for other filters, where it
    /// follows from NIS and det S.
    pub log_likelihood: f64,
    /// Effective sample size of a particle filter before it resampled; NaN for any other.
    pub effective_samples: f64,
    /// For an adaptive filter, the present variances of process and sensor noise.
    pub noise: Option<AssumedNoise<'a>>,
    /// For a filter that weighs its readings, the weight of each sensor's, from 0 for none to about 1, m numbers; NaN where a sensor
    /// measured nothing, and empty for any other filter.
    pub weights: &'a [f64],
    /// Whether the filter widened P in the step to this sample, because its innovations had grown at once; of a bank, whether it is
    /// from this sample on more probable that its parameters walk.
    pub has_widened: bool,
}

impl<'a> Sample<'a> {
    /// A belief without a measurement, and without that before it.
    pub fn unmeasured(mean: &'a [f64], cov: &'a [f64]) -> Self {
        let nan = f64::NAN;
        Self {
            mean,
            cov,
            prior_mean: &[],
            prior_cov: &[],
            innovation: &[],
            innovation_cov: &[],
            gain: &[],
            earlier: 0,
            nis: nan,
            determinant: nan,
            log_likelihood: nan,
            effective_samples: nan,
            noise: None,
            weights: &[],
            has_widened: false,
        }
    }

    /// The number of readings in its update.
    pub fn readings(&self) -> u32 {
        self.earlier + readings(self.innovation)
    }

    /// The log likelihood of the measurements, of every kind of filter; NaN where there was none.
    ///
    /// ```text
    /// -(NIS + ln det S + m ln 2π) / 2
    /// ```
    pub fn ln_likelihood(&self) -> f64 {
        let Self { innovation, innovation_cov, nis, determinant, log_likelihood: own, .. } = *self;
        match self.readings() {
            0 => f64::NAN,
            _ if !own.is_nan() => own,
            measured => {
                let ln_determinant = gaussian_likelihood::ln_determinant(determinant, innovation_cov, innovation.len());
                gaussian_likelihood::log_likelihood(nis, ln_determinant, measured)
            }
        }
    }
}

#[inline]
pub(crate) fn readings(innovation: &[f64]) -> u32 {
    innovation.iter().map(|e| u32::from(!e.is_nan())).sum()
}

/// The variances of an adaptive filter.
#[derive(Clone, Copy, Debug)]
pub struct AssumedNoise<'a> {
    /// Diagonal of Q, n numbers, in the state's units squared.
    pub process: &'a [f64],
    /// Diagonal of R, m numbers, in the sensors' units squared.
    pub sensors: &'a [f64],
    /// The variance of each number of [`Self::sensors`]; zero where R is not learnt.
    pub uncertainty: &'a [f64],
    /// Mean and standard deviation of ln s, where s is the factor between √Q and the √Q of the settings; NaN for a filter with one scale
    /// ([`FilterSettings::process_scales`](crate::FilterSettings::process_scales)).
    pub process_scale: [f64; 2],
}
