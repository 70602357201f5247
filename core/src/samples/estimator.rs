//! Filters of any kind over any plant, with types and sizes erased.

pub(crate) mod bounded;
pub(crate) mod engine;
pub(crate) mod in_units;
pub(crate) mod sampled;
pub(crate) mod setup;
pub(crate) mod update;

use crate::data::record::Parts;
use crate::mathematics::filter::Gaussian;
use crate::mathematics::model::{Hold, InputKind, Model};
use crate::samples::sink::Sink;
use crate::{Channel, FilterError, FilterSettings, PlantKind, Quantity, Record, Scenario};

pub(crate) trait Estimator: Send {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError>;

    /// Predicts from the last sample with its force, updates with this sample's measurements, and reports the result.
    fn step(&mut self, force_before: f64, force: f64, measured: &[f64], sink: &mut dyn Sink)
    -> Result<(), FilterError>;

    /// The same through a step's parts. A filter that [`counts_in_samples`] takes each sensor's last reading at the end.
    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError>;

    /// In the channels' units. Only a mean and a covariance can be replaced.
    fn set_belief(&mut self, _mean: &[f64], _cov: &[f64]) -> Result<(), FilterError> {
        Err(FilterError::IndefiniteCovariance)
    }

    /// Adds from now on its passages to sinks that ask for them. Returns false for a filter that has none.
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

/// A belief in the coordinates of its filter, and the usual misfits of one that weighs its readings.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) belief: Gaussian,
    misfits: Vec<f64>,
}

/// A filter that counts in samples cannot go from one reading to the next: it takes each reading at the sample after it.
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
pub(crate) struct Failed(pub(crate) FilterError);

impl Estimator for Failed {
    fn begin(&self, _: &mut dyn Sink) -> Result<(), FilterError> {
        Err(self.0)
    }

    fn step(&mut self, _: f64, _: f64, _: &[f64], _: &mut dyn Sink) -> Result<(), FilterError> {
        Err(self.0)
    }

    fn step_through(&mut self, _: &Parts, _: &mut dyn Sink) -> Result<(), FilterError> {
        Err(self.0)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct FilterContext {
    /// The truth's kind of plant; the filter uses it unless its settings name another.
    pub(crate) plant: PlantKind,
    pub(crate) input: InputKind,
    pub(crate) hold: Hold,
    pub(crate) sensors: Vec<Quantity>,
    /// Time between samples \[s\].
    pub(crate) dt: f64,
    pub(crate) seed: u64,
    /// The number of the filter's random stream, from 0 on.
    pub(crate) stream: usize,
    /// Whether it goes from one reading of the record to the next, at the times that they have.
    pub(crate) is_timed: bool,
    /// The time of the first sample \[s\].
    pub(crate) start: f64,
}

impl FilterContext {
    pub(crate) fn new(scenario: &Scenario, dt: f64, filter: &FilterSettings) -> Self {
        let Scenario { seed, plant, input, hold, .. } = scenario;
        let sensors = scenario.measured();
        let stream = filter.id.saturating_sub(1) as usize;
        Self {
            plant: plant.kind,
            input: *input,
            hold: *hold,
            sensors,
            dt,
            seed: *seed,
            stream,
            is_timed: false,
            start: 0.0,
        }
    }

    pub(crate) fn over(self, record: &Record, settings: &FilterSettings) -> Self {
        let has_times = record.clocks().is_some() || settings.delays(record.dt()).is_of_sensors();
        let is_timed = has_times && counts_in_samples(settings).is_none();
        Self { is_timed, start: record.time_of(0), ..self }
    }

    /// Whether a reading does not tell of its sample.
    pub(crate) fn is_late(&self, settings: &FilterSettings) -> bool {
        self.is_timed || settings.delays(self.dt).is_of_sensors()
    }

    pub(crate) fn steps(&self, settings: &FilterSettings) -> usize {
        settings.steps(self.plant, self.input, self.dt)
    }

    pub(crate) fn model(&self, settings: &FilterSettings) -> Model {
        settings.model(self.plant, self.input)
    }
}
