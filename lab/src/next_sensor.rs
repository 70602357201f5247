//! Which sensor next: the ±2σ of each parameter that a sensor would give, before anything is measured.
//!
//! ```text
//! σ² = mean over inputs of J⁻¹,  J of the Cramér-Rao bound along the truth of each input, with the filter's fading
//! ```

use std::collections::BTreeMap;

use kalmanscope_core::record::{Clocks, Timed};
use kalmanscope_core::scenario::MAX_SENSORS;
use kalmanscope_core::{
    Aspect, Channel, CramerRao, InputKind, Quantity, Record, RunError, Scenario, Sensor, Simulator, Work,
};
use kalmanscope_records::task::{Progress, pause};
use serde::{Deserialize, Serialize};

use crate::EnsembleError;

/// The readings per sample of the scenario that are offered. The input and its steps stay the same.
pub const RATES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

/// The durations that each forecast has, in durations of the scenario.
pub const DURATIONS: [f64; 3] = [0.5, 1.0, 2.0];

/// The place of the scenario's own duration.
pub const WHOLE: usize = 1;

/// The inputs for the present sensors, at least and at most: J⁻¹ of one random force differs by 25 to 100 % from that of another.
const INPUTS: (u64, u64) = (32, 256);

/// Limits the standard error of a mean variance, relative to it, from which on no more inputs are needed.
const PRECISION: f64 = 0.05;

/// The first inputs, for the other choices: their ratios to the present sensors differ less, and the mean of these is that of all inputs.
const FEW: u64 = 8;

/// Limits the samples between two pauses: about a millisecond of the largest plants.
const PIECE: usize = 32;

/// The choices that a forecast compares.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorPlan {
    /// The readings of each sensor per sample of the scenario: one of [`RATES`].
    pub rate: f64,
    /// Each sensor alone, not beside the present ones.
    pub alone: bool,
    /// The noise of sensors that the scenario lacks, in the unit of their kind, by the quantity of the first mass.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub noise_std: BTreeMap<Quantity, f64>,
}

impl Default for SensorPlan {
    fn default() -> Self {
        Self { rate: 1.0, alone: false, noise_std: BTreeMap::new() }
    }
}

/// The expected standard deviations of a filter with each sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorForecast {
    /// The parameters that the filter estimates; if it knows them all, the motion.
    pub channels: Vec<Channel>,
    /// The standard deviation that today's sensors give at the end of the scenario, in the unit of each channel.
    pub now: Vec<f64>,
    /// The present sensors at the plan's rate, then every other choice.
    pub rows: Vec<SensorRow>,
    /// The number of simulated inputs that differ.
    pub inputs: u64,
    /// Whether the plant has several masses.
    pub has_places: bool,
}

/// One choice of sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorRow {
    /// The new sensor; `None` for the present ones.
    pub sensor: Option<Sensor>,
    /// The standard deviation of each channel after each of [`DURATIONS`]; NaN where there is no bound, as after the end of a truth.
    pub std: [Vec<f64>; DURATIONS.len()],
}

impl SensorPlan {
    /// Checks every value.
    ///
    /// # Errors
    /// A sentence that says which value is impossible.
    pub fn check(&self) -> Result<(), String> {
        let Self { rate, alone: _, noise_std } = self;
        let is_noise = noise_std.values().all(|std| std.is_finite() && *std > 0.0);
        let holds = RATES.contains(rate) && is_noise;
        if holds { Ok(()) } else { Err(format!("the rate must be one of {RATES:?}, and each noise above 0")) }
    }

    /// The noise of a sensor that the scenario lacks: the plan's, else that of a present sensor of its kind, else the usual one.
    pub fn noise_std_of(&self, aspect: Aspect, scenario: &Scenario) -> f64 {
        let own = self.noise_std.get(&Quantity::new(aspect, 0)).copied();
        let present = scenario.sensors.iter().find(|sensor| sensor.measures.aspect() == aspect);
        own.or(present.map(|sensor| sensor.noise_std)).unwrap_or(aspect.info().usual_noise)
    }

    fn sensors(&self, scenario: &Scenario) -> Vec<Sensor> {
        if scenario.sensors.len() >= MAX_SENSORS && !self.alone {
            return Vec::new();
        }
        let of = |quantity: Quantity| match scenario.sensor_place(quantity) {
            Some(place) => self.alone.then(|| scenario.sensors[place]),
            None => Some(Sensor::new(quantity, self.noise_std_of(quantity.aspect(), scenario))),
        };
        measurable(scenario).into_iter().filter_map(of).collect()
    }

    /// The scenario with another sensor.
    #[must_use]
    pub fn with(&self, sensor: Sensor, scenario: &Scenario) -> Scenario {
        let mut next = scenario.clone();
        let gone = next.measured().into_iter().filter(|_| self.alone);
        gone.for_each(|quantity| next.remove_sensor(quantity));
        next.add_sensor(sensor);
        next
    }

    /// The forecast for the filter at `place`, over simulated inputs of the seeds 1 and on, or members of a population. This is the
    /// σ that the filter will say; its errors are smaller where it forgets or lets walk what stays, and larger until it has settled.
    ///
    /// It takes the mean of covariances, which is that of squared errors over many records. A mean of information would give a σ that is 3 to
    /// 25 % smaller. Source: Miller and Chang (1978), A modified Cramér-Rao bound and its applications.
    ///
    /// # Errors
    /// [`EnsembleError`] for an impossible plan, scenario or filter, and where the record is measured.
    pub fn forecast(self, scenario: &Scenario, place: usize) -> Result<Work<SensorForecast>, EnsembleError> {
        if scenario.record.is_some() {
            let reason = "the record is measured, and a forecast needs a scenario's own truth and force";
            return Err(EnsembleError::Plan(reason.to_owned()));
        }
        self.check().map_err(EnsembleError::Plan)?;
        scenario.validate().map_err(RunError::from)?;
        let filter = scenario.filters.get(place).cloned().ok_or(RunError::NoFilter(place))?;
        let mut scenario = Scenario { filters: vec![filter], ..scenario.clone() };
        scenario.keep_draws();
        Ok(Work::new(|progress| compare(self, scenario, progress)))
    }
}

/// The quantities that a sensor can measure, each once: those that equal another one are left out, unless they are measured.
pub fn measurable(scenario: &Scenario) -> Vec<Quantity> {
    // Under a force total and relative acceleration are equal, and so are drift and displacement of the first mass.
    let is_told_apart = |quantity: &Quantity| match quantity.aspect() {
        aspect if aspect == Aspect::TOTAL_ACCELERATION => scenario.input == InputKind::GroundAcceleration,
        aspect if aspect == Aspect::DRIFT => quantity.mass() > 0,
        _ => true,
    };
    let is_shown = |quantity: &Quantity| is_told_apart(quantity) || scenario.sensor_place(*quantity).is_some();
    scenario.plant.kind.quantities().filter(is_shown).collect()
}

type Variances = [Vec<f64>; DURATIONS.len()];

/// Whether the means of some variances are known well enough, by the sums of these and of their squares.
fn is_known(sums: &Variances, squares: &Variances, count: f64) -> bool {
    let mut both =
        sums.iter().flatten().zip(squares.iter().flatten()).map(|(sum, square)| (sum / count, square / count));
    !both.any(|(mean, square)| (square - mean * mean) / count > (PRECISION * mean).powi(2))
}

async fn compare(plan: SensorPlan, scenario: Scenario, progress: Progress) -> SensorForecast {
    let channels = channels(&scenario);
    let sensors = plan.sensors(&scenario);
    let zeros = || DURATIONS.map(|_| vec![0.0; channels.len()]);
    let add = |sum: &mut Variances, more: &Variances| {
        sum.iter_mut().flatten().zip(more.iter().flatten()).for_each(|(sum, one)| *sum += one);
    };
    // The present sensors at the plan's rate come before the others.
    let (mut all, mut squares, mut few, mut sums) = (zeros(), zeros(), zeros(), vec![zeros(); sensors.len() + 1]);
    let (mut inputs, mut first): (u64, Option<Variances>) = (0, None);
    for seed in 1..=INPUTS.1 {
        let member = scenario.member(seed);
        if member.validate().is_err() {
            continue;
        }
        let mut every = member.clone();
        sensors.iter().for_each(|sensor| every.add_sensor(*sensor));
        let record = truth(&every).await;
        let present = variances(&member, &record, &channels).await;
        // Other noise alone changes no bound: one input is enough where all are equal.
        if first.as_ref() == Some(&present) && scenario.draw.is_empty() {
            break;
        }
        add(&mut all, &present);
        add(&mut squares, &present.each_ref().map(|all| all.iter().map(|variance| variance * variance).collect()));
        if inputs < FEW {
            add(&mut few, &present);
            let record = if plan.rate == 1.0 { record } else { at_rate(&record, plan.rate) };
            for (place, sum) in sums.iter_mut().enumerate() {
                let set = place.checked_sub(1).map_or(member.clone(), |place| plan.with(sensors[place], &member));
                add(sum, &variances(&set, &record, &channels).await);
                let share = place as f64 / (sensors.len() + 1) as f64;
                progress.set(0.5 * (inputs as f64 + share) / FEW as f64);
            }
        }
        first.get_or_insert(present);
        inputs += 1;
        if inputs >= FEW {
            progress.set(0.5 + 0.5 * inputs as f64 / INPUTS.1 as f64);
        }
        if inputs >= INPUTS.0 && is_known(&all, &squares, inputs as f64) {
            break;
        }
    }
    // Without any input all are NaN.
    let std = |sum: &Variances, duration: usize, at: usize| {
        (sum[duration][at] / few[duration][at] * (all[duration][at] / inputs as f64)).sqrt()
    };
    let places: Vec<usize> = (0..channels.len()).collect();
    let stds = |sum: Variances| [0, 1, 2].map(|duration| places.iter().map(|at| std(&sum, duration, *at)).collect());
    let now = places.iter().map(|at| std(&few, WHOLE, *at)).collect();
    let choices = std::iter::once(None).chain(sensors.into_iter().map(Some));
    let rows = choices.zip(sums).map(|(sensor, sum)| SensorRow { sensor, std: stds(sum) }).collect();
    let has_places = scenario.plant.kind.quantities().any(|quantity| quantity.mass() > 0);
    SensorForecast { channels, now, rows, inputs, has_places }
}

fn channels(scenario: &Scenario) -> Vec<Channel> {
    let (kind, filter) = (&scenario.plant.kind, &scenario.filters[0]);
    let is_estimated = |channel: &Channel| {
        let is_free = filter.initial_std[*channel] > 0.0 || filter.process_std[*channel] > 0.0;
        channel.is_parameter() && *channel != Channel::WHITE_FORCE && !filter.knows(*channel) && is_free
    };
    let estimated: Vec<Channel> = kind.parameters().chain(filter.augment.clone()).filter(is_estimated).collect();
    let motion = || kind.channels().iter().copied().filter(|channel| !channel.is_parameter()).collect();
    if estimated.is_empty() { motion() } else { estimated }
}

/// The record of the longest duration, with the readings of every sensor.
async fn truth(scenario: &Scenario) -> Record {
    let mut simulator = Simulator::new(scenario);
    let mut record = simulator.empty_record();
    let samples = samples(scenario, DURATIONS.len() - 1) + 1;
    while record.len() < samples && simulator.advance_some(&mut record, samples) {
        pause().await;
    }
    record
}

fn samples(scenario: &Scenario, duration: usize) -> usize {
    libm::round(DURATIONS[duration] * scenario.duration / scenario.dt) as usize
}

/// The same truth, with readings at another rate. A reading between two samples is missing where the later sample's is.
fn at_rate(record: &Record, rate: f64) -> Record {
    let count = (record.len().saturating_sub(1) as f64 * rate) as usize;
    let of = |sensor: usize| {
        let value = |time: f64| record.measured(sensor)[libm::ceil(time) as usize];
        let times = (1..=count).map(|reading| reading as f64 / rate).filter(|time| value(*time).is_finite());
        let times: Vec<f64> = times.collect();
        Timed { values: times.iter().map(|time| value(*time)).collect(), times }
    };
    let readings = (0..record.sensors().len()).map(of).collect();
    record.clone().with_clocks(Clocks { input: None, readings }).unwrap_or_else(|_| record.clone())
}

async fn variances(scenario: &Scenario, record: &Record, channels: &[Channel]) -> Variances {
    let bound = CramerRao::with_fading(scenario, 0, record.dt());
    let ends = [0, 1, 2].map(|duration| samples(scenario, duration));
    let Some(mut bound) = bound else { return ends.map(|_| vec![f64::NAN; channels.len()]) };
    let mut end = PIECE;
    while !bound.follow_to(end, record) {
        end += PIECE;
        pause().await;
    }
    ends.map(|end| {
        let std = |channel: &Channel| bound.place(*channel).filter(|_| end < bound.len()).map(|at| bound.std(end, at));
        channels.iter().map(|channel| std(channel).map_or(f64::NAN, |std| std * std)).collect()
    })
}

impl SensorForecast {
    /// The rows by their standard deviation of one channel after one of [`DURATIONS`], the best first; those without a bound last.
    pub fn ranked(&self, duration: usize, channel: usize) -> Vec<&SensorRow> {
        let mut rows: Vec<&SensorRow> = self.rows.iter().collect();
        // Positive NaN is above all numbers.
        rows.sort_by(|a, b| a.std[duration][channel].abs().total_cmp(&b.std[duration][channel].abs()));
        rows
    }

    /// The place and the kind of a row's sensor, as a title.
    pub fn name(&self, sensor: Option<Sensor>) -> String {
        let Some(sensor) = sensor else { return "Today's sensors".to_owned() };
        let kind = Quantity::new(sensor.measures.aspect(), 0).name();
        let place = if self.has_places { format!(" on mass {}", sensor.measures.mass() + 1) } else { String::new() };
        format!("{}{} sensor{place}", kind[..1].to_uppercase(), &kind[1..])
    }

    /// The best choice for one channel after one of [`DURATIONS`], in a sentence. `number` writes a number with its unit.
    pub fn sentence(
        &self,
        plan: &SensorPlan,
        (duration, at): (usize, usize),
        number: impl Fn(f64) -> String,
    ) -> String {
        let two = |std: f64| format!("±{}", number(2.0 * std));
        let of = |row: &SensorRow| row.std[duration][at];
        let symbol = self.channels[at].symbol();
        let Some(best) = self.ranked(duration, at).into_iter().find(|row| row.sensor.is_some()) else {
            return format!(
                "No sensor is left to add: all is measured, or by the {MAX_SENSORS} sensors that there can be."
            );
        };
        let times = |factor: f64, of: &str| (factor != 1.0).then(|| format!("{factor} times {of}"));
        let changed = [times(plan.rate, "the rate"), times(DURATIONS[duration], "the duration")];
        let changed: Vec<String> = changed.into_iter().flatten().collect();
        let with = if changed.is_empty() { String::new() } else { format!(", with {}", changed.join(" and ")) };
        let name = self.name(best.sensor).to_lowercase();
        let name = format!("{} {name}", if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "An" } else { "A" });
        let ([best, now], present) = ([of(best), self.now[at]], of(&self.rows[0]));
        if !(best.is_finite() && now.is_finite()) {
            format!("There is no bound for {symbol}{with}: the truth ends before, or no filter can begin.")
        } else if plan.alone {
            format!("{name} alone would give {symbol} best{with}: {}. Today's sensors give {}.", two(best), two(now))
        } else if best > (1.0 - LITTLE) * present {
            format!("No further sensor would narrow {symbol} by {} %{with}: {}.", 100.0 * LITTLE, two(present))
        } else {
            format!("{name} would narrow {symbol} most{with}: {} → {}.", two(now), two(best))
        }
    }
}

/// A share by which a narrower band is not worth a sensor.
const LITTLE: f64 = 0.02;
