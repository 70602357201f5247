//! A filter over samples that come in one by one has the bits of a pass over their record; and the belief before the update, which a sink
//! can ask for.

use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Hold, InputKind, LastSample, OnlineFilter, Pass, Quantity, Record,
    RunError, Sample, Scenario, Sensor, Sink as _, simulate,
};

use crate::run::{Each, assert_same_estimates, finished, one_filter, readings};

fn of(kind: FilterKind) -> Scenario {
    let mut scenario = Scenario { duration: 3.0, ..one_filter(kind) };
    scenario.filters[0].ensemble_size = 50;
    scenario
}

fn held(kind: FilterKind, hold: Hold) -> Scenario {
    Scenario { hold, ..of(kind) }
}

fn record(scenario: &Scenario) -> Record {
    let is_missing = |sensor, k| (100..120).contains(&k) || [k % 7 == 3, k % 3 == 1][sensor];
    simulate(scenario).without_truth().with_gaps(is_missing)
}

fn passed(scenario: &Scenario, record: &Record) -> Estimates {
    let mut estimates = Pass::history(scenario, 0).expect("there is a filter");
    Pass::new(scenario, 0, record).expect("the record fits").follow(record, record.len(), &mut estimates);
    estimates
}

fn variants(kind: FilterKind) -> Vec<Scenario> {
    let with = |hold: Hold, change: &dyn Fn(&mut FilterSettings)| {
        let mut scenario = held(kind, hold);
        change(&mut scenario.filters[0]);
        scenario
    };
    let delayed = |hold| [0, 3, -4].map(|delay| with(hold, &|filter| filter.input_delay = delay));
    let mut variants = [delayed(Hold::Zero), delayed(Hold::First)].concat();
    let ground = with(Hold::Zero, &|filter| filter.jump = kind != FilterKind::KF && !kind.is_sampled());
    variants.push(Scenario { input: InputKind::GroundAcceleration, ..ground });
    if !kind.is_sampled() {
        let learns = |filter: &mut FilterSettings| {
            (filter.log_parameters, filter.adaptation.sensor_noise) = (true, true);
        };
        variants.push(with(Hold::Zero, &learns));
        variants.push(with(Hold::Zero, &|filter| filter.augment = vec![Channel::INPUT_GAIN]));
    }
    if kind == FilterKind::EKF {
        variants.push(with(Hold::Zero, &|filter| filter.guesses = 3));
    }
    variants
}

#[test]
fn samples_that_come_in_have_the_bits_of_a_pass() {
    for scenario in FilterKind::ALL.into_iter().flat_map(variants) {
        let what = scenario.to_toml().expect("it can be written");
        let record = record(&scenario);
        let expected = passed(&scenario, &record);
        assert!(expected.len() == record.len(), "{what}: {:?}", expected.stop());
        let mut online = OnlineFilter::new(&scenario, 0).expect("the scenario is possible");
        let mut estimates = Pass::history(&scenario, 0).expect("there is a filter");
        for k in 0..record.len() {
            online.step(record.input()[k], &readings(&record, k), &mut estimates);
            let late = scenario.filters[0].input_delay.min(0).unsigned_abs() as usize;
            assert_eq!((estimates.len(), online.pass.done()), ([(k + 1).saturating_sub(late); 2]).into(), "{what}");
        }
        online.finish(&mut estimates);
        assert_same_estimates(&estimates, &expected, &what);
    }
}

#[test]
fn a_filter_that_has_failed_says_where_and_why() {
    let mut online = OnlineFilter::new(&of(FilterKind::EKF), 0).expect("the scenario is possible");
    let mut estimates = Pass::history(&of(FilterKind::EKF), 0).expect("there is a filter");
    for k in 0..8 {
        online.step(0.0, &[if k == 5 { 1e200 } else { 0.0 }, 0.0], &mut estimates);
    }
    let stop = online.pass.stop.expect("it has stopped");
    assert_eq!((stop.sample, estimates.stop(), estimates.len()), (5, Some(stop), 5));
    assert_eq!(OnlineFilter::new(&of(FilterKind::EKF), 1).err(), Some(RunError::NoFilter(1)));
}

fn samples(scenario: &Scenario, record: &Record, wants_prior: bool) -> Vec<LastSample> {
    let mut all = Vec::new();
    let keep = |sample: &Sample<'_>| {
        all.push(LastSample::default());
        all.last_mut().unwrap().push(sample);
    };
    let mut sink = Each { wants_prior, call: keep };
    Pass::new(scenario, 0, record).expect("the record fits").follow(record, record.len(), &mut sink);
    assert_eq!(all.len(), record.len());
    all
}

fn variants_with_prior(kind: FilterKind) -> Vec<Scenario> {
    let mut variants = vec![held(kind, Hold::Zero), held(kind, Hold::First)];
    if kind == FilterKind::UKF {
        variants[0].filters[0].guesses = 3;
    }
    variants[1].filters[0].jump = kind != FilterKind::KF && !kind.is_sampled();
    let mut white = held(kind, Hold::Zero);
    white.filters[0].augment = vec![Channel::WHITE_FORCE];
    if white.validate().is_ok() {
        variants.push(white);
    }
    variants
}

#[test]
fn a_linear_update_leads_from_the_prior_to_the_mean_and_a_sink_gets_the_prior_that_asks_for_it() {
    for scenario in FilterKind::ALL.into_iter().flat_map(variants_with_prior) {
        let (run, kind) = (finished(&scenario), scenario.filters[0].kind);
        let all = samples(&scenario, run.record(), true);
        for (k, (with, without)) in all.iter().zip(samples(&scenario, run.record(), false)).enumerate() {
            let (with, without) = (with.sample(), without.sample());
            assert!(without.prior_mean.is_empty() && without.prior_cov.is_empty(), "{kind:?}: nobody asks for it");
            assert_eq!((with.mean, with.cov), (without.mean, without.cov), "{kind:?} {k}");
            assert_eq!(with.mean, run.estimates()[0].mean(k), "{kind:?} {k}");
        }
        let first = all[0].sample();
        assert_eq!((&first.prior_mean, &first.prior_cov), (&first.mean, &first.cov), "{kind:?}");
        for (k, sample) in all.iter().map(LastSample::sample).enumerate().skip(1) {
            let Sample { mean, prior_mean, prior_cov, innovation, innovation_cov, gain, .. } = sample;
            let n = mean.len();
            assert_eq!((prior_mean.len(), prior_cov.len()), (n, n * n));
            for (i, &e) in innovation.iter().enumerate() {
                let z = run.record().measured(i)[k];
                assert!((z - prior_mean[i] - e).abs() < 1e-12, "{kind:?} {k}: e = z - H y⁻");
                let variance = innovation_cov[3 * i] - prior_cov[i * (n + 1)];
                let r = scenario.filters[0].sensor_std[i].powi(2);
                assert!((variance - r).abs() < 1e-10, "{kind:?} {k}: S = H P⁻ Hᵀ + R, {variance} {r}");
            }
            if kind.is_sampled() {
                continue;
            }
            for i in 0..n {
                let moved: f64 = innovation.iter().enumerate().map(|(j, e)| gain[j * n + i] * e).sum();
                assert!((prior_mean[i] + moved - mean[i]).abs() < 1e-12, "{kind:?} {k} {i}: y = y⁻ + K e");
            }
            for i in 0..n {
                for j in 0..n {
                    // P = P⁻ - K H P⁻, H of the first two components.
                    let told: f64 = (0..2).map(|s| gain[s * n + i] * prior_cov[s * n + j]).sum();
                    let expected = prior_cov[j * n + i] - told;
                    assert!((expected - sample.cov[j * n + i]).abs() < 1e-10, "{kind:?} {k} {i} {j}: P = (I - K H) P⁻");
                }
            }
        }
    }
}

#[test]
fn a_prior_is_in_the_channels_units() {
    for hold in [Hold::Zero, Hold::First] {
        for kind in [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF] {
            let mut scenario = held(kind, hold);
            scenario.filters[0].log_parameters = true;
            // Nothing is measured at all, so that the belief is what it was before each update.
            scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 0.01)];
            scenario.filters[0].sensor_std = vec![0.01];
            let run = finished(&scenario);
            let record = run.record().clone().with_gaps(|_, _| true);
            for sample in samples(&scenario, &record, true).iter().map(LastSample::sample) {
                assert_eq!((&sample.prior_mean, &sample.prior_cov), (&sample.mean, &sample.cov), "{kind:?} {hold:?}");
                let wn = sample.prior_mean[2];
                assert!((wn - scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY]).abs() < 1e-9, "{wn}");
            }
        }
    }
}
