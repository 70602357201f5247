//! The times of a file: those of a column, in seconds, and the even steps that they are close to.

use std::borrow::Cow;

use kalmanscope_filters::lists::{mapped, median, sort_items};

use super::header::{Dimension, unit};
use super::{Column, FEWEST, ImportError, MOST, Result, Table};
use crate::resample::Steps;

pub(super) const DAY: f64 = 86_400.0;

const UNITS: [(&str, f64); 3] = [("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];

/// The years 2000 to 2100 in seconds since 1970: times since a start are far smaller.
pub(super) const EPOCHS: std::ops::Range<f64> = 9.4e8..4.1e9;

/// The seconds of the unit, and those from the date to 1970.
const CLOCKS: [(&str, f64, f64); 9] = [
    ("s since 1970", 1.0, 0.0),
    ("ms since 1970", 1e-3, 0.0),
    ("µs since 1970", 1e-6, 0.0),
    ("ns since 1970", 1e-9, 0.0),
    ("ticks of 100 ns since 1601, as Windows counts them", 1e-7, 11_644_473_600.0),
    ("ticks of 100 ns since the year 1, as .NET counts them", 1e-7, 62_135_596_800.0),
    ("days of a spreadsheet", DAY, 25_569.0 * DAY),
    ("days of MATLAB", DAY, 719_529.0 * DAY),
    ("Julian days", DAY, 2_440_587.5 * DAY),
];

const PLAUSIBLE: std::ops::RangeInclusive<f64> = 2e-5..=1.0;

/// \[s\]: up to the first one seconds, up to the second one a question for the user; longer steps have a smaller unit.
const SLOW: [f64; 2] = [1.0, 10.0];

pub(super) struct Clock<'a> {
    pub(super) place: usize,
    /// \[s\]
    pub(super) times: Cow<'a, [f64]>,
    pub(super) timing: Timing,
}

impl<'a> Clock<'a> {
    pub(super) fn of(table: &'a Table, place: usize, unit: &str, remarks: &mut Vec<String>) -> Result<Self> {
        let column = table.columns[place].without_text()?;
        let times = of(table, column, unit, remarks);
        let timing = Timing::of_times(&times, &column.name, |row| table.line(row))?;
        Ok(Self { place, times, timing })
    }

    pub(super) fn ends(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }
}

/// \[s\], up to the last row that has a time.
pub(super) fn of<'a>(table: &Table, column: &'a Column, text: &str, remarks: &mut Vec<String>) -> Cow<'a, [f64]> {
    let values = &column.values;
    let rows = values.iter().rposition(|time| !time.is_nan()).map_or(0, |last| last + 1);
    let mut times = Cow::Borrowed(&values[..rows]);
    if rows > 0 && rows < values.len() {
        let (line, left) = (table.line(rows - 1), values.len() - rows);
        remarks.push(format!("the times end in line {line}: {left} row(s) below it are left out"));
    }
    let size = match unit(text) {
        // Times of day and dates are in seconds, even if their header names another unit.
        _ if column.is_time_of_day || column.is_dated => 1.0,
        Some((Dimension::Time, size)) => size,
        None if text.trim().is_empty() => {
            let (size, said) = second(column);
            remarks.extend(said);
            size
        }
        known => {
            remarks.push(format!("`{text}` is not a known unit of time: the times count as seconds"));
            known.map_or(1.0, |(_, size)| size)
        }
    };
    if size != 1.0 {
        times = mapped(&times, &|time| time * size).into();
    }
    times
}

/// By name, year or steps; with a sentence where the unit is another, or may be.
pub(super) fn second(column: &Column) -> (f64, Option<String>) {
    let name = column.name.to_lowercase();
    let words = [("millis", 1e-3), ("micros", 1e-6), ("nanos", 1e-9)];
    if let Some((_, size)) = words.into_iter().find(|(word, _)| name.contains(word)) {
        return (size, None);
    }
    let times: Vec<f64> = column.values.iter().copied().filter(|time| time.is_finite()).collect();
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    let (Some(step), Some(&last)) = (median(steps.collect()), times.last()) else { return (1.0, None) };
    let said = |unit: &str, why: &str, question: &str| {
        Some(format!("the times in `{}` have no unit: by their {why} they are {unit}{question}", column.name))
    };
    // A record of days has small steps.
    let is_since = |(_, size, zero): &&(&str, f64, f64)| {
        EPOCHS.contains(&(last * size - zero)) && (*size <= 1.0 || PLAUSIBLE.contains(&(size * step)))
    };
    if let Some((unit, size, _)) = CLOCKS.iter().find(is_since) {
        return (*size, if *size == 1.0 { None } else { said(unit, "size", "") });
    }
    let rate = |size: f64| 1.0 / (step * size);
    if step < 0.5 * PLAUSIBLE.start() && PLAUSIBLE.contains(&(DAY * step)) {
        // A time of day is a share of one, and a record is a small part of that.
        if (0.0..=1.0).contains(&last) && last > 10.0 * (last - times[0]) {
            return (DAY, said("days of a spreadsheet", "size", ""));
        }
        let question =
            format!(", {} samples a second: are they days? State their unit if it is another", rounded(rate(1.0)));
        return (1.0, said("seconds", "steps", &question));
    }
    if step < SLOW[0] {
        return (1.0, None);
    }
    if step < SLOW[1] {
        let said = "are they ms? They count as seconds until their unit is stated";
        let (name, rate) = (&column.name, rate(1.0));
        return (
            1.0,
            Some(format!("the times in `{name}` have no unit; in seconds they are {rate} samples a second: {said}")),
        );
    }
    // Where several units are plausible, the one counts whose rate is nearest to 100 Hz.
    let mut plausible: Vec<&(&str, f64)> =
        UNITS.iter().filter(|(_, size)| PLAUSIBLE.contains(&(step * size))).collect();
    let distance = |size: f64| libm::log10(rate(size) / 100.0).abs();
    sort_items(&mut plausible, |a, b| distance(a.1).total_cmp(&distance(b.1)));
    match plausible.as_slice() {
        [] => (1.0, said("seconds", "steps", &format!(", of which a sample has {step}: state their unit"))),
        [(unit, size), others @ ..] => {
            let (samples, seconds) = (rate(*size), 1.0 / rate(1.0));
            let or = others.first().map(|(other, size)| format!(" (in {other} {} a second)", rate(*size)));
            let question =
                format!(", {samples} samples a second{}; in seconds one in {seconds:.0} s", or.unwrap_or_default());
            (*size, said(unit, "steps", &(question + ": state their unit if it is another")))
        }
    }
}

/// Limits the error of times without a remark, as a share of the step.
const EXACT: f64 = 0.01;
/// Limits the error of a time that belongs to a sample, as a share of the step: beyond a half another is nearer.
const CLOSE: f64 = 0.5;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Timing {
    pub(super) start: f64,
    pub(super) dt: f64,
    pub(super) samples: usize,
    pub(super) places: Places,
    /// As a share of the step.
    worst: f64,
    is_rounded: bool,
    pub(super) remark: Option<String>,
    pub(super) gaps: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Places {
    Rows,
    Gaps(Vec<usize>),
    /// In steps after the first; values are interpolated linearly.
    Times(Vec<f64>),
}

impl Timing {
    pub(super) fn of_steps(Steps { start, dt, count: samples }: Steps) -> Self {
        let (places, remark, gaps) = (Places::Rows, None, None);
        Self { start, dt, samples, places, worst: 0.0, is_rounded: true, remark, gaps }
    }

    pub(super) fn of_times(times: &[f64], column: &str, line: impl Fn(usize) -> usize) -> Result<Self> {
        if times.len() < FEWEST {
            return Err(ImportError::TooShort(times.len()));
        }
        if let Some(row) = times.iter().position(|time| !time.is_finite()) {
            let problem = "a time is missing: state the sample rate, and the rows count as even".to_owned();
            return Err(ImportError::Cell(line(row), column.to_owned(), problem));
        }
        if let Some(row) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
            let (before, found) = (times[row], times[row + 1]);
            let turn = if found < before { "goes back" } else { "stands still" };
            let turn = format!("`{column}` {turn} from {before} s to {found} s");
            return Err(ImportError::NotRising(line(row + 1), turn, cure(times)));
        }
        let (start, last) = (times[0], times[times.len() - 1]);
        let even = (last - start) / (times.len() - 1) as f64;
        let step = times[1] - start;
        // A mean step is rounded, but that of a file with exact times must be exact.
        let exact = times.iter().enumerate().all(|(k, &time)| time == start + k as f64 * step);
        let dt = if exact { step } else { even };
        let off = |k: usize, place: f64, dt: f64| ((times[k] - start) / dt - place).abs();
        let worst = (0..times.len()).map(|k| off(k, k as f64, dt)).fold(0.0, f64::max);
        let resolution = resolution(times);
        let is_rounded = |worst: f64, dt: f64| worst * dt <= ROUNDED * resolution;
        let off_by = |worst: f64, dt: f64| {
            let why = if is_rounded(worst, dt) { ", as rounded ones are" } else { "" };
            let (percent, dt) = (100.0 * worst, rounded(dt));
            format!("the times are off by up to {percent:.0} % of a step{why}; even steps of {dt} s are used")
        };
        let (samples, places, (remark, gaps)) = (times.len(), Places::Rows, Default::default());
        let even = Self { start, dt, samples, places, worst, is_rounded: is_rounded(worst, dt), remark, gaps };
        if worst <= CLOSE {
            return Ok(Self { remark: (worst > EXACT).then(|| off_by(worst, dt)), ..even });
        }
        let median = median_step(times);
        let mut places = Vec::with_capacity(times.len());
        places.push(0);
        let mut longest = (0, 0);
        for row in 1..times.len() {
            let steps = libm::round((times[row] - times[row - 1]) / median).max(1.0);
            places.push(count(places[row - 1] as f64 + steps + 1.0)? - 1);
            longest = longest.max((steps as usize - 1, row));
        }
        let samples = places[places.len() - 1] + 1;
        let dt = (last - start) / (samples - 1) as f64;
        let worst = (0..times.len()).map(|k| off(k, places[k] as f64, dt)).fold(0.0, f64::max);
        if worst <= CLOSE {
            let (missing, (most, row)) = (samples - times.len(), longest);
            let gaps =
                format!("{missing} samples are missing; the longest gap has {most} and ends in line {}", line(row));
            let is_rounded = is_rounded(worst, dt);
            let remark = (worst > EXACT && !is_rounded).then(|| off_by(worst, dt));
            let (places, gaps) = (Places::Gaps(places), Some(gaps));
            return Ok(Self { dt, samples, places, worst, is_rounded, remark, gaps, ..even });
        }
        let samples = count(libm::floor((last - start) / median + 1e-9) + 1.0)?;
        let places = Places::Times(mapped(times, &|time| (time - start) / median));
        let remark =
            Some(format!("the times are irregular; values are interpolated at even steps of {} s", rounded(median)));
        Ok(Self { dt: median, samples, places, worst, is_rounded: false, remark, ..even })
    }

    pub(super) fn at_steps(self, dt: f64) -> Result<Self> {
        let samples = count(libm::floor((self.samples - 1) as f64 * self.dt / dt + 1e-6) + 1.0)?;
        Ok(Self { dt, samples, ..self })
    }

    pub(super) fn is_even(&self) -> bool {
        !matches!(self.places, Places::Times(_)) && (self.worst <= EXACT || self.is_rounded)
    }

    pub(super) fn kept(&self) -> String {
        let (dt, percent, own) = (rounded(self.dt), 100.0 * self.worst, "the filters use each reading at its own time");
        match self.places {
            Places::Times(_) => format!("the times are irregular: {own}, and report at steps of {dt} s"),
            _ => format!("the times are off by up to {percent:.0} % of a step of {dt} s: {own}"),
        }
    }

    /// NaN at samples without a row.
    pub(super) fn spread(&self, rows: &[f64]) -> Vec<f64> {
        match &self.places {
            // Rows without a time at the end have no sample.
            Places::Rows => rows[..self.samples.min(rows.len())].to_vec(),
            Places::Gaps(places) => {
                let mut values = vec![f64::NAN; self.samples];
                places.iter().zip(rows).for_each(|(&place, &value)| values[place] = value);
                values
            }
            Places::Times(times) => {
                let mut row = 0;
                let at = |k: usize| {
                    let time = k as f64;
                    while row + 2 < times.len() && times[row + 1] <= time {
                        row += 1;
                    }
                    let share = (time - times[row]) / (times[row + 1] - times[row]);
                    // A gap between distant values is not interpolated.
                    let is_gap = times[row + 1] - times[row] > 3.0;
                    match share {
                        share if share <= 0.0 => rows[row],
                        share if share >= 1.0 => rows[row + 1],
                        _ if is_gap => f64::NAN,
                        share => rows[row] + share * (rows[row + 1] - rows[row]),
                    }
                };
                (0..self.samples).map(at).collect()
            }
        }
    }
}

fn cure(times: &[f64]) -> String {
    let still = times.windows(2).filter(|pair| pair[1] == pair[0]).count();
    if 3 * still < times.len() || times.windows(2).any(|pair| pair[1] < pair[0]) {
        return "choose a part by its times, or state the sample rate to count the rows as even".to_owned();
    }
    // Whole runs of equal times, without the first one and the last, have the rate.
    let changes: Vec<usize> = (1..times.len()).filter(|&row| times[row] > times[row - 1]).collect();
    let rate = match changes.as_slice() {
        [first, .., last] => {
            format!(" of about {} Hz", rounded((last - first) as f64 / (times[*last] - times[*first])))
        }
        _ => String::new(),
    };
    let rows = times.len() as f64 / (changes.len() + 1) as f64;
    format!(
        "about {rows:.0} rows have the same time, as rounded ones: state the sample rate{rate}, and the rows count as even"
    )
}

fn count(samples: f64) -> Result<usize> {
    let found = samples.min(1e15) as usize;
    if samples > MOST as f64 { Err(ImportError::TooLong(found)) } else { Ok(found) }
}

/// Limits the shift by rounding, in units of the last decimal: half is a time's own, half that of the ends.
const ROUNDED: f64 = 1.01;

/// \[s\]; zero below a nanosecond.
fn resolution(times: &[f64]) -> f64 {
    let is_resolved = |unit: &f64| {
        let is_whole = |time: &f64| {
            let units = time / unit;
            (units - libm::round(units)).abs() <= 1e-3
        };
        times.iter().all(is_whole)
    };
    (0..=9).map(|decimals| libm::pow(10.0, -f64::from(decimals))).find(is_resolved).unwrap_or(0.0)
}

fn rounded(dt: f64) -> f64 {
    format!("{dt:.5e}").parse().unwrap_or(dt)
}

pub(super) fn median_step(times: &[f64]) -> f64 {
    median(times.windows(2).map(|pair| pair[1] - pair[0]).collect()).unwrap_or(f64::NAN)
}
