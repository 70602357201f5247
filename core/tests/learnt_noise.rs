//! Noise that a filter learns, and what it knows about it.

use kalmanscope_core::{FilterKind, FilterSettings, Hold, PlantKind, Quantity, Run, Scenario};

/// The share of late samples of many records at which ±2σ of the learnt noise holds the true one, of each sensor.
fn coverage(
    kind: FilterKind,
    plant: PlantKind,
    change: impl Fn(&mut Scenario),
    seeds: std::ops::Range<u64>,
) -> Vec<f64> {
    let mut counts = Vec::new();
    for seed in seeds {
        let mut scenario = Scenario { duration: 30.0, seed, ..Scenario::default() };
        scenario.filters.truncate(1);
        scenario.set_plant(plant);
        let true_std: Vec<f64> = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let sensor_std = true_std.iter().map(|std| 2.0 * std).collect();
        let filter = &mut scenario.filters[0];
        *filter = FilterSettings { kind, fading: 1.0, sensor_std, ..filter.clone() };
        (filter.adaptation.sensor_noise, filter.adaptation.forgetting) = (true, 0.99);
        change(&mut scenario);
        let true_std: Vec<f64> = scenario.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let mut run = Run::new(&scenario).expect("it can be run");
        run.finish();
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
