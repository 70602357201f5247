//! Cells without a reading, and the steps from even times to the samples of a record: a band, a part, another rate.

use kalmanscope_filters::Hold;
use kalmanscope_filters::lists::places;

use super::header::unit;
use super::times::Timing;
use super::{MappedColumn, Mapping, MappingError, Result, Table};
use crate::resample::{self, Steps, band_pass};

#[derive(Clone, Copy)]
pub(super) struct Conditioning<'a> {
    pub(super) mapping: &'a Mapping,
    pub(super) timing: &'a Timing,
}

impl Conditioning<'_> {
    pub(super) fn part(&self) -> std::ops::Range<usize> {
        let Timing { start, dt, samples, .. } = *self.timing;
        let place = |place: f64| place.clamp(0.0, samples as f64) as usize;
        let from = self.mapping.from.map_or(0, |from| place(libm::ceil((from - start) / dt - 1e-6)));
        let to = self.mapping.to.map_or(samples, |to| place(libm::floor((to - start) / dt + 1e-6) + 1.0));
        from..to.max(from)
    }

    pub(super) fn steps(&self) -> Steps {
        let (Mapping { every, interpolate, .. }, Timing { start, dt, .. }) = (self.mapping, self.timing);
        let part = self.part();
        let kept = part.len().div_ceil(*every);
        let is_same = *every == 1 && *interpolate == 1;
        Steps {
            start: start + part.start as f64 * dt,
            dt: if is_same { *dt } else { dt * *every as f64 / *interpolate as f64 },
            count: kept.saturating_sub(1) * interpolate + kept.min(1),
        }
    }

    pub(super) fn input(&self, mut values: Vec<f64>, hold: Hold) -> Vec<f64> {
        self.condition(&mut values);
        resample::finer_input(&values, self.mapping.interpolate, hold)
    }

    pub(super) fn sensor(&self, mut values: Vec<f64>) -> Vec<f64> {
        let mut missing: Vec<f64> = values.clone();
        let changes = self.mapping.band.is_some() || self.mapping.every > 1;
        // A filter would spread a single NaN over the whole record.
        let is_filled = changes && fill(&mut values).is_some();
        self.condition(&mut values);
        if is_filled {
            self.cut(&mut missing);
            resample::keep_every(&mut missing, self.mapping.every);
            let gaps = values.iter_mut().zip(&missing).filter(|(_, missing)| missing.is_nan());
            gaps.for_each(|(value, _)| *value = f64::NAN);
        }
        let steps = self.mapping.interpolate;
        if steps > 1 { resample::spread(&values, steps) } else { values }
    }

    pub(super) fn cut(&self, values: &mut Vec<f64>) {
        let part = self.part();
        values.truncate(part.end);
        values.drain(..part.start.min(values.len()));
    }

    fn condition(&self, values: &mut Vec<f64>) {
        if let Some([low, high]) = self.mapping.band {
            let dt = self.timing.dt;
            band_pass(values, low * dt, high * dt);
        }
        // The low-pass before the cut, so that the record does not begin with its swing-in.
        resample::anti_alias(values, self.mapping.every);
        self.cut(values);
        resample::keep_every(values, self.mapping.every);
    }
}

impl Mapping {
    pub(super) fn needs_even_steps(&self) -> bool {
        self.time.even || self.band.is_some() || self.every != 1 || self.interpolate != 1
    }

    /// As shares of the Nyquist frequency; `dt` \[s\].
    pub fn passed(&self, dt: f64) -> [f64; 2] {
        let [low, high] = self.band.map_or([0.0, 1.0], |band| band.map(|limit| 2.0 * limit * dt));
        let high = high.min(if self.every > 1 { resample::GUARD } else { 1.0 });
        [low.clamp(0.0, 0.99 * high), high]
    }
}

impl MappedColumn {
    pub(super) fn factor(&self) -> f64 {
        self.gain * unit(&self.unit).map_or(1.0, |(_, size)| size)
    }

    /// The column of a table with a name, in the unit of its header, without the numbers that loggers write for a missing reading.
    pub fn of(table: &Table, column: impl Into<String>) -> Self {
        let mut mapped = Self::new(column);
        if let Some(place) = table.place(&mapped.column) {
            mapped.unit = table.columns[place].unit.clone().unwrap_or_default();
            mapped.missing = table.sentinel(place).filter(|found| found.is_usual).map(|found| found.value);
        }
        mapped
    }
}

pub(super) fn above_nyquist(band: Option<[f64; 2]>, nyquist: f64) -> Result<Option<String>> {
    let Some([low, high]) = band.filter(|[_, high]| *high >= nyquist) else { return Ok(None) };
    if low >= nyquist {
        let (key, value) = ("band".to_owned(), format!("[{low}, {high}]"));
        let allowed = format!("below the Nyquist frequency, {nyquist} Hz");
        return Err(MappingError { key, value, allowed }.into());
    }
    Ok(Some(format!(
        "the band's upper limit, {high} Hz, is not below the Nyquist frequency, {nyquist} Hz: it removes nothing"
    )))
}

/// Repeats the nearest value at the ends. Returns the first missing place and the number of missing values.
pub(super) fn fill(values: &mut [f64]) -> Option<(usize, usize)> {
    let missing = places(values.len(), &|place| values[place].is_nan());
    for gap in missing.chunk_by(|one, next| one + 1 == *next) {
        let from = gap[0].checked_sub(1).map(|before| values[before]);
        let to = values.get(gap[0] + gap.len()).copied();
        for (i, place) in gap.iter().enumerate() {
            let share = (i + 1) as f64 / (gap.len() as f64 + 1.0);
            values[*place] = match (from, to) {
                (Some(from), Some(to)) => from + share * (to - from),
                (known, None) | (None, known) => known.unwrap_or(0.0),
            };
        }
    }
    Some((*missing.first()?, missing.len()))
}

/// Negative `delay` moves values to later samples; the ends become missing.
pub(super) fn shift(values: &mut [f64], delay: i32) {
    let n = values.len();
    let by = (delay.unsigned_abs() as usize).min(n);
    let gap = if delay > 0 { n - by..n } else { 0..by };
    let rotate = if delay > 0 { <[f64]>::rotate_left } else { <[f64]>::rotate_right };
    rotate(values, by);
    values[gap].fill(f64::NAN);
}

/// A number that seems to mark missing readings: it occurs several times, far from all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sentinel {
    /// The number.
    pub value: f64,
    /// The number of cells that have it.
    pub count: usize,
    /// The line of the first one, counted from 1.
    pub line: usize,
    /// Whether loggers write it for a missing reading: nines, the ends of whole numbers of 16 and 32 bits, 1e30 and more.
    pub is_usual: bool,
}

/// Limits from below the distance of a sentinel from all numbers, over their range: of a usual one, of any other number.
const FAR: [f64; 2] = [3.0, 30.0];

#[derive(Clone, Copy)]
struct End {
    value: f64,
    count: usize,
    row: usize,
    next: f64,
}

impl Table {
    /// The number that seems to mark missing readings in the column at a place.
    pub fn sentinel(&self, place: usize) -> Option<Sentinel> {
        let values = &self.columns[place].values;
        let (low, high) = (end(values, 1.0)?, end(values, -1.0)?);
        let finite = values.iter().filter(|value| value.is_finite()).count();
        let of = |end: End, other: End| {
            let is_usual = is_usual(end.value);
            let range = (end.next - other.value).abs();
            let far = (end.value - end.next).abs() > FAR[usize::from(!is_usual)] * range;
            let enough = end.count >= if is_usual { 2 } else { 3 } && 2 * end.count < finite;
            let End { value, count, row, .. } = end;
            (range > 0.0 && far && enough).then(|| Sentinel { value, count, line: self.line(row), is_usual })
        };
        of(low, high).or_else(|| of(high, low))
    }

    /// The table without the number `missing`, or those that loggers write for a missing reading, and a remark on each column with some.
    #[must_use]
    pub fn with_gaps(&self, missing: Option<f64>) -> Self {
        let mut with_gaps = self.clone();
        for (place, column) in with_gaps.columns.iter_mut().enumerate() {
            let guessed = || self.sentinel(place).filter(|sentinel| sentinel.is_usual).map(|sentinel| sentinel.value);
            let Some(number) = missing.or_else(guessed) else { continue };
            let cells = column.values.iter_mut().filter(|value| **value == number);
            let count = cells.map(|value| *value = f64::NAN).count();
            if count > 0 {
                let remark = format!("{number} in {count} cells of `{}` counts as missing", column.name);
                with_gaps.remarks.push(remark);
            }
        }
        with_gaps
    }
}

fn end(values: &[f64], sign: f64) -> Option<End> {
    let mut end: Option<End> = None;
    for (row, &value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        match &mut end {
            None => end = Some(End { value, count: 1, row, next: sign * f64::INFINITY }),
            Some(end) if value == end.value => end.count += 1,
            Some(end) if sign * value < sign * end.value => *end = End { value, count: 1, row, next: end.value },
            Some(end) if sign * value < sign * end.next => end.next = value,
            Some(_) => {}
        }
    }
    end.filter(|end| end.next.is_finite())
}

fn is_usual(value: f64) -> bool {
    let size = value.abs();
    let nines = [999.0, 9999.0, 99_999.0, 999_999.0, 9_999_999.0, 999.25, 999.9, 9999.9];
    let ends = [32_767.0, 32_768.0, 65_535.0, 2_147_483_647.0, 2_147_483_648.0, 8888.0, 7999.0, 6999.0];
    nines.contains(&size) || ends.contains(&size) || size >= 1e30
}

pub(super) fn cells_without_readings(table: &Table, place: usize, mapped: &MappedColumn) -> Vec<String> {
    let column = &table.columns[place];
    let name = &column.name;
    let word = column.word.as_ref().map(|word| {
        let (count, line) = (column.words, word.line);
        let text = &word.text;
        format!(
            "{count} cell(s) of `{name}` have a word such as `{text}`, the first in line {line}: they count as missing"
        )
    });
    let number = match mapped.missing {
        Some(missing) => {
            let rows = || column.values.iter().enumerate().filter(|(_, value)| **value == missing);
            rows().next().map(|(row, _)| {
                let (count, line) = (rows().count(), table.line(row));
                format!("{count} cell(s) of `{name}` are {missing}, the first in line {line}: they count as missing")
            })
        }
        None => table.sentinel(place).map(|found| {
            let (value, count, line) = (found.value, found.count, found.line);
            format!(
                "{count} cells of `{name}` are {value}, far from all others, the first in line {line}: are they missing? They \
                 count as readings until `missing = {value}` is stated"
            )
        }),
    };
    word.into_iter().chain(number).collect()
}

pub(super) fn is_still(readings: &[f64]) -> bool {
    let mut there = readings.iter().filter(|reading| !reading.is_nan());
    let first = there.next();
    there.all(|reading| Some(reading) == first)
}
