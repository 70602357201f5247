//! A record for trials: without means, lost readings filled, of several plucks the longest part, its input's course the likeliest.

use kalmanscope_filters::lists::{mapped, places, sort_items};
use kalmanscope_filters::{Channel, Hold};
use kalmanscope_records::Record;
use kalmanscope_records::mapping::{MappedColumn, Offset};

use super::ambient::has_no_input;
use super::likeliest::{likelihood_over, tried};
use super::spectra::stride;
use super::{Suggestion, augment, moments, motion_sensor, rounded};
use crate::scenario::option::PLUCKED;
use crate::{Run, Scenario};

/// A mean of the input counts as an offset if it is this many times its standard error: chance does so once in 16,000.
const CERTAIN: f64 = 4.0;

/// A mean of a sensor's readings is an offset if it is larger than this share of their spread.
const OFFSET: f64 = 0.5;

impl Suggestion {
    /// Constant parts bend every estimate: the mapping takes them away. Without a mapping, filters get them as known constants.
    pub(super) fn remove_means(&mut self, record: &mut Record) {
        let (mapping, is_open) =
            (self.scenario.record.as_ref(), |column: &MappedColumn| column.offset == Offset::default());
        let mut removed = Vec::new();
        let (mean, std) = moments(record.input());
        // A random force has a small mean too, and its effect on the displacement is motion.
        let chance = std / libm::sqrt(record.len().max(1) as f64);
        let is_input = mapping.map_or(std > 0.0, |mapping| mapping.input.as_ref().is_some_and(is_open));
        if is_input && mean.abs() > CERTAIN * chance {
            record.change_input(|value| value - mean);
            removed.push((Channel::INPUT_OFFSET, -mean, "the input".to_owned()));
        }
        for sensor in 0..record.sensors().len() {
            let quantity = record.sensors()[sensor];
            let (mean, std) = moments(record.measured(sensor));
            let is_sensor = match mapping {
                Some(mapping) => mapping.sensors.get(&quantity).is_some_and(is_open),
                None => self.scenario.sensors.iter().any(|one| one.measures == quantity),
            };
            // Without the mean of the input, that of a sensor has no cause any more.
            if is_sensor && (!removed.is_empty() || mean.abs() > OFFSET * std) {
                record.change_measured(|of, _, value| if of == sensor { value - mean } else { value });
                removed.push((quantity.bias(), mean, format!("the {}", quantity.name())));
            }
        }
        if removed.is_empty() {
            return;
        }
        let what = mapped(&removed, &|(.., what)| what.as_str()).join(" and ");
        if let Some(mapping) = &mut self.scenario.record {
            let input = mapping.input.iter_mut().map(|input| (Channel::INPUT_OFFSET, input));
            let sensors = mapping.sensors.iter_mut().map(|(quantity, column)| (quantity.bias(), column));
            let columns = input.chain(sensors).filter(|(of, _)| removed.iter().any(|(channel, ..)| channel == of));
            columns.for_each(|(_, column)| column.offset = Offset::MEAN);
            self.reasons.push(format!("the mean of {what} is removed: a constant part is no motion"));
            return;
        }
        for filter in self.filters() {
            removed.iter().for_each(|(channel, mean, _)| augment(filter, *channel, (*mean, 0.0)));
        }
        self.reasons.push(format!("the filters treat the mean of {what} as an offset: a constant part is no motion"));
    }
}

/// Limits the samples of a record that is filled; longer ones have windows enough between their gaps.
const MOST: usize = 1 << 18;
const THERE: f64 = 0.75;
/// The process noise of the filter, as a share of the motion's size a step: a guess that is off must not stop it.
pub(super) const FILLING: f64 = 1e-3;
/// Limits the innovations of a filter with usable predictions, as a share of the readings' size.
const KNOWN: f64 = 0.5;

pub(super) struct LostReadings(Vec<Vec<usize>>);

impl LostReadings {
    pub(super) fn of(record: &Record) -> Option<Self> {
        let columns = (0..record.sensors().len()).map(|sensor| record.measured(sensor));
        let lost = columns.map(|column| {
            let lost = places(column.len(), &|k| column[k].is_nan());
            let is_small = stride(column) == 1 && lost.len() as f64 <= (1.0 - THERE) * column.len() as f64;
            is_small.then_some(lost)
        });
        let lost = lost.collect::<Option<Vec<_>>>()?;
        (record.len() <= MOST && lost.iter().any(|lost| !lost.is_empty())).then_some(Self(lost))
    }

    pub(super) fn there(&self, sensor: usize, samples: usize) -> f64 {
        let lost = self.0.get(sensor).map_or(0, Vec::len);
        1.0 - lost as f64 / samples.max(1) as f64
    }

    pub(super) fn lose(&self, record: &mut Record) {
        for (sensor, lost) in self.0.iter().enumerate() {
            lost.iter().for_each(|&k| record.measured_mut(sensor)[k] = f64::NAN);
        }
    }

    pub(super) fn filled(&self, run: &Run, raw: &Record) -> Option<Record> {
        let (scenario, record) = (run.scenario(), run.record());
        let (settings, estimates) = (scenario.filters.first()?, run.estimates().first()?);
        if estimates.stop().is_some() || estimates.len() < record.len() {
            return None;
        }
        let (quantity, measured) = motion_sensor(record)?;
        let place = scenario.sensor_place(quantity)?;
        let power = |of: &dyn Fn(usize) -> f64| {
            let half = (estimates.len() / 2..estimates.len()).map(of).filter(|value| !value.is_nan());
            half.map(|value| value * value).sum::<f64>()
        };
        let (mean, _) = moments(measured);
        if power(&|k| estimates.innovation(k)[place]) >= KNOWN * KNOWN * power(&|k| measured[k] - mean) {
            return None;
        }
        let model = settings.model(&scenario.plant.kind, scenario.input);
        let mut filled = raw.clone();
        for (sensor, lost) in self.0.iter().enumerate().filter(|(_, lost)| !lost.is_empty()) {
            let reading = model.reading(raw.sensors()[sensor])?;
            let there = (0..raw.len()).find(|&k| !raw.measured(sensor)[k].is_nan())?;
            let offset = raw.measured(sensor)[there] - record.measured(sensor)[there];
            for &k in lost {
                let (state, _) = model.to_state(estimates.mean(k));
                let force = record.delayed_force(k, settings.input_delay);
                let expected = model.read(&reading, state.as_slice(), force) + offset;
                filled.measured_mut(sensor)[k] = if expected.is_finite() { expected } else { f64::NAN };
            }
        }
        Some(filled)
    }
}

pub(super) struct Plucked {
    pub(super) whole: Record,
    times: Vec<f64>,
    growth: f64,
}

/// A pause has at least this many usual gaps between readings, and a part this many readings.
const PAUSE: usize = 10;
const PART: usize = 100;

/// A free motion is smaller after a pause than before. One that is this many times as large was pulled.
const PULLED: f64 = 1.05;

impl Plucked {
    /// `None` for a record with an input, or without a part that swings more after a pause.
    pub(super) fn of(record: &Record) -> Option<(Record, Self)> {
        let measured = record.sensors().first().map(|_| record.measured(0)).filter(|_| has_no_input(record))?;
        let read = places(record.len(), &|k| !measured[k].is_nan());
        let gap = |i: usize| read[i] - read[i - 1];
        let mut sorted: Vec<usize> = (1..read.len()).map(gap).collect();
        sort_items(&mut sorted, Ord::cmp);
        let usual = *sorted.get(sorted.len() / 2)?;
        let largest = |places: &[usize]| places.iter().fold(0.0, |most: f64, &k| most.max(measured[k].abs()));
        let pauses: Vec<usize> = (1..read.len()).filter(|&i| gap(i) >= PAUSE * usual).collect();
        let is_pulled = |&place: &usize| {
            let at = pauses[place];
            let before = place.checked_sub(1).map_or(0, |before| pauses[before]);
            let after = pauses.get(place + 1).copied().unwrap_or(read.len());
            largest(&read[at..after]) > PULLED * largest(&read[usize::midpoint(before, at)..at])
        };
        let begins = (0..pauses.len()).filter(is_pulled).map(|place| pauses[place]);
        let bounds: Vec<usize> = [0].into_iter().chain(begins).chain([read.len()]).collect();
        let parts = || bounds.windows(2).map(|part| (part[0], part[1]));
        let (begin, end) = parts().max_by_key(|(begin, end)| end - begin)?;
        if bounds.len() < 3 || parts().any(|(begin, end)| end - begin < PART) {
            return None;
        }
        let longest = record.part(read[begin]..read[end - 1] + 1);
        let growth = largest(&read) / largest(&read[begin..end]);
        let time = |&begin: &usize| libm::round((record.time(read[begin]) - 0.5 * record.dt()) * 1e6) / 1e6;
        let times = mapped(&bounds[1..bounds.len() - 1], &time);
        Some((longest, Self { whole: record.clone(), times, growth }))
    }

    pub(super) fn apply(&self, suggestion: &mut Suggestion) {
        for filter in suggestion.filters().filter(|filter| filter.can(&PLUCKED)) {
            filter.plucks.clone_from(&self.times);
            filter.initial_mean[Channel::DISPLACEMENT] = 0.0;
            for channel in [Channel::DISPLACEMENT, Channel::VELOCITY] {
                filter.initial_std[channel] = rounded(self.growth.max(1.0) * filter.initial_std[channel]);
            }
        }
        let times: Vec<String> = mapped(&self.times, &|time| format!("{} s", rounded(*time)));
        suggestion.reasons.push(format!(
            "plucked again at {}: each time the motion begins again after a pause, and the estimates of ωₙ and ζ stay; \
             start values are those of the longest part",
            times.join(", ")
        ));
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Course {
    Linear,
    Held,
    BandLimited,
}

const STEPS: usize = 4;

const TRIED: usize = 2048;

/// A band-limited input is not known well from the samples on one side alone: this many readings at both ends of the trials do not count.
const ENDS: usize = 32;

const FEWEST: usize = 256;

/// Parts of the motion's size that are tried for its process noise per sample. A wrong course needs some.
const SHARES: [f64; 5] = [0.0, 1e-5, 1e-4, 1e-3, 1e-2];

const FALLEN: f64 = 10.0;

/// Another course is taken if it gains this much log likelihood: it is then 150 times as likely.
const CLEARLY: f64 = 5.0;

impl Course {
    const ALL: [Self; 3] = [Self::Linear, Self::Held, Self::BandLimited];
    const NAMES: [&str; 3] = ["linear", "held", "band-limited"];

    pub(super) const fn steps(self) -> usize {
        if matches!(self, Self::BandLimited) { STEPS } else { 1 }
    }

    /// A record whose input has this course, which its scenario takes over. `None` if it would be too long, or its readings have times
    /// of their own.
    pub(super) fn of(self, record: &Record, scenario: &mut Scenario) -> Option<Record> {
        match self {
            Self::Linear => Some(record.clone()),
            Self::Held => {
                scenario.hold = Hold::Zero;
                Some(record.clone().with_hold(Hold::Zero))
            }
            Self::BandLimited => {
                let finer = record.finer(STEPS)?;
                scenario.dt /= STEPS as f64;
                scenario.record.iter_mut().for_each(|mapping| mapping.interpolate = STEPS);
                Some(finer)
            }
        }
    }
}

/// The number of readings and their largest log likelihood, for each course.
type Tried = [Option<(u32, f64)>; 3];

/// Whether a record that is taken for linear between samples may have another course. False without an input, or where it is stated.
pub(super) fn has_open_course(record: &Record, given: &Scenario) -> bool {
    let Scenario { hold, record: mapping, .. } = given;
    *hold == Hold::First
        && record.hold() == Hold::First
        && mapping.as_ref().is_some_and(|mapping| mapping.interpolate == 1)
        && record.len() >= FEWEST
        && !has_no_input(record)
}

pub(super) async fn likeliest_course(
    suggestion: &Suggestion,
    record: &Record,
    progress: impl Fn(f64),
) -> (Course, Option<String>) {
    let mut all = Tried::default();
    for (course, best) in Course::ALL.into_iter().zip(&mut all) {
        // Of a part, a band-limited input is as well known at the end as within.
        let more = record.part(0..record.len().min(TRIED + 2 * ENDS));
        let steps = course.steps();
        let samples = (more.len().min(TRIED) - 1) * steps + 1;
        let mut suggestion = suggestion.clone();
        let Some(part) = course.of(&more, &mut suggestion.scenario) else { continue };
        let part = part.part(0..samples);
        suggestion.substeps(part.dt(), None);
        for (place, share) in SHARES.into_iter().enumerate() {
            progress((course as usize as f64 + place as f64 / SHARES.len() as f64) / Course::ALL.len() as f64);
            // Process noise adds up over the steps of a sample.
            let scenario = suggestion.with_share(share / libm::sqrt(steps as f64));
            let run = tried(&scenario, &part, part.len()).await;
            let found = run.and_then(|run| likelihood_over(&run, ENDS * steps..run.samples() - ENDS * steps));
            let Some((now, readings)) = found else { continue };
            let before = best.map_or(f64::NEG_INFINITY, |(_, before)| before);
            if now > before {
                *best = Some((readings, now));
            }
            if now < before - FALLEN {
                break;
            }
        }
    }
    chosen(&all)
}

fn chosen(tried: &Tried) -> (Course, Option<String>) {
    let readings = tried.iter().flatten().next().map(|(readings, _)| *readings);
    let likelihood = |course: &Course| tried[*course as usize].filter(|(count, _)| Some(*count) == readings);
    let all = || Course::ALL.into_iter().filter_map(|course| Some((course, likelihood(&course)?.1)));
    let Some(taken) = all().reduce(|taken, other| if other.1 > taken.1 + CLEARLY { other } else { taken }) else {
        return (Course::Linear, None);
    };
    let others = all().filter(|(course, _)| *course != taken.0);
    let Some(next) = others.max_by(|a, b| a.1.total_cmp(&b.1)) else { return (taken.0, None) };
    let (lead, name, other) = (taken.1 - next.1, Course::NAMES[taken.0 as usize], Course::NAMES[next.0 as usize]);
    let digits = usize::from(lead.abs() < 10.0);
    let sentence = if lead > CLEARLY {
        format!(
            "the input is {name} between samples, the likeliest of linear, held and band-limited: by {lead:.digits$} in log \
             likelihood before {other}"
        )
    } else {
        format!(
            "the filters assume that the input is {name} between samples: the readings do not exclude {other}, \
             whose log likelihood differs by {:.1}",
            lead.abs()
        )
    };
    (taken.0, Some(sentence))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_likeliest_course_of_the_same_readings_is_taken_and_the_simpler_one_of_two_that_are_alike() {
        let of = |likelihood: f64| Some((900, likelihood));
        for (best, expected, says) in [
            ([of(1000.0), of(1300.0), of(900.0)], Course::Held, "is held between samples, the likeliest"),
            ([of(1000.0), of(1300.0), of(900.0)], Course::Held, "by 300 in log likelihood before linear"),
            ([of(1000.0), of(500.0), of(1200.0)], Course::BandLimited, "by 200 in log likelihood before linear"),
            ([of(1000.0), of(500.0), of(1004.0)], Course::Linear, "do not exclude band-limited"),
            ([of(1000.0), of(1300.0), of(1302.0)], Course::Held, "differs by 2.0"),
            ([of(1000.0), Some((899, 9000.0)), of(800.0)], Course::Linear, "before band-limited"),
        ] {
            let (course, sentence) = chosen(&best);
            assert_eq!(course, expected);
            assert!(sentence.as_ref().is_some_and(|sentence| sentence.contains(says)), "{sentence:?}");
        }
        assert_eq!(chosen(&[of(1000.0), None, None]), (Course::Linear, None));
        assert_eq!(chosen(&[None, of(1000.0), None]), (Course::Held, None));
        assert_eq!(chosen(&[None, None, None]), (Course::Linear, None));
    }
}
