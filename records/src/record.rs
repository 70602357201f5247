//! The input and the measurements, simulated or from a file, as a CSV file too, and the reasons why there are none.

mod clocks;
mod growth;
mod live;

use std::io::Write;
use std::sync::Arc;

use kalmanscope_filters::catalogue::all_and;
use kalmanscope_filters::filter::ForceOn;
use kalmanscope_filters::lists::{mapped, numbers};
use kalmanscope_filters::{Channel, ForcedMass, Hold, InputKind, Quantity};
use thiserror::Error;

use crate::resample::{finer_input, spread};

pub use clocks::{Clocks, Delays, Parts, Timed};
pub use live::{LiveError, LiveRecord};

use clocks::{Course, Readings};

/// Limits the samples of a record.
pub const MOST: usize = 2_000_000;

/// Equally spaced samples of the input, the measurements and, where it is known, the truth.
///
/// A run can forget its first samples: indices count from the first that is kept, only [`Self::time_of`] from the run's beginning. With
/// [times of readings and input](Clocks) filters go from one to the next; the columns are then for plots, spectra and start values.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    dt: f64,
    start: f64,
    forgotten: usize,
    kind: InputKind,
    hold: Hold,
    input: Vec<f64>,
    sensors: Vec<Quantity>,
    measured: Vec<Vec<f64>>,
    truth_channels: Vec<Channel>,
    truth: Vec<Vec<f64>>,
    forced: Vec<ForcedMass>,
    forces: Vec<Vec<f64>>,
    clocks: Option<Arc<Clocks>>,
}

/// The input of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The kind of input.
    pub kind: InputKind,
    /// The hold between samples.
    pub hold: Hold,
    /// The value at every sample \[m/s²\].
    pub values: Vec<f64>,
}

impl Record {
    /// A measured record with `dt` \[s\] between samples, from t = 0 on, and one column of measurements per quantity,
    /// of the length of the input and in the quantity's unit. NaN is a missing measurement.
    ///
    /// ```
    /// use kalmanscope_records::record::{Input, Record};
    /// use kalmanscope_filters::{Hold, InputKind, Quantity};
    ///
    /// let input = Input { kind: InputKind::Force, hold: Hold::Zero, values: vec![0.0, 1.0, 0.5] };
    /// let velocity = vec![0.0, f64::NAN, 0.02];
    /// let record = Record::new(0.01, input, vec![(Quantity::VELOCITY, velocity)]).unwrap();
    /// assert_eq!((record.len(), record.time(2)), (3, 0.02));
    /// ```
    ///
    /// # Errors
    /// [`RecordError::Step`] where `dt` is not positive and finite, [`RecordError::Repeated`] where two columns are of one
    /// quantity, [`RecordError::Length`] where a column is not as long as the input, [`RecordError::Value`] where the input
    /// is not finite or a measurement is infinite.
    pub fn new(dt: f64, input: Input, columns: Vec<(Quantity, Vec<f64>)>) -> Result<Self, RecordError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(RecordError::Step(dt));
        }
        let Input { kind, hold, values } = input;
        check("input", &values, "a finite number", f64::is_finite)?;
        let (sensors, measured) = complete(columns, values.len(), |quantity| quantity.key().to_owned())?;
        Ok(Self { input: values, measured, ..Self::empty(dt, kind, hold, sensors, Vec::new()) })
    }

    /// The same record with the truth of some channels, one column each in the channel's unit; NaN where it is not known.
    ///
    /// # Errors
    /// [`RecordError::Repeated`], [`RecordError::Length`] and [`RecordError::Value`] as in [`Self::new`].
    pub fn with_truth(self, columns: Vec<(Channel, Vec<f64>)>) -> Result<Self, RecordError> {
        let (truth_channels, truth) = complete(columns, self.len(), |channel| format!("true_{}", channel.key()))?;
        Ok(Self { truth_channels, truth, ..self })
    }

    /// The same record with forces over mass on single masses, a finite value for each sample \[m/s²\], with the course of the input
    /// between samples.
    ///
    /// # Errors
    /// [`RecordError::Repeated`], [`RecordError::Length`] and [`RecordError::Value`] as in [`Self::new`].
    pub fn with_forces(self, columns: Vec<(ForcedMass, Vec<f64>)>) -> Result<Self, RecordError> {
        for (on, values) in &columns {
            check(on.key(), values, "a finite number", f64::is_finite)?;
        }
        let (forced, forces) = complete(columns, self.len(), |on| on.key().to_owned())?;
        Ok(Self { forced, forces, ..self })
    }

    /// The same record, with times for its readings, and maybe for its input. A reading counts in the step in which it falls, and its
    /// column should have its value at the end of that step: a filter reports the innovation there.
    ///
    /// # Errors
    /// [`RecordError::Clocks`].
    pub fn with_clocks(self, clocks: Clocks) -> Result<Self, RecordError> {
        let clocks = clocks.checked(self.sensors.len())?;
        Ok(Self { clocks: Some(Arc::new(clocks)), ..self })
    }

    /// The times that readings and input have, if they are not those of the samples.
    pub fn clocks(&self) -> Option<&Clocks> {
        self.clocks.as_deref()
    }

    /// The same record, with the readings at its samples alone.
    pub fn at_samples(self) -> Self {
        Self { clocks: None, ..self }
    }

    /// The same record, of which nothing is known but what was measured.
    #[must_use]
    pub fn without_truth(self) -> Self {
        Self { truth_channels: Vec::new(), truth: Vec::new(), ..self }
    }

    /// A record without samples.
    pub fn empty(dt: f64, kind: InputKind, hold: Hold, sensors: Vec<Quantity>, truth_channels: Vec<Channel>) -> Self {
        let (start, forgotten, input, clocks, forced, forces) = Default::default();
        let [measured, truth] = [sensors.len(), truth_channels.len()].map(|count| vec![Vec::new(); count]);
        Self {
            dt,
            start,
            forgotten,
            kind,
            hold,
            input,
            sensors,
            measured,
            truth_channels,
            truth,
            forced,
            forces,
            clocks,
        }
    }

    fn columns(&self) -> impl Iterator<Item = &Vec<f64>> {
        std::iter::once(&self.input).chain(&self.forces).chain(&self.measured).chain(&self.truth)
    }

    fn columns_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        std::iter::once(&mut self.input).chain(&mut self.forces).chain(&mut self.measured).chain(&mut self.truth)
    }

    /// Takes the memory of an old record.
    pub fn recycle(&mut self, mut old: Self) {
        for (new, old) in self.columns_mut().zip(old.columns_mut()) {
            old.clear();
            *new = std::mem::take(old);
        }
    }

    /// The same record with this many steps in place of one. `None` if it would be too long, or its readings have their own times.
    pub fn finer(&self, steps: usize) -> Option<Self> {
        if self.clocks().is_some() || self.len().saturating_mul(steps) > MOST {
            return None;
        }
        let input = finer_input(&self.input, steps, self.hold);
        check("input", &input, "a finite number", f64::is_finite).ok()?;
        let measured = mapped(&self.measured, &|values| spread(values, steps));
        let empty = Self::empty(self.dt / steps as f64, self.kind, self.hold, self.sensors.clone(), Vec::new());
        let (forced, forces) =
            (self.forced.clone(), mapped(&self.forces, &|force| finer_input(force, steps, self.hold)));
        Some(Self { input, measured, forced, forces, start: self.time(0), ..empty })
    }

    /// Removes the first samples.
    pub fn forget(&mut self, samples: usize) {
        self.forgotten += samples;
        self.columns_mut().for_each(|column| drop(column.drain(..samples)));
    }

    /// Adds a sample.
    pub fn push(&mut self, input: f64, measured: impl IntoIterator<Item = f64>, truth: impl IntoIterator<Item = f64>) {
        self.input.push(input);
        let columns = self.measured.iter_mut().zip(measured).chain(self.truth.iter_mut().zip(truth));
        columns.for_each(|(column, value)| column.push(value));
    }

    /// A record without samples, with columns for the forces on these masses too.
    #[must_use]
    pub fn with_columns_of(self, forced: Vec<ForcedMass>) -> Self {
        let forces = vec![Vec::new(); forced.len()];
        Self { forced, forces, ..self }
    }

    /// Adds the forces on single masses of a sample that was [pushed](Self::push).
    pub fn push_forces(&mut self, forces: impl IntoIterator<Item = f64>) {
        self.forces.iter_mut().zip(forces).for_each(|(column, value)| column.push(value));
    }

    /// Time between samples \[s\].
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Time of sample `k` of those that are kept \[s\].
    pub fn time(&self, k: usize) -> f64 {
        self.time_of(self.forgotten + k)
    }

    /// The time of the sample with this number, counted from the run's beginning, kept or not, also beyond the last \[s\].
    pub fn time_of(&self, number: usize) -> f64 {
        self.start + number as f64 * self.dt
    }

    /// The number of forgotten samples, which is also the number of the first one that is kept.
    pub fn forgotten(&self) -> usize {
        self.forgotten
    }

    /// The number of samples that are kept.
    pub fn len(&self) -> usize {
        self.input.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.input.is_empty()
    }

    /// The input at every sample \[m/s²\].
    pub fn input(&self) -> &[f64] {
        &self.input
    }

    /// The masses on which forces are recorded besides the input.
    pub fn forced(&self) -> &[ForcedMass] {
        &self.forced
    }

    /// The force over mass on one mass at every sample \[m/s²\], if it is recorded.
    pub fn force_on(&self, mass: ForcedMass) -> Option<&[f64]> {
        self.forces().find(|(own, _)| *own == mass).map(|(_, values)| values)
    }

    /// The forces over mass on single masses at every sample \[m/s²\].
    pub fn forces(&self) -> impl Iterator<Item = (ForcedMass, &[f64])> {
        self.forced.iter().zip(&self.forces).map(|(mass, values)| (*mass, values.as_slice()))
    }

    /// Whether nothing moves the masses: input and forces are zero.
    pub fn is_free(&self) -> bool {
        std::iter::once(&self.input).chain(&self.forces).flatten().all(|value| *value == 0.0)
    }

    /// Writes the forces on these masses at the samples before `k` and at `k`, which were recorded `delay` samples before.
    pub fn forces_to(&self, k: usize, delay: i32, masses: &[ForcedMass], into: &mut [ForceOn]) {
        for (on, mass) in into.iter_mut().zip(masses) {
            let values = self.force_on(*mass);
            on.ends = [k.saturating_sub(1), k].map(|k| values.map_or(0.0, |values| values[self.delayed(k, delay)]));
        }
    }

    /// The kind of input.
    pub fn input_kind(&self) -> InputKind {
        self.kind
    }

    /// The course of the input between samples.
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// The force over mass at sample `k` \[m/s²\].
    #[inline]
    pub fn force(&self, k: usize) -> f64 {
        self.kind.force(self.input[k])
    }

    /// The force over mass \[m/s²\] at sample `k` that was recorded `delay` samples before. Beyond the ends the nearest value holds.
    #[inline]
    pub fn delayed_force(&self, k: usize, delay: i32) -> f64 {
        self.force(self.delayed(k, delay))
    }

    #[inline]
    fn delayed(&self, k: usize, delay: i32) -> usize {
        let place = if delay < 0 { k + delay.unsigned_abs() as usize } else { k.saturating_sub(delay as usize) };
        place.min(self.len() - 1)
    }

    /// False if readings and input have the samples' times.
    pub fn parts_to(&self, k: usize, delays: &Delays, columns: &[usize], into: &mut Parts) -> bool {
        let clocks = self.clocks.as_deref();
        if clocks.is_none() && !delays.is_of_sensors() {
            return false;
        }
        let of_samples = [k - 1, k].map(|k| self.delayed_force(k, delays.input));
        let course = Course { kind: self.kind, hold: self.hold, delay: f64::from(delays.input), of_samples };
        let of = |place: usize| Readings {
            // Samples count from this one: a record that has forgotten some gives the same bits.
            times: clocks.map(|clocks| clocks.readings[columns[place]].times.as_slice()).ok_or(k),
            values: clocks.map_or(&self.measured[columns[place]], |clocks| &clocks.readings[columns[place]].values),
            late: delays.of(place),
        };
        let end = if clocks.is_some() { k as f64 } else { 0.0 };
        into.take(end, columns.len(), of, clocks.and_then(|clocks| clocks.input.as_ref()), &course);
        true
    }

    /// Late by steps, to the nearest sample; NaN where there is none.
    #[inline]
    pub fn late_reading(&self, column: usize, k: usize, late: f64) -> f64 {
        let place = if late == 0.0 { Some(k) } else { k.checked_add_signed(libm::round(late) as isize) };
        place.and_then(|place| self.measured[column].get(place)).copied().unwrap_or(f64::NAN)
    }

    /// The measured quantities.
    pub fn sensors(&self) -> &[Quantity] {
        &self.sensors
    }

    /// All measurements of one sensor, in its quantity's unit; NaN where one is missing.
    pub fn measured(&self, sensor: usize) -> &[f64] {
        &self.measured[sensor]
    }

    /// All measurements of one quantity, if there is a sensor for it.
    pub fn measured_quantity(&self, quantity: Quantity) -> Option<&[f64]> {
        quantity.place_in(&self.sensors).map(|i| self.measured(i))
    }

    /// The channels whose true values are known, in the order of [`Channel::all`], and after them those of equations.
    pub fn true_channels(&self) -> Vec<Channel> {
        all_and(self.truth_channels.iter().copied()).into_iter().filter(|c| self.truth(*c).is_some()).collect()
    }

    /// The true values of a channel, if they are known; NaN where one is missing.
    pub fn truth(&self, channel: Channel) -> Option<&[f64]> {
        channel.place_in(&self.truth_channels).map(|i| self.truth[i].as_slice())
    }

    /// Writes a file that a [`build`](crate::import::build) reads back bit by bit, with 17 significant digits. Of a record
    /// with the times of readings it is one with a column of times before each of its columns, without the truth.
    ///
    /// # Errors
    /// [`RecordError::Csv`] where `output` cannot be written.
    pub fn write_csv(&self, output: impl Write) -> Result<(), RecordError> {
        let mut writer = csv::Writer::from_writer(output);
        match self.clocks() {
            Some(clocks) => self.write_clocks(clocks, &mut writer)?,
            None => self.write_samples(&mut writer)?,
        }
        Ok(writer.flush().map_err(csv::Error::from)?)
    }

    fn write_samples(&self, writer: &mut csv::Writer<impl Write>) -> Result<(), csv::Error> {
        let forces = self.forced.iter().map(|on| on.key().to_owned());
        let sensors = forces.chain(self.sensors.iter().map(|s| s.key().to_owned()));
        let truth = self.truth_channels.iter().map(|c| format!("true_{}", c.key()));
        writer
            .write_record(["t".to_owned(), input_name(self.kind).to_owned()].into_iter().chain(sensors).chain(truth))?;
        for k in 0..self.len() {
            let columns = self.forces.iter().chain(&self.measured).chain(&self.truth).map(|column| column[k]);
            let row = [self.time(k), self.input[k]].into_iter().chain(columns);
            writer.write_record(row.map(digits))?;
        }
        Ok(())
    }

    fn write_clocks(&self, clocks: &Clocks, writer: &mut csv::Writer<impl Write>) -> Result<(), csv::Error> {
        let of_samples =
            |values: &Vec<f64>| Timed { times: numbers(self.len(), &|k| k as f64), values: values.clone() };
        let mut inputs = vec![clocks.input.clone().unwrap_or_else(|| of_samples(&self.input))];
        inputs.extend(self.forces.iter().map(of_samples));
        let all: Vec<&Timed> = inputs.iter().chain(&clocks.readings).collect();
        let forces = self.forced.iter().map(|on| on.key());
        let sensors = self.sensors.iter().map(|sensor| sensor.key());
        let names = std::iter::once(input_name(self.kind)).chain(forces).chain(sensors);
        let header = names.enumerate().flat_map(|(place, name)| {
            let time = if place == 0 { "t [s]".to_owned() } else { format!("t ({}) [s]", place + 1) };
            [time, name.to_owned()]
        });
        writer.write_record(header)?;
        for row in 0..all.iter().map(|timed| timed.times.len()).max().unwrap_or(0) {
            let pair = |timed: &&Timed| match (timed.times.get(row), timed.values.get(row)) {
                (Some(steps), Some(value)) => [self.time(0) + steps * self.dt, *value],
                _ => [f64::NAN; 2],
            };
            writer.write_record(all.iter().flat_map(pair).map(digits))?;
        }
        Ok(())
    }
}

fn digits(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.16e}") }
}

pub(crate) fn input_name(kind: InputKind) -> &'static str {
    match kind {
        InputKind::Force => "force",
        InputKind::GroundAcceleration => "ground_acceleration",
    }
}

fn complete<T: Copy + PartialEq>(
    columns: Vec<(T, Vec<f64>)>,
    expected: usize,
    name: impl Fn(T) -> String,
) -> Result<(Vec<T>, Vec<Vec<f64>>), RecordError> {
    for (place, (of, values)) in columns.iter().enumerate() {
        if columns[..place].iter().any(|(other, _)| other == of) {
            return Err(RecordError::Repeated(name(*of)));
        }
        if values.len() != expected {
            return Err(RecordError::Length(name(*of), values.len(), expected));
        }
        check(&name(*of), values, "a number or NaN", |x| !x.is_infinite())?;
    }
    Ok(columns.into_iter().unzip())
}

fn check(column: &str, values: &[f64], allowed: &'static str, is_allowed: fn(f64) -> bool) -> Result<(), RecordError> {
    let bad = values.iter().position(|&x| !is_allowed(x));
    bad.map_or(Ok(()), |sample| Err(RecordError::Value(column.to_owned(), sample, values[sample], allowed)))
}

/// The reason why columns or a file are not a record.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The time between samples is not positive and finite.
    #[error("dt = {0} s, but must be positive and finite")]
    Step(f64),
    /// Two columns are of the same quantity or channel.
    #[error("there are two columns `{0}`")]
    Repeated(String),
    /// A column is not as long as the input: its name, the number of its values, and the input's.
    #[error("column `{0}` has {1} values, but the input has {2}")]
    Length(String, usize, usize),
    /// A value is not finite where it must be, or infinite: the column's name, the sample from 0 on, the value, and what is allowed.
    #[error("sample {1}, column `{0}`: {2} is not {3}")]
    Value(String, usize, f64, &'static str),
    /// The file cannot be written.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// The times that readings have do not fit: why.
    #[error("{0}")]
    Clocks(String),
}
