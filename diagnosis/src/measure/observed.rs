//! A run as measures look at it: all its estimates, or the sums of a whole run.

use std::cell::OnceCell;
use std::ops::Range;

use kalmanscope_core::diagnostics::ErrorSums;
use kalmanscope_core::score::{ChannelScore, Outcome};
use kalmanscope_core::{Channel, CramerRao, Diagnostics, Estimates, FilterSettings, Quantity, Record, Scenario};

/// One filter's run over one record, with all its estimates, or the smoothed ones.
pub struct Observed<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) place: usize,
    pub(super) record: &'a Record,
    pub(super) estimates: &'a Estimates,
    pub(super) all: &'a [Estimates],
    given: Option<&'a Diagnostics>,
    own: OnceCell<Diagnostics>,
    bound: OnceCell<Option<CramerRao>>,
}

/// The samples of a measure: the last one, and all of them, if nothing is said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// The time of a single sample \[s\].
    pub at: Option<f64>,
    /// The beginning of a range \[s\].
    pub from: Option<f64>,
    /// The end of a range, excluded \[s\].
    pub to: Option<f64>,
}

impl<'a> Observed<'a> {
    /// The run of the filter at `place` of a scenario over a record.
    pub fn new(scenario: &'a Scenario, place: usize, record: &'a Record, estimates: &'a Estimates) -> Self {
        let (own, bound) = (OnceCell::new(), OnceCell::new());
        Self { scenario, place, record, estimates, all: &[], given: None, own, bound }
    }

    /// With the diagnostics of the same estimates, which are otherwise computed when they are needed.
    #[must_use]
    pub fn with(self, diagnostics: &'a Diagnostics) -> Self {
        Self { given: Some(diagnostics), ..self }
    }

    /// With the estimates of all filters of the scenario.
    #[must_use]
    pub fn among(self, all: &'a [Estimates]) -> Self {
        Self { all, ..self }
    }

    pub(super) fn settings(&self) -> &FilterSettings {
        &self.scenario.filters[self.place]
    }

    pub(super) fn diagnostics(&self) -> &Diagnostics {
        self.given.unwrap_or_else(|| self.own.get_or_init(|| Diagnostics::new(self.estimates, self.record)))
    }

    fn bound(&self) -> Option<&CramerRao> {
        let bound = self.bound.get_or_init(|| {
            let mut bound = CramerRao::new(self.scenario, self.place, self.record.dt())?;
            bound.follow_to(self.record.len(), self.record);
            Some(bound)
        });
        bound.as_ref()
    }
}

pub(super) struct Part<'a> {
    pub(super) run: &'a Observed<'a>,
    pub(super) channel: Option<Channel>,
    pub(super) sensor: Option<Quantity>,
    pub(super) times: Times,
}

impl Part<'_> {
    pub(super) fn range(&self) -> Range<usize> {
        self.samples_up_to(self.run.estimates.len())
    }

    pub(super) fn range_of_record(&self) -> Range<usize> {
        self.samples_up_to(self.run.record.len())
    }

    fn samples_up_to(&self, len: usize) -> Range<usize> {
        let end = self.times.to.map_or(len, |t| self.sample_of(t).min(len));
        self.times.from.map_or(0, |t| self.sample_of(t).min(end))..end
    }

    pub(super) fn sample(&self) -> Option<usize> {
        let last = self.run.estimates.len().checked_sub(1)?;
        let k = self.times.at.map_or(last, |t| self.sample_of(t));
        (k <= last).then_some(k)
    }

    fn sample_of(&self, t: f64) -> usize {
        (t / self.run.record.dt()).round() as usize
    }

    pub(super) fn place(&self) -> Option<usize> {
        self.run.estimates.place(self.channel?)
    }

    pub(super) fn place_of_sensor(&self) -> Option<usize> {
        let sensors = self.run.estimates.sensors();
        self.sensor.map_or(Some(0), |sensor| sensor.place_in(sensors))
    }

    pub(super) fn tally(&self) -> Option<ErrorSums> {
        self.run.diagnostics().tally(self.channel?, self.range())
    }

    pub(super) fn settled(&self) -> Option<usize> {
        self.run.diagnostics().settled(self.channel?).filter(|_| self.run.estimates.stop().is_none())
    }

    pub(super) fn errors(&self, samples: Range<usize>) -> Option<Vec<[f64; 2]>> {
        let (truth, place, estimates) = (self.run.record.truth(self.channel?)?, self.place()?, self.run.estimates);
        let error = |k: usize| [estimates.canonical_mean(k, place) - truth[k], estimates.std(k, place)];
        Some(samples.map(error).collect())
    }

    pub(super) fn sensor_noise_of_channel(&self) -> Option<f64> {
        let mut sensors = self.run.scenario.sensors.iter();
        sensors.find(|sensor| sensor.measures.channel() == self.channel).map(|sensor| sensor.noise_std)
    }

    pub(super) fn true_noise(&self) -> Option<f64> {
        let noise = self.run.scenario.true_noise_for(self.run.settings()).0;
        noise.get(self.place_of_sensor()?).copied()
    }

    pub(super) fn learnt_noise(&self, k: usize) -> Option<[f64; 2]> {
        self.run.estimates.sensor_noise(k, self.place_of_sensor()?)
    }

    /// Mean and standard deviation of the logarithm of the filter's √Q over the true one, at a sample.
    pub(super) fn process_scale(&self, k: usize) -> Option<[f64; 2]> {
        let [mean, std] = self.run.estimates.process_scale(k)?;
        let truth = self.run.scenario.true_process_scale(self.run.settings())?;
        Some([mean - libm::log(truth), std])
    }

    pub(super) fn bound(&self, k: usize) -> Option<f64> {
        let bound = self.run.bound()?;
        (k < bound.len()).then(|| bound.place(self.channel?).map(|place| bound.std(k, place)))?
    }
}

/// The sums of one filter's run over a whole record.
#[derive(Clone, Copy)]
pub struct Whole<'a> {
    /// The record.
    pub record: &'a Record,
    /// The sums.
    pub outcome: &'a Outcome,
    /// The filter's channels.
    pub channels: &'a [Channel],
}

pub(super) struct ObservedSums<'a> {
    pub(super) whole: &'a Whole<'a>,
    pub(super) channel: Option<Channel>,
}

impl ObservedSums<'_> {
    pub(super) fn score(&self, number: impl Fn(&ChannelScore) -> f64) -> f64 {
        let mut scores = self.whole.outcome.channels.iter();
        scores.find(|(channel, _)| Some(*channel) == self.channel).map_or(f64::NAN, |(_, score)| number(score))
    }

    fn place(&self) -> Option<usize> {
        self.channel?.place_in(self.whole.channels)
    }
}

pub(super) fn std(sums: &ObservedSums<'_>) -> f64 {
    sums.place().map_or(f64::NAN, |place| sums.whole.outcome.std[place])
}

/// In the canonical form of the oscillator, with a natural frequency ≥ 0; NaN if the filter does not have the channel.
pub(super) fn estimate(sums: &ObservedSums<'_>) -> f64 {
    let Whole { channels, outcome, .. } = sums.whole;
    let frequency = Channel::NATURAL_FREQUENCY.place_in(channels);
    let is_mirrored = frequency.is_some_and(|place| outcome.mean[place] < 0.0);
    let mean = sums.place().map_or(f64::NAN, |place| outcome.mean[place]);
    if is_mirrored && sums.channel.is_some_and(Channel::is_mirrored) { -mean } else { mean }
}
