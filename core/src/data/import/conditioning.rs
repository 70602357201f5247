//! The way from even times to the samples of a record: a band, a part, another rate.

use super::butterworth::band_pass;
use super::samples::fill;
use super::timing::Timing;
use super::{Mapping, resample};
use crate::Hold;

/// The conditioning of all columns of a record.
pub(super) struct Conditioning<'a> {
    mapping: &'a Mapping,
    timing: &'a Timing,
}

impl<'a> Conditioning<'a> {
    pub(super) fn new(mapping: &'a Mapping, timing: &'a Timing) -> Self {
        Self { mapping, timing }
    }

    /// The samples of the part that is used.
    pub(super) fn part(&self) -> std::ops::Range<usize> {
        let Timing { start, dt, samples, .. } = *self.timing;
        let place = |time: f64| libm::ceil((time - start) / dt - 1e-6).clamp(0.0, samples as f64) as usize;
        let from = self.mapping.from.map_or(0, place);
        let to = self
            .mapping
            .to
            .map_or(samples, |to| (libm::floor((to - start) / dt + 1e-6) + 1.0).clamp(0.0, samples as f64) as usize);
        from..to.max(from)
    }

    /// The time of the first sample \[s\].
    pub(super) fn start(&self) -> f64 {
        self.timing.start + self.part().start as f64 * self.timing.dt
    }

    /// Time between samples \[s\].
    pub(super) fn dt(&self) -> f64 {
        let Mapping { every, interpolate, .. } = self.mapping;
        let dt = self.timing.dt;
        if *every == 1 && *interpolate == 1 { dt } else { dt * *every as f64 / *interpolate as f64 }
    }

    /// The number of samples.
    pub(super) fn samples(&self) -> usize {
        let kept = self.part().len().div_ceil(self.mapping.every);
        kept.saturating_sub(1) * self.mapping.interpolate + kept.min(1)
    }

    /// The samples of an input without gaps, which has this course between them.
    pub(super) fn input(&self, mut values: Vec<f64>, hold: Hold) -> Vec<f64> {
        self.condition(&mut values);
        resample::finer_input(&values, self.mapping.interpolate, hold)
    }

    /// The samples of a sensor. Missing values stay missing.
    pub(super) fn sensor(&self, mut values: Vec<f64>) -> Vec<f64> {
        let mut missing: Vec<f64> = values.clone();
        let changes = self.mapping.band.is_some() || self.mapping.every > 1;
        if changes && fill(&mut values).is_some() {
            self.condition(&mut values);
            self.cut(&mut missing);
            resample::keep_every(&mut missing, self.mapping.every);
            for (value, missing) in values.iter_mut().zip(&missing) {
                if missing.is_nan() {
                    *value = f64::NAN;
                }
            }
        } else {
            self.condition(&mut values);
        }
        let steps = self.mapping.interpolate;
        if steps > 1 { resample::spread(&values, steps) } else { values }
    }

    /// The part that is used.
    pub(super) fn cut(&self, values: &mut Vec<f64>) {
        let part = self.part();
        values.truncate(part.end);
        values.drain(..part.start.min(values.len()));
    }

    /// Band-pass, low-pass, cut, and fewer samples.
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

#[cfg(test)]
mod tests {
    use super::super::builder::tests::{TEXT, import};

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
}
