//! The value of a check's measure in an outcome.

use std::ops::Range;

use kalmanscope_core::{Channel, Diagnosis, Evidence, ModelClasses, Trouble};

use crate::check::{Check, Times};
use crate::measure::Measure;
use crate::outcome::FilterOutcome;
use crate::value::Value;
use crate::{LessonError, Outcome, evaluations_per_step};

impl Check {
    /// The value of the check's measure in an outcome, divided by the reference value if the check compares. `before`
    /// is the outcome before the step's change. A number that does not exist is NaN, so that no check holds.
    ///
    /// # Errors
    /// [`LessonError::UnknownFilter`] where an outcome does not have the filter.
    pub fn value(&self, outcome: &Outcome, before: &Outcome) -> Result<Value, LessonError> {
        let find = |outcome: &'_ Outcome, (name, smoothed): (&str, bool), times: Times| {
            let filter = outcome.filter(name, smoothed).ok_or_else(|| LessonError::UnknownFilter(name.to_owned()))?;
            Ok::<_, LessonError>(self.measured(filter, times))
        };
        let value = find(outcome, (&self.filter, self.smoothed), self.times())?;
        let Value::Number(number) = value else { return Ok(value) };
        if !self.is_relative() {
            return Ok(value);
        }
        let reference = if self.before { before } else { outcome };
        match find(reference, self.reference_filter(), self.reference_times())? {
            Value::Number(other) => Ok(Value::Number(number / other)),
            _ => Ok(Value::Number(f64::NAN)),
        }
    }

    fn measured(&self, filter: FilterOutcome<'_>, times: Times) -> Value {
        let FilterOutcome { outcome, diagnostics, estimates, .. } = filter;
        match self.measure {
            Measure::Verdict => {
                let diagnosis = Diagnosis::new(diagnostics, estimates, outcome.run().record(), None);
                let verdict = diagnosis.and_then(|diagnosis| diagnosis.verdict);
                Value::Words(vec![verdict.map_or("none", |verdict| verdict.kind.name())])
            }
            Measure::Stopped => Value::Flag(estimates.stop().is_some()),
            Measure::Remark => {
                let mut keys: Vec<_> = estimates.remarks().iter().map(|remark| trouble_key(remark.what)).collect();
                keys.dedup();
                Value::Words(if keys.is_empty() { vec!["none"] } else { keys })
            }
            _ => Value::Number(self.number(filter, times).unwrap_or(f64::NAN)),
        }
    }

    fn number(&self, filter: FilterOutcome<'_>, times: Times) -> Option<f64> {
        let FilterOutcome { outcome, diagnostics, estimates, .. } = filter;
        let (range, at) = (range(filter, times), sample(filter, times)?);
        let tally = |channel: Channel| diagnostics.tally(channel, range.clone());
        let place = |channel: Channel| estimates.place(channel);
        Some(match self.measure {
            Measure::Rmse => tally(self.channel?)?.rmse(),
            Measure::RmseOverSensor => {
                let channel = self.channel?;
                let mut sensors = outcome.scenario().sensors.iter();
                let sensor = sensors.find(|sensor| sensor.measures.channel() == Some(channel))?;
                tally(channel)?.rmse() / sensor.noise_std
            }
            Measure::MeanError => {
                let errors = errors(filter, self.channel?, range)?;
                (errors.iter().map(|(error, _)| error).sum::<f64>() / errors.len() as f64).abs()
            }
            Measure::ErrorInStd => {
                let range = if times.at.is_some() { at..at + 1 } else { range };
                let errors = errors(filter, self.channel?, range)?;
                let squares = errors.iter().map(|(error, std)| error * error / (std * std));
                (squares.sum::<f64>() / errors.len() as f64).sqrt()
            }
            Measure::Estimate => estimates.mean(at)[place(self.channel?)?],
            Measure::Std => estimates.std(at, place(self.channel?)?),
            Measure::StdOverBound => {
                let channel = self.channel?;
                let bound = outcome.bound(filter.place)?;
                let bound = (at < bound.len()).then(|| bound.place(channel).map(|place| bound.std(at, place)))??;
                estimates.std(at, place(channel)?) / bound
            }
            Measure::Coverage => tally(self.channel?)?.coverage(),
            Measure::Nees => diagnostics.nees_within(range).per_degree(),
            Measure::Nis => diagnostics.nis_within(range).per_degree(),
            Measure::Autocorrelation => {
                let first = diagnostics.whiteness().iter().map(|whiteness| whiteness.autocorrelation()[0]);
                first.max_by(f64::total_cmp)?
            }
            Measure::Gain => self.mean_gain(filter, range)?,
            Measure::LearntNoise => {
                let (sensor, truth) = self.noise_of(filter)?;
                estimates.sensor_noise(at, sensor)?[0] / truth
            }
            Measure::LearntNoiseStd => {
                let [std, spread] = estimates.sensor_noise(at, self.noise_of(filter)?.0)?;
                spread / std
            }
            Measure::LearntNoiseCoverage => {
                let (sensor, truth) = self.noise_of(filter)?;
                let is_inside = |[std, spread]: [f64; 2]| (std - truth).abs() <= 2.0 * spread;
                let all: Vec<bool> =
                    range.map(|k| Some(is_inside(estimates.sensor_noise(k, sensor)?))).collect::<Option<_>>()?;
                all.iter().filter(|inside| **inside).count() as f64 / all.len() as f64
            }
            Measure::Settled => {
                let settled = diagnostics.settled(self.channel?).map_or(f64::INFINITY, |n| filter.record().time_of(n));
                (settled - times.from.unwrap_or(0.0)).max(0.0)
            }
            Measure::LogLikelihood => {
                let range = Some(range).filter(|r| r.start <= r.end && r.end <= estimates.len())?;
                let values = range.map(|k| estimates.log_likelihood(k)).filter(|value| !value.is_nan());
                let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
                sum / f64::from(count)
            }
            Measure::Probability => {
                let evidence = outcome.run().estimates().iter().map(|of| Evidence::new(of).at(at));
                ModelClasses::new(evidence.map(|ln| ln.unwrap_or(f64::NEG_INFINITY))).probabilities()[filter.place]
            }
            Measure::Evaluations => evaluations_per_step(filter.settings(), outcome.scenario().plant.kind) as f64,
            Measure::Verdict | Measure::Stopped | Measure::Remark => return None,
        })
    }

    /// The place of the check's sensor, or of the first one, and its true noise.
    fn noise_of(&self, filter: FilterOutcome<'_>) -> Option<(usize, f64)> {
        let place = self.sensor.map_or(Some(0), |q| filter.estimates.sensors().iter().position(|&s| s == q))?;
        Some((place, *filter.outcome.scenario().true_noise_for(filter.settings()).0.get(place)?))
    }

    fn mean_gain(&self, filter: FilterOutcome<'_>, range: Range<usize>) -> Option<f64> {
        let estimates = filter.estimates;
        let n = estimates.channels().len();
        let sensor = self.sensor.map_or(Some(0), |q| estimates.sensors().iter().position(|&s| s == q))?;
        let entry = sensor * n + estimates.place(self.channel?)?;
        let count = range.len() as f64;
        Some(range.map(|k| estimates.gain(k)[entry].abs()).sum::<f64>() / count)
    }
}

/// The samples of a range of time, as far as there are estimates.
fn range(filter: FilterOutcome<'_>, times: Times) -> Range<usize> {
    let len = filter.estimates.len();
    let k = |t: f64| ((t / filter.record().dt()).round() as usize).min(len);
    times.from.map_or(0, k)..times.to.map_or(len, k)
}

/// The sample at a time, if there is an estimate.
fn sample(filter: FilterOutcome<'_>, times: Times) -> Option<usize> {
    let last = filter.estimates.len().checked_sub(1)?;
    let k = times.at.map_or(last, |t| (t / filter.record().dt()).round() as usize);
    (k <= last).then_some(k)
}

/// A channel's errors and standard deviations.
fn errors(filter: FilterOutcome<'_>, channel: Channel, range: Range<usize>) -> Option<Vec<(f64, f64)>> {
    let truth = filter.record().truth(channel)?;
    let place = filter.estimates.place(channel)?;
    let error = |k: usize| (filter.estimates.canonical_mean(k, place) - truth[k], filter.estimates.std(k, place));
    Some(range.map(error).collect())
}

const fn trouble_key(trouble: Trouble) -> &'static str {
    match trouble {
        Trouble::WindUp(_) => "wind_up",
        Trouble::Indefinite(..) => "indefinite",
        Trouble::Missing(_) => "missing",
        Trouble::Unknown(_) => "unknown",
        Trouble::Collapse => "collapse",
        Trouble::Widened => "widened",
        Trouble::VanishingSensorNoise(_) => "vanishing_sensor_noise",
        Trouble::GrowingSensorNoise(_) => "growing_sensor_noise",
        Trouble::VanishingProcessNoise(_) => "vanishing_process_noise",
        Trouble::GrowingProcessNoise(_) => "growing_process_noise",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::{Scenario, Summary};

    fn outcome() -> Outcome {
        let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
        scenario.filters[0].smoother = true;
        scenario.filters[1].fading = 1e60;
        Outcome::of(&scenario).unwrap()
    }

    fn value(outcome: &Outcome, filter: &str, check: &str) -> Value {
        let check: Check = toml::from_str(&format!("filter = \"{filter}\"\n{check}")).unwrap();
        check.value(outcome, outcome).unwrap()
    }

    fn number(outcome: &Outcome, filter: &str, check: &str) -> f64 {
        match value(outcome, filter, check) {
            Value::Number(number) => number,
            other => panic!("{other}"),
        }
    }

    #[test]
    fn measures_are_those_of_the_summary() {
        let outcome = outcome();
        let summary = Summary::new(&outcome.run().estimates()[0], outcome.run().record());
        let frequency = summary.finals[2];
        let score = frequency.score.unwrap();
        let of = |measure: &str| {
            number(&outcome, "EKF", &format!("channel = \"natural_frequency\"\nmeasure = \"{measure}\""))
        };
        for (measured, expected) in [
            (of("rmse"), score.rmse),
            (of("std"), frequency.std),
            (of("estimate"), frequency.mean),
            (of("settled"), score.settled.unwrap()),
            (of("coverage"), score.coverage),
            (of("nees"), summary.nees.unwrap().mean / 4.0),
            (of("nis"), summary.nis.unwrap().mean / 2.0),
            (of("log_likelihood"), summary.log_likelihood / 1000.0),
            (of("evaluations"), 5.0),
        ] {
            assert!((measured / expected - 1.0).abs() < 1e-12, "{measured} instead of {expected}");
        }
        assert!(of("mean_error") < of("rmse") && of("std_over_bound") > 0.9);
        assert!(number(&outcome, "EKF", "measure = \"rmse_over_sensor\"\nchannel = \"displacement\"") < 0.5);
        assert_eq!(value(&outcome, "EKF", "measure = \"verdict\""), Value::Words(vec!["consistent"]));
        assert_eq!(value(&outcome, "EKF", "measure = \"remark\""), Value::Words(vec!["none"]));
    }

    #[test]
    fn ratios_compare_filters_and_times() {
        let outcome = outcome();
        let std = |more: &str| {
            number(&outcome, "EKF", &format!("channel = \"natural_frequency\"\nmeasure = \"std\"\n{more}"))
        };
        assert_eq!(std("at = 1.0\nthan_at = 0.0"), std("at = 1.0") / 2.0);
        assert_eq!(std("at = 1.0\nbefore = true"), 1.0);
        assert!((std("than_smoothed = true") - 1.0).abs() < 1e-12, "at the end of the record both know the same");
        assert!(std("at = 0.2\nthan = \"EKF\"\nthan_smoothed = true") > 1.0, "hindsight knows better");
        let error = "channel = \"natural_frequency\"\nmeasure = \"error_in_std\"\nat = 0.0";
        assert_eq!(number(&outcome, "EKF", error), 1.0, "8 ± 2 where 6 is true");
    }

    #[test]
    fn a_missing_number_fails_every_check() {
        let outcome = outcome();
        assert_eq!(value(&outcome, "UKF", "measure = \"stopped\""), Value::Flag(true));
        for check in ["measure = \"nis\"\nfrom = 9.0", "measure = \"std\"\nchannel = \"velocity\"\nat = 9.0"] {
            assert!(number(&outcome, "UKF", check).is_nan(), "{check}");
        }
        assert!(number(&outcome, "EKF", "measure = \"std\"\nchannel = \"cubic_stiffness\"").is_nan());
        let check: Check = toml::from_str("filter = \"KF\"\nmeasure = \"nis\"").unwrap();
        assert_eq!(check.value(&outcome, &outcome), Err(LessonError::UnknownFilter("KF".to_owned())));
        let limits: Check = toml::from_str("filter = \"KF\"\nmeasure = \"nis\"\nabove = 0.0").unwrap();
        assert!(!limits.holds(&Value::Number(f64::NAN)) && limits.holds(&Value::Number(f64::INFINITY)));
    }
}
