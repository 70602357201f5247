//! The results of a filter over the kept part of a record.

use kalmanscope_core::diagnostics::{Diagnostics, ErrorSums, LjungBox, MeanSquare, Whiteness};
use kalmanscope_core::{Channel, Estimates, FilterKind, Quantity, Record, Stop};

use crate::{Diagnosis, Verdict};

/// The results of one filter over a record.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// The filter's name.
    pub name: String,
    /// The filter's kind.
    pub kind: FilterKind,
    /// The number of samples with an estimate that are kept.
    pub samples: usize,
    /// The verdict on the filter, if there are enough samples.
    pub verdict: Option<Verdict>,
    /// The last estimate of each channel.
    pub finals: Vec<Final>,
    /// The normalised innovation squared, if anything was measured.
    pub nis: Option<MeanSquare>,
    /// The normalised estimation error squared, if any truth is known.
    pub nees: Option<MeanSquare>,
    /// The share of samples with the truth inside the belief's 95 % ellipsoid, if any truth is known.
    pub share_in_ellipsoid: Option<f64>,
    /// The Ljung-Box test of each sensor's innovations, if there are enough.
    pub ljung_box: Vec<(Quantity, Option<LjungBox>)>,
    /// Sum of the log likelihoods of all samples with a measurement.
    pub log_likelihood: f64,
    /// Where the filter stopped, if it could not continue.
    pub stop: Option<Stop>,
}

/// The last estimate of a channel, canonical and in the channel's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Final {
    /// The channel.
    pub channel: Channel,
    /// Estimated mean.
    pub mean: f64,
    /// Its standard deviation according to the filter.
    pub std: f64,
    /// Its errors, where the truth is known.
    pub score: Option<Score>,
}

/// The errors of a channel's estimates, in the channel's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// The last mean minus the truth.
    pub error: f64,
    /// Root mean square error over all samples.
    pub rmse: f64,
    /// Root mean square error over the last third of the samples.
    pub rmse_last_third: f64,
    /// The share of samples with the truth inside ±2σ.
    pub coverage: f64,
    /// The time since which the estimate has stayed within 5 % of the truth \[s\], if it is.
    pub settled: Option<f64>,
}

impl Summary {
    /// The log likelihood as the evidence of a model class: minus infinity where the filter stopped.
    pub fn log_evidence(&self) -> f64 {
        if self.stop.is_some() { f64::NEG_INFINITY } else { self.log_likelihood }
    }

    /// Sums up the estimates of a filter against the record that it followed.
    pub fn new(estimates: &Estimates, record: &Record) -> Self {
        let diagnostics = Diagnostics::new(estimates, record);
        let diagnosis = Diagnosis::new(&diagnostics, estimates, record);
        Self::of(&diagnostics, diagnosis.as_ref(), estimates, record)
    }

    /// Sums up diagnostics that have followed these estimates and this record, and the diagnosis that they have led to.
    pub fn of(
        diagnostics: &Diagnostics,
        diagnosis: Option<&Diagnosis>,
        estimates: &Estimates,
        record: &Record,
    ) -> Self {
        let finals = diagnostics.len().checked_sub(1).map_or(Vec::new(), |last| {
            let one = |(place, &channel): (usize, &Channel)| Final {
                channel,
                mean: estimates.canonical_mean(last, place),
                std: estimates.std(last, place),
                score: Score::new(diagnostics, record, channel),
            };
            estimates.channels().iter().enumerate().map(one).collect()
        });
        let tests = diagnostics.whiteness.iter().map(Whiteness::ljung_box);
        Self {
            name: estimates.name().to_owned(),
            kind: estimates.kind,
            samples: diagnostics.len(),
            verdict: diagnosis.and_then(|diagnosis| diagnosis.verdict.clone()),
            finals,
            nis: diagnostics.mean_nis(),
            nees: diagnostics.mean_nees(),
            share_in_ellipsoid: diagnostics.share_in_ellipsoid(),
            ljung_box: estimates.sensors().iter().copied().zip(tests).collect(),
            log_likelihood: diagnostics.log_likelihood(),
            stop: diagnostics.stop,
        }
    }
}

impl Score {
    fn new(diagnostics: &Diagnostics, record: &Record, channel: Channel) -> Option<Self> {
        let all = diagnostics.tally(channel, 0..diagnostics.len())?;
        let last_third = diagnostics.tally(channel, diagnostics.last_third());
        Some(Self {
            error: diagnostics.error(channel)?,
            rmse: all.rmse(),
            rmse_last_third: last_third.map_or(f64::NAN, ErrorSums::rmse),
            coverage: all.coverage(),
            settled: diagnostics.settled(channel).map(|number| record.time_of(number)),
        })
    }
}
