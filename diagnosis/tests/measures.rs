//! Measures: their words, and numbers from sums and from all estimates.

use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, Quantity, Scenario};
use kalmanscope_diagnosis::{Measure, MeasureKind, Observed, Times, Whole};

use crate::run::finished;

const CHANNELS: [Channel; 2] = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

#[test]
fn measures_are_written_and_read() {
    let mut all = Measure::all(&CHANNELS, &[Quantity::DISPLACEMENT]);
    all.push("gain.natural_frequency.displacement".parse().unwrap());
    all.push(Measure::new(MeasureKind::from_word("remark").unwrap(), None, None).unwrap());
    for measure in &all {
        assert_eq!(measure.to_string().parse(), Ok(*measure));
    }
    let words: std::collections::BTreeSet<&str> = all.iter().map(|measure| measure.info().word).collect();
    assert_eq!(words.len(), MeasureKind::all().count(), "each has its own row");
    assert_eq!("coverage.damping_ratio".parse::<Measure>().unwrap().name(), "share of ζ inside ±2σ");
    let unit = |text: &str| text.parse::<Measure>().unwrap().unit();
    assert_eq!(
        ["rmse", "settled", "coverage"].map(|word| unit(&format!("{word}.natural_frequency"))),
        ["rad/s", "s", ""]
    );
    assert_eq!([unit("free_run.displacement"), unit("learnt_noise.displacement")], ["m", ""]);
}

#[test]
fn what_follows_from_sums_needs_no_history() {
    let of_sums = Measure::of_sums(&CHANNELS);
    assert!(of_sums.contains(&Measure::NIS) && of_sums.contains(&Measure::rmse(CHANNELS[1])));
    assert!(!of_sums.contains(&Measure::VERDICT));
}

#[test]
fn sums_and_history_tell_the_same() {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    scenario.filters[1].fading = 1e60;
    let mirrored = scenario.filters[0].initial_mean.clone().with([(Channel::NATURAL_FREQUENCY, -7.0)]);
    scenario.filters[0].initial_mean = mirrored;
    let run = finished(&scenario);
    let times = Times::default();
    for (place, estimates) in run.estimates().iter().enumerate() {
        let record = run.record();
        let outcome = Outcome::at(&scenario, place, record, &[]).unwrap();
        let whole = Whole { record, outcome: &outcome, channels: estimates.channels() };
        let observed = Observed::new(&scenario, place, record, estimates);
        let all = Measure::of_sums(estimates.channels());
        assert!(all.len() > 20);
        for measure in all {
            let [sums, history] = [measure.of_whole(&whole), measure.of(&observed, times).number()];
            let is_same =
                (sums - history).abs() <= 1e-12 * history.abs() || sums == history || sums.is_nan() && history.is_nan();
            assert!(is_same, "{measure} of {}: {sums} from sums, {history} from all estimates", estimates.name());
        }
    }
}

#[test]
fn a_time_a_range_and_other_filters_narrow_a_measure() {
    let scenario = Scenario { duration: 20.0, ..Scenario::default() };
    let run = finished(&scenario);
    let observed = Observed::new(&scenario, 0, run.record(), &run.estimates()[0]);
    let of = |text: &str, times: Times| text.parse::<Measure>().unwrap().of(&observed, times).number();
    let whole = Times::default();
    let std = |at: f64| of("std.natural_frequency", Times { at: Some(at), ..whole });
    assert!(std(1.0) > 2.0 * std(10.0) && std(21.0).is_nan());
    let late = Times { from: Some(15.0), to: Some(99.0), at: None };
    assert!(of("rmse.natural_frequency", late) < of("rmse.natural_frequency", whole) / 3.0);
    assert_eq!(
        of("rmse.natural_frequency", Times { from: Some(9.0), to: Some(3.0), at: None }).to_bits(),
        f64::NAN.to_bits()
    );
    assert!(of("std_over_bound.natural_frequency", whole) > 0.9);
    assert!(of("probability", whole).is_nan(), "the other filters are not known");
    let among = Observed::new(&scenario, 0, run.record(), &run.estimates()[0]).among(run.estimates());
    let probability = "probability".parse::<Measure>().unwrap().of(&among, whole).number();
    assert!((0.0..=1.0).contains(&probability), "{probability}");
    assert!(of("gain.velocity.displacement", whole) != of("gain.velocity.velocity", whole));
    assert_eq!(of("gain.velocity", whole), of("gain.velocity.displacement", whole), "of the first sensor");
    assert!(of("learnt_noise.displacement", whole).is_nan(), "the filter does not learn it");
    assert!(of("process_scale_coverage", whole).is_nan(), "the filter has one scale");
}

#[test]
fn other_words_are_refused_with_those_that_there_are() {
    for text in [
        "",
        "nis.velocity",
        "rmse",
        "rmse.speed",
        "free_run.damping_ratio",
        "verdicts",
        "rmse.velocity.velocity",
        "gain.velocity.speed",
        "gain.velocity.velocity.velocity",
        "learnt_noise",
    ] {
        let error = text.parse::<Measure>().unwrap_err().to_string();
        assert!(error.contains("log_likelihood") && error.contains("free_run"), "{text}: {error}");
    }
}
