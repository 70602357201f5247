//! A filter over samples that come in one by one has the bits of a pass over their record.

use kalmanscope_core::record::Record;
use kalmanscope_core::{
    Channel, Estimates, FilterKind, Hold, InputKind, LastSample, OnlineFilter, Pass, RunError, Scenario, simulate,
};

use crate::run::one_filter;

const DT: f64 = 0.01;

fn of(kind: FilterKind) -> Scenario {
    let mut scenario = Scenario { dt: DT, duration: 3.0, ..one_filter(kind) };
    scenario.filters[0].ensemble_size = 50;
    scenario
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

fn readings(record: &Record, k: usize) -> [f64; 2] {
    [record.measured(0)[k], record.measured(1)[k]]
}

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
            online.step(record.input()[k], &readings(&record, k), &mut estimates);
            let late = scenario.filters[0].input_delay.min(0).unsigned_abs() as usize;
            assert_eq!((estimates.len(), online.pass().done()), ([(k + 1).saturating_sub(late); 2]).into(), "{what}");
        }
        online.finish(&mut estimates);
        assert_same(&estimates, &expected, &what);
    }
}

#[test]
fn a_filter_that_has_failed_says_where_and_why() {
    let mut online = OnlineFilter::new(&of(FilterKind::EKF), 0).expect("the scenario is possible");
    let mut estimates = Pass::history(&of(FilterKind::EKF), 0).expect("there is a filter");
    for k in 0..8 {
        online.step(0.0, &[if k == 5 { 1e200 } else { 0.0 }, 0.0], &mut estimates);
    }
    let stop = online.pass().stop().expect("it has stopped");
    assert_eq!((stop.sample, estimates.stop(), estimates.len()), (5, Some(stop), 5));
    assert_eq!(OnlineFilter::new(&of(FilterKind::EKF), 1).err(), Some(RunError::NoFilter(1)));
}

#[test]
fn a_filter_can_be_sent_to_another_thread() {
    let mut online = OnlineFilter::new(&of(FilterKind::PF), 0).expect("the scenario is possible");
    let step = move || {
        online.step(0.0, &[0.0, 0.0], &mut LastSample::default());
        online.pass().done()
    };
    assert_eq!(std::thread::spawn(step).join().ok(), Some(1));
}
