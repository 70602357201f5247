//! The way from even times to the samples of a record: a band, a part, another rate.

use super::times::Timing;
use super::{ImportError, Mapping};
use crate::Hold;
use crate::data::even_steps::Steps;
use crate::data::resample::{self, band_pass};
use crate::mathematics::lists::places;

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

pub(super) fn above_nyquist(band: Option<[f64; 2]>, nyquist: f64) -> Result<Option<String>, ImportError> {
    let Some([low, high]) = band.filter(|[_, high]| *high >= nyquist) else { return Ok(None) };
    if low >= nyquist {
        let (key, value) = ("band".to_owned(), format!("[{low}, {high}]"));
        let allowed = format!("below the Nyquist frequency, {nyquist} Hz");
        return Err(ImportError::Setting(key, value, allowed));
    }
    Ok(Some(format!(
        "the band's upper limit, {high} Hz, is not below the Nyquist frequency, {nyquist} Hz: it takes nothing away"
    )))
}

/// Interpolates missing values linearly, or repeats the nearest at the ends. Returns the first one's place, and how many there are.
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

/// Moves values to earlier samples by `delay`, or to later ones where it is negative; the ends become missing.
pub(super) fn shift(values: &mut [f64], delay: i32) {
    let n = values.len();
    let by = (delay.unsigned_abs() as usize).min(n);
    if delay > 0 {
        values.rotate_left(by);
        values[n - by..].fill(f64::NAN);
    } else if delay < 0 {
        values.rotate_right(by);
        values[..by].fill(f64::NAN);
    }
}

pub(super) fn mean(values: &[f64]) -> f64 {
    let there = values.iter().filter(|value| !value.is_nan());
    there.clone().fold(0.0, |sum, value| sum + value) / there.count().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::builder::tests::{TEXT, import};
    use super::*;

    #[test]
    fn a_part_is_cut_and_keeps_its_times() {
        let record = import(TEXT, |mapping| (mapping.from, mapping.to) = (Some(0.1), Some(0.3))).unwrap().record;
        assert_eq!((record.len(), record.time(0)), (3, 0.1));
        assert_eq!(record.input(), [2.0, 3.0, 4.0]);
    }

    #[test]
    fn interpolation_leaves_measurements_where_they_were() {
        let record = import(TEXT, |mapping| mapping.interpolate = 2).unwrap().record;
        assert_eq!((record.len(), record.dt()), (9, 0.05));
        assert!(record.measured(0)[1].is_nan());
        assert_eq!(record.measured(0)[2], 3.0);
        assert_eq!((record.input()[0], record.input()[2]), (1.0, 2.0));
    }

    #[test]
    fn decimation_keeps_missing_samples_missing() {
        let mut text = "t,force,displacement\n".to_owned();
        for k in 0..100 {
            let x = if (40..44).contains(&k) { String::new() } else { "1".to_owned() };
            text.push_str(&format!("{},0.5,{x}\n", f64::from(k) * 0.01));
        }
        let record = import(&text, |mapping| mapping.every = 4).unwrap().record;
        assert_eq!((record.len(), record.dt()), (25, 0.04));
        assert!(record.measured(0)[10].is_nan() && !record.measured(0)[11].is_nan());
        assert!((record.measured(0)[20] - 1.0).abs() < 1e-9 && (record.input()[12] - 0.5).abs() < 1e-9);
    }

    #[test]
    fn bands_above_the_nyquist_frequency_are_told() {
        let band = |low, high| import(TEXT, |mapping| mapping.band = Some([low, high]));
        let remarks = band(1.0, 90.0).unwrap().remarks;
        assert!(remarks[0].contains("90 Hz, is not below the Nyquist frequency, 5 Hz"), "{remarks:?}");
        assert!(band(6.0, 90.0).unwrap_err().to_string().contains("below the Nyquist frequency, 5 Hz"));
    }

    #[test]
    fn gaps_are_filled_shifted_and_left_out_of_the_mean() {
        let mut ends = [f64::NAN, 1.0, f64::NAN, f64::NAN, 4.0, f64::NAN];
        assert_eq!(fill(&mut ends), Some((0, 4)));
        assert_eq!(ends, [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        assert!(fill(&mut ends).is_none());
        for (delay, expected) in
            [(1, "[2.0, 3.0, NaN]"), (-2, "[NaN, NaN, 1.0]"), (0, "[1.0, 2.0, 3.0]"), (7, "[NaN, NaN, NaN]")]
        {
            let mut values = [1.0, 2.0, 3.0];
            shift(&mut values, delay);
            assert_eq!(format!("{values:?}"), expected);
        }
        assert_eq!([mean(&[1.0, f64::NAN, 4.0]), mean(&[f64::NAN])], [2.5, 0.0]);
    }
}
