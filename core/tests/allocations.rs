//! Filters that go over a record into a sink of one's own reserve no memory for a sample.

use kalmanscope_core::filter::{Adaptation, Robust};
use kalmanscope_core::{
    Channel, FilterKind, Hold, LastSample, OnlineFilter, Pass, Quantity, Record, Sample, Scenario, Sensor, Sink, Stop,
    simulate,
};

struct Count {
    samples: usize,
    wants_prior: bool,
}

impl Sink for Count {
    fn push(&mut self, sample: &Sample<'_>) {
        assert_eq!(sample.prior_cov.len(), if self.wants_prior { sample.cov.len() } else { 0 });
        self.samples += 1;
    }

    fn stop_at(&mut self, stop: Stop) {
        panic!("{stop:?}");
    }

    fn wants_prior(&self) -> bool {
        self.wants_prior
    }
}

const KINDS: [FilterKind; 6] =
    [FilterKind::KF, FilterKind::EKF, FilterKind::IEKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF];

fn scenarios(kind: FilterKind) -> Vec<(&'static str, Scenario)> {
    type Change = fn(&mut Scenario);
    let feel = |scenario: &mut Scenario| {
        scenario.remove_sensor(Quantity::VELOCITY);
        scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
    };
    let learn = |scenario: &mut Scenario| {
        let adaptation = Adaptation { sensor_noise: true, process_noise: true, forgetting: 0.99, training: 0.0 };
        scenario.filters[0].adaptation = adaptation;
    };
    let changes: [(&str, Hold, Change); 8] = [
        ("augmented", Hold::Zero, |scenario| scenario.filters[0].augment = vec![Channel::INPUT_GAIN]),
        ("logarithms", Hold::First, |scenario| scenario.filters[0].log_parameters = true),
        ("accelerometer", Hold::Zero, feel),
        ("accelerometer, linear force", Hold::First, feel),
        ("learns its noise", Hold::First, learn),
        ("jumps", Hold::First, |scenario| scenario.filters[0].jump = scenario.filters[0].kind != FilterKind::KF),
        ("plain", Hold::Zero, |_| ()),
        ("linear force", Hold::First, |_| ()),
    ];
    let plain = |hold, change: &dyn Fn(&mut Scenario)| {
        let mut scenario = Scenario { duration: 5.0, hold, ..Scenario::default() };
        scenario.filters.truncate(1);
        scenario.filters[0].kind = kind;
        change(&mut scenario);
        scenario
    };
    let changed = changes.map(|(name, hold, change)| (name, plain(hold, &change)));
    let robust = Robust::ALL.map(|rule| (rule.info().key, plain(Hold::Zero, &|of| of.filters[0].robust = rule)));
    changed.into_iter().chain(robust).collect()
}

fn record(scenario: &Scenario) -> Record {
    simulate(scenario).without_truth().with_gaps(|place, k| k % (place + 3) == 1)
}

#[test]
fn a_pass_reserves_no_memory_for_a_sample() {
    for (kind, wants_prior) in KINDS.into_iter().flat_map(|kind| [(kind, false), (kind, true)]) {
        for (name, scenario) in scenarios(kind) {
            let record = record(&scenario);
            let mut pass = Pass::new(&scenario, 0, &record).expect("the record fits");
            let mut sink = Count { samples: 0, wants_prior };
            // The first samples make room for matrices.
            pass.follow(&record, 10, &mut sink);
            let reserved = allocation_counter::measure(|| pass.follow(&record, 501, &mut sink)).count_total;
            assert_eq!((sink.samples, reserved), (501, 0), "{kind:?} {name} {wants_prior}");
        }
    }
}

#[test]
fn a_sample_that_comes_in_reserves_no_memory() {
    for kind in KINDS {
        for (name, mut scenario) in scenarios(kind) {
            scenario.filters[0].input_delay = -2;
            let mut filter = OnlineFilter::new(&scenario, 0).expect("the scenario is possible");
            let mut last = LastSample::default();
            let mut steps = |from: u32, to: u32| {
                for k in from..to {
                    let velocity = if k % 3 == 0 { f64::NAN } else { 0.0 };
                    filter.step(0.1, &[0.0, velocity], &mut last);
                }
            };
            // Samples are forgotten at times, not at once.
            steps(0, 300);
            let reserved = allocation_counter::measure(|| steps(300, 1000)).count_total;
            assert_eq!(reserved, 0, "{kind:?} {name}");
        }
    }
}
