//! One filter of a scenario over readings that come at their own times.

use std::collections::VecDeque;

use kalmanscope_filters::filter::FilterError;
use kalmanscope_filters::{Channel, Hold, Quantity, Stop};
use kalmanscope_records::Record;
use kalmanscope_records::record::Parts;
use thiserror::Error;

use crate::run::estimator::{Estimator, FilterContext, State, Truncating, Truncation, counts_in_samples};
use crate::run::forces::Forces;
use crate::run::pass;
use crate::run::passage::{Adjoint, Passage, Passages};
use crate::run::run_error::one_input;
use crate::run::sink::{LastSample, Sample, Sink};
use crate::run::smoother::Hindsight;
use crate::{FilterSettings, Pass, RunError, Scenario};

/// A filter of a scenario that follows events: readings and inputs with their own times, sensors at their own rates,
/// late ones too.
///
/// ```text
/// from an event to the next, h later, in n = ⌈h / dt⌉ equal parts:
///     y⁻ = the prediction over h / n,  P⁻ = λ^(h / n dt) Φ P Φᵀ + Q h / (n dt)
/// ```
///
/// Q and λ are those of a step of dt, the longest one; a shorter one has its share.
///
/// What comes late is taken in at its time, and the filter goes again over what came after it, from a belief that is kept
/// ([`Self::keeping`]). With a smoother and a look-ahead it also reports its estimates in hindsight ([`Self::hindsight`]).
///
/// The first event sets the time. Its estimate is the initial belief, and its readings do not count, as in every run.
/// What is refused leaves the filter as it was.
///
/// ```
/// use kalmanscope_core::{EventFilter, Scenario};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut filter = EventFilter::new(&Scenario::from_toml("dt = 0.01\n[[filters]]\nkind = \"ekf\"")?, 0)?;
/// let missing = f64::NAN;
/// filter.take(0.0, 1.0, &[missing, missing])?;
/// filter.take(0.0143, missing, &[0.0001, missing])?;
/// let sample = filter.take(0.0095, missing, &[missing, 0.009])?; // It comes late.
/// assert_eq!(sample.mean.len(), 4);
/// assert_eq!(filter.time(), Some(0.0143));
/// # Ok(())
/// # }
/// ```
pub struct EventFilter {
    estimator: Box<dyn Estimator>,
    settings: FilterSettings,
    scenario: Scenario,
    /// The components of the state, in the order of every mean and covariance.
    pub channels: Vec<Channel>,
    timeline: Timeline,
    /// The time for which hindsight waits \[s\], if it is asked for.
    look_ahead: Option<f64>,
    truncation: Truncation,
    latest: LatestSample,
    hindsight: Hindsight,
    in_hindsight: LastSample,
    stopped: Option<(f64, FilterError)>,
    /// The events that the last call went over again, because something came late.
    pub again: usize,
    /// The times of the first event and of the newest one \[s\]: a delayed input waits for its time.
    first: f64,
    now: f64,
    at: usize,
}

#[derive(Default)]
struct LatestSample(LastSample, Passages);

impl Sink for LatestSample {
    fn push(&mut self, sample: &Sample<'_>) {
        self.0.push(sample);
    }

    fn stop_at(&mut self, _: Stop) {}

    fn wants_prior(&self) -> bool {
        true
    }

    fn passages(&mut self) -> Option<&mut Passages> {
        Some(&mut self.1)
    }
}

/// Times that differ by less than this share of dt are the same: clocks have decimals.
const SAME: f64 = 1e-6;

impl EventFilter {
    /// Seconds for which beliefs are kept, unless [`Self::keeping`] says otherwise.
    pub const KEPT: f64 = 1.0;

    /// The filter at `place` of a scenario, before its first event.
    ///
    /// # Errors
    /// [`EventSetupError`] where the scenario is impossible, or the filter has a setting that counts in samples.
    pub fn new(scenario: &Scenario, place: usize) -> Result<Self, EventSetupError> {
        scenario.validate().map_err(RunError::from)?;
        one_input(scenario)?;
        let mut scenario = scenario.clone();
        scenario.number_filters();
        let settings = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?.clone();
        let look_ahead = Some(settings.look_ahead).filter(|seconds| settings.smoother && *seconds > 0.0);
        let refused = [
            (settings.guesses > 1, "several guesses"),
            (settings.process_scales > 1, "scales of Q"),
            (look_ahead.is_some() && !settings.consider.is_empty(), "hindsight beside parameters that it considers"),
        ];
        let refused = refused.into_iter().find_map(|(is, what)| is.then_some(what));
        if let Some(what) = counts_in_samples(&settings).or(refused) {
            return Err(EventSetupError::Setting(what));
        }
        let record = Record::empty(scenario.dt, scenario.input, scenario.hold, scenario.measured(), Vec::new());
        Pass::columns(&scenario, place, &record)?;
        let context = FilterContext::new(&scenario, scenario.dt, &settings);
        let mut estimator = pass::build(&settings, &context);
        let channels = context.model(&settings).channels().to_vec();
        let (mut truncation, mut latest) = (Truncation::of(&settings, &channels), LatestSample::default());
        estimator.begin(&mut Truncating { truncation: &mut truncation, sink: &mut latest })?;
        if look_ahead.is_some() {
            estimator.keep_passages();
        }
        let kept = Self::least_kept(&settings, scenario.dt, look_ahead).max(Self::KEPT);
        Ok(Self {
            hindsight: Hindsight::new(&settings, &context),
            channels,
            timeline: Timeline { events: VecDeque::new(), hold: scenario.hold, kept, before: None },
            look_ahead,
            truncation,
            latest,
            in_hindsight: LastSample::default(),
            stopped: None,
            again: 0,
            first: f64::NEG_INFINITY,
            now: f64::NEG_INFINITY,
            at: 0,
            estimator,
            settings,
            scenario,
        })
    }

    /// The same filter before its first event, which keeps its beliefs for some seconds: what comes later is refused.
    #[must_use]
    pub fn keeping(mut self, seconds: f64) -> Self {
        self.timeline.kept = seconds.max(Self::least_kept(&self.settings, self.scenario.dt, self.look_ahead));
        self
    }

    /// The seconds for which beliefs must be kept: for hindsight, and for sensors that are late.
    fn least_kept(settings: &FilterSettings, dt: f64, look_ahead: Option<f64>) -> f64 {
        settings.sensor_delay.iter().map(|late| late + dt).fold(look_ahead.unwrap_or(0.0), f64::max)
    }

    /// The time of the newest event \[s\].
    pub fn time(&self) -> Option<f64> {
        self.now.is_finite().then_some(self.now)
    }

    /// The estimate that the last call has returned.
    pub fn sample(&self) -> Sample<'_> {
        self.latest.0.sample()
    }

    /// Whether it reports estimates in hindsight.
    pub fn looks_back(&self) -> bool {
        self.look_ahead.is_some()
    }

    /// The last event at least the look-ahead before the newest one, and the estimate there in the light of all since, if there is one.
    pub fn hindsight(&mut self) -> Option<(f64, Sample<'_>)> {
        let newest = self.timeline.place_until(self.now).unwrap_or(0);
        let then = self.now - self.look_ahead? * (1.0 - SAME);
        let place = self.timeline.place_until(then)?;
        let mut belief = self.timeline.events[place].state.as_ref()?.belief.clone();
        let mut adjoint = Adjoint::nothing(belief.size());
        for later in (place + 1..=newest).rev() {
            self.timeline.events[later].passages.iter().rev().for_each(|passage| adjoint.pass(passage));
        }
        adjoint.correct(&mut belief);
        self.hindsight.report(&belief, &mut self.in_hindsight);
        Some((self.timeline.events[place].time, self.in_hindsight.sample()))
    }

    /// Takes in the input from a time \[s\] on \[m/s²\] and the sensors' readings, NaN where there is none. Returns the newest estimate.
    ///
    /// # Errors
    /// [`EventError`]. Only where the filter fails does it stop; all else leaves it as it was.
    pub fn take(&mut self, time: f64, input: f64, readings: &[f64]) -> Result<Sample<'_>, EventError> {
        self.check(time, input, readings)?;
        let force = (!input.is_nan()).then(|| self.scenario.input.force(input));
        // A delayed input acts at another time than the readings beside it.
        let delay = f64::from(self.settings.input_delay) * self.scenario.dt;
        let felt = force.filter(|_| delay != 0.0).map(|_| time + delay);
        let oldest = self.timeline.events.front().map(|event| event.time);
        let felt = felt.map(|felt| felt.max(self.first));
        let (readings, others) = self.by_time(time, readings);
        // All times are checked before anything is put: what is refused must leave nothing behind.
        let mut times = felt.into_iter().chain(others.iter().map(|(time, _)| *time));
        if let Some(oldest) = oldest
            && let Some(time) = times.find(|time| *time < oldest)
        {
            return Err(EventError::TooLate(time, oldest));
        }
        (self.again, self.now) = (0, self.now.max(time));
        let nothing = vec![f64::NAN; readings.len()];
        match (oldest, felt) {
            (None, felt) => {
                (self.first, self.at) = (time, 0);
                self.timeline.insert(TimedEvent::new(time, force, readings));
                self.timeline.events[0].state = self.estimator.state();
                if let Some(felt) = felt.filter(|felt| *felt > time) {
                    self.put(TimedEvent::new(felt, force, nothing))?;
                }
            }
            (Some(_), Some(felt)) => {
                self.put(TimedEvent::new(felt, force, nothing))?;
                self.put(TimedEvent::new(time, None, readings))?;
            }
            (Some(_), None) => self.put(TimedEvent::new(time, force, readings))?,
        }
        for (time, readings) in others {
            self.put(TimedEvent::new(time, None, readings))?;
        }
        self.at -= self.timeline.forget(self.now, self.at);
        Ok(self.sample())
    }

    fn check(&self, time: f64, input: f64, readings: &[f64]) -> Result<(), EventError> {
        let sensors = &self.scenario.sensors;
        let oldest = self.timeline.events.front().map_or(f64::NEG_INFINITY, |event| event.time);
        let before = self.time().unwrap_or(time);
        let steps = libm::round((time - before) / self.scenario.dt);
        Err(if let Some((time, reason)) = self.stopped {
            EventError::Stopped(time, reason)
        } else if readings.len() != sensors.len() {
            EventError::Readings(readings.len(), sensors.len())
        } else if !time.is_finite() {
            EventError::Time(time)
        } else if input.is_infinite() {
            EventError::Input(input)
        } else if let Some((sensor, _)) = sensors.iter().zip(readings).find(|(_, reading)| reading.is_infinite()) {
            EventError::InfiniteReading(sensor.measures)
        } else if time < oldest {
            EventError::TooLate(time, oldest)
        } else if steps > EventError::MOST_STEPS as f64 {
            EventError::Gap(time, before, steps)
        } else {
            return Ok(());
        })
    }

    fn put(&mut self, event: TimedEvent) -> Result<(), EventError> {
        let before = self.at;
        let first = self.timeline.insert(event).max(1);
        if first <= before {
            self.again += before + 1 - first;
            self.at = first - 1;
            if let Some(state) = &self.timeline.events[first - 1].state
                && let Err(reason) = self.estimator.restore(state)
            {
                return Err(self.stop(self.timeline.events[first].time, reason));
            }
        }
        let newest = self.timeline.place_until(self.now).unwrap_or(0);
        while self.at < newest {
            let place = self.at + 1;
            if let Err(reason) = self.follow(place) {
                return Err(self.stop(self.timeline.events[place].time, reason));
            }
            self.at = place;
        }
        Ok(())
    }

    fn stop(&mut self, time: f64, reason: FilterError) -> EventError {
        self.stopped = Some((time, reason));
        EventError::Stopped(time, reason)
    }

    fn follow(&mut self, place: usize) -> Result<(), FilterError> {
        let Self { estimator, timeline, truncation, latest, .. } = self;
        let times = [place - 1, place].map(|place| timeline.events[place].time);
        let forces = timeline.forces_to(place);
        let force = timeline.events[place].force.unwrap_or(forces[1]);
        let steps = (times[1] - times[0]) / self.scenario.dt;
        let parts = Parts::evenly(steps, times, forces, force, &timeline.events[place].readings);
        latest.1 = Passages::default();
        estimator.step_through(&parts, &Forces::default(), &mut Truncating { truncation, sink: latest })?;
        let event = &mut timeline.events[place];
        event.passages = std::mem::take(&mut latest.1).all;
        event.state = estimator.state();
        Ok(())
    }

    /// Readings of this time, and those of late or early sensors with their own times \[s\]; those before the first event do not count.
    fn by_time(&self, time: f64, readings: &[f64]) -> (Vec<f64>, Vec<(f64, Vec<f64>)>) {
        let (mut own, mut others) = (readings.to_vec(), Vec::new());
        let first = if self.first.is_finite() { self.first } else { time };
        for (place, late) in self.settings.sensor_delay.iter().enumerate().filter(|(_, late)| **late != 0.0) {
            let reading = std::mem::replace(&mut own[place], f64::NAN);
            let then = time - late;
            if !reading.is_nan() && then > first + SAME * self.scenario.dt {
                let mut alone = vec![f64::NAN; readings.len()];
                alone[place] = reading;
                others.push((then, alone));
            }
        }
        (own, others)
    }
}

struct TimedEvent {
    /// \[s\]
    time: f64,
    /// The force over mass from now on \[m/s²\], if it was known.
    force: Option<f64>,
    readings: Vec<f64>,
    state: Option<State>,
    passages: Vec<Passage>,
}

impl TimedEvent {
    fn new(time: f64, force: Option<f64>, readings: Vec<f64>) -> Self {
        Self { time, force, readings, state: None, passages: Vec::new() }
    }
}

/// Events in the order of their times, the oldest first. Those of one time stand in the order in which they came.
struct Timeline {
    events: VecDeque<TimedEvent>,
    hold: Hold,
    /// \[s\]
    kept: f64,
    before: Option<(f64, f64)>,
}

// A fast sensor could fill the memory within the seconds that are kept.
const MOST: usize = 1 << 16;

impl Timeline {
    fn place_until(&self, time: f64) -> Option<usize> {
        self.events.partition_point(|event| event.time <= time).checked_sub(1)
    }

    /// Puts an event at its place. Returns the first place after which beliefs are no longer right.
    fn insert(&mut self, event: TimedEvent) -> usize {
        let place = self.events.partition_point(|other| other.time <= event.time);
        let has_force = event.force.is_some();
        self.events.insert(place, event);
        // On a line between inputs, an input changes the force back to the one before it.
        match (self.hold, has_force) {
            (Hold::First, true) => {
                let before = self.events.range(..place).rposition(|event| event.force.is_some());
                before.map_or(place, |before| before + 1).min(place)
            }
            _ => place,
        }
    }

    /// The force over mass from the event before a place to that at the place, at the beginning and at the end \[m/s²\].
    fn forces_to(&self, place: usize) -> [f64; 2] {
        let known = |event: &TimedEvent| event.force.map(|force| (event.time, force));
        let last = self.events.range(..place).rev().find_map(known).or(self.before);
        let Some((from, begin)) = last else { return [0.0; 2] };
        let next = || self.events.range(place..).find_map(known);
        match (self.hold, if self.hold == Hold::First { next() } else { None }) {
            (Hold::First, Some((to, end))) if to > from => {
                let at = |time: f64| begin + (end - begin) * ((time - from) / (to - from));
                let before = place.checked_sub(1).map_or(from, |before| self.events[before].time);
                let time = self.events[place].time;
                [at(before), if time == to { end } else { at(time) }]
            }
            _ => [begin; 2],
        }
    }

    fn forget(&mut self, now: f64, place: usize) -> usize {
        let mut forgotten = 0;
        while forgotten < place && (self.events[1].time < now - self.kept || self.events.len() > MOST) {
            let Some(TimedEvent { time, force, .. }) = self.events.pop_front() else { break };
            self.before = force.map(|force| (time, force)).or(self.before);
            forgotten += 1;
        }
        forgotten
    }
}

/// The reason why an [`EventFilter`](crate::EventFilter) does not take in what came.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EventError {
    /// The filter has failed, then or before: the time that it could not reach \[s\], and the reason.
    #[error("the filter has stopped at {0} s: {1}")]
    Stopped(f64, FilterError),
    /// The number of readings is not that of the sensors: both numbers.
    #[error("there are {0} readings, but the scenario has {1} sensors: a missing reading is NaN")]
    Readings(usize, usize),
    /// A reading is infinite.
    #[error("the reading of {} is infinite, but must be a number or NaN", .0.key())]
    InfiniteReading(Quantity),
    /// The input is infinite.
    #[error("the input is {0}, but must be a finite number, or NaN where nothing is known of it")]
    Input(f64),
    /// The time is not finite.
    #[error("the time is {0}, but must be a finite number of seconds")]
    Time(f64),
    /// It comes later than the filter keeps its beliefs: the time, and that of the oldest belief \[s\].
    #[error("the time is {0} s, which is too late: nothing before {1} s is kept")]
    TooLate(f64, f64),
    /// The time since what came before is too long to be bridged: both times \[s\], and the steps of dt between them.
    #[error(
        "the time is {} s, {} steps after {} s, but at most {} are bridged: begin a new filter",
        legible(*.0),
        legible(*.2),
        .1,
        EventError::MOST_STEPS
    )]
    Gap(f64, f64, f64),
}

impl EventError {
    /// Limits the steps of dt between two events.
    pub const MOST_STEPS: usize = 100_000;
}

fn legible(number: f64) -> String {
    if number.abs() < 1e9 { number.to_string() } else { format!("{number:e}") }
}

/// A filter that cannot follow events.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EventSetupError {
    /// The scenario is impossible, or has no such filter.
    #[error(transparent)]
    Run(#[from] crate::RunError),
    /// The filter has a setting that counts in samples.
    #[error("a filter with {0} follows samples at equal times only")]
    Setting(&'static str),
    /// The filter cannot begin.
    #[error(transparent)]
    Filter(#[from] FilterError),
}
