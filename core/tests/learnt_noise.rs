//! Noise that a filter learns, and what it knows about it.

use kalmanscope_core::{FilterKind, FilterSettings, Hold, PlantKind, Quantity, Scenario};

use crate::run::{finished, one_filter};

/// The share of late samples of many records at which ±2σ of the learnt noise holds the true one, of each sensor.
fn coverage(
    kind: FilterKind,
    plant: PlantKind,
    change: impl Fn(&mut Scenario),
    seeds: std::ops::Range<u64>,
) -> Vec<f64> {
    let mut counts = Vec::new();
    for seed in seeds {
        let mut scenario = Scenario { duration: 30.0, seed, ..one_filter(FilterKind::EKF) };
        scenario.set_plant(plant);
        let true_std: Vec<f64> = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let sensor_std = true_std.iter().map(|std| 2.0 * std).collect();
        let filter = &mut scenario.filters[0];
        *filter = FilterSettings { kind, fading: 1.0, sensor_std, ..filter.clone() };
        (filter.adaptation.sensor_noise, filter.adaptation.forgetting) = (true, 0.99);
        change(&mut scenario);
        let true_std: Vec<f64> = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let run = finished(&scenario);
        let estimates = &run.estimates()[0];
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

/// In training a filter learns as one that always does; then it works with what it has learnt.
#[test]
fn training_ends_and_what_was_learnt_stays() {
    for (kind, hold) in
        [(FilterKind::EKF, Hold::Zero), (FilterKind::UKF, Hold::First), (FilterKind::SR_UKF, Hold::Zero)]
    {
        let mut scenario = Scenario { duration: 20.0, hold, ..one_filter(FilterKind::EKF) };
        let filter = &mut scenario.filters[0];
        (filter.kind, filter.fading) = (kind, 1.0);
        filter.sensor_std.iter_mut().for_each(|std| *std *= 3.0);
        (filter.adaptation.sensor_noise, filter.adaptation.process_noise) = (true, true);
        filter.adaptation.forgetting = 0.99;
        let always = filter.clone();
        (filter.id, filter.name, filter.adaptation.training) = (2, "trained".to_owned(), 8.0);
        scenario.filters.insert(0, always);
        let run = finished(&scenario);
        let [always, trained] = [0, 1].map(|place| &run.estimates()[place]);
        let noise = |of: &kalmanscope_core::Estimates, k: usize| of.sensor_noise(k, 0).expect("it learns R");
        let far = |k: usize| (noise(always, k)[0] / noise(trained, k)[0] - 1.0).abs();
        assert!((0..=800).all(|k| far(k) == 0.0), "{kind:?}");
        assert!((801..=2000).all(|k| noise(trained, k) == noise(trained, 800)), "{kind:?}");
        assert!(far(2000) > 1e-3, "{kind:?}: the other one goes on");
    }
}

/// ±2σ of what a training has found hold the true noise as often as they say, on records that were not looked at.
#[test]
fn two_sigma_after_a_training_hold_the_true_noise() {
    let trained = |scenario: &mut Scenario| {
        (scenario.filters[0].adaptation.training, scenario.filters[0].adaptation.forgetting) = (12.0, 0.995);
    };
    let shares = [(FilterKind::EKF, 1000..1200), (FilterKind::UKF, 1200..1400)]
        .map(|(kind, seeds)| coverage(kind, PlantKind::SDOF, trained, seeds));
    println!("after training: {shares:?}");
    // What was learnt stays, so that each record counts once: three standard deviations of 200 and of 800 are 4.4 % and 2.2 %.
    let all: Vec<f64> = shares.into_iter().flatten().collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!(all.iter().all(|share| *share >= 0.91) && (0.932..=0.976).contains(&mean), "{all:?}");
}

#[test]
fn two_sigma_of_learnt_noise_hold_the_true_one() {
    for (what, shares) in [
        ("EKF", coverage(FilterKind::EKF, PlantKind::SDOF, |_| (), 0..200)),
        ("UKF", coverage(FilterKind::UKF, PlantKind::SDOF, |_| (), 200..300)),
        ("held", coverage(FilterKind::EKF, PlantKind::SDOF, |scenario| scenario.hold = Hold::First, 300..400)),
        ("slow", coverage(FilterKind::EKF, PlantKind::SDOF, |s| s.filters[0].adaptation.forgetting = 0.995, 400..500)),
        ("Duffing", coverage(FilterKind::UKF, PlantKind::DUFFING, |_| (), 500..560)),
        (
            "one sensor",
            coverage(
                FilterKind::EKF,
                PlantKind::SDOF,
                |scenario| {
                    scenario.set_sensors(&[Quantity::DISPLACEMENT]);
                    scenario.filters[0].sensor_std = vec![0.5 * scenario.sensors[0].noise_std];
                },
                560..660,
            ),
        ),
    ] {
        println!("{what}: {shares:?}");
        assert!(shares.iter().all(|share| (0.92..=0.98).contains(share)), "{what}: {shares:?}");
    }
}
