//! One filter over one record, and how it is built.

use std::cell::LazyCell;

use kalmanscope_filters::filter::Algorithm;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::quantity::MAX_SENSORS;
use kalmanscope_filters::{Channel, FilterError, Quantity, Stop};
use kalmanscope_records::Record;
use kalmanscope_records::record::{Delays, Parts};

use crate::run::estimator::setup::Setup;
use crate::run::estimator::{Estimator, FilterContext, Truncating, Truncation, counts_in_samples, engine, sampled};
use crate::run::forces::Forces;
use crate::run::mixture::{Guesses, Mixture, Scales, Walk};
use crate::run::run_error::{RunError, one_input, sensor_places};
use crate::run::sink::Sink;
use crate::run::tape::Tape;
use crate::{Estimates, FilterSettings, Scenario};

/// A filter that runs over a record sample by sample and reports to a [`Sink`]: whole records, live mode and maps are loops over it.
pub struct Pass {
    filter: Built,
    truncation: Truncation,
    sensors: Vec<usize>,
    delays: Delays,
    forces: Forces,
    parts: Option<Box<Parts>>,
    done: usize,
    /// Where and why the filter stopped, if it did.
    pub stop: Option<Stop>,
    ahead: Option<Tape>,
}

/// Drawing a large ensemble takes time, so the filter is built later.
type Built = LazyCell<Box<dyn Estimator>, Box<dyn FnOnce() -> Box<dyn Estimator> + Send>>;

impl Pass {
    /// The filter at `place` of a scenario before the first sample of a record.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible or has no such filter, or where the record does not fit it.
    pub fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Self, RunError> {
        let sensors = Self::columns(scenario, place, record)?;
        let mut scenario = scenario.clone();
        scenario.number_filters();
        let filter = &scenario.filters[place];
        let context = FilterContext::over(record, &scenario, filter);
        Ok(Self::with(filter, context, sensors))
    }

    /// The columns of a record for the sensors of a scenario, over which its filter at `place` can run; with the errors of [`Self::new`].
    pub fn columns(scenario: &Scenario, place: usize, record: &Record) -> Result<Vec<usize>, RunError> {
        scenario.validate()?;
        if scenario.filters.get(place).is_none() {
            return Err(RunError::NoFilter(place));
        }
        sensor_places(scenario, record)
    }

    pub(crate) fn with(settings: &FilterSettings, context: FilterContext, sensors: Vec<usize>) -> Self {
        let own = settings.clone();
        Self {
            delays: settings.delays(context.dt),
            forces: context.forces(settings),
            parts: context.is_timed.then(Box::default),
            truncation: Truncation::of(settings, context.model(settings).channels()),
            filter: Built::new(Box::new(move || build(&own, &context))),
            sensors,
            done: 0,
            stop: None,
            ahead: None,
        }
    }

    pub(crate) fn keep_passages(&mut self) -> bool {
        self.filter.keep_passages()
    }

    /// An empty history for the filter at `place` of a scenario, to be filled by a pass.
    ///
    /// # Errors
    /// [`RunError::NoFilter`] where there is no such filter.
    pub fn history(scenario: &Scenario, place: usize) -> Result<Estimates, RunError> {
        let filter = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        Ok(Estimates::new(filter, scenario, scenario.measured()))
    }

    /// [`Self::history`] with memory for a whole record, whose readings may have their own times: its remarks know of them.
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

    /// Appends samples that another pass has computed, of `samples` in all. Returns false if they are of another filter.
    pub(crate) fn take(&mut self, tape: &Tape, samples: usize, estimates: &mut Estimates) -> bool {
        let Some((count, stop)) = tape.play(estimates) else { return false };
        self.done = if stop.is_some() { samples } else { (self.done + count).min(samples) };
        self.stop = stop;
        true
    }

    pub(crate) fn begin_again(&mut self) {
        (self.done, self.stop, self.ahead) = (0, None, None);
    }

    /// Computes the next sample of the record ahead, and keeps it until [`Self::settle`]. Returns whether it has been there already.
    pub(crate) fn prepare(&mut self, record: &Record) -> bool {
        let (next, is_there) = (self.done, self.ahead.is_some() || self.stop.is_some());
        if !is_there && next < record.forgotten() + record.len() {
            let mut tape = Tape::default();
            self.follow(record, next + 1, &mut tape);
            (self.done, self.stop, self.ahead) = (next, None, Some(tape));
        }
        is_there
    }

    pub(crate) fn settle(&mut self, samples: usize, estimates: &mut Estimates) {
        if let Some(tape) = self.ahead.take() {
            self.take(&tape, samples, estimates);
        }
    }

    /// Computes until `samples` samples, counted from the record's beginning, are done, or to the end, or until the filter stops.
    pub fn follow(&mut self, record: &Record, samples: usize, sink: &mut dyn Sink) {
        let Self { filter, truncation, sensors, delays, forces, parts, done, stop, ahead: _ } = self;
        let force = |k: usize| record.delayed_force(k, delays.input);
        let goal = samples.min(record.forgotten() + record.len()).max(*done);
        let mut measured = [f64::NAN; MAX_SENSORS];
        let measured = &mut measured[..sensors.len()];
        if goal == *done {
            return;
        }
        let is_free = truncation.is_empty();
        let mut bounded = Truncating { truncation, sink };
        let sink: &mut dyn Sink = if is_free { bounded.sink } else { &mut bounded };
        for sample in *done..goal {
            if stop.is_some() {
                break;
            }
            let step = if sample == 0 {
                filter.begin(sink)
            } else {
                let k = sample - record.forgotten();
                forces.take(record, k, delays.input);
                if let Some(parts) = parts.as_mut()
                    && record.parts_to(k, delays, sensors, parts)
                {
                    filter.step_through(parts, forces, sink)
                } else {
                    for (place, (value, &sensor)) in measured.iter_mut().zip(sensors.iter()).enumerate() {
                        *value = record.late_reading(sensor, k, delays.of(place));
                    }
                    filter.step([force(k - 1), force(k)], forces, measured, sink)
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

/// The samples between two readings of each sensor, where the readings of a record have their own times.
pub(crate) fn apart(record: &Record, sensors: &[Quantity]) -> Option<Vec<usize>> {
    let clocks = record.clocks()?;
    let readings = |quantity: &Quantity| {
        let column = quantity.place_in(record.sensors());
        column.map_or(0, |column| clocks.readings[column].times.len())
    };
    Some(mapped(sensors, &|quantity| record.len() / readings(quantity).max(1)))
}

/// A [`Pass`] over a record that grows: a sample comes in, an estimate goes out, with the bits of a pass over the whole record.
///
/// Samples follow each other after dt; readings of one that is lost are NaN. With a delay of d samples, estimates come d later.
pub struct OnlineFilter {
    /// The pass, which has the number of samples that are done, and where and why the filter has stopped.
    pub pass: Pass,
    record: Record,
    /// The samples after the one that it filters, and before it, that it reads.
    reach: [usize; 2],
}

/// Forgets samples only when there are this many, since forgetting moves all others.
const FORGET: usize = 64;

impl OnlineFilter {
    /// The filter at `place` of a scenario, before its first sample; with the errors of [`Pass::new`].
    pub fn new(scenario: &Scenario, place: usize) -> Result<Self, RunError> {
        let sensors = scenario.measured();
        let record = Record::empty(scenario.dt, scenario.input, scenario.hold, sensors, Vec::new());
        one_input(scenario)?;
        let pass = Pass::new(scenario, place, &record)?;
        let delays = scenario.filters[place].delays(scenario.dt);
        Ok(Self { pass, record, reach: [delays.lookahead(), delays.reach()] })
    }

    /// Takes in the input \[m/s²\], and a reading of each sensor in the unit of its quantity, NaN where one is missing.
    ///
    /// # Panics
    /// Panics where there is not one reading for each sensor.
    pub fn step(&mut self, input: f64, readings: &[f64], sink: &mut dyn Sink) {
        let Self { pass, record, reach: [after, before] } = self;
        assert_eq!(readings.len(), record.sensors().len(), "a reading for each sensor");
        record.push(input, readings.iter().copied(), []);
        pass.follow(record, (record.forgotten() + record.len()).saturating_sub(*after), sink);
        let read = pass.done().saturating_sub(record.forgotten() + *before + 1);
        if read >= FORGET {
            record.forget(read);
        }
    }

    /// Computes the last samples as a record does at its end, where the last input holds from then on.
    pub fn finish(&mut self, sink: &mut dyn Sink) {
        self.pass.follow(&self.record, usize::MAX, sink);
    }
}

pub(crate) fn build(settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    if settings.process_scales > 1 {
        let rule = Scales::new(settings, context);
        let members = rule.members(settings, context.model(settings).channels());
        return Box::new(Mixture::new(&members, rule, |member| single(member, context)));
    }
    if settings.guesses > 1 {
        let members = Guesses::members(settings);
        return Box::new(Mixture::new(&members, Guesses::new(members.len()), |member| walking(member, context)));
    }
    walking(settings, context)
}

fn walking(settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    if settings.walk == 0.0 {
        return single(settings, context);
    }
    let members = Walk::members(settings, context);
    let (model, frequency) = (context.model(settings), Channel::NATURAL_FREQUENCY);
    let turn = match model.place(frequency) {
        Some(_) => settings.initial_mean[frequency].abs() * context.dt,
        None => settings.turn(&model, context.dt),
    };
    let rule = Walk::new(if turn > 0.0 { turn } else { context.dt });
    Box::new(Mixture::new(&members, rule, |member| single(member, context)))
}

fn single(settings: &FilterSettings, context: &FilterContext) -> Box<dyn Estimator> {
    match settings.kind.info().algorithm {
        Algorithm::Belief(begin) => sampled::estimator(begin, settings, context),
        Algorithm::Gaussian(_) => match Setup::of(settings, context, (0..context.sensors.len()).collect()) {
            Some(setup) => engine::estimator(&setup, settings),
            None => Box::new(FilterError::TooLarge),
        },
    }
}
