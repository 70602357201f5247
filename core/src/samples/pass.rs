//! One filter over one record.

use crate::data::record::{Delays, Parts};
use crate::mathematics::lists::mapped;
use crate::mathematics::quantity::MAX_SENSORS;
use crate::samples::estimator::{Estimator, Failed, FilterContext, counts_in_samples};
use crate::samples::run_error::sensor_places;
use crate::samples::select;
use crate::samples::sink::Sink;
use crate::samples::tape::Tape;
use crate::{Estimates, FilterError, FilterSettings, Quantity, Record, RunError, Scenario, Stop};

/// A filter that runs over a record sample by sample and reports to a [`Sink`]. Whole records, live mode and maps of
/// thousands of runs are loops over this.
pub struct Pass {
    filter: Built,
    sensors: Vec<usize>,
    delays: Delays,
    /// Memory for the parts of a step, of a filter that goes from one reading to the next.
    parts: Option<Box<Parts>>,
    done: usize,
    stop: Option<Stop>,
    ahead: Option<Tape>,
}

#[derive(Default)]
struct Built {
    /// What it is built from: to draw a large ensemble takes time. None once it is built, and for a pass without a filter.
    recipe: Option<Box<(FilterSettings, FilterContext)>>,
    estimator: Option<Box<dyn Estimator>>,
}

impl Built {
    fn estimator(&mut self) -> &mut dyn Estimator {
        let Self { recipe, estimator } = self;
        let build = || match recipe.take() {
            Some(recipe) => select::estimator(&recipe.0, &recipe.1),
            None => Box::new(Failed(FilterError::NotFinite)),
        };
        estimator.get_or_insert_with(build).as_mut()
    }
}

impl Pass {
    /// The filter at `place` of a scenario before the first sample of a record.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible, [`RunError::NoFilter`] where there is no such filter,
    /// [`RunError::MissingSensor`] and [`RunError::InputKind`] where the record does not fit the scenario.
    pub fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Self, RunError> {
        let sensors = Self::columns(scenario, place, record)?;
        let mut scenario = scenario.clone();
        scenario.number_filters();
        let filter = &scenario.filters[place];
        let context = FilterContext::new(&scenario, record.dt(), filter).over(record, filter);
        Ok(Self::with(filter, &context, sensors))
    }

    /// The columns of a record for the sensors of a scenario, over which its filter at `place` can run.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn columns(scenario: &Scenario, place: usize, record: &Record) -> Result<Vec<usize>, RunError> {
        scenario.validate()?;
        if scenario.filters.get(place).is_none() {
            return Err(RunError::NoFilter(place));
        }
        sensor_places(scenario, record)
    }

    pub(crate) fn with(settings: &FilterSettings, context: &FilterContext, sensors: Vec<usize>) -> Self {
        let estimator = Some(select::estimator(settings, context));
        Self::of(Built { recipe: None, estimator }, settings.delays(context.dt), context.is_timed, sensors)
    }

    /// The same, which adds its passages to sinks that ask for them; `None` of a filter that has none.
    pub(crate) fn with_passages(
        settings: &FilterSettings,
        context: &FilterContext,
        sensors: Vec<usize>,
    ) -> Option<Self> {
        let mut pass = Self::with(settings, context, sensors);
        pass.filter.estimator().keep_passages().then_some(pass)
    }

    /// The same, but the filter is built with its first sample.
    pub(crate) fn later(settings: &FilterSettings, context: FilterContext, sensors: Vec<usize>) -> Self {
        let (delays, is_timed) = (settings.delays(context.dt), context.is_timed);
        let recipe = Some(Box::new((settings.clone(), context)));
        Self::of(Built { recipe, estimator: None }, delays, is_timed, sensors)
    }

    fn of(filter: Built, delays: Delays, is_timed: bool, sensors: Vec<usize>) -> Self {
        let parts = is_timed.then(Box::default);
        Self { filter, sensors, delays, parts, done: 0, stop: None, ahead: None }
    }

    pub(crate) fn idle() -> Self {
        Self::of(Built::default(), Delays::default(), false, Vec::new())
    }

    /// An empty history for the filter at `place` of a scenario, to be filled by a pass.
    ///
    /// # Errors
    /// [`RunError::NoFilter`] where there is no such filter.
    pub fn history(scenario: &Scenario, place: usize) -> Result<Estimates, RunError> {
        let filter = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        let quantities = scenario.measured();
        Ok(Estimates::new(filter, &filter.model(scenario.plant.kind, scenario.input), quantities))
    }

    /// [`Self::history`] with memory for a whole record, whose readings may have times of their own: its remarks say so where the
    /// filter does not follow them, and a sensor that measures seldom is not taken for a silent one.
    ///
    /// # Errors
    /// Those of [`Self::history`].
    pub fn history_over(scenario: &Scenario, place: usize, record: &Record) -> Result<Estimates, RunError> {
        let mut history = Self::history(scenario, place)?;
        history.recycle(None, record.len());
        let apart = apart(record, history.sensors());
        Ok(history.over(apart.as_deref(), record.dt(), counts_in_samples(&scenario.filters[place])))
    }

    /// The number of samples done, counted from the record's beginning.
    pub fn done(&self) -> usize {
        self.done
    }

    /// Where and why the filter stopped, if it did.
    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Appends samples that another pass of the same filter has computed; this one can continue only from the last. Returns false
    /// if they are of another filter. `samples` is the number of all samples.
    pub(crate) fn take(&mut self, tape: &Tape, samples: usize, estimates: &mut Estimates) -> bool {
        let Some((count, stop)) = tape.play(estimates) else { return false };
        self.done = if stop.is_some() { samples } else { (self.done + count).min(samples) };
        self.stop = stop;
        true
    }

    pub(crate) fn begin_again(&mut self) {
        (self.done, self.stop, self.ahead) = (0, None, None);
    }

    /// Computes the next sample of the record ahead, if there is one, and keeps it until [`Self::settle`].
    pub(crate) fn prepare(&mut self, record: &Record) {
        let next = self.done;
        if self.ahead.is_none() && self.stop.is_none() && next < record.forgotten() + record.len() {
            let mut tape = Tape::default();
            self.follow(record, next + 1, &mut tape);
            (self.done, self.stop, self.ahead) = (next, None, Some(tape));
        }
    }

    /// Whether the next sample has been computed ahead, or there is none.
    pub(crate) fn is_prepared(&self) -> bool {
        self.ahead.is_some() || self.stop.is_some()
    }

    /// Appends the sample that was computed ahead, if there is one. `samples` is the number of all samples.
    pub(crate) fn settle(&mut self, samples: usize, estimates: &mut Estimates) {
        if let Some(tape) = self.ahead.take() {
            self.take(&tape, samples, estimates);
        }
    }

    /// Computes until `samples` samples, counted from the record's beginning, are done, or to the end of the record. A
    /// filter that fails reports the reason to the sink and computes no further samples.
    pub fn follow(&mut self, record: &Record, samples: usize, sink: &mut dyn Sink) {
        let Self { filter, sensors, delays, parts, done, stop, ahead: _ } = self;
        let force = |k: usize| record.delayed_force(k, delays.input);
        let goal = samples.min(record.forgotten() + record.len()).max(*done);
        let mut measured = [f64::NAN; MAX_SENSORS];
        let measured = &mut measured[..sensors.len()];
        if goal == *done {
            return;
        }
        let estimator = filter.estimator();
        for sample in *done..goal {
            if stop.is_some() {
                break;
            }
            let step = if sample == 0 {
                estimator.begin(sink)
            } else {
                let k = sample - record.forgotten();
                if let Some(parts) = parts.as_mut()
                    && record.parts_to(k, delays, sensors, parts)
                {
                    estimator.step_through(parts, sink)
                } else {
                    for (place, (value, &sensor)) in measured.iter_mut().zip(sensors.iter()).enumerate() {
                        *value = record.late_reading(sensor, k, delays.of(place));
                    }
                    estimator.step(force(k - 1), force(k), measured, sink)
                }
            };
            if let Err(reason) = step {
                let at = Stop { sample, reason };
                *stop = Some(at);
                sink.stop_at(at);
            }
        }
        *done = goal;
    }
}

/// The samples between two readings of each sensor, where the readings of a record have times of their own.
pub(crate) fn apart(record: &Record, sensors: &[Quantity]) -> Option<Vec<usize>> {
    let clocks = record.clocks()?;
    let readings = |quantity: &Quantity| {
        let column = quantity.place_in(record.sensors());
        column.map_or(0, |column| clocks.readings[column].times.len())
    };
    Some(mapped(sensors, &|quantity| record.len() / readings(quantity).max(1)))
}
