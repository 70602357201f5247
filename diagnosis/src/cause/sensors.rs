//! What is wrong with the readings of a sensor.

use kalmanscope_core::Length;
use kalmanscope_core::internals::{mapped, sort_numbers};
use kalmanscope_core::scenario::option::WEIGHED;

use super::{BadFilter, Cause, LikelyCause};
use crate::case::Case;
use crate::words::{percent, short};

pub(super) static CLIPPED: Cause = Cause {
    key: "clipped",
    name: "a sensor that is clipped",
    hint: "Readings stop at the end of the sensor's range. Leave out those at the end, or use a sensor with a wider \
           range. A filter that weighs its readings leaves them out in part.",
    likely_causes: |bad, cause, found| marked(bad, cause, found, Readings::clipped, "are at the end of its range"),
};

pub(super) static STICKING: Cause = Cause {
    key: "sticking",
    name: "a sensor that sticks",
    hint: "A logger repeats the last reading if no new one arrives. Leave the repeats out, as empty cells. A filter \
           that weighs its readings leaves them out in part.",
    likely_causes: |bad, cause, found| marked(bad, cause, found, Readings::stuck, "repeat the last one"),
};

type Look = fn(&Readings) -> Option<Marked>;

fn marked(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>, look: Look, what: &str) {
    for (place, one) in bad.case.sensors.iter().enumerate() {
        let Some(Marked { share, levels }) = Readings::of(bad.case, place).as_ref().and_then(look) else { continue };
        let [there, elsewhere] = levels;
        if there <= 1.5 * elsewhere.max(1.0) {
            continue;
        }
        let (some, name, times, others) = (percent(share), one.sensor.key(), short(there), short(elsewhere));
        let level = format!("where innovations² are {times} times what is expected ({others} elsewhere)");
        let sentence = format!("{some} of the readings of the {name} {what}, {level}");
        let with = |edits| LikelyCause::new(cause, 1.0 - 1.0 / there, 0.0, edits, sentence.clone()).of_record();
        found.push(with(Vec::new()));
        if !bad.filter.robust.is_on() && bad.filter.can(&WEIGHED) && bad.filter.walk == 0.0 {
            found.push(with(vec![bad.edit("robust", "gate")]));
        }
    }
}

/// The least step that matters, in assumed σ of the noise: two add a third to R, by a twelfth of their square.
const LEAST_STEP: f64 = 2.0;

pub(super) static COARSE: Cause = Cause {
    key: "coarse",
    name: "the coarse steps of a sensor",
    hint: "A converter with few bits rounds each reading to a step. Rounding adds a twelfth of the step squared to the \
           noise: add it to R.",
    likely_causes: |bad, cause, found| {
        // Adds the variance of rounding to R: a step squared over twelve (Widrow and Kollár 2008, *Quantization Noise*).
        let length = Length::of(bad.scenario.record.as_ref());
        let mut stds = bad.filter.sensor_std.clone();
        let (mut told, mut most) = (Vec::new(), 0.0_f64);
        for (place, one) in bad.case.sensors.iter().enumerate() {
            let (own, step) = (stds[place], Readings::of(bad.case, place).and_then(|readings| readings.step()));
            // A filter that knows of the rounding has a larger σ.
            let Some(step) = step.filter(|step| *step >= LEAST_STEP * own) else { continue };
            stds[place] = (own * own + step * step / 12.0).sqrt();
            most = most.max(step / own);
            let (name, unit, times) = (one.sensor.key(), length.in_place_of(one.sensor.unit()), short(step / own));
            told.push(format!("the {name} reads in steps of {} {unit}, {times} times the assumed σ", short(step)));
        }
        if told.is_empty() {
            return;
        }
        let edits = vec![bad.edit("sensor_std", stds)];
        let likely = LikelyCause::new(cause, 1.0 - 1.0 / most, told.len() as f64, edits, told.join(", "));
        found.push(LikelyCause { certain: true, ..likely });
    },
};

pub(super) static OUTLIERS: Cause = Cause {
    key: "outliers",
    name: "outliers of a sensor",
    hint: "Single readings are far off, and their neighbours are not. A larger R would weaken all readings because of \
           a few. Let the filter weigh each reading by its fit.",
    likely_causes: |bad, cause, found| {
        if bad.filter.robust.is_on() || !bad.filter.can(&WEIGHED) || bad.filter.walk > 0.0 {
            return;
        }
        let (mut sentences, mut most) = (Vec::new(), f64::NAN);
        for (place, one) in bad.case.sensors.iter().enumerate() {
            let Some(marked) = Readings::of(bad.case, place).and_then(|readings| readings.outliers()) else { continue };
            let [there, elsewhere] = marked.levels;
            most = there.max(most);
            let (some, name, times, others) = (percent(marked.share), one.sensor.key(), short(there), short(elsewhere));
            let sizes = format!("their innovations² are {times} times what is expected, those of the others {others}");
            sentences.push(format!("{some} of the readings of the {name} stand alone and far off: {sizes}"));
        }
        if sentences.is_empty() {
            return;
        }
        let sentence = sentences.join("; ");
        for (place, rule) in ["student_t", "gate"].into_iter().enumerate() {
            let weight = (1.0 - 1.0 / most) * if place == 0 { 1.0 } else { 0.9 };
            let likely = LikelyCause::new(cause, weight, 1.0, vec![bad.edit("robust", rule)], sentence.clone());
            found.push(LikelyCause { certain: true, ..likely });
        }
    },
};

const WIDE: f64 = 10.0;

pub(super) static SENSOR_BIAS: Cause = Cause {
    key: "sensor_bias",
    name: "a sensor's bias or drift",
    hint: "The sensor's zero is off, or drifts. Let the filter estimate it, with process noise if it drifts.",
    likely_causes: |bad, cause, found| {
        let case = bad.case;
        for (one, std) in case.sensors.iter().zip(&bad.filter.sensor_std) {
            let bias = one.sensor.bias();
            let mean = one.mean(&case.kept).abs();
            let name = one.sensor.key();
            // Over a record of n samples the random walk of the bias goes by √n steps: ten σ of the sensor.
            let step = WIDE * std / (case.len().max(1) as f64).sqrt();
            if bad.filter.augment.contains(&bias) {
                for step in [0.2 * step, step].into_iter().filter(|step| *step > bad.filter.process_std[bias]) {
                    let edits = vec![bad.entry("process_std", bias, step)];
                    let sentence = format!("the bias of the {name} drifts, but its Q is too small");
                    found.push(LikelyCause::new(cause, 0.5, 1.0, edits, sentence));
                }
                continue;
            }
            let still = vec![bad.augmented(bias), bad.entry("initial_std", bias, WIDE * std)];
            let mut drifting = still.clone();
            drifting.push(bad.entry("process_std", bias, step));
            let weight = 2.0 * mean / (1.0 + 2.0 * mean);
            found.push(LikelyCause::new(cause, weight, 1.0, still, format!("the {name} has a bias")));
            found.push(LikelyCause::new(cause, 0.8 * weight, 2.0, drifting, format!("the bias of the {name} drifts")));
        }
    },
};

/// Over the correlation time of innovations, which is shorter than that of the noise: a filter takes a part of it for motion.
const LONGER: [f64; 3] = [1.0, 2.0, 5.0];

pub(super) static COLOURED_NOISE: Cause = Cause {
    key: "coloured_noise",
    name: "coloured noise of a sensor",
    hint: "A sensor's filter or a loose mount correlates its noise over time, but the filter assumes white noise. Let \
           it estimate a bias with a correlation time.",
    likely_causes: coloured,
};

/// A Gauss-Markov bias: the noise of a step is `σ √(1 - exp(-2 dt / τ))`.
/// Source: Bryson and Henrikson (1968), Estimation using sampled data containing sequentially correlated noise.
fn coloured(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    for (place, one) in case.sensors.iter().enumerate() {
        let (bias, (lag, first)) = (one.sensor.bias(), one.first_correlation(&case.kept));
        if first < 0.08 || bad.filter.augment.contains(&bias) {
            continue;
        }
        let size = bad.filter.sensor_std[place] * one.level(&case.kept).max(0.0).sqrt();
        // By chance r is below zero or about 1, and the time would be no number or have no end.
        let last = |r: f64| -1.0 / libm::log(r.clamp(0.01, 0.99));
        let next = one.autocorrelation(&case.kept).get(2 * lag - 1).map_or(0.0, |second| second / first);
        // With a white part, r₂ = φ r₁ and r₁ = φ (1 - its share of the variance).
        let of_part = (next > first && next < 1.0).then(|| (last(next), (1.0 - first / next).sqrt()));
        for (readings, white) in LONGER.map(|by| (by * last(first), 0.05)).into_iter().chain(of_part) {
            let samples = readings * lag as f64;
            let (mut stds, coloured) = (bad.filter.sensor_std.clone(), size * (1.0 - white * white).sqrt());
            stds[place] = white * size;
            let edits = vec![
                bad.augmented(bias),
                bad.entry("initial_std", bias, coloured),
                bad.entry("process_std", bias, coloured * (-libm::expm1(-2.0 / samples)).sqrt()),
                bad.entry("correlation_time", bias, samples * case.record.dt()),
                bad.edit("sensor_std", stds),
            ];
            let (name, time) = (one.sensor.key(), short(samples * case.record.dt()));
            let coloured = format!("the noise of the {name} is coloured, with a correlation time of about {time} s");
            let sentence = coloured + ": a bias can model it";
            found.push(LikelyCause::new(cause, first / (1.0 + first), 2.0, edits, sentence));
        }
    }
}

/// A step of more than this share of the range, from near one end to near the other, is a turn.
const TURN: f64 = 0.8;

pub(super) static WRAPS: Cause = Cause {
    key: "wraps",
    name: "an angle that wraps",
    hint: "An encoder restarts after each turn, and its readings jump from one end to the other. Add a turn at each \
           jump, as an import does.",
    likely_causes: |bad, cause, found| {
        for (place, one) in bad.case.sensors.iter().enumerate() {
            let Some(readings) = Readings::of(bad.case, place) else { continue };
            let Some((count, turn)) = readings.turns() else { continue };
            let sentence = format!(
                "the readings of the {} jump {count} times from one end to the other, by about {}: an angle that \
             wraps, and no setting corrects that",
                one.sensor.key(),
                short(turn)
            );
            found.push(LikelyCause::new(cause, 0.9, 0.0, Vec::new(), sentence).of_record());
        }
    },
};

/// The readings of one sensor, and its normalised innovations.
pub struct Readings {
    /// NaN where nothing was measured.
    pub values: Vec<f64>,
    /// As many as `values`.
    pub innovations: Vec<f64>,
}

/// Readings that have something in common.
pub struct Marked {
    /// Of all readings.
    pub share: f64,
    levels: [f64; 2],
}

impl Readings {
    fn of(case: &Case<'_>, place: usize) -> Option<Self> {
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

    /// The readings at the ends of a range.
    pub fn clipped(&self) -> Option<Marked> {
        let ends = clipped_ends(&self.values);
        let marks: Vec<bool> = mapped(&self.values, &|value| ends.contains(value));
        if ends.is_empty() { None } else { self.marked(&marks) }
    }

    /// The readings that repeat the last one.
    pub fn stuck(&self) -> Option<Marked> {
        // A sensor that is clipped repeats the end of its range.
        let [low, high] = ends(&self.values);
        let is_end = |value: f64| value <= low || value >= high;
        let repeats = |pair: &[f64]| pair[0].to_bits() == pair[1].to_bits() && !is_end(pair[0]);
        let same: Vec<bool> = self.values.windows(2).map(repeats).collect();
        let mut marks = vec![false; self.values.len()];
        let mut end = 0;
        for run in same.chunk_by(|one, next| one == next) {
            end += run.len();
            marks[end + 1 - run.len()..=end].fill(run[0] && run.len() > 1);
        }
        let stuck = marks.iter().filter(|mark| **mark).count() as f64;
        let short = same.iter().filter(|same| **same).count() as f64 - stuck;
        let count = self.values.len() as f64;
        let is_so = stuck >= SHARE * count && stuck >= FEWEST as f64 && short < 0.02 * count;
        if is_so { self.marked(&marks).filter(|marked| marked.share < 0.9) } else { None }
    }

    /// Their number and size. `None` where the readings move far in other ways.
    fn turns(&self) -> Option<(usize, f64)> {
        let (known, [low, high]) = (known(&self.values).collect::<Vec<f64>>(), ends(&self.values));
        let (mut jumps, mut sum) = (0, 0.0);
        for four in known.windows(4) {
            let [before, jump, after] = [four[1] - four[0], four[2] - four[1], four[3] - four[2]];
            if jump.abs() > TURN * (high - low) {
                let goes_on = before * jump <= 0.0 && after * jump <= 0.0;
                if !goes_on || before.abs().max(after.abs()) > 0.5 * (1.0 - TURN) * (high - low) {
                    return None;
                }
                (jumps, sum) = (jumps + 1, sum + jump.abs());
            } else if jump.abs() > 0.5 * (high - low) {
                return None;
            }
        }
        (jumps >= 3).then(|| (jumps, sum / jumps as f64))
    }

    /// The step to which readings are rounded.
    pub fn step(&self) -> Option<f64> {
        let mut values: Vec<f64> = known(&self.values).collect();
        let count = values.len();
        sort_numbers(&mut values);
        values.dedup();
        let [first, .., last] = values[..] else { return None };
        if count < 50 || values.len() as f64 > 0.3 * count as f64 {
            return None;
        }
        // Equal readings may differ by rounding, which would pass for the step.
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

    /// Single readings that are far off.
    pub fn outliers(&self) -> Option<Marked> {
        let mut sizes: Vec<f64> = self.innovations.iter().map(|e| e.abs()).filter(|e| e.is_finite()).collect();
        if sizes.len() < 200 {
            return None;
        }
        let middle = sizes.len() / 2;
        let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
        // Where innovations are smaller than expected, ordinary ones must not count as far off.
        let usual = (*median / MEDIAN).max(1.0);
        let marks: Vec<bool> = mapped(&self.innovations, &|e| e.abs() > FAR * usual);
        let many = marks.iter().filter(|mark| **mark).count() as f64;
        // The share of the far readings whose follower is far too: chance makes it their share of all.
        let followed = marks.windows(2).filter(|pair| pair[0] && pair[1]).count() as f64 / many;
        let share = many / sizes.len() as f64;
        let alone = followed < share + 0.25 && share < 0.3;
        // Noise that grows once has its large values behind that time alone.
        let quarters = marks.chunks(marks.len().div_ceil(4).max(1));
        let spread = quarters.map(|part| part.iter().filter(|mark| **mark).count() as f64 / many);
        let alone = alone && spread.fold(f64::INFINITY, f64::min) > 0.06;
        if many >= FEWEST as f64 && share >= 0.004 && alone { self.marked(&marks) } else { None }
    }
}

fn known(values: &[f64]) -> impl Iterator<Item = f64> {
    values.iter().copied().filter(|value| !value.is_nan())
}

fn ends(values: &[f64]) -> [f64; 2] {
    known(values).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
}

/// An end is clipped where it has many readings, in several spells.
pub(super) fn clipped_ends(values: &[f64]) -> Vec<f64> {
    let known = || known(values);
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
    ends(values).into_iter().filter(is_end).collect()
}

const FEWEST: usize = 10;
const SHARE: f64 = 0.01;

/// The least number of spells at an end: one alone may be a rest.
const SPELLS: usize = 3;

const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Chance puts 6 of ten million innovations beyond this many usual ones.
const FAR: f64 = 5.0;

fn spells(marks: impl Iterator<Item = bool>) -> usize {
    let mut before = false;
    marks.filter(|&mark| !std::mem::replace(&mut before, mark) && mark).count()
}
