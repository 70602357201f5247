//! The input between samples: linear, held or band-limited, the likeliest of them.

use super::Suggestion;
use super::ambient::has_no_input;
use super::likeliest::{Likeliest, likelihood_over};
use crate::data::import::finer;
use crate::{Hold, Record, Run, Scenario};

/// The course of an input between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Course {
    Linear,
    Held,
    BandLimited,
}

/// Steps in place of one, for a band-limited input.
const STEPS: usize = 4;

/// Limits the samples of a trial.
const TRIED: usize = 2048;

/// A band-limited input is not known well from the samples on one side alone: this many readings at both ends of the trials do not count.
const ENDS: usize = 32;

/// The fewest samples of a trial.
const FEWEST: usize = 256;

/// Parts of the motion's size that are tried for its process noise per sample. A wrong course needs some.
const SHARES: [f64; 5] = [0.0, 1e-5, 1e-4, 1e-3, 1e-2];

/// A larger share is not tried once the log likelihood has fallen by this much.
const FALLEN: f64 = 10.0;

/// Another course is taken if it gains this much log likelihood: it is then 150 times as likely.
const CLEARLY: f64 = 5.0;

impl Course {
    const ALL: [Self; 3] = [Self::Linear, Self::Held, Self::BandLimited];

    const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Held => "held",
            Self::BandLimited => "band-limited",
        }
    }

    pub(super) const fn steps(self) -> usize {
        if matches!(self, Self::BandLimited) { STEPS } else { 1 }
    }

    /// A record whose input has this course. `None` if it would be too long, or its readings have times of their own.
    pub(super) fn of(self, record: &Record) -> Option<Record> {
        match self {
            Self::Linear => Some(record.clone()),
            Self::Held => Some(record.clone().with_hold(Hold::Zero)),
            Self::BandLimited => finer(record, STEPS),
        }
    }

    /// Sets the scenario of such a record.
    pub(super) fn set(self, scenario: &mut Scenario) {
        match self {
            Self::Linear => {}
            Self::Held => scenario.hold = Hold::Zero,
            Self::BandLimited => {
                scenario.dt /= STEPS as f64;
                scenario.record.iter_mut().for_each(|mapping| mapping.interpolate = STEPS);
            }
        }
    }
}

/// The trials of the courses, each with some shares of process noise, and their log likelihoods of the same readings.
pub(super) struct Between {
    /// The courses that are done.
    place: usize,
    /// The first samples, with the course that is tried.
    part: Option<Record>,
    /// The number of readings in the likeliest trial of each course.
    readings: [Likeliest<u32>; 3],
}

impl Between {
    /// The trials for a record that is taken for linear between samples. `None` without an input, or where its course is stated.
    pub(super) fn of(record: &Record, given: &Scenario) -> Option<Self> {
        let Scenario { hold, record: mapping, filters, .. } = given;
        let is_open = *hold == Hold::First
            && record.hold() == Hold::First
            && mapping.as_ref().is_some_and(|mapping| mapping.interpolate == 1)
            && !filters.is_empty()
            && record.len() >= FEWEST
            && !has_no_input(record);
        is_open.then(|| Self { place: 0, part: None, readings: [const { Likeliest::new() }; 3] })
    }

    pub(super) fn progress(&self) -> f64 {
        let shares = self.readings.get(self.place).map_or(0, |tried| tried.trials);
        (self.place as f64 + shares as f64 / SHARES.len() as f64) / Course::ALL.len() as f64
    }

    /// The record and the scenario of the next trial, from the settings and the record so far. `None` if all are done.
    pub(super) fn next(&mut self, suggestion: &Suggestion, record: &Record) -> Option<(&Record, Scenario)> {
        while self.part.is_none() {
            let course = Course::ALL.get(self.place)?;
            // Of a part, a band-limited input is as well known at the end as within.
            let more = record.part(0..record.len().min(TRIED + 2 * ENDS));
            let samples = (more.len().min(TRIED) - 1) * course.steps() + 1;
            self.part = course.of(&more).map(|part| part.part(0..samples));
            self.place += usize::from(self.part.is_none());
        }
        let (part, course) = (self.part.as_ref()?, Course::ALL[self.place]);
        let mut suggestion = suggestion.clone();
        course.set(&mut suggestion.scenario);
        suggestion.substeps(part.dt());
        // Process noise adds up over the steps of a sample.
        let share = SHARES[self.readings[self.place].trials];
        Some((part, suggestion.with_share(share / libm::sqrt(course.steps() as f64))))
    }

    pub(super) fn take(&mut self, run: Option<&Run>) {
        let steps = Course::ALL[self.place].steps();
        let found = run.and_then(|run| likelihood_over(run, ENDS * steps..run.samples() - ENDS * steps));
        let likeliest = &mut self.readings[self.place];
        let before = likeliest.best.map_or(f64::NEG_INFINITY, |(_, before)| before);
        let has_fallen = found.is_some_and(|(now, _)| now < before - FALLEN);
        let (now, readings) = found.unzip();
        likeliest.take(readings.unwrap_or_default(), now, 0.0);
        if has_fallen || likeliest.trials == SHARES.len() {
            (self.place, self.part) = (self.place + 1, None);
        }
    }

    /// The course to be taken, and a sentence about it.
    pub(super) fn chosen(&self) -> (Course, Option<String>) {
        let Some((readings, linear)) = self.readings[0].best else { return (Course::Linear, None) };
        let of = |course: &Course| self.readings[*course as usize].best.filter(|(count, _)| *count == readings);
        let mut all: Vec<(Course, f64)> =
            Course::ALL.iter().filter_map(|course| Some((*course, of(course)?.1))).collect();
        let mut taken = (Course::Linear, linear);
        for other in &all {
            // The simpler one stays unless another one is clearly likelier.
            if other.1 > taken.1 + CLEARLY {
                taken = *other;
            }
        }
        all.retain(|(course, _)| *course != taken.0);
        let Some(next) = all.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)) else { return (taken.0, None) };
        let (lead, name, other) = (taken.1 - next.1, taken.0.name(), next.0.name());
        let digits = usize::from(lead.abs() < 10.0);
        let sentence = if lead > CLEARLY {
            format!(
                "the input is {name} between samples, the likeliest of linear, held and band-limited: by {lead:.digits$} in log \
                 likelihood before {other}"
            )
        } else {
            format!(
                "the input is taken for {name} between samples: the readings do not tell it from {other}, whose log likelihood \
                 differs by {:.1}",
                lead.abs()
            )
        };
        (taken.0, Some(sentence))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(best: [Option<(f64, u32)>; 3]) -> Between {
        let readings = best.map(|best| Likeliest { best: best.map(|(now, readings)| (readings, now)), trials: 0 });
        Between { place: 0, part: None, readings }
    }

    #[track_caller]
    fn check(best: [Option<(f64, u32)>; 3], expected: Course, says: &str) {
        let (course, sentence) = between(best).chosen();
        assert_eq!(course, expected);
        assert!(sentence.as_ref().is_some_and(|sentence| sentence.contains(says)), "{sentence:?}");
    }

    #[test]
    fn the_likeliest_course_is_taken_and_the_simpler_one_of_two_that_are_alike() {
        let of = |likelihood: f64| Some((likelihood, 900));
        check([of(1000.0), of(1300.0), of(900.0)], Course::Held, "is held between samples, the likeliest");
        check([of(1000.0), of(1300.0), of(900.0)], Course::Held, "by 300 in log likelihood before linear");
        check([of(1000.0), of(500.0), of(1200.0)], Course::BandLimited, "by 200 in log likelihood before linear");
        check([of(1000.0), of(500.0), of(1004.0)], Course::Linear, "do not tell it from band-limited");
        check([of(1000.0), of(1300.0), of(1302.0)], Course::Held, "differs by 2.0");
    }

    #[test]
    fn likelihoods_of_other_readings_do_not_compare() {
        check([Some((1000.0, 900)), Some((9000.0, 899)), Some((800.0, 900))], Course::Linear, "before band-limited");
        assert_eq!(between([Some((1000.0, 900)), None, None]).chosen(), (Course::Linear, None));
        assert_eq!(between([None, Some((1000.0, 900)), None]).chosen(), (Course::Linear, None));
    }
}
