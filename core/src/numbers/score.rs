//! Scores of a filter that need no history.

mod lane_sums;
pub(crate) mod lanes;
mod log_products;
mod look;
pub(crate) mod outcome;
mod scored_pass;

use crate::mathematics::gaussian_likelihood::ln_determinant;
use crate::numbers::diagnostics::Total;
use crate::numbers::diagnostics::accuracy::{TrackedChannel, sign_of};
use crate::numbers::diagnostics::likelihood::Likelihood;
use crate::numbers::diagnostics::nees::ErrorSquare;
use crate::samples::sink::{Sample, Sink};
use crate::{Channel, Estimates, Record, Stop};

use outcome::ChannelSums;

pub use look::Look;
pub use outcome::Outcome;
pub use scored_pass::ScoredPass;

/// Running sums over the samples of one filter, in constant memory, for maps of thousands of runs. The numbers are
/// bit-identical to those of [`Diagnostics`](crate::Diagnostics).
///
/// ```
/// use kalmanscope_core::{Channel, Pass, Run, Scenario, Scores};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario { duration: 20.0, ..Scenario::default() };
/// let mut run = Run::new(&Scenario { filters: vec![], ..scenario.clone() })?;
/// run.finish();
/// let mut scores = Scores::new(&Pass::history(&scenario, 0)?, run.record());
/// Pass::new(&scenario, 0, run.record())?.follow(run.record(), run.samples(), &mut scores.against(run.record()));
/// assert!(scores.channel(Channel::NATURAL_FREQUENCY).unwrap().rmse < 0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Scores {
    channels: usize,
    /// The place of the natural frequency; its sign determines the canonical form.
    frequency: Option<usize>,
    sensors: usize,
    samples: usize,
    known: Vec<TrackedChannel>,
    /// The last error of each tracked channel, and its initial standard deviation.
    last: Vec<Last>,
    /// The last mean and variance of every channel.
    mean: Vec<f64>,
    variance: Vec<f64>,
    /// The errors' squares and their number in the record's last fifth.
    recent: Vec<(f64, u32)>,
    last_fifth: usize,
    errors: Vec<f64>,
    square: ErrorSquare,
    nees: Total,
    nis: Total,
    /// NEES and NIS of the last sample; NaN without a known truth, or a measurement.
    last_squares: [f64; 2],
    likelihood: Likelihood,
    stop: Option<Stop>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Last {
    error: f64,
    initial_std: f64,
}

/// The accuracy of one channel, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelScore {
    /// The last mean minus the truth.
    pub error: f64,
    /// The last standard deviation.
    pub std: f64,
    /// Root mean square error over all samples.
    pub rmse: f64,
    /// The share of samples with the truth inside ±2σ.
    pub coverage: f64,
    /// The sample since which the estimate has stayed within 5 % of the truth, if it is.
    pub settled: Option<usize>,
}

impl Scores {
    /// Empty sums, for a filter with this empty history over the whole of a record.
    pub fn new(history: &Estimates, record: &Record) -> Self {
        let known: Vec<TrackedChannel> = TrackedChannel::of(history.channels(), record, 0).collect();
        let mut square = ErrorSquare::default();
        square.restart(known.iter().map(|known| known.place));
        Self {
            channels: history.channels().len(),
            frequency: history.place(Channel::NATURAL_FREQUENCY),
            sensors: history.sensors().len(),
            samples: 0,
            last: vec![Last { error: f64::NAN, initial_std: f64::NAN }; known.len()],
            mean: vec![f64::NAN; history.channels().len()],
            variance: vec![f64::NAN; history.channels().len()],
            recent: vec![(0.0, 0); known.len()],
            last_fifth: record.len() * 4 / 5,
            errors: vec![f64::NAN; known.len()],
            known,
            square,
            nees: Total::default(),
            nis: Total::default(),
            last_squares: [f64::NAN; 2],
            likelihood: Likelihood::new(history.kind()),
            stop: None,
        }
    }

    /// The sink for samples of this record, which must be the one given to [`Self::new`].
    pub fn against<'a>(&'a mut self, record: &'a Record) -> Scoring<'a> {
        Scoring { scores: self, record }
    }

    /// The number of samples.
    pub fn len(&self) -> usize {
        self.samples
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.samples == 0
    }

    /// The sum of the NEES over all samples; [`Total::mean`] is the mean.
    pub fn nees(&self) -> Total {
        self.nees
    }

    /// The sum of the NIS over all samples with a measurement.
    pub fn nis(&self) -> Total {
        self.nis
    }

    /// The filter at the last sample.
    pub fn look(&self) -> Look {
        let [nees, nis] = self.last_squares;
        let mut channels = vec![[f64::NAN; 2]; self.channels];
        for (at, known) in self.known.iter().enumerate() {
            if let Some(score) = self.sums(at).score(self.samples) {
                channels[known.place] = [score.error, score.std];
            }
        }
        Look { nees, nis, channels }
    }

    /// Sum of the log likelihoods of all samples with a measurement.
    pub fn log_likelihood(&self) -> f64 {
        self.likelihood.value(self.nis)
    }

    /// The accuracy of a channel. `None` if the truth is not known.
    pub fn channel(&self, channel: Channel) -> Option<ChannelScore> {
        let at = self.known.iter().position(|known| known.channel == channel)?;
        self.sums(at).score(self.samples)
    }

    /// The sums of a tracked channel.
    fn sums(&self, at: usize) -> ChannelSums {
        let TrackedChannel { total, first_error, largest_truth, settled, place, .. } = self.known[at];
        let Last { error, initial_std } = self.last[at];
        let (std, recent) = (self.variance[place].sqrt(), self.recent[at]);
        ChannelSums { total, first_error, largest_truth, settled, recent, error, std, initial_std }
    }

    /// Where and why the filter stopped, if it did.
    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Whether the filter has stopped or lost the truth: in the last fifth of the record a channel's error exceeds 10σ,
    /// the largest truth and the initial uncertainty.
    pub fn diverged(&self) -> bool {
        self.stop.is_some() || (0..self.known.len()).any(|at| self.sums(at).is_lost())
    }

    /// All scores at once.
    pub fn outcome(&self) -> Outcome {
        let score = |at: usize| Some((self.known[at].channel, self.sums(at).score(self.samples)?));
        Outcome {
            samples: self.samples,
            nees: self.nees,
            nis: self.nis,
            log_likelihood: self.log_likelihood(),
            stop: self.stop,
            diverged: self.diverged(),
            channels: (0..self.known.len()).filter_map(score).collect(),
            mean: self.mean.clone(),
            std: self.variance.iter().map(|variance| variance.sqrt()).collect(),
            looks: Vec::new(),
        }
    }
}

/// [`Scores`] with their record, as a sink.
pub struct Scoring<'a> {
    scores: &'a mut Scores,
    record: &'a Record,
}

impl Sink for Scoring<'_> {
    fn push(&mut self, sample: &Sample<'_>) {
        let Self { scores, record } = self;
        let Scores { channels, frequency, sensors, samples, known, last, recent, last_fifth, errors, .. } =
            &mut **scores;
        let (n, sensors) = (*channels, *sensors);
        let Some(k) = samples.checked_sub(record.forgotten()) else { return };
        let sign = sign_of(sample.mean, *frequency);
        for (at, known) in known.iter_mut().enumerate() {
            let truth = record.truth_at(known.truth, k);
            let variance = sample.cov[known.place * (n + 1)];
            errors[at] = known.error(sample.mean, sign, truth);
            known.take_in(errors[at], truth, variance, *samples);
            if *samples >= *last_fifth && !errors[at].is_nan() {
                let (squares, count) = &mut recent[at];
                *squares += errors[at] * errors[at];
                *count += 1;
            }
            let Last { error, initial_std } = &mut last[at];
            *error = if known.channel.is_mirrored() { sign * errors[at] } else { errors[at] };
            if *samples == 0 {
                *initial_std = variance.sqrt();
            }
        }
        *samples += 1;
        scores.mean.copy_from_slice(sample.mean);
        for (place, variance) in scores.variance.iter_mut().enumerate() {
            *variance = sample.cov[place * (n + 1)];
        }
        let Scores { errors, square, nees, nis, last_squares, likelihood, .. } = &mut **scores;
        let (square, degrees) = square.of(errors, sample.mean, sample.cov);
        *last_squares = [if degrees > 0 { square } else { f64::NAN }, sample.nis];
        nees.add(square, degrees);
        nis.add(sample.nis, sample.readings());
        let ln = || ln_determinant(sample.determinant, sample.innovation_cov, sensors);
        likelihood.push(sample.determinant, ln, || sample.log_likelihood);
    }

    fn stop_at(&mut self, stop: Stop) {
        self.scores.stop = Some(stop);
    }
}
