//! Filters of any kind over any plant, with types and sizes erased.

pub(crate) mod engine;
pub(crate) mod sampled;
pub(crate) mod setup;
pub(crate) mod update;

use kalmanscope_filters::filter::Gaussian;
use kalmanscope_filters::truncated_normal::truncated;
use kalmanscope_filters::{Channel, FilterError, ForcedMass, Hold, InputKind, Quantity, Stop};
use kalmanscope_records::Record;
use kalmanscope_records::record::Parts;

use crate::run::forces::Forces;
use crate::run::passage::Passages;
use crate::run::sink::{Sample, Sink};
use crate::{FilterSettings, Model, PlantKind, Scenario};

pub(crate) trait Estimator: Send {
    fn begin(&mut self, sink: &mut dyn Sink) -> Result<(), FilterError>;

    /// With the force on all masses at the sample before and at this one.
    fn step(&mut self, force: [f64; 2], forces: &Forces, z: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError>;

    /// The same through a step's parts. A filter that [`counts_in_samples`] takes each sensor's last reading at the end.
    fn step_through(&mut self, parts: &Parts, forces: &Forces, sink: &mut dyn Sink) -> Result<(), FilterError>;

    /// In the channels' units. Only a mean and a covariance can be replaced.
    fn set_belief(&mut self, _mean: &[f64], _cov: &[f64]) -> Result<(), FilterError> {
        Err(FilterError::IndefiniteCovariance)
    }

    /// Makes passages for sinks that ask for them from now on. Returns false for a filter that has none.
    fn keep_passages(&mut self) -> bool {
        false
    }

    /// The state from which [`Self::restore`] can begin again; none of a filter that is more than a belief.
    fn state(&self) -> Option<State> {
        None
    }

    fn restore(&mut self, _: &State) -> Result<(), FilterError> {
        Err(FilterError::IndefiniteCovariance)
    }
}

pub(crate) struct State {
    pub(crate) belief: Gaussian,
    memory: Vec<f64>,
}

/// The option that makes a filter count in samples: such a filter takes each reading at the sample after it.
pub(crate) fn counts_in_samples(settings: &FilterSettings) -> Option<&'static str> {
    let such = [
        (!settings.kind.is_gaussian(), "random members"),
        (settings.adaptation.is_on(), "noise that it learns"),
        (settings.jump, "jumps"),
        (settings.walk > 0.0, "a bank"),
        (settings.augment.contains(&Channel::WHITE_FORCE), "a white force"),
    ];
    such.into_iter().find_map(|(is, what)| is.then_some(what))
}

/// A filter that fails at the first sample, because its initial covariance has no root to draw samples with.
impl Estimator for FilterError {
    fn begin(&mut self, _: &mut dyn Sink) -> Result<(), FilterError> {
        Err(*self)
    }

    fn step(&mut self, _: [f64; 2], _: &Forces, _: &[f64], _: &mut dyn Sink) -> Result<(), FilterError> {
        Err(*self)
    }

    fn step_through(&mut self, _: &Parts, _: &Forces, _: &mut dyn Sink) -> Result<(), FilterError> {
        Err(*self)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct FilterContext {
    /// The truth's kind of plant; the filter uses it unless its settings name another.
    pub(crate) plant: PlantKind,
    pub(crate) input: InputKind,
    pub(crate) hold: Hold,
    pub(crate) sensors: Vec<Quantity>,
    pub(crate) dt: f64,
    pub(crate) seed: u64,
    pub(crate) stream: usize,
    pub(crate) is_timed: bool,
    pub(crate) start: f64,
    pub(crate) forced: Vec<ForcedMass>,
}

impl FilterContext {
    pub(crate) fn new(scenario: &Scenario, dt: f64, filter: &FilterSettings) -> Self {
        let &Scenario { seed, input, hold, .. } = scenario;
        let (plant, sensors) = (scenario.plant.kind.clone(), scenario.measured());
        let stream = filter.id.saturating_sub(1) as usize;
        Self { plant, input, hold, sensors, dt, seed, stream, is_timed: false, start: 0.0, forced: Vec::new() }
    }

    /// Over a record, at the times of its readings where it has some.
    pub(crate) fn over(record: &Record, scenario: &Scenario, settings: &FilterSettings) -> Self {
        let has_times = record.clocks().is_some() || settings.delays(record.dt()).is_of_sensors();
        let is_timed = has_times && counts_in_samples(settings).is_none();
        let forced = record.forced().to_vec();
        Self { is_timed, start: record.time_of(0), forced, ..Self::new(scenario, record.dt(), settings) }
    }

    pub(crate) fn steps(&self, settings: &FilterSettings) -> usize {
        settings.steps(&self.plant, self.input, self.dt)
    }

    pub(crate) fn model(&self, settings: &FilterSettings) -> Model {
        settings.model(&self.plant, self.input)
    }

    pub(crate) fn forces(&self, settings: &FilterSettings) -> Forces {
        Forces::of(self.model(settings).channels(), &self.forced, self.hold)
    }
}

/// Bounds of channels: a filter reports the moments of its belief between the ends.
/// ```text
/// y ← y + k (μ - yᵢ),  P ← P + k (s² - Pᵢᵢ) kᵀ,  k = P eᵢ / Pᵢᵢ
/// ```
/// for each channel, with mean μ and standard deviation s of N(yᵢ, Pᵢᵢ) between the ends. The filter keeps its belief: an end counts once.
/// Source: Simon (2010), Kalman filtering with state constraints: a survey of linear and nonlinear algorithms.
#[derive(Clone, Debug, Default)]
pub(crate) struct Truncation {
    places: Vec<(usize, [f64; 2])>,
    mean: Vec<f64>,
    cov: Vec<f64>,
    along: Vec<f64>,
}

impl Truncation {
    pub(crate) fn of(settings: &FilterSettings, channels: &[Channel]) -> Self {
        let place = |channel: Channel| channel.place_in(channels);
        let places = settings.bounds.iter().filter_map(|(channel, between)| Some((place(channel)?, between.ends())));
        Self { places: places.collect(), ..Self::default() }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    pub(crate) fn apply<'a>(&'a mut self, mean: &'a [f64], cov: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        if self.is_empty() {
            return (mean, cov);
        }
        let Self { places, mean: own, cov: own_cov, along } = self;
        own.clear();
        own.extend_from_slice(mean);
        own_cov.clear();
        own_cov.extend_from_slice(cov);
        let n = own.len();
        for &(i, ends) in &*places {
            let variance = own_cov[i * n + i];
            if !(variance > 0.0 && own[i].is_finite()) {
                continue;
            }
            let [mean, std] = truncated([own[i], variance.sqrt()], ends);
            along.clear();
            along.extend(own_cov[i * n..(i + 1) * n].iter().map(|entry| entry / variance));
            let by = mean - own[i];
            own.iter_mut().zip(&*along).for_each(|(mean, along)| *mean += along * by);
            own[i] = mean;
            let more = std * std - variance;
            for row in 0..n {
                for column in 0..=row {
                    let entry = own_cov[row * n + column] + more * (along[row] * along[column]);
                    (own_cov[row * n + column], own_cov[column * n + row]) = (entry, entry);
                }
            }
        }
        // A later channel may have moved one before it.
        places.iter().for_each(|&(i, [least, most])| own[i] = own[i].clamp(least, most));
        (own, own_cov)
    }
}

pub(crate) struct Truncating<'a> {
    pub(crate) truncation: &'a mut Truncation,
    pub(crate) sink: &'a mut dyn Sink,
}

impl Sink for Truncating<'_> {
    fn push(&mut self, sample: &Sample<'_>) {
        let (mean, cov) = self.truncation.apply(sample.mean, sample.cov);
        self.sink.push(&Sample { mean, cov, ..*sample });
    }

    fn stop_at(&mut self, stop: Stop) {
        self.sink.stop_at(stop);
    }

    fn wants_prior(&self) -> bool {
        self.sink.wants_prior()
    }

    fn passages(&mut self) -> Option<&mut Passages> {
        self.sink.passages()
    }
}
