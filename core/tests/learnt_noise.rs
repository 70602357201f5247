//! How large R and Q are: a filter that learns noise, and filters with several scales of Q.

use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Hold, PlantKind, Quantity, Scenario, Signal, Trouble,
};

use crate::numbers::{apart, mean};
use crate::run::{finished, finished_on, one_filter, oscillator, values, with_times};

fn coverage(
    kind: FilterKind,
    plant: &PlantKind,
    change: impl Fn(&mut Scenario),
    seeds: std::ops::Range<u64>,
) -> Vec<f64> {
    let mut counts = Vec::new();
    for seed in seeds {
        let mut scenario = Scenario { duration: 30.0, seed, ..one_filter(FilterKind::EKF) };
        scenario.set_plant(plant.clone());
        let sensor_std = scenario.sensors.iter().map(|sensor| 2.0 * sensor.noise_std).collect();
        let filter = &mut scenario.filters[0];
        *filter = FilterSettings { kind, fading: 1.0, sensor_std, ..filter.clone() };
        (filter.adaptation.sensor_noise, filter.adaptation.forgetting) = (true, 0.99);
        change(&mut scenario);
        let true_std: Vec<f64> = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let estimates = &finished(&scenario).estimates()[0].clone();
        assert_eq!(estimates.stop(), None, "{kind:?} {plant:?} {seed}");
        counts.resize(true_std.len(), [0, 0]);
        for k in (1500..estimates.len()).step_by(250) {
            for (sensor, (count, truth)) in counts.iter_mut().zip(&true_std).enumerate() {
                let [std, spread] = estimates.sensor_noise(k, sensor).expect("the filter learns R");
                *count = [count[0] + usize::from((std - truth).abs() < 2.0 * spread), count[1] + 1];
            }
        }
    }
    counts.into_iter().map(|[inside, all]| inside as f64 / all as f64).collect()
}

#[test]
fn training_ends_and_what_was_learnt_stays() {
    for (kind, hold) in
        [(FilterKind::EKF, Hold::Zero), (FilterKind::UKF, Hold::First), (FilterKind::SR_UKF, Hold::Zero)]
    {
        let mut scenario = Scenario { duration: 20.0, hold, ..one_filter(kind) };
        let filter = &mut scenario.filters[0];
        filter.fading = 1.0;
        filter.sensor_std.iter_mut().for_each(|std| *std *= 3.0);
        (filter.adaptation.sensor_noise, filter.adaptation.process_noise) = (true, true);
        filter.adaptation.forgetting = 0.99;
        let always = filter.clone();
        (filter.id, filter.name, filter.adaptation.training) = (2, "trained".to_owned(), 8.0);
        scenario.filters.insert(0, always);
        let run = finished(&scenario);
        let [always, trained] = [0, 1].map(|place| &run.estimates()[place]);
        let noise = |of: &Estimates, k: usize| of.sensor_noise(k, 0).expect("it learns R");
        let far = |k: usize| (noise(always, k)[0] / noise(trained, k)[0] - 1.0).abs();
        assert!((0..=800).all(|k| far(k) == 0.0), "{kind:?}");
        assert!((801..=2000).all(|k| noise(trained, k) == noise(trained, 800)), "{kind:?}");
        assert!(far(2000) > 1e-3, "{kind:?}: the other one goes on");
    }
}

#[test]
fn two_sigma_after_a_training_hold_the_true_noise() {
    let trained = |scenario: &mut Scenario| {
        (scenario.filters[0].adaptation.training, scenario.filters[0].adaptation.forgetting) = (12.0, 0.995);
    };
    let shares = [(FilterKind::EKF, 1000..1200), (FilterKind::UKF, 1200..1400)]
        .map(|(kind, seeds)| coverage(kind, &PlantKind::SDOF, trained, seeds));
    // The learnt noise stays, so that each record counts once: three standard deviations of 200 and of 800 are 4.4 % and 2.2 %.
    let all: Vec<f64> = shares.into_iter().flatten().collect();
    let mean = mean(&all);
    assert!(all.iter().all(|share| *share >= 0.91) && (0.932..=0.976).contains(&mean), "{all:?}");
}

#[test]
fn two_sigma_of_learnt_noise_hold_the_true_one() {
    use {FilterKind as Kind, PlantKind as Plant};
    let one_sensor = |scenario: &mut Scenario| {
        scenario.set_sensors(&[Quantity::DISPLACEMENT]);
        scenario.filters[0].sensor_std = vec![0.5 * scenario.sensors[0].noise_std];
    };
    for (what, shares) in [
        ("EKF", coverage(Kind::EKF, &Plant::SDOF, |_| (), 0..200)),
        ("UKF", coverage(Kind::UKF, &Plant::SDOF, |_| (), 200..300)),
        ("held", coverage(Kind::EKF, &Plant::SDOF, |scenario| scenario.hold = Hold::First, 300..400)),
        ("slow", coverage(Kind::EKF, &Plant::SDOF, |s| s.filters[0].adaptation.forgetting = 0.995, 400..500)),
        ("Duffing", coverage(Kind::UKF, &Plant::DUFFING, |_| (), 500..560)),
        ("one sensor", coverage(Kind::EKF, &Plant::SDOF, one_sensor, 560..660)),
    ] {
        assert!(shares.iter().all(|share| (0.92..=0.98).contains(share)), "{what}: {shares:?}");
    }
}

fn scenario(seed: u64, wrong: f64) -> Scenario {
    let mut scenario = Scenario { duration: 40.0, seed, plant: oscillator(6.0, 0.05), ..one_filter(FilterKind::EKF) };
    scenario.plant.disturbance_std = 2.0;
    let (_, truth) = scenario.true_noise();
    let filter = &mut scenario.filters[0];
    (filter.fading, filter.process_scales) = (1.0, 17);
    for (channel, std) in truth.iter() {
        filter.process_std[channel] = wrong * std;
    }
    filter.adaptation.forgetting = 0.995;
    let sensor_std = scenario.true_noise_for(&scenario.filters[0]).0;
    scenario.filters[0].sensor_std = sensor_std;
    scenario
}

fn coverage_of_q(wrong: f64, seeds: std::ops::Range<u64>, change: impl Fn(&mut Scenario)) -> f64 {
    let (mut inside, mut all) = (0, 0);
    for seed in seeds {
        let mut scenario = scenario(seed, wrong);
        change(&mut scenario);
        let estimates = &finished(&scenario).estimates()[0].clone();
        assert_eq!(estimates.stop(), None, "{seed}");
        for k in (1500..estimates.len()).step_by(250) {
            let [mean, std] = estimates.process_scale(k).expect("it tells the scale");
            inside += usize::from((mean + wrong.ln()).abs() < 2.0 * std);
            all += 1;
        }
    }
    inside as f64 / f64::from(all)
}

#[test]
fn two_sigma_hold_the_true_process_noise() {
    let forget = |scenario: &mut Scenario, a: f64| scenario.filters[0].adaptation.forgetting = a;
    let known = |scenario: &mut Scenario| {
        let filter = &mut scenario.filters[0];
        (filter.kind, filter.initial_mean) = (FilterKind::KF, values([0.0, 0.0, 6.0, 0.05]));
    };
    let one_sensor = |scenario: &mut Scenario| {
        scenario.set_sensors(&[Quantity::VELOCITY]);
        scenario.filters[0].sensor_std = scenario.true_noise_for(&scenario.filters[0]).0;
    };
    let r_too = |scenario: &mut Scenario| {
        let filter = &mut scenario.filters[0];
        filter.adaptation.sensor_noise = true;
        filter.sensor_std.iter_mut().for_each(|std| *std *= 2.0);
    };
    for (what, share) in [
        ("EKF", coverage_of_q(0.2, 0..60, |_| ())),
        ("UKF", coverage_of_q(4.0, 100..160, |scenario| scenario.filters[0].kind = FilterKind::UKF)),
        ("KF", coverage_of_q(1.0, 200..260, known)),
        ("held", coverage_of_q(0.5, 300..360, |scenario| scenario.hold = Hold::First)),
        ("fast", coverage_of_q(2.0, 400..460, |scenario| forget(scenario, 0.98))),
        ("slow", coverage_of_q(3.0, 500..560, |scenario| forget(scenario, 0.999))),
        ("trained", coverage_of_q(0.3, 600..750, |scenario| scenario.filters[0].adaptation.training = 14.0)),
        ("Duffing", coverage_of_q(1.5, 800..860, |scenario| scenario.set_plant(PlantKind::DUFFING))),
        ("one sensor", coverage_of_q(0.7, 860..920, one_sensor)),
        ("R too", coverage_of_q(0.7, 960..1020, r_too)),
    ] {
        assert!((0.92..=0.98).contains(&share), "{what}: {share}");
    }
}

#[test]
fn estimates_are_those_of_a_filter_that_knows_q() {
    // The mean square of late errors of the natural frequency, and that in standard deviations.
    let of = |scales: usize, wrong: f64| {
        let (mut squares, mut in_std, mut count) = (0.0, 0.0, 0.0);
        for seed in 2000..2040 {
            let mut scenario = scenario(seed, wrong);
            scenario.filters[0].process_scales = scales;
            let estimates = &finished(&scenario).estimates()[0].clone();
            let place = estimates.place(Channel::NATURAL_FREQUENCY).expect("it is estimated");
            for k in (2000..estimates.len()).step_by(20) {
                let (error, std) = (estimates.mean(k)[place] - 6.0, estimates.std(k, place));
                squares += error * error;
                in_std += error * error / (std * std);
                count += 1.0;
            }
        }
        [squares / count, in_std / count]
    };
    let [bank, alone, wrong] = [of(17, 0.1), of(1, 1.0), of(1, 0.1)];
    assert!(bank[0] < 1.02 * alone[0] && wrong[0] > 1.05 * alone[0], "{bank:?} {alone:?} {wrong:?}");
    assert!(bank[1] < 1.1 * alone[1] && wrong[1] > 5.0 * alone[1], "{bank:?} {alone:?} {wrong:?}");
}

#[test]
fn readings_keep_their_times() {
    let scenario = scenario(7, 0.5);
    let run = finished(&scenario);
    let record = run.record().clone().without_truth();
    let again = finished_on(&scenario, with_times(&record, |_, k| k));
    let [one, other] = [&run, &again].map(|run| &run.estimates()[0]);
    for k in (0..one.len()).step_by(50) {
        let [[a, std], [b, _]] = [one, other].map(|of| of.process_scale(k).expect("it tells the scale"));
        assert!((a - b).abs() < 1e-6 * std, "{k}: {a} {b}");
        assert!(apart((other, k), (one, k)) < 1e-6, "{k}");
    }
}

#[test]
fn a_scale_beyond_the_last_one_is_told() {
    for (disturbance, is_told) in [(0.0, true), (2.0, false)] {
        let mut scenario = scenario(11, 1.0);
        scenario.plant.disturbance_std = disturbance;
        let run = finished(&scenario);
        let told = run.estimates()[0].remarks().iter().any(|remark| remark.what == Trouble::ScaleAtEnd);
        assert_eq!(told, is_told, "{disturbance}");
    }
}

#[test]
fn usual_noise_is_scaled_too() {
    let text =
        "duration = 20.0\nseed = 3\n[plant]\ndisturbance_std = 3.0\n[[filters]]\nkind = \"ekf\"\nprocess_scales = 9";
    let scenario = Scenario::from_toml(text).expect("it is a scenario");
    let estimates = &finished(&scenario).estimates()[0].clone();
    let [_, std] = estimates.process_scale(estimates.len() - 1).expect("it tells the scale");
    assert!(std < 0.5, "it is told by readings: {std}");
    let n = estimates.channels().len();
    for k in 0..estimates.len() {
        let cov = estimates.cov(k);
        assert!((0..n * n).all(|at| cov[at].to_bits() == cov[at % n * n + at / n].to_bits()), "{k}");
    }
}

#[test]
fn the_scale_of_q_is_known_where_all_of_q_has_one() {
    let mut scenario = Scenario::default();
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    let mut filter = scenario.filters[0].clone();
    assert_eq!(scenario.true_process_scale(&filter), None, "nothing shakes it");
    scenario.plant.disturbance_std = 2.0;
    assert_eq!(scenario.true_process_scale(&filter), None, "its parameters walk, and the true ones do not");
    filter.process_std = scenario.true_noise().1;
    assert_eq!(scenario.true_process_scale(&filter), Some(1.0));
    filter.process_std[Channel::VELOCITY] *= 0.1;
    assert_eq!(scenario.true_process_scale(&filter), None, "displacement and velocity differ");
    filter.process_std[Channel::DISPLACEMENT] = 0.0;
    let scale = scenario.true_process_scale(&filter).unwrap();
    assert!((scale - 10.0).abs() < 1e-9, "{scale}");
}
