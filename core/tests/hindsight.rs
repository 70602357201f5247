//! The smoother and the Cramér-Rao bound.

use kalmanscope_core::scenario::Fault;
use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Hold, PlantKind, Quantity, Run, RunError, Scenario, Sensor, Values,
    simulate, smoothed as smoothed_at_once,
};

use nalgebra::{DMatrix, DVector, Matrix2, Matrix4, Vector2, Vector4};

use crate::numbers::{ADAPTIVE, joint_motion};
use crate::run::{bound, finished, finished_on, knowing, oscillator, truth, with_times};

fn known(kind: FilterKind, samples: usize) -> Scenario {
    let duration = 0.01 * (samples - 1) as f64;
    let mut scenario = Scenario { duration, plant: oscillator(6.0, 0.05), ..Scenario::default() };
    scenario.plant.disturbance_std = 2.0;
    scenario.filters = vec![FilterSettings { smoother: true, ..knowing(kind, [6.0, 0.05]) }];
    scenario
}

fn smoothed(run: &Run) -> Estimates {
    run.smoothed().pop().unwrap()
}

const SAMPLES: usize = 12;
/// The joint normal distribution of the motion given all measurements: both sensors at every sample except the first.
fn batch(run: &Run, scenario: &Scenario) -> (DVector<f64>, DMatrix<f64>) {
    let (mean, cov) = joint_motion(run.record(), [6.0, 0.05]);
    let (mut innovation_cov, mut innovation) = (cov.clone(), DVector::zeros(mean.len()));
    for i in 0..mean.len() {
        let (k, sensor) = (i / 2, i % 2);
        innovation_cov[(i, i)] += if k == 0 { 1e12 } else { scenario.filters[0].sensor_std[sensor].powi(2) };
        innovation[i] = if k == 0 { 0.0 } else { run.record().measured(sensor)[k] - mean[i] };
    }
    let gain = &cov * innovation_cov.try_inverse().unwrap();
    (mean + &gain * innovation, &cov - &gain * &cov)
}

#[test]
fn smoothing_is_conditioning_on_the_whole_record() {
    for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF] {
        let scenario = known(kind, SAMPLES);
        let run = finished(&scenario);
        let (mean, cov) = batch(&run, &scenario);
        let smoothed = smoothed(&run);
        assert_eq!(smoothed.len(), SAMPLES);
        for k in 0..SAMPLES {
            for i in 0..2 {
                let std = cov[(2 * k + i, 2 * k + i)].sqrt();
                let error = (smoothed.mean(k)[i] - mean[2 * k + i]).abs() / std;
                assert!(error < 1e-6, "{} mean {i} at {k}: {error}", kind.name());
                let error = (smoothed.std(k, i) / std - 1.0).abs();
                assert!(error < 1e-6, "{} std {i} at {k}: {error}", kind.name());
            }
            assert_eq!(&smoothed.mean(k)[2..], &[6.0, 0.05], "{} moves what it knows", kind.name());
        }
    }
}

#[test]
fn smoothing_reduces_parameter_errors() {
    for kind in ADAPTIVE {
        for log_parameters in [false, true] {
            let usual = Scenario::default().filters[0].clone();
            let filter = FilterSettings { kind, log_parameters, smoother: true, fading: 1.0, ..usual };
            let scenario = Scenario { plant: oscillator(6.0, 0.05), filters: vec![filter], ..Scenario::default() };
            let run = finished(&scenario);
            let (filtered, smoothed) = (&run.estimates()[0], smoothed(&run));
            let last = scenario.samples() - 1;
            assert_eq!(smoothed.len(), scenario.samples());
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
            assert!((0..4).all(|i| close(smoothed.mean(last)[i], filtered.mean(last)[i])), "{}", kind.name());
            // After two seconds the filter has used a thirtieth of the smoother's data.
            let k = 200;
            for i in [2, 3] {
                assert!(smoothed.std(k, i) < 0.5 * filtered.std(k, i), "{} {i}", kind.name());
            }
            let error = (smoothed.mean(k)[2] - 6.0).abs();
            assert!(error < 4.0 * smoothed.std(k, 2) + 0.01, "{}: {error} ± {}", kind.name(), smoothed.std(k, 2));
        }
    }
}

#[test]
fn a_smoother_uses_all_samples_so_far() {
    let scenario = known(FilterKind::EKF, 300);
    let mut run = Run::new(&scenario).unwrap();
    assert!(smoothed(&run).is_empty());
    run.advance_to(100);
    assert_eq!(smoothed(&run).len(), 100);
    let again = Run::on_record(&scenario, std::sync::Arc::new(run.record().clone())).unwrap();
    assert_eq!(smoothed(&again).len(), 0);
    let none = Run::new(&Scenario::default()).unwrap();
    assert!(none.smoothed().is_empty());
}

#[test]
fn a_smoother_without_a_run_has_the_bits_of_that_of_a_run() {
    let kinds = FilterKind::ALL.into_iter().filter(|kind| !kind.is_sampled());
    for (kind, hold) in kinds.flat_map(|kind| [Hold::Zero, Hold::First].map(|hold| (kind, hold))) {
        let mut scenario = Scenario { hold, ..known(kind, 200) };
        let sampled = FilterSettings { kind: FilterKind::PF, smoother: false, ..scenario.filters[0].clone() };
        scenario.filters.insert(0, sampled);
        scenario.filters[1].input_delay = -2;
        let run = finished(&scenario);
        let expected = smoothed(&run);
        // It need not be asked for by the settings.
        scenario.filters[1].smoother = false;
        let found = smoothed_at_once(&scenario, 1, run.record()).unwrap();
        assert_eq!((found.len(), found.checksum()), (200, expected.checksum()), "{kind:?} {hold:?}");
        assert_eq!((found.id(), found.name()), (expected.id(), expected.name()));
        assert_eq!(found.stop(), None);
    }
}

#[test]
fn a_smoother_that_there_is_not_is_refused_in_words() {
    let mut scenario = known(FilterKind::PF, 50);
    scenario.filters[0].smoother = false;
    let run = finished(&scenario);
    assert!(matches!(smoothed_at_once(&scenario, 0, run.record()), Err(RunError::Scenario(_))));
    assert_eq!(smoothed_at_once(&scenario, 1, run.record()).unwrap_err(), RunError::NoFilter(1));

    let scenario = known(FilterKind::KF, 50);
    let mut run = finished(&scenario);
    assert!(run.forget(20));
    let error = smoothed_at_once(&scenario, 0, run.record()).unwrap_err();
    assert_eq!(error, RunError::Forgotten(20));
}

#[test]
fn a_smoother_of_a_filter_that_fails_has_the_samples_before_and_the_reason() {
    let scenario = known(FilterKind::KF, 50);
    let change = |sensor, k, value| if (sensor, k) == (0, 30) { 1e200 } else { value };
    let record = simulate(&scenario).without_truth().with_measured(change);
    let found = smoothed_at_once(&scenario, 0, &record).unwrap();
    assert_eq!((found.len(), found.stop().map(|stop| stop.sample)), (30, Some(30)));
    let mut cannot_begin = scenario;
    cannot_begin.filters[0].kind = FilterKind::SR_UKF;
    cannot_begin.filters[0].initial_std[Channel::VELOCITY] = 1e200;
    let found = smoothed_at_once(&cannot_begin, 0, &record).unwrap();
    assert_eq!((found.len(), found.stop().map(|stop| stop.sample)), (0, Some(0)));
}

#[test]
fn the_bound_of_a_linear_plant_is_the_kalman_filters_covariance() {
    let mut scenario = known(FilterKind::KF, 1000);
    scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
    let mut chain = scenario.clone();
    chain.set_plant(PlantKind::SHEAR_3);
    // An input that is felt late, which its gain shows, and a sensor that is late.
    let mut late = scenario.clone();
    (late.plant.input_delay, late.filters[0].input_delay) = (3, 3);
    late.filters[0].augment = vec![Channel::INPUT_GAIN];
    let measures = late.sensors[0].measures;
    late.sensors[0].faults.add(Fault::LATE, measures);
    late.filters[0].sensor_delay = (0..late.sensors.len()).map(|place| if place == 0 { 0.05 } else { 0.0 }).collect();
    // Readings between the samples.
    for (mut scenario, is_timed) in [(scenario.clone(), false), (chain, false), (late, false), (scenario, true)] {
        for channel in scenario.plant.kind.parameters() {
            scenario.filters[0].initial_mean[channel] = scenario.plant.parameter(channel).unwrap().at(0.0);
        }
        scenario.filters[0].sensor_std = scenario.true_sensor_std();
        let mut record = simulate(&scenario);
        if is_timed {
            record = with_times(&record, |sensor, k| k - 0.3 * sensor as f64);
        }
        let run = finished_on(&scenario, record);
        let kf = &run.estimates()[0];
        let bound = bound(&scenario, 0, run.record());
        assert_eq!(bound.len(), scenario.samples());
        for k in 0..kf.len() {
            for place in 0..kf.channels().len() {
                let (floor, std) = (bound.std(k, place), kf.std(k, place));
                assert!((floor - std).abs() <= 1e-10 * std, "{:?} at {k}: {floor} and {std}", kf.channels()[place]);
            }
        }
    }
}

/// Tichavský's recursion as printed, on the information matrix, for a plant without exactly known components.
#[test]
fn the_bound_is_the_information_recursion() {
    let scenario = Scenario { duration: 5.0, plant: oscillator(6.0, 0.05), ..Scenario::default() };
    let run = finished(&scenario);
    let record = run.record();
    let bound = bound(&scenario, 0, record);
    let filter = &scenario.filters[0];
    let variance = |per: &Values, i: usize| per[run.estimates()[0].channels()[i]].powi(2);
    let diagonal = |per: &Values| Matrix4::from_diagonal(&Vector4::from_fn(|i, _| variance(per, i)));
    let inverse = |m: Matrix4<f64>| m.try_inverse().unwrap();
    let q = inverse(diagonal(&filter.process_std));
    let mut information = inverse(diagonal(&filter.initial_std));
    let mut sensors = Matrix4::zeros();
    for (i, sensor) in scenario.sensors.iter().enumerate() {
        sensors[(i, i)] = sensor.noise_std.powi(-2);
    }
    let truth = |channel, k: usize| truth(record, channel)[k];
    for k in 1..record.len() {
        let (x, v) = (truth(Channel::DISPLACEMENT, k - 1), truth(Channel::VELOCITY, k - 1));
        let (wn, zeta) = (6.0, 0.05);
        let mut a = Matrix4::zeros();
        a[(0, 1)] = 1.0;
        let row = [-wn * wn, -2.0 * zeta * wn, -2.0 * (wn * x + zeta * v), -2.0 * wn * v];
        a.set_row(1, &row.into());
        let identity = Matrix4::identity();
        let phi = (1..15).rev().fold(identity, |sum, n| identity + a * sum * (scenario.dt / f64::from(n)));
        let (d11, d12) = (phi.transpose() * q * phi, -phi.transpose() * q);
        information = q + sensors - d12.transpose() * inverse(information + d11) * d12;
        let covariance = inverse(information);
        for i in 0..4 {
            let error = bound.std(k, i) / covariance[(i, i)].sqrt() - 1.0;
            assert!(error.abs() < 1e-6, "{i} at {k}: {error}");
        }
    }
}

/// The fast part dies early and no noise stirs it: a prediction's covariance loses its rank, and the beginning is certain.
#[test]
fn a_motion_that_dies_out_is_smoothed_back_to_its_beginning() {
    let (wn, zeta, dt) = (6.0_f64, 3.0_f64, 0.01);
    // Sigma points move by a Runge-Kutta step, whose error so fast a motion shows.
    let kinds = [(FilterKind::KF, 1e-6), (FilterKind::EKF, 1e-6), (FilterKind::UKF, 1e-3), (FilterKind::SR_UKF, 1e-3)];
    for (kind, tolerance) in kinds {
        let mut scenario = known(kind, 2001);
        scenario.plant.disturbance_std = 0.0;
        scenario.plant.set(Channel::DAMPING_RATIO, zeta);
        scenario.filters[0].initial_mean[Channel::DAMPING_RATIO] = zeta;
        scenario.filters[0].process_std = Values::ZERO;
        let smoothed = smoothed(&finished(&scenario));
        assert_eq!(smoothed.len(), 2001);

        // h and its derivative by both roots of the characteristic equation.
        let root = wn * (zeta * zeta - 1.0).sqrt();
        let [slow, fast] = [root - zeta * wn, -root - zeta * wn];
        let h = ((slow * dt).exp() - (fast * dt).exp()) / (2.0 * root);
        let dh = (slow * (slow * dt).exp() - fast * (fast * dt).exp()) / (2.0 * root);
        let transition = Matrix2::new(dh + 2.0 * zeta * wn * h, h, -wn * wn * h, dh);
        let filter = &scenario.filters[0];
        let inverse = |std: f64| 1.0 / (std * std);
        let sensors =
            Matrix2::from_diagonal(&Vector2::new(inverse(filter.sensor_std[0]), inverse(filter.sensor_std[1])));
        let [x, v] = [Channel::DISPLACEMENT, Channel::VELOCITY].map(|channel| inverse(filter.initial_std[channel]));
        let mut information = Matrix2::from_diagonal(&Vector2::new(x, v));
        let mut from_begin = Matrix2::identity();
        for _ in 1..2001 {
            from_begin = transition * from_begin;
            information += from_begin.transpose() * sensors * from_begin;
        }
        let mut cov = information.try_inverse().unwrap();
        for k in 0..40 {
            for i in 0..2 {
                let error = smoothed.std(k, i) / cov[(i, i)].sqrt() - 1.0;
                let std = smoothed.std(k, i);
                assert!(error.abs() < tolerance, "{} at {k}: std {std} of {i}, {error:e}", kind.name());
            }
            cov = transition * cov * transition.transpose();
        }
    }
}
