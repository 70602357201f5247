//! Filters that go over a record into a sink of one's own reserve no memory for a sample.

use kalmanscope_core::filter::{Adaptation, Gaussian, Matrix, Robust, Vector};
use kalmanscope_core::simulate;
use kalmanscope_core::{
    Channel, FilterKind, Hold, KalmanFilter, MeasurementModel, OnlineFilter, Pass, Quantity, Record, Scenario, Sensor,
    Stop,
};
use kalmanscope_core::{Sample, Sink};

/// Counts samples.
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

/// Tuned kernels, filters by the book because of the hold, because of the state, and because they weigh or learn.
fn scenarios(kind: FilterKind) -> Vec<(&'static str, Scenario)> {
    let mut kernel = Scenario { duration: 5.0, ..Scenario::default() };
    kernel.filters.truncate(1);
    kernel.filters[0].kind = kind;
    let book = Scenario { hold: Hold::First, ..kernel.clone() };
    let mut augmented = kernel.clone();
    augmented.filters[0].augment = vec![Channel::INPUT_GAIN];
    let mut logarithms = book.clone();
    logarithms.filters[0].log_parameters = true;
    let feeling = |mut scenario: Scenario| {
        scenario.remove_sensor(Quantity::VELOCITY);
        scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
        scenario
    };
    let one = ("kernel with an accelerometer", feeling(kernel.clone()));
    let other = ("book with an accelerometer", feeling(book.clone()));
    let mut all = vec![("augmented", augmented), ("logarithms", logarithms), one, other];
    for rule in Robust::ALL {
        let mut robust = kernel.clone();
        robust.filters[0].robust = rule;
        all.push((rule.info().key, robust));
    }
    let mut learning = book.clone();
    learning.filters[0].adaptation =
        Adaptation { sensor_noise: true, process_noise: true, forgetting: 0.99, training: 0.0 };
    let mut jumping = book.clone();
    jumping.filters[0].jump = kind != FilterKind::KF;
    all.extend([("learns its noise", learning), ("jumps", jumping), ("kernel", kernel), ("book", book)]);
    all
}

/// A record of a scenario in which readings are missing now and then.
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
            let mut steps = |from: u32, to: u32| {
                for k in from..to {
                    let velocity = if k % 3 == 0 { f64::NAN } else { 0.0 };
                    filter.step(0.01 * f64::from(k), 0.1, &[0.0, velocity]).expect("it goes on");
                }
            };
            // Samples are forgotten at times, not at once.
            steps(0, 300);
            let reserved = allocation_counter::measure(|| steps(300, 1000)).count_total;
            assert_eq!(reserved, 0, "{kind:?} {name}");
        }
    }
}

#[test]
fn a_step_of_ones_own_system_reserves_no_memory() {
    let h = Matrix::from_row_slice(2, 2, &[1.0, 0.0, 0.5, 1.0]);
    let of_function = MeasurementModel::function(|x, z| (z[0], z[1]) = (x[0] * x[0], x[1]));
    for model in [h.into(), of_function] {
        let a = Matrix::from_row_slice(2, 2, &[1.0, 0.1, 0.0, 1.0]);
        let r = Matrix::from_row_slice(2, 2, &[1.0, 0.3, 0.3, 1.0]);
        let initial = Gaussian::independent(Vector::zeros(2), &Vector::repeat(2, 1.0));
        let q = Matrix::identity(2, 2) * 0.01;
        let mut filter = KalmanFilter::new(a, Matrix::repeat(2, 1, 0.1), model, q, r, initial).expect("it is one");
        let mut steps = |count: u32| {
            for k in 0..count {
                let second = if k % 3 == 1 { f64::NAN } else { 0.1 };
                filter.step(&[0.1], &[0.2, second]).expect("it goes on");
            }
        };
        steps(3);
        assert_eq!(allocation_counter::measure(|| steps(300)).count_total, 0);
    }
}
