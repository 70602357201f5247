//! Readings and inputs at other times than those of the samples, or late.

use std::ops::Range;

use kalmanscope_filters::lists::{mapped, sort_numbers};
use kalmanscope_filters::{Hold, InputKind};

use super::RecordError;

/// Values with their times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timed {
    /// The times, which rise, in steps of dt after the record's first sample.
    pub times: Vec<f64>,
    /// A value for each time.
    pub values: Vec<f64>,
}

/// The exact times of a record's readings, and of its input if they are not those of the samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clocks {
    /// The input \[m/s²\]; `None` if its times are those of the samples.
    pub input: Option<Timed>,
    /// The readings of each sensor, in its quantity's unit.
    pub readings: Vec<Timed>,
}

impl Timed {
    fn check(&self) -> Result<(), RecordError> {
        let Self { times, values } = self;
        if times.len() != values.len() {
            return Err(RecordError::Clocks(format!("{} times, but {} values", times.len(), values.len())));
        }
        let is_bad =
            |k: &usize| !(times[*k].is_finite() && values[*k].is_finite()) || (*k > 0 && times[*k] <= times[*k - 1]);
        let said = |k: usize| RecordError::Clocks(format!("value {k}: the times must rise, and all numbers be finite"));
        (0..times.len()).find(is_bad).map_or(Ok(()), |k| Err(said(k)))
    }

    /// Outside of its values the nearest one.
    pub(crate) fn at(&self, time: f64, hold: Hold) -> f64 {
        let Self { times, values } = self;
        let next = times.partition_point(|other| *other <= time + SAME);
        let Some(known) = next.checked_sub(1) else { return values[0] };
        match hold {
            Hold::First if next < times.len() => {
                let share = (time - times[known]) / (times[next] - times[known]);
                values[known] + (values[next] - values[known]) * share.max(0.0)
            }
            _ => values[known],
        }
    }
}

/// Limits the difference of times that are the same, in steps; also of delays, which users write in decimals, and whole steps.
const SAME: f64 = 1e-6;

/// Clocks have few decimals: a time next to a step is the step's.
pub(super) fn snapped(steps: f64) -> f64 {
    let whole = libm::round(steps);
    if (steps - whole).abs() <= SAME { whole } else { steps }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    pub share: f64,
    /// At the beginning and just before the end \[m/s²\].
    pub forces: [f64; 2],
    /// At the end \[m/s²\].
    pub force: f64,
}

/// The parts of a step between two samples, each with the readings at its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    parts: Vec<Part>,
    /// m at the end of each part; NaN where there is none.
    readings: Vec<f64>,
    /// The times of both samples \[s\].
    pub times: Option<[f64; 2]>,
    cuts: Vec<f64>,
}

pub(super) struct Readings<'a> {
    /// In steps; or the first sample of even times.
    pub(super) times: Result<&'a [f64], usize>,
    /// NaN where one is missing.
    pub(super) values: &'a [f64],
    pub(super) late: f64,
}

impl Readings<'_> {
    fn within(&self, after: f64, until: f64) -> Range<usize> {
        let (after, until) = (after + self.late, until + self.late);
        match self.times {
            Ok(times) => within(times, after, until),
            Err(origin) => {
                let place = |bound: f64| origin.saturating_add_signed(libm::floor(bound) as isize + 1);
                let end = place(until).min(self.values.len());
                place(after).min(end)..end
            }
        }
    }

    fn time(&self, place: usize) -> f64 {
        match self.times {
            Ok(times) => times[place] - self.late,
            Err(origin) => place as f64 - origin as f64 - self.late,
        }
    }
}

fn within(times: &[f64], after: f64, until: f64) -> Range<usize> {
    let place = |bound: f64| times.partition_point(|time| *time <= bound);
    place(after)..place(until)
}

impl Parts {
    /// Each part with its readings.
    pub fn iter(&self) -> impl Iterator<Item = (Part, &[f64])> {
        let m = self.readings.len() / self.parts.len().max(1);
        self.parts.iter().enumerate().map(move |(k, part)| (*part, &self.readings[k * m..(k + 1) * m]))
    }

    /// Parts of one step at most, of a force that is linear in time, with readings at the end.
    pub fn evenly(steps: f64, times: [f64; 2], [begin, end]: [f64; 2], force: f64, readings: &[f64]) -> Self {
        let count = (steps - SAME).ceil().max(1.0);
        let is_whole = (steps / count - 1.0).abs() <= SAME;
        let share = if is_whole { 1.0 } else { steps.max(0.0) / count };
        let of = |place: f64| begin + (end - begin) * (place / count);
        let part = |place: usize| Part { share, forces: [of(place as f64), of(place as f64 + 1.0)], force };
        let count = count as usize;
        let readings = [&vec![f64::NAN; (count - 1) * readings.len()], readings].concat();
        Self { parts: (0..count).map(part).collect(), readings, times: Some(times), cuts: Vec::new() }
    }

    /// \[s\]
    pub fn between(&self, place: usize) -> Option<[f64; 2]> {
        let [from, to] = self.times?;
        Some([place, place + 1].map(|end| from + (to - from) * (end as f64 / self.parts.len() as f64)))
    }

    pub(super) fn take<'a>(
        &mut self,
        end: f64,
        sensors: usize,
        of: impl Fn(usize) -> Readings<'a>,
        input: Option<&Timed>,
        course: &Course,
    ) {
        let begin = end - 1.0;
        let Self { parts, readings, cuts, times: _ } = self;
        cuts.clear();
        cuts.push(end);
        for sensor in (0..sensors).map(&of) {
            let there = sensor.within(begin + SAME, end + SAME).filter(|place| !sensor.values[*place].is_nan());
            cuts.extend(there.map(|place| sensor.time(place)));
        }
        if let Some(input) = input {
            let delay = course.delay;
            cuts.extend(input.times[within(&input.times, begin - delay, end - delay)].iter().map(|time| time + delay));
        }
        sort_numbers(cuts);
        cuts.dedup_by(|later, before| *later - *before <= SAME);
        // The end itself is exact.
        if let Some(last) = cuts.last_mut() {
            *last = end;
        }
        parts.clear();
        readings.clear();
        let mut from = begin;
        for &cut in &*cuts {
            let [before, force] = [from, cut].map(|time| course.at(time, input, [begin, end]));
            let ahead = if course.hold == Hold::Zero { before } else { force };
            parts.push(Part { share: cut - from, forces: [before, ahead], force });
            for sensor in (0..sensors).map(&of) {
                let place = sensor.within(from + SAME, cut + SAME).next_back();
                readings.push(place.map_or(f64::NAN, |place| sensor.values[place]));
            }
            from = cut;
        }
    }
}

impl Clocks {
    pub(super) fn checked(mut self, sensors: usize) -> Result<Self, RecordError> {
        let Self { input, readings } = &mut self;
        if readings.len() != sensors {
            let count = readings.len();
            return Err(RecordError::Clocks(format!(
                "{count} series of readings, but the record has {sensors} sensor(s)"
            )));
        }
        if input.as_ref().is_some_and(|input| input.times.is_empty()) {
            return Err(RecordError::Clocks("an input with times of its own needs a value".to_owned()));
        }
        for timed in input.iter_mut().chain(readings) {
            timed.check()?;
            timed.times.iter_mut().for_each(|time| *time = snapped(*time));
        }
        Ok(self)
    }

    pub(super) fn change(&mut self, change: impl Fn(usize, usize, f64) -> f64) {
        for (sensor, Timed { times, values }) in self.readings.iter_mut().enumerate() {
            for (time, value) in times.iter().zip(&mut *values) {
                *value = change(sensor, libm::ceil(time.max(0.0)) as usize, *value);
            }
            let mut is_there = mapped(values, &|value| !value.is_nan()).into_iter();
            times.retain(|_| is_there.next().unwrap_or(false));
            values.retain(|value| !value.is_nan());
        }
    }

    pub(super) fn change_input(&mut self, change: impl Fn(f64) -> f64) {
        let values = self.input.iter_mut().flat_map(|input| &mut input.values);
        values.for_each(|value| *value = change(*value));
    }

    pub(super) fn part(&self, samples: Range<usize>) -> Self {
        let (first, last) = (samples.start as f64, samples.end.saturating_sub(1) as f64);
        let moved = |timed: &Timed, places: Range<usize>| Timed {
            times: mapped(&timed.times[places.clone()], &|time| time - first),
            values: timed.values[places].to_vec(),
        };
        // The input before the part still acts in it.
        let of_input = |input: &Timed| {
            let known = input.times.partition_point(|time| *time <= first).saturating_sub(1);
            let end = (input.times.partition_point(|time| *time < last) + 1).min(input.times.len());
            moved(input, known..end.max(known + 1))
        };
        Self {
            input: self.input.as_ref().map(of_input),
            readings: mapped(&self.readings, &|timed| moved(timed, within(&timed.times, first - 1.0, last))),
        }
    }
}

pub(super) struct Course {
    pub(super) kind: InputKind,
    pub(super) hold: Hold,
    pub(super) delay: f64,
    /// At both samples \[m/s²\], for an input at the samples' times.
    pub(super) of_samples: [f64; 2],
}

impl Course {
    /// \[m/s²\]
    fn at(&self, time: f64, input: Option<&Timed>, [begin, end]: [f64; 2]) -> f64 {
        let Some(input) = input else {
            let [before, after] = self.of_samples;
            return match self.hold {
                Hold::Zero if time < end => before,
                Hold::Zero => after,
                Hold::First => before + (after - before) * (time - begin),
            };
        };
        self.kind.force(input.at(time - self.delay, self.hold))
    }
}

/// The delays of the input and of the readings of a filter's sensors, in steps of dt.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Delays {
    /// The number of samples after which the plant feels the recorded input.
    pub input: i32,
    /// The steps by which each sensor is late, in the order of the filter's sensors; empty where none is.
    pub sensors: Vec<f64>,
}

impl Delays {
    /// Limits the steps by which a sensor is late or early.
    pub const MOST: f64 = 100_000.0;

    /// In steps, of which none are beyond [`Self::MOST`].
    pub fn new(input: i32, sensors: impl Iterator<Item = f64>) -> Self {
        let mut sensors: Vec<f64> = sensors.map(|steps| snapped(steps.clamp(-Self::MOST, Self::MOST))).collect();
        if sensors.iter().all(|steps| *steps == 0.0) {
            sensors.clear();
        }
        Self { input, sensors }
    }

    /// The delay of a sensor \[samples\].
    pub fn of(&self, place: usize) -> f64 {
        self.sensors.get(place).copied().unwrap_or(0.0)
    }

    /// Whether a sensor has one.
    pub fn is_of_sensors(&self) -> bool {
        !self.sensors.is_empty()
    }

    /// The number of later samples that it needs.
    pub fn lookahead(&self) -> usize {
        self.most(-1.0)
    }

    /// The number of earlier samples that it needs.
    pub fn reach(&self) -> usize {
        self.most(1.0)
    }

    /// A sensor that is late needs later samples, an input that is late earlier ones.
    fn most(&self, sign: f64) -> usize {
        let sensors = self.sensors.iter().map(|steps| -sign * steps);
        libm::ceil(sensors.fold((sign * f64::from(self.input)).max(0.0), f64::max)) as usize
    }
}
