//! Where a filter reports to.

/// One sample of a filter: its belief after the update, in the channels' units, and what the measurement told. n channels,
/// m sensors.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Mean, n numbers.
    pub mean: &'a [f64],
    /// Covariance, n × n, symmetric to the last bit.
    pub cov: &'a [f64],
    /// The innovation e of each sensor in its unit, m numbers; NaN where a sensor measured nothing.
    pub innovation: &'a [f64],
    /// S, the covariance of e, m × m.
    pub innovation_cov: &'a [f64],
    /// K: for each sensor, the change of each channel by a unit of innovation; m × n.
    pub gain: &'a [f64],
    /// Normalised innovation squared.
    pub nis: f64,
    /// det S over the sensors that measured; zero or infinite where it leaves the range of numbers.
    pub determinant: f64,
    /// Of a particle filter, the logarithm of the mean likelihood of its particles; NaN for any other, where it follows
    /// from NIS and det S.
    pub log_likelihood: f64,
    /// Effective sample size of a particle filter before it resampled; NaN for any other.
    pub effective_samples: f64,
    /// Of an adaptive filter, the variances of process and sensor noise that it assumes by now.
    pub noise: Option<AssumedNoise<'a>>,
}

impl<'a> Sample<'a> {
    /// A belief that no measurement belongs to.
    pub fn unmeasured(mean: &'a [f64], cov: &'a [f64]) -> Self {
        let nan = f64::NAN;
        Self {
            mean,
            cov,
            innovation: &[],
            innovation_cov: &[],
            gain: &[],
            nis: nan,
            determinant: nan,
            log_likelihood: nan,
            effective_samples: nan,
            noise: None,
        }
    }
}

/// The variances that an adaptive filter assumes.
#[derive(Clone, Copy, Debug)]
pub struct AssumedNoise<'a> {
    /// Diagonal of Q, n numbers, in the state's units squared.
    pub process: &'a [f64],
    /// Diagonal of R, m numbers, in the sensors' units squared.
    pub sensors: &'a [f64],
}
