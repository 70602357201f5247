//! Diagnostics of whole runs: against direct computations, for any portions, in the canonical form.

use kalmanscope_core::diagnostics::{ErrorSums, LAGS};
use kalmanscope_core::{
    Channel, Diagnostics, Estimates, FilterKind, FilterSettings, Force, Hold, InputKind, Pass, PlantKind, Record, Run,
    Sample, Scenario, Scores, Sink as _,
};

use crate::numbers::{Random, bits, mean, rms};
use crate::run::{finished, finished_on, last, one_filter, oscillator, record_of};

fn guessing(natural_frequency: f64, damping_ratio: f64) -> Scenario {
    let mut scenario = Scenario { plant: oscillator(6.0, 0.05), ..one_filter(FilterKind::EKF) };
    scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = natural_frequency;
    scenario.filters[0].initial_mean[Channel::DAMPING_RATIO] = damping_ratio;
    scenario
}

fn all_bits(diagnostics: &Diagnostics) -> Vec<u64> {
    let n = diagnostics.len();
    let tally = |ErrorSums { squares, known, inside }: ErrorSums| [squares, f64::from(known), f64::from(inside)];
    let mut numbers: Vec<f64> = diagnostics.nees().to_vec();
    for k in 0..=n {
        for channel in diagnostics.known() {
            numbers.extend(diagnostics.tally(channel, 0..k).into_iter().flat_map(tally));
        }
        numbers.extend([diagnostics.nis_within(0..k).sum, diagnostics.nees_within(0..k).sum]);
    }
    for channel in diagnostics.known() {
        numbers.extend(diagnostics.error(channel));
        numbers.extend(diagnostics.settled(channel).map(|k| k as f64));
    }
    for whiteness in &diagnostics.whiteness {
        numbers.extend(whiteness.autocorrelation());
    }
    numbers.extend([diagnostics.log_likelihood(), diagnostics.share_in_ellipsoid().unwrap()]);
    bits(&numbers)
}

#[test]
fn any_portions_give_the_same_bits() {
    let mut scenario = Scenario { duration: 7.0, ..Scenario::default() };
    scenario.filters.push(FilterSettings { kind: FilterKind::KF, ..scenario.filters[0].clone() });
    let whole = finished(&scenario);
    for (i, estimates) in whole.estimates().iter().enumerate() {
        let at_once = Diagnostics::new(estimates, whole.record());
        assert_eq!(at_once.len(), 701);
        for portions in [&[1][..], &[3, 1, 250, 17]] {
            let mut run = Run::new(&scenario).unwrap();
            let mut following = Diagnostics::new(&run.estimates()[i], run.record());
            assert!(following.is_empty());
            for portion in portions.iter().cycle() {
                if run.len() == run.samples() {
                    break;
                }
                run.advance_to(run.len() + portion);
                following.follow_to(run.len(), &run.estimates()[i], run.record());
                assert_eq!(following.len(), run.len());
            }
            assert_eq!(all_bits(&following), all_bits(&at_once));
        }
    }
}

#[test]
fn restarted_diagnostics_equal_new_ones() {
    let (first, second) = (finished(&Scenario::default()), finished(&guessing(9.0, 0.1)));
    let mut diagnostics = Diagnostics::new(&first.estimates()[1], first.record());
    diagnostics.restart(&second.estimates()[0], second.record());
    assert_eq!(all_bits(&diagnostics), all_bits(&Diagnostics::new(&second.estimates()[0], second.record())));
}

fn direct_rmse(estimates: &Estimates, record: &Record, place: usize, from: usize) -> f64 {
    let truth = record.truth(estimates.channels()[place]).unwrap();
    let errors: Vec<f64> = (from..estimates.len()).map(|k| estimates.canonical_mean(k, place) - truth[k]).collect();
    rms(&errors)
}

#[test]
fn running_sums_equal_a_direct_computation() {
    for steps in [600, 601, 602] {
        let run = finished(&Scenario { duration: f64::from(steps) * 0.01, ..guessing(8.0, 0.1) });
        let (estimates, record) = (&run.estimates()[0], run.record());
        let diagnostics = Diagnostics::new(estimates, record);
        let n = estimates.len();
        let first = (0..n).find(|&k| 3 * k >= 2 * n).unwrap();
        assert_eq!(diagnostics.last_third(), first..n);
        for (place, channel) in estimates.channels().iter().copied().enumerate() {
            let tally = |range| diagnostics.tally(channel, range).unwrap();
            assert!((tally(0..n).rmse() / direct_rmse(estimates, record, place, 0) - 1.0).abs() < 1e-12);
            let last_third = tally(diagnostics.last_third()).rmse() / direct_rmse(estimates, record, place, first);
            assert!((last_third - 1.0).abs() < 1e-9, "{channel:?}: {last_third}");
        }
        let mean = mean(&estimates.nis()[1..]);
        assert!((diagnostics.mean_nis().unwrap().mean - mean).abs() < 1e-12);
        let likelihood: f64 = (1..n).map(|k| estimates.log_likelihood(k)).sum();
        assert!((diagnostics.log_likelihood() - likelihood).abs() < 1e-9);
        for (sensor, whiteness) in diagnostics.whiteness.iter().enumerate() {
            let normalised =
                |k: usize| estimates.innovation(k)[sensor] / estimates.innovation_cov(k)[3 * sensor].sqrt();
            let square: f64 = (1..n).map(|k| normalised(k) * normalised(k)).sum();
            for (i, r) in whiteness.autocorrelation().into_iter().enumerate() {
                let product: f64 = (i + 2..n).map(|k| normalised(k) * normalised(k - i - 1)).sum();
                assert!((r - product / square).abs() < 1e-12);
            }
            assert_eq!(whiteness.autocorrelation().len(), LAGS);
        }
    }
}

#[test]
fn the_nees_is_that_of_the_inverse_covariance() {
    let run = finished(&Scenario { duration: 5.0, ..guessing(-8.0, -0.1) });
    let (estimates, record) = (&run.estimates()[0], run.record());
    let diagnostics = Diagnostics::new(estimates, record);
    for (k, nees) in diagnostics.nees().iter().enumerate().step_by(50) {
        let sign = |place| estimates.canonical_sign(k, place);
        let cov = nalgebra::Matrix4::from_fn(|i, j| sign(i) * sign(j) * estimates.cov(k)[4 * i + j]);
        let error = nalgebra::Vector4::from_fn(|i, _| {
            estimates.canonical_mean(k, i) - record.truth(estimates.channels()[i]).unwrap()[k]
        });
        let direct = error.dot(&(cov.try_inverse().unwrap() * error));
        assert!((nees / direct - 1.0).abs() < 1e-6, "{k}: {nees} instead of {direct}");
    }
}

#[test]
fn a_mirrored_oscillator_scores_like_its_mirror_image() {
    let (plain, mirrored) = (finished(&guessing(8.0, 0.1)), finished(&guessing(-8.0, -0.1)));
    let (a, b) = (&plain.estimates()[0], &mirrored.estimates()[0]);
    let last = b.len() - 1;
    assert!(b.mean(last)[2] < -5.9 && b.mean(last)[3] < 0.0, "the filter stays in its own form");
    for place in 0..4 {
        let (sign, plain_mean) = (b.canonical_sign(last, place), a.canonical_mean(last, place));
        assert_eq!(sign, if place < 2 { 1.0 } else { -1.0 });
        assert_eq!(a.canonical_sign(last, place), 1.0);
        assert!((b.canonical_mean(last, place) / plain_mean - 1.0).abs() < 1e-9);
    }
    let [a, b] = [&plain, &mirrored].map(|run| Diagnostics::new(&run.estimates()[0], run.record()));
    for channel in a.known() {
        let [one, other] = [&a, &b].map(|of| of.tally(channel, 0..of.len()).unwrap());
        assert!((one.rmse() / other.rmse() - 1.0).abs() < 1e-9 && a.settled(channel) == b.settled(channel));
        assert_eq!(one.coverage(), other.coverage());
    }
    assert!((a.mean_nees().unwrap().mean / b.mean_nees().unwrap().mean - 1.0).abs() < 1e-6);
}

#[test]
fn unknown_truths_and_missing_measurements_are_not_scored() {
    let mut scenario = Scenario { duration: 3.0, force: Force::None, ..one_filter(FilterKind::EKF) };
    let run = finished(&scenario);
    let mut file = Vec::new();
    run.record().write_csv(&mut file).unwrap();
    let text = String::from_utf8(file).unwrap().replace("true_damping_ratio", "other");
    let record = record_of(text.into_bytes(), &scenario);
    let again = finished_on(&scenario, record);
    let diagnostics = Diagnostics::new(&again.estimates()[0], again.record());
    assert_eq!(diagnostics.known().count(), 3);
    assert_eq!(diagnostics.tally(Channel::DAMPING_RATIO, 0..9), None);
    assert_eq!((diagnostics.error(Channel::DAMPING_RATIO), diagnostics.settled(Channel::DAMPING_RATIO)), (None, None));
    assert_eq!(diagnostics.mean_nees().unwrap().expected, 3.0);
    assert_eq!(diagnostics.nees_within(0..10).degrees, 30);

    scenario.sensors.clear();
    scenario.filters[0].sensor_std.clear();
    let blind = finished(&scenario);
    let diagnostics = Diagnostics::new(&blind.estimates()[0], blind.record());
    assert!(diagnostics.mean_nis().is_none());
    assert!(diagnostics.whiteness.is_empty() && diagnostics.mean_nees().is_some());
}

#[test]
fn parameters_held_for_certain_have_no_part_in_the_nees() {
    let mut scenario = guessing(6.0, 0.05);
    scenario.filters[0].kind = FilterKind::KF;
    let run = finished(&scenario);
    let nees = Diagnostics::new(&run.estimates()[0], run.record()).mean_nees().unwrap();
    assert_eq!(nees.expected, 2.0);
    assert!(nees.interval.contains(&nees.mean), "{nees:?}");
}

#[test]
fn scores_are_the_diagnostics_to_the_last_bit() {
    let mut scenario = Scenario { duration: 30.0, ..Scenario::default() };
    let good = scenario.filters[0].clone();
    let of = |name: &str, kind| FilterSettings { name: name.to_owned(), kind, ensemble_size: 80, ..good.clone() };
    let mut sure = FilterSettings { fading: 1.0, ..of("sure", FilterKind::EKF) };
    for channel in PlantKind::SDOF.parameters() {
        sure.initial_std[channel] = 1e-6;
        sure.initial_mean[channel] *= 3.0;
    }
    scenario.filters.extend([of("PF", FilterKind::PF), of("KF", FilterKind::KF), sure]);
    let run = finished(&scenario);
    let record = run.record();
    for (place, estimates) in run.estimates().iter().enumerate() {
        let mut scores = Scores::new(&Pass::history(&scenario, place).unwrap(), record);
        let mut pass = Pass::new(&scenario, place, record).unwrap();
        for samples in [1, 2, 500, usize::MAX] {
            pass.follow(record, samples, &mut scores.against(record));
        }
        let diagnostics = Diagnostics::new(estimates, record);
        let (outcome, all) = (scores.outcome(), 0..estimates.len());
        let within = (diagnostics.nees_within(all.clone()), diagnostics.nis_within(all.clone()));
        assert_eq!((outcome.samples, outcome.nees, outcome.nis), (all.end, within.0, within.1));
        assert_eq!(outcome.log_likelihood.to_bits(), diagnostics.log_likelihood().to_bits());
        assert!(outcome.channels.iter().map(|(channel, _)| *channel).eq(diagnostics.known()));
        assert_eq!(outcome.diverged, estimates.name() == "sure");
        for (channel, score) in outcome.channels {
            let tally = diagnostics.tally(channel, all.clone()).unwrap();
            assert_eq!((score.rmse, score.coverage), (tally.rmse(), tally.coverage()));
            assert_eq!((Some(score.error), score.settled), (diagnostics.error(channel), diagnostics.settled(channel)));
            assert_eq!(score.std, last(estimates, channel).1);
        }
    }
}

const STD: f64 = 0.5;
const FREQUENCY: Channel = Channel::NATURAL_FREQUENCY;
const DAMPING: Channel = Channel::DAMPING_RATIO;

fn of(samples: impl IntoIterator<Item = [(f64, f64); 2]>) -> Diagnostics {
    let mut estimates = Estimates::new(&FilterSettings::default(), &Scenario::default(), Vec::new());
    let mut record = Record::empty(0.01, InputKind::Force, Hold::Zero, Vec::new(), vec![FREQUENCY, DAMPING]);
    for pairs in samples {
        let [frequency, damping] = pairs.map(|(mean, _)| mean);
        let cov: Vec<f64> = (0..16).map(|i| if i % 5 == 0 { STD * STD } else { 0.0 }).collect();
        estimates.push(&Sample::unmeasured(&[0.0, 0.0, frequency, damping], &cov));
        record.push(0.0, [], pairs.map(|(_, truth)| truth));
    }
    Diagnostics::new(&estimates, &record)
}

#[test]
fn an_estimate_has_settled_from_when_on_it_is_near_the_truth_for_good() {
    let (near, far, unknown) = (0.199, -0.201, f64::NAN);
    for (errors, expected) in [
        (&[far, near, -near, 0.0][..], Some(1)),
        (&[near, near], Some(0)),
        (&[near, far, near], Some(2)),
        (&[near, near, far], None),
        (&[far, unknown], None),
        (&[far, unknown, near, unknown], Some(2)),
        (&[unknown, unknown], None),
        (&[], None),
    ] {
        let pair = |error: &f64| [(4.0 + error, if error.is_nan() { f64::NAN } else { 4.0 }), (0.0, 0.0)];
        assert_eq!(of(errors.iter().map(pair)).settled(FREQUENCY), expected, "{errors:?}");
    }
}

#[test]
fn errors_are_those_of_the_canonical_form() {
    let mirrored = of([[(-6.5, 6.0), (-0.04, 0.05)], [(-6.25, 6.0), (-0.03, 0.05)]]);
    assert_eq!(mirrored.error(FREQUENCY), Some(0.25));
    assert!((mirrored.error(DAMPING).unwrap() + 0.02).abs() < 1e-15);
    assert!((mirrored.tally(FREQUENCY, 0..2).unwrap().squares - (0.25 + 0.0625)).abs() < 1e-15);
    assert_eq!(mirrored.settled(FREQUENCY), Some(1));
}

#[test]
fn normal_errors_are_inside_two_standard_deviations_as_often_as_they_should() {
    let mut normal = Random::new(5);
    let diagnostics = of((0..20_000).map(|_| [(7.0 + STD * normal.normal(), 7.0), (2.0, 0.0)]));
    let tally = diagnostics.tally(FREQUENCY, 0..20_000).unwrap();
    // 0.9545 ± three standard deviations of a share of 20 000 samples.
    assert!((tally.coverage() - 0.9545).abs() < 0.0045, "{}", tally.coverage());
    assert!((tally.rmse() / STD - 1.0).abs() < 0.015, "{}", tally.rmse());
    let far = ErrorSums { squares: 80_000.0, known: 20_000, inside: 0 };
    assert_eq!(diagnostics.tally(DAMPING, 0..20_000), Some(far));
}

#[test]
fn ranges_are_as_long_as_there_are_samples() {
    let some = of([[(1.0, 0.0), (0.0, f64::NAN)], [(3.0, 0.0), (2.0, 0.0)], [(f64::NAN, 0.0), (0.0, 0.0)]]);
    assert_eq!(some.tally(FREQUENCY, 1..99), Some(ErrorSums { squares: 9.0, known: 1, inside: 0 }));
    assert_eq!((some.tally(DAMPING, 0..1), some.error(FREQUENCY)), (None, None));
    assert_eq!(some.tally(DAMPING, 0..3).map(|tally| tally.known), Some(2));
    assert_eq!(of([]).tally(FREQUENCY, 0..5), None);
}
