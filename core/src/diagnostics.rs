//! How good the estimates of one filter are.

use statrs::distribution::{ChiSquared, ContinuousCDF as _};

use crate::{Channel, Estimates, FilterKind, Record, Stop};

/// What one filter made of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The filter's name.
    pub name: String,
    /// The filter's kind.
    pub kind: FilterKind,
    /// The number of samples with an estimate.
    pub samples: usize,
    /// The last estimate of each channel.
    pub finals: Vec<Final>,
    /// The normalised innovation squared, if anything was measured.
    pub nis: Option<MeanNis>,
    /// Sum of the log likelihoods of all samples with a measurement.
    pub log_likelihood: f64,
    /// Where the filter stopped, if it could not go on.
    pub stop: Option<Stop>,
}

/// The last estimate of a channel, in the channel's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Final {
    /// The channel.
    pub channel: Channel,
    /// Estimated mean.
    pub mean: f64,
    /// Its standard deviation as the filter sees it.
    pub std: f64,
    /// Mean minus truth, where the truth is known.
    pub error: Option<f64>,
}

/// Mean NIS of a record and the interval that a consistent filter's would be in with probability 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanNis {
    /// Mean over all samples with a measurement.
    pub mean: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl MeanNis {
    /// The sum of the NIS of n samples with d measured numbers in all is χ² distributed with d degrees of freedom.
    ///
    /// Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section
    /// 5.4.
    fn new(estimates: &Estimates) -> Option<Self> {
        let (mut samples, mut degrees, mut sum) = (0.0, 0.0, 0.0);
        for (k, nis) in estimates.nis().iter().enumerate().filter(|(_, nis)| !nis.is_nan()) {
            samples += 1.0;
            degrees += estimates.innovation(k).iter().filter(|e| !e.is_nan()).count() as f64;
            sum += nis;
        }
        let chi_squared = ChiSquared::new(degrees).ok()?;
        let quantile = |p| chi_squared.inverse_cdf(p) / samples;
        Some(Self { mean: sum / samples, low: quantile(0.025), high: quantile(0.975) })
    }

    /// Whether the mean is inside the interval.
    pub fn is_consistent(&self) -> bool {
        (self.low..=self.high).contains(&self.mean)
    }
}

impl Summary {
    /// Sums up the estimates of a filter against the record that it followed.
    pub fn new(estimates: &Estimates, record: &Record) -> Self {
        let finals = estimates.len().checked_sub(1).map_or(Vec::new(), |last| {
            let one = |(place, &channel): (usize, &Channel)| {
                let mean = estimates.mean(last)[place];
                let truth = record.truth(channel).map(|truth| truth[last]).filter(|x| !x.is_nan());
                Final { channel, mean, std: estimates.std(last, place), error: truth.map(|x| mean - x) }
            };
            estimates.channels().iter().enumerate().map(one).collect()
        });
        Self {
            name: estimates.name().to_owned(),
            kind: estimates.kind(),
            samples: estimates.len(),
            finals,
            nis: MeanNis::new(estimates),
            log_likelihood: estimates.log_likelihood().iter().filter(|x| !x.is_nan()).sum(),
            stop: estimates.stop(),
        }
    }
}
