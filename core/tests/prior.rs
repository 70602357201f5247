//! The belief before the update, which a sink can ask for.

use kalmanscope_core::{
    Channel, FilterKind, Hold, LastSample, Pass, Quantity, Run, Sample, Scenario, Sensor, Sink, Stop,
};

use crate::run::{finished, one_filter};

struct All {
    wants_prior: bool,
    samples: Vec<LastSample>,
}

impl Sink for All {
    fn push(&mut self, sample: &Sample<'_>) {
        let mut kept = LastSample::default();
        kept.push(sample);
        self.samples.push(kept);
    }

    fn stop_at(&mut self, stop: Stop) {
        panic!("{stop:?}");
    }

    fn wants_prior(&self) -> bool {
        self.wants_prior
    }
}

fn samples(scenario: &Scenario, run: &Run, wants_prior: bool) -> Vec<LastSample> {
    let mut all = All { wants_prior, samples: Vec::new() };
    let record = run.record();
    Pass::new(scenario, 0, record).expect("the record fits").follow(record, record.len(), &mut all);
    assert_eq!(all.samples.len(), record.len());
    all.samples
}

fn scenario(kind: FilterKind, hold: Hold) -> Scenario {
    let mut scenario = Scenario { duration: 3.0, hold, ..one_filter(FilterKind::EKF) };
    (scenario.filters[0].kind, scenario.filters[0].ensemble_size) = (kind, 60);
    scenario
}

fn variants(kind: FilterKind) -> Vec<Scenario> {
    let mut variants = vec![scenario(kind, Hold::Zero), scenario(kind, Hold::First)];
    if kind == FilterKind::UKF {
        variants[0].filters[0].guesses = 3;
    }
    variants[1].filters[0].jump = kind != FilterKind::KF && !kind.is_sampled();
    let mut white = scenario(kind, Hold::Zero);
    white.filters[0].augment = vec![Channel::WHITE_FORCE];
    if white.validate().is_ok() {
        variants.push(white);
    }
    variants
}

#[test]
fn a_linear_update_leads_from_the_prior_to_the_mean() {
    for scenario in FilterKind::ALL.into_iter().flat_map(variants) {
        let (run, kind) = (finished(&scenario), scenario.filters[0].kind);
        let all = samples(&scenario, &run, true);
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
fn a_sink_that_does_not_ask_gets_none_and_the_same_estimates() {
    for scenario in FilterKind::ALL.into_iter().flat_map(variants) {
        let run = finished(&scenario);
        let (with, without) = (samples(&scenario, &run, true), samples(&scenario, &run, false));
        for (k, (with, without)) in with.iter().zip(&without).enumerate() {
            let (with, without) = (with.sample(), without.sample());
            assert!(without.prior_mean.is_empty() && without.prior_cov.is_empty());
            assert_eq!((with.mean, with.cov), (without.mean, without.cov));
            assert_eq!(with.mean, run.estimates()[0].mean(k));
        }
    }
}

#[test]
fn a_prior_is_in_the_channels_units() {
    for hold in [Hold::Zero, Hold::First] {
        for kind in [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF] {
            let mut scenario = scenario(kind, hold);
            scenario.filters[0].log_parameters = true;
            // Nothing is measured at all, so that the belief is what it was before each update.
            scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 0.01)];
            scenario.filters[0].sensor_std = vec![0.01];
            let run = finished(&scenario);
            let record = run.record().clone().with_gaps(|_, _| true);
            let mut all = All { wants_prior: true, samples: Vec::new() };
            Pass::new(&scenario, 0, &record).expect("the record fits").follow(&record, 50, &mut all);
            for sample in all.samples.iter().map(LastSample::sample) {
                assert_eq!((&sample.prior_mean, &sample.prior_cov), (&sample.mean, &sample.cov), "{kind:?} {hold:?}");
                let wn = sample.prior_mean[2];
                assert!((wn - scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY]).abs() < 1e-9, "{wn}");
            }
        }
    }
}
