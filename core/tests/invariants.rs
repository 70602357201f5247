//! Properties of every valid scenario, and of every sensible filter.

use kalmanscope_core::{Aspect, Channel, FilterKind, PlantKind, Quantity, Scenario, Sensor, Trouble, simulate};
use proptest::prelude::*;
use proptest::test_runner::{Config as ProptestConfig, RngSeed};

use crate::health::{check_file, check_scenario, scenario_of};
use crate::numbers::beliefs;
use crate::run::{finished, finished_on, oscillator, shrinking};

/// The same random cases every time, so that a failure is reproducible.
pub(crate) fn cases(seed: u64, cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Default::default() }
}

/// Any scenario of the generator, and how many of 256 readings it lacks.
fn any_scenario() -> impl Strategy<Value = (Scenario, u8)> {
    proptest::collection::vec(any::<u8>(), 400).prop_map(|bytes| scenario_of(&bytes))
}

proptest! {
    #![proptest_config(cases(20_240_607, 400))]

    #[test]
    fn beliefs_are_normal_distributions_until_a_filter_stops_and_a_file_gives_the_scenario_back((scenario, gap) in any_scenario()) {
        check_scenario(&scenario, gap).map_err(TestCaseError::fail)?;
        check_file(&scenario.to_toml().unwrap()).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn a_sensor_that_is_always_missing_is_no_sensor((mut scenario, _) in any_scenario(), which in 0_usize..4) {
        // A bank weighs its filters by NIS and det S, whose last digits depend on the number of sensors.
        scenario.filters.iter_mut().for_each(|filter| (filter.walk, filter.plant) = (0.0, None));
        scenario.set_plant(PlantKind::SDOF);
        let is_other = |sensor: &&Sensor| !Quantity::all()[..3].contains(&sensor.measures);
        let others: Vec<Quantity> = scenario.sensors.iter().filter(is_other).map(|sensor| sensor.measures).collect();
        others.into_iter().chain([Quantity::VELOCITY]).for_each(|quantity| scenario.remove_sensor(quantity));
        scenario.add_sensor(Sensor::new(Quantity::VELOCITY, 0.1));
        let which = which % scenario.sensors.len();
        // Noise whose square overflows stops a filter before the first reading.
        scenario.sensors[which].noise_std = scenario.sensors[which].noise_std.min(1.0);
        scenario.filters.iter_mut().for_each(|filter| filter.sensor_std[which] = filter.sensor_std[which].min(1.0));
        let record = simulate(&scenario);
        let gaps = record.clone().with_gaps(|sensor, _| sensor == which);
        let blind = finished_on(&scenario, gaps);
        let mut fewer = scenario.clone();
        fewer.remove_sensor(scenario.sensors[which].measures);
        let without = finished_on(&fewer, record);
        // Where any sensor reads more than the state, all are read by sigma points: the same but for rounding.
        let reads_rates = |scenario: &Scenario| {
            let is_of_state = [Aspect::DISPLACEMENT, Aspect::VELOCITY];
            scenario.sensors.iter().any(|sensor| !is_of_state.contains(&sensor.measures.aspect()))
        };
        for (a, b) in blind.estimates().iter().zip(without.estimates()) {
            if reads_rates(&scenario) == reads_rates(&fewer) {
                prop_assert_eq!(beliefs(a), beliefs(b));
                prop_assert_eq!(a.stop(), b.stop());
            }
            for k in 0..a.len().min(b.len()).min(5) {
                for i in 0..a.mean(k).len() {
                    let off = (a.mean(k)[i] - b.mean(k)[i]).abs();
                    prop_assert!(off <= 1e-6 * a.std(k, i).max(a.mean(k)[i].abs()), "{} of {}: {:e}", i, k, off);
                }
            }
            prop_assert!((0..a.len()).all(|k| a.innovation(k)[which].is_nan()));
        }
    }
}

proptest! {
    #![proptest_config(cases(20_240_607, 60))]

    #[test]
    fn sensible_filters_find_the_truth(
        seed in 0_u64..1000,
        wn in 2.0_f64..12.0,
        zeta in 0.02_f64..0.2,
        off in (0.7..1.4, 0.0..0.3),
        sensors in proptest::sample::subsequence(Quantity::all()[..3].to_vec(), 1..=3),
    ) {
        let mut scenario = Scenario { seed, plant: oscillator(wn, zeta), ..Scenario::default() };
        let noise = |q: Quantity| if q == Quantity::DISPLACEMENT { 0.01 } else if q == Quantity::VELOCITY { 0.06 } else { 0.5 };
        scenario.sensors = sensors.iter().map(|&q| Sensor::new(q, noise(q))).collect();
        for filter in &mut scenario.filters {
            filter.sensor_std = sensors.iter().map(|&q| noise(q)).collect();
            filter.initial_mean[Channel::NATURAL_FREQUENCY] = wn * off.0;
            filter.initial_mean[Channel::DAMPING_RATIO] = off.1;
        }
        for estimates in finished(&scenario).estimates() {
            prop_assert_eq!(estimates.stop(), None);
            let last = estimates.len() - 1;
            for (place, truth) in [(2, wn), (3, zeta)] {
                let error = estimates.mean(last)[place] - truth;
                prop_assert!(error.abs() < 6.0 * estimates.std(last, place), "{}: {}", estimates.name(), error);
            }
            prop_assert!((estimates.mean(last)[2] / wn - 1.0).abs() < 0.05);
        }
    }
}

/// A covariance that loses its rank is refused or remarked by each kind of filter.
#[test]
fn rounding_makes_no_variance_negative() {
    for kind in FilterKind::ALL {
        let scenario = shrinking(kind);
        check_scenario(&scenario, 0).unwrap_or_else(|what| panic!("{}: {what}", kind.name()));
        let run = finished(&scenario);
        let estimates = &run.estimates()[0];
        assert!(estimates.len() > 15, "{}", kind.name());
        let is_remarked = estimates.remarks().iter().any(|remark| matches!(remark.what, Trouble::Indefinite(..)));
        assert!(kind != FilterKind::EKF || is_remarked, "{:?}", estimates.remarks());
    }
}
