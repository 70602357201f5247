//! What a sensor's readings tell of the sensor, without a model: clipping, sticking, coarse steps, outliers.

use super::case::Case;
use crate::data::sorting::sort_numbers;

/// The readings of one sensor over the diagnosed samples, and its normalised innovations `e/√S`; NaN where there is none.
pub(super) struct Readings {
    pub(super) values: Vec<f64>,
    pub(super) innovations: Vec<f64>,
}

/// Readings of which something is wrong.
pub(super) struct Marked {
    /// Their share of the readings.
    pub(super) share: f64,
    /// The mean of their innovations², relative to the expectation, and that of all others.
    pub(super) levels: [f64; 2],
}

impl Readings {
    /// The readings of the sensor at a place among the filter's. `None` if the record has no column for it.
    pub(super) fn of(case: &Case<'_>, place: usize) -> Option<Self> {
        let column = case.estimates.measured(case.record, place)?;
        let m = case.sensors.len();
        let innovation = |k: usize| {
            let (e, s) = (case.estimates.innovation(k)[place], case.estimates.innovation_cov(k)[place * (m + 1)]);
            e / s.sqrt()
        };
        Some(Self {
            values: case.samples.clone().map(column).collect(),
            innovations: case.samples.clone().map(innovation).collect(),
        })
    }

    /// Compares the marked readings with the others. `None` if there are only some of one kind.
    fn marked(&self, marks: &[bool]) -> Option<Marked> {
        let mut sums = [(0.0, 0.0); 2];
        for (innovation, marked) in self.innovations.iter().zip(marks).filter(|(innovation, _)| innovation.is_finite())
        {
            let (sum, count) = &mut sums[usize::from(!*marked)];
            (*sum, *count) = (*sum + innovation * innovation, *count + 1.0);
        }
        let levels = sums.map(|(sum, count)| sum / count);
        let share = sums[0].1 / (sums[0].1 + sums[1].1);
        levels.iter().all(|level| level.is_finite()).then_some(Marked { share, levels })
    }

    /// The readings at the end of the sensor's range.
    pub(super) fn clipped(&self) -> Option<Marked> {
        let ends = clipped_ends(&self.values);
        let marks: Vec<bool> = self.values.iter().map(|value| ends.contains(value)).collect();
        if ends.is_empty() { None } else { self.marked(&marks) }
    }

    /// The readings that repeat the one before, in spells of three or more. The sensor must not repeat itself elsewhere.
    pub(super) fn stuck(&self) -> Option<Marked> {
        // A sensor that is clipped repeats the end of its range.
        let known = || self.values.iter().copied().filter(|value| !value.is_nan());
        let ends = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let is_end = |value: f64| value <= ends.0 || value >= ends.1;
        let repeats = |pair: &[f64]| pair[0].to_bits() == pair[1].to_bits() && !is_end(pair[0]);
        let same: Vec<bool> = self.values.windows(2).map(repeats).collect();
        let mut marks = vec![false; self.values.len()];
        let mut start = 0;
        while start < same.len() {
            let end = same[start..].iter().position(|same| !same).map_or(same.len(), |length| start + length);
            // Two repeats and more are three equal readings and more.
            if end - start >= 2 {
                marks[start + 1..=end].fill(true);
            }
            start = end + 1;
        }
        let stuck = marks.iter().filter(|mark| **mark).count() as f64;
        let short = same.iter().filter(|same| **same).count() as f64 - stuck;
        let count = self.values.len() as f64;
        let is_so = stuck >= SHARE * count && stuck >= FEWEST as f64 && short < 0.02 * count;
        if is_so { self.marked(&marks).filter(|marked| marked.share < 0.9) } else { None }
    }

    /// The step of a coarse sensor: all its readings are multiples of one number.
    pub(super) fn step(&self) -> Option<f64> {
        let mut values: Vec<f64> = self.values.iter().copied().filter(|value| !value.is_nan()).collect();
        let count = values.len();
        sort_numbers(&mut values);
        values.dedup();
        let [first, .., last] = values[..] else { return None };
        if count < 50 || values.len() as f64 > MOST_LEVELS * count as f64 {
            return None;
        }
        let rounding = 1e-9 * (last - first);
        let gaps = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > rounding);
        let step = gaps.fold(f64::INFINITY, f64::min);
        let is_multiple = |value: &&f64| {
            let steps = (**value - first) / step;
            (steps - steps.round()).abs() < 1e-3
        };
        let multiples = values.iter().filter(is_multiple).count();
        (step.is_finite() && multiples as f64 >= 0.99 * values.len() as f64).then_some(step)
    }

    /// The readings whose innovations are far beyond the usual ones, if they are few and stand alone.
    pub(super) fn outliers(&self) -> Option<Marked> {
        let mut sizes: Vec<f64> = self.innovations.iter().map(|e| e.abs()).filter(|e| e.is_finite()).collect();
        if sizes.len() < 200 {
            return None;
        }
        let middle = sizes.len() / 2;
        let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
        let usual = (*median / MEDIAN).max(1.0);
        let marks: Vec<bool> = self.innovations.iter().map(|e| e.abs() > FAR * usual).collect();
        let many = marks.iter().filter(|mark| **mark).count() as f64;
        // The share of the far readings whose follower is far too: chance makes it their share of all.
        let followed = marks.windows(2).filter(|pair| pair[0] && pair[1]).count() as f64 / many;
        let share = many / sizes.len() as f64;
        let alone = followed < share + 0.25 && share < 0.3;
        // Noise that grows once has its large values behind that time alone.
        let quarters = marks.chunks(marks.len().div_ceil(4).max(1));
        let spread = quarters.map(|part| part.iter().filter(|mark| **mark).count() as f64 / many);
        let alone = alone && spread.fold(f64::INFINITY, f64::min) > LEAST_PART;
        if many >= FEWEST as f64 && share >= OUTLYING && alone { self.marked(&marks) } else { None }
    }
}

/// The largest and the smallest reading, if so many are there, in several spells, that the sensor cannot read beyond them.
pub(super) fn clipped_ends(values: &[f64]) -> Vec<f64> {
    let known = || values.iter().copied().filter(|value| !value.is_nan());
    let (low, high) = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let count = known().count();
    let is_end = |end: &f64| {
        let is_there = |value: &f64| value == end;
        let there = known().filter(is_there).count();
        // The next value that occurs: of a coarse sensor it is as frequent.
        let beside =
            known().filter(|value| !is_there(value)).min_by(|a, b| (a - end).abs().total_cmp(&(b - end).abs()));
        let next = known().filter(|value| Some(*value) == beside).count();
        let spells = spells(values.iter().map(is_there));
        there >= FEWEST && there as f64 >= SHARE * count as f64 && spells >= SPELLS && there > 3 * next
    };
    [low, high].into_iter().filter(is_end).collect()
}

/// The least number of marked readings, and their least share.
const FEWEST: usize = 10;
const SHARE: f64 = 0.01;

/// The least number of spells at an end: one alone may be a rest.
const SPELLS: usize = 3;

/// Limits the different values of a coarse sensor, as a share of its readings.
const MOST_LEVELS: f64 = 0.3;

/// The median of the absolute value of a standard normal number.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// An innovation beyond so many usual ones is far: chance makes 6 of ten million so.
const FAR: f64 = 5.0;

/// The least share of outliers.
const OUTLYING: f64 = 0.004;

/// The least share of all outliers in each quarter of the record.
const LEAST_PART: f64 = 0.06;

/// The number of spells of consecutive marks.
fn spells(marks: impl Iterator<Item = bool>) -> usize {
    let mut before = false;
    marks.filter(|&mark| !std::mem::replace(&mut before, mark) && mark).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::Normal;

    /// A swing read with noise, changed in some way, with innovations that are the noise.
    fn readings(change: impl Fn(usize, f64) -> f64) -> Readings {
        let mut normal = Normal::from_seed(4);
        let (mut values, mut innovations) = (Vec::new(), Vec::new());
        for k in 0..2000_usize {
            let (x, noise) = ((0.06 * k as f64).sin(), normal.sample());
            let value = change(k, x + 0.01 * noise);
            values.push(value);
            innovations.push((value - x) / 0.01);
        }
        Readings { values, innovations }
    }

    #[test]
    fn each_fault_is_found_and_no_other() {
        let none = |_: usize, x: f64| x;
        let clip = |_: usize, x: f64| x.clamp(-0.8, 0.8);
        let coarse = |_: usize, x: f64| (x / 0.05).round() * 0.05;
        let outliers = |k: usize, x: f64| if k % 50 == 7 { x + 0.2 } else { x };
        let growing = |k: usize, x: f64| if k < 1000 { x } else { x + 0.1 * (1.7 * (k * k) as f64).sin() };
        let found = |readings: &Readings| {
            [readings.clipped().is_some(), readings.stuck().is_some(), readings.outliers().is_some()]
        };
        assert_eq!(found(&readings(none)), [false; 3]);
        assert_eq!(found(&readings(clip))[0..2], [true, false]);
        assert_eq!(found(&readings(outliers)), [false, false, true]);
        assert!(!found(&readings(growing))[2], "noise that grows once is no outliers");
        let step = readings(coarse).step().unwrap();
        assert!((step / 0.05 - 1.0).abs() < 1e-6 && !found(&readings(coarse))[0], "{step}");
        assert_eq!(readings(none).step(), None);
        let mut stuck = readings(none);
        for k in (100..1900).filter(|k| k % 100 < 20 && k % 100 > 0) {
            stuck.values[k] = stuck.values[k - 1];
        }
        assert!(found(&stuck)[1] && !found(&stuck)[0]);
        let marked = stuck.stuck().unwrap();
        assert!((marked.share - 0.17).abs() < 0.02, "{}", marked.share);
    }

    #[test]
    fn nothing_is_found_in_nothing() {
        for values in [Vec::new(), vec![f64::NAN; 300], vec![1.0; 300]] {
            let innovations = vec![f64::NAN; values.len()];
            let readings = Readings { values, innovations };
            assert!(readings.clipped().is_none() && readings.stuck().is_none() && readings.outliers().is_none());
            assert_eq!(readings.step(), None);
        }
    }
}
