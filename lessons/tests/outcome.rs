use kalmanscope_core::Scenario;
use kalmanscope_diagnosis::{Summary, Value, VerdictKind};
use kalmanscope_lessons::{AnalysedRun, Check, LessonError};

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
    let of =
        |measure: &str| number(&outcome, "EKF", &format!("channel = \"natural_frequency\"\nmeasure = \"{measure}\""));
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
    let std =
        |more: &str| number(&outcome, "EKF", &format!("channel = \"natural_frequency\"\nmeasure = \"std\"\n{more}"));
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
