//! Complete runs of scenarios, with the results that checks need, and the value of a check in them.

use kalmanscope_core::{Diagnostics, Estimates, Run, Scenario, Source};
use kalmanscope_diagnosis::{Analysis, Measure, Observed, Times, Value, Wanted};

use crate::check::Check;
use crate::{LessonError, records};

/// A complete run of a scenario, with its results.
pub struct AnalysedRun {
    /// The complete run.
    pub run: Run,
    analysis: Analysis,
    /// The diagnostics of the smoothed estimates.
    diagnostics: Vec<Diagnostics>,
}

#[derive(Clone, Copy)]
pub(crate) struct FilterOutcome<'a> {
    pub(crate) outcome: &'a AnalysedRun,
    pub(crate) place: usize,
    pub(crate) estimates: &'a Estimates,
    pub(crate) diagnostics: &'a Diagnostics,
}

impl AnalysedRun {
    /// Runs a scenario over its whole record: a simulated one, or the built-in one that it names.
    ///
    /// # Errors
    /// [`LessonError`] where the scenario is impossible, or its record is not built in.
    pub fn of(scenario: &Scenario) -> Result<Self, LessonError> {
        Self::on(scenario, records::source(scenario)?)
    }

    /// Runs a scenario over the whole record of a source.
    ///
    /// # Errors
    /// [`LessonError::Run`] where the scenario is impossible, or the source does not fit it.
    pub fn on(scenario: &Scenario, source: Source) -> Result<Self, LessonError> {
        let mut run = Run::from_source(scenario, source)?;
        run.finish();
        let analysis = Analysis::new(&run, Wanted::default());
        let of = |smoothed: &Estimates| Diagnostics::new(smoothed, run.record());
        let diagnostics = analysis.smoothed().iter().map(of).collect();
        Ok(Self { run, analysis, diagnostics })
    }

    pub(crate) fn filter(&self, name: &str, smoothed: bool) -> Option<FilterOutcome<'_>> {
        let place = self.run.scenario().filters.iter().position(|filter| filter.name == name)?;
        let id = self.run.estimates().get(place)?.id();
        let (all, of_all) = if smoothed {
            (self.analysis.smoothed(), self.diagnostics.as_slice())
        } else {
            (self.run.estimates(), self.analysis.diagnostics())
        };
        let (estimates, diagnostics) = all.iter().zip(of_all).find(|(of, _)| of.id() == id)?;
        Some(FilterOutcome { outcome: self, place, estimates, diagnostics })
    }
}

impl Check {
    /// The value of the check's measure in an outcome, divided by the reference value if the check compares. `before`
    /// is the outcome before the step's change. A number that does not exist is NaN, so that no check holds.
    ///
    /// # Errors
    /// [`LessonError::UnknownFilter`] where an outcome does not have the filter.
    pub fn value(&self, outcome: &AnalysedRun, before: &AnalysedRun) -> Result<Value, LessonError> {
        let find = |outcome: &'_ AnalysedRun, (name, smoothed): (&str, bool), times: Times| {
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

    /// Whether the measure keeps within the limits of a cell in its outcome.
    pub(crate) fn holds_in(&self, cell: &AnalysedRun) -> Result<bool, LessonError> {
        let value = self.value(cell, cell)?;
        Ok(self.cells.as_ref().is_some_and(|cells| cells.hold(&value)))
    }

    fn measured(&self, filter: FilterOutcome<'_>, times: Times) -> Value {
        let FilterOutcome { outcome, place, estimates, diagnostics } = filter;
        let run = Observed::new(outcome.run.scenario(), place, outcome.run.record(), estimates);
        let run = run.with(diagnostics).among(outcome.run.estimates());
        // None if the measure needs a channel or a sensor that the check does not give.
        let measure = Measure::new(self.measure, self.channel, self.sensor);
        measure.map_or(Value::Number(f64::NAN), |measure| measure.of(&run, times))
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_diagnosis::{Summary, VerdictKind};

    use super::*;

    fn outcome() -> AnalysedRun {
        let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
        scenario.filters[0].smoother = true;
        scenario.filters[1].fading = 1e60;
        AnalysedRun::of(&scenario).unwrap()
    }

    fn value(outcome: &AnalysedRun, filter: &str, check: &str) -> Value {
        let check: Check = toml::from_str(&format!("filter = \"{filter}\"\n{check}")).unwrap();
        check.value(outcome, outcome).unwrap()
    }

    fn number(outcome: &AnalysedRun, filter: &str, check: &str) -> f64 {
        match value(outcome, filter, check) {
            Value::Number(number) => number,
            other => panic!("{other}"),
        }
    }

    #[test]
    fn measures_are_those_of_the_summary() {
        let outcome = outcome();
        let summary = Summary::new(&outcome.run.estimates()[0], outcome.run.record());
        let frequency = summary.finals[2];
        let score = frequency.score.unwrap();
        let of = |measure: &str| {
            number(&outcome, "EKF", &format!("channel = \"natural_frequency\"\nmeasure = \"{measure}\""))
        };
        for (measured, expected) in
            [(of("rmse"), score.rmse), (of("nees"), summary.nees.unwrap().mean / 4.0), (of("evaluations"), 5.0)]
        {
            assert!((measured / expected - 1.0).abs() < 1e-12, "{measured} instead of {expected}");
        }
        assert!(of("mean_error") < of("rmse") && of("std_over_bound") > 0.9);
        assert!(number(&outcome, "EKF", "measure = \"rmse_over_sensor\"\nchannel = \"displacement\"") < 0.5);
        assert_eq!(value(&outcome, "EKF", "measure = \"verdict\""), Value::Verdict(Some(VerdictKind::Consistent)));
        assert_eq!(value(&outcome, "EKF", "measure = \"remark\""), Value::Words(vec![]));
    }

    #[test]
    fn ratios_compare_filters_and_times() {
        let outcome = outcome();
        let std = |more: &str| {
            number(&outcome, "EKF", &format!("channel = \"natural_frequency\"\nmeasure = \"std\"\n{more}"))
        };
        assert_eq!(std("at = 1.0\nthan_at = 0.0"), std("at = 1.0") / 2.0);
        assert_eq!(std("at = 1.0\nbefore = true"), 1.0);
        assert!((std("smoothed = true\nthan = \"EKF\"") - 1.0).abs() < 1e-12, "at the end both know the same");
        assert!(std("at = 0.2\nsmoothed = true\nthan = \"EKF\"") < 1.0, "hindsight knows better");
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
