//! A filter over samples that come in one by one has the bits of a pass over their record.

use kalmanscope_core::record::{Input, Record};
use kalmanscope_core::{
    Channel, Estimates, FilterKind, Hold, InputKind, OnlineError, OnlineFilter, Pass, Quantity, RunError, Sample,
    Scenario, Sink, Stop, simulate,
};

use crate::run::one_filter;

const DT: f64 = 0.01;

/// A scenario with one filter of a kind.
fn of(kind: FilterKind) -> Scenario {
    let mut scenario = Scenario { dt: DT, duration: 3.0, ..one_filter(kind) };
    scenario.filters[0].ensemble_size = 50;
    scenario
}

/// A record of the scenario in which some readings are missing: some of one sensor, a few of both.
fn record(scenario: &Scenario) -> Record {
    let is_missing = |sensor, k| (100..120).contains(&k) || [k % 7 == 3, k % 3 == 1][sensor];
    simulate(scenario).without_truth().with_gaps(is_missing)
}

/// The estimates of a pass.
fn passed(scenario: &Scenario, record: &Record) -> Estimates {
    let mut estimates = Pass::history(scenario, 0).expect("there is a filter");
    Pass::new(scenario, 0, record).expect("the record fits").follow(record, record.len(), &mut estimates);
    estimates
}

fn readings(record: &Record, k: usize) -> [f64; 2] {
    [record.measured(0)[k], record.measured(1)[k]]
}

/// Whether two histories have the same bits.
fn assert_same(one: &Estimates, other: &Estimates, what: &str) {
    let bits = |estimates: &Estimates| {
        let updates = (0..estimates.len()).flat_map(|k| {
            let matrices = estimates.innovation_cov(k).iter().chain(estimates.gain(k));
            estimates.innovation(k).iter().chain(matrices).map(|x| x.to_bits()).collect::<Vec<_>>()
        });
        updates.chain(estimates.log_likelihoods().map(f64::to_bits)).collect::<Vec<u64>>()
    };
    assert_eq!((one.len(), one.stop()), (other.len(), other.stop()), "{what}");
    assert_eq!(one.checksum(), other.checksum(), "{what}");
    assert!(bits(one) == bits(other), "{what}");
}

/// Holds, input delays and settings that change the way in which a filter is computed.
fn variants(kind: FilterKind) -> Vec<(String, Scenario)> {
    let mut variants = Vec::new();
    for hold in [Hold::Zero, Hold::First] {
        for input_delay in [0, 3, -4] {
            let mut scenario = Scenario { hold, ..of(kind) };
            scenario.filters[0].input_delay = input_delay;
            variants.push((format!("{kind:?} {hold:?} {input_delay}"), scenario));
        }
    }
    let mut ground = Scenario { input: InputKind::GroundAcceleration, ..of(kind) };
    ground.filters[0].jump = kind != FilterKind::KF && !kind.is_sampled();
    variants.push((format!("{kind:?} of the ground"), ground));
    if !kind.is_sampled() {
        let mut adaptive = of(kind);
        adaptive.filters[0].log_parameters = true;
        adaptive.filters[0].adaptation.sensor_noise = true;
        variants.push((format!("{kind:?} that learns"), adaptive));
        let mut augmented = of(kind);
        augmented.filters[0].augment = vec![Channel::INPUT_GAIN];
        variants.push((format!("{kind:?} with a gain"), augmented));
    }
    if kind == FilterKind::EKF {
        let mut guesses = of(kind);
        guesses.filters[0].guesses = 3;
        variants.push(("guesses".to_owned(), guesses));
    }
    variants
}

#[test]
fn samples_that_come_in_have_the_bits_of_a_pass() {
    for (what, scenario) in FilterKind::ALL.into_iter().flat_map(variants) {
        let record = record(&scenario);
        let expected = passed(&scenario, &record);
        assert!(expected.len() == record.len(), "{what}: {:?}", expected.stop());
        let mut online = OnlineFilter::new(&scenario, 0).expect("the scenario is possible");
        let mut estimates = Pass::history(&scenario, 0).expect("there is a filter");
        for k in 0..record.len() {
            // Not from zero on, and not to the last bit.
            let time = 1.7e9 + DT * k as f64 + 1e-5 * libm::sin(k as f64);
            online.step_into(time, record.input()[k], &readings(&record, k), &mut estimates).expect("it goes on");
            assert_eq!(estimates.len(), (k + 1).saturating_sub(online.latency()), "{what}");
        }
        assert_eq!(online.latency(), scenario.filters[0].input_delay.min(0).unsigned_abs() as usize);
        online.finish(&mut estimates).expect("it goes on");
        assert_same(&estimates, &expected, &what);
    }
}

#[test]
fn a_step_returns_the_sample_that_it_has_computed() {
    for kind in [FilterKind::EKF, FilterKind::PF] {
        for input_delay in [0, -4] {
            let mut scenario = of(kind);
            scenario.filters[0].input_delay = input_delay;
            let record = record(&scenario);
            let expected = passed(&scenario, &record);
            let mut online = OnlineFilter::new(&scenario, 0).expect("the scenario is possible");
            assert_eq!(online.channels(), expected.channels());
            for k in 0..200 {
                let latency = online.latency();
                let step = online.step(DT * k as f64, record.input()[k], &readings(&record, k)).expect("it goes on");
                let Some(at) = k.checked_sub(latency) else {
                    assert!(step.is_none(), "{k}");
                    continue;
                };
                let sample = step.expect("there is a sample");
                assert_eq!((sample.mean, sample.cov), (expected.mean(at), expected.cov(at)));
                assert_eq!(sample.gain, expected.gain(at));
                assert_eq!(sample.nis.to_bits(), expected.nis()[at].to_bits());
                assert_eq!(sample.ln_likelihood().to_bits(), expected.log_likelihood(at).to_bits());
                assert_eq!((sample.prior_mean.len(), sample.prior_cov.len()), (4, 16));
            }
        }
    }
}

#[test]
fn a_gap_is_filled_with_predictions() {
    for hold in [Hold::Zero, Hold::First] {
        for input_delay in [0, 3, -4] {
            let mut scenario = Scenario { hold, ..of(FilterKind::UKF) };
            scenario.filters[0].input_delay = input_delay;
            let whole = record(&scenario);
            let is_lost = |k: usize| (50..58).contains(&k) || k == 130;
            let mut values = whole.input().to_vec();
            for gap in [50..58, 130..131] {
                let (before, after) = (values[gap.start - 1], values[gap.end]);
                for (step, k) in (1..).zip(gap.clone()) {
                    let share = f64::from(step) / (gap.len() + 1) as f64;
                    values[k] = if hold == Hold::Zero { before } else { before + (after - before) * share };
                }
            }
            let column = |sensor: usize| {
                let values = whole.measured(sensor).iter().enumerate();
                values.map(|(k, &value)| if is_lost(k) { f64::NAN } else { value }).collect::<Vec<f64>>()
            };
            let columns = vec![(Quantity::DISPLACEMENT, column(0)), (Quantity::VELOCITY, column(1))];
            let input = Input { kind: scenario.input, hold, values };
            let filled = Record::new(DT, input, columns).expect("it is a record");
            let mut online = OnlineFilter::new(&scenario, 0).expect("the scenario is possible");
            let mut estimates = Pass::history(&scenario, 0).expect("there is a filter");
            for k in (0..whole.len()).filter(|&k| !is_lost(k)) {
                let step = online.step_into(DT * k as f64, whole.input()[k], &readings(&whole, k), &mut estimates);
                step.expect("the gap is filled");
            }
            online.finish(&mut estimates).expect("it goes on");
            assert_same(&estimates, &passed(&scenario, &filled), &format!("{hold:?} {input_delay}"));
        }
    }
}

#[test]
fn a_sample_that_is_refused_leaves_the_filter_as_it_was() {
    let scenario = Scenario { hold: Hold::First, ..of(FilterKind::EKF) };
    let record = record(&scenario);
    let mut online = OnlineFilter::new(&scenario, 0).expect("the scenario is possible");
    let mut estimates = Pass::history(&scenario, 0).expect("there is a filter");
    for k in 0..record.len() {
        let time = 2.0 + DT * k as f64;
        online.step_into(time, record.input()[k], &readings(&record, k), &mut estimates).expect("it goes on");
        if k != 10 {
            continue;
        }
        let (inf, nan) = (f64::INFINITY, f64::NAN);
        for (time, input, readings, message) in [
            (2.115, 0.0, &[0.0, 0.0][..], "is 2.115 s, 1.5 steps of 0.01 s after the last sample, but must be a whole"),
            (2.1, 0.0, &[0.0, 0.0], "is 2.1 s, 0 steps of 0.01 s after the last sample, but must be a whole number"),
            (1.0, 0.0, &[0.0, 0.0], "is 1 s, -110 steps of 0.01 s after the last sample, but must be a whole number"),
            (5002.1, 0.0, &[0.0, 0.0], "at most 100000 are filled: begin a new filter"),
            (nan, 0.0, &[0.0, 0.0], "the time is NaN s and the input 0, but both must be finite numbers"),
            (2.11, inf, &[0.0, 0.0], "the time is 2.11 s and the input inf, but both must be finite numbers"),
            (2.11, 0.0, &[0.0, -inf], "the reading of velocity is infinite, but must be a number or NaN"),
            (2.11, 0.0, &[0.0], "there are 1 readings of 2 sensors: a missing reading is NaN"),
        ] {
            let refused = online.step_into(time, input, readings, &mut estimates).expect_err("it is refused");
            assert!(refused.to_string().contains(message), "{refused}");
        }
    }
    assert_same(&estimates, &passed(&scenario, &record), "after samples that were refused");
    assert_eq!(OnlineFilter::new(&scenario, 1).err(), Some(RunError::NoFilter(1)));
}

/// Notes where a filter has stopped.
#[derive(Default)]
struct Stopped(Option<Stop>);

impl Sink for Stopped {
    fn push(&mut self, _: &Sample<'_>) {}

    fn stop_at(&mut self, stop: Stop) {
        self.0 = Some(stop);
    }
}

#[test]
fn a_filter_that_has_failed_says_where_and_why() {
    let mut online = OnlineFilter::new(&of(FilterKind::EKF), 0).expect("the scenario is possible");
    let mut sink = Stopped::default();
    for k in 0..5 {
        online.step_into(DT * f64::from(k), 0.0, &[0.0, 0.0], &mut sink).expect("it goes on");
    }
    let error = online.step_into(0.05, 0.0, &[1e200, 0.0], &mut sink);
    let stop = sink.0.expect("it has stopped");
    assert_eq!((stop.sample, error), (5, Err(OnlineError::Stopped(stop))));
    let again = online.step(0.06, 0.0, &[0.0, 0.0]).map(|_| ()).expect_err("it has stopped").to_string();
    assert_eq!(
        again,
        "the filter has stopped at sample 5: a measurement is so far from what the filter expects that its likelihood is zero"
    );
}

#[test]
fn a_filter_can_be_sent_to_another_thread() {
    let mut online = OnlineFilter::new(&of(FilterKind::PF), 0).expect("the scenario is possible");
    let done = std::thread::spawn(move || online.step(0.0, 0.0, &[0.0, 0.0]).expect("it goes on").is_some());
    assert!(done.join().expect("it goes on"));
}
