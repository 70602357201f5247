//! What a tenth of outliers in one sensor does to plain and to robust filters.

use kalmanscope_core::scenario::Fault;
use kalmanscope_core::{Channel, Diagnostics, FilterKind, FilterSettings, Quantity, Robust, Scenario, simulate};

use crate::numbers::{ADAPTIVE, rms};
use crate::run::{finished, finished_on, oscillator};

#[derive(Clone, Copy, Default)]
struct Sums {
    squares: [f64; 2],
    nees: f64,
    seeds: u32,
    /// Readings that were left out rightly, left out wrongly, kept wrongly.
    flags: [u32; 3],
}

fn scenario(seed: u64, kind: FilterKind, robust: Robust, is_clean: bool) -> Scenario {
    let filter = FilterSettings { kind, robust, ..FilterSettings::default() };
    let plant = oscillator(6.0, 0.05);
    let mut scenario = Scenario { seed, duration: 60.0, plant, filters: vec![filter], ..Scenario::default() };
    scenario.plant.disturbance_std = 0.3;
    // The filter's noise is true but for the outliers.
    let (sensor_std, process_std) = scenario.true_noise();
    (scenario.filters[0].sensor_std, scenario.filters[0].process_std) = (sensor_std, process_std);
    if !is_clean {
        scenario.sensors[0].faults.add(Fault::OUTLIERS, Quantity::DISPLACEMENT);
    }
    scenario
}

fn add(sums: &mut Sums, seed: u64, kind: FilterKind, robust: Robust, is_clean: bool) {
    let run = finished(&scenario(seed, kind, robust, is_clean));
    let clean = finished(&scenario(seed, kind, robust, true));
    let estimates = &run.estimates()[0];
    assert_eq!(estimates.stop(), None, "seed {seed}");
    let late = 2 * estimates.len() / 3..estimates.len();
    let truths = [(Channel::NATURAL_FREQUENCY, 6.0), (Channel::DAMPING_RATIO, 0.05)];
    for (square, (channel, truth)) in sums.squares.iter_mut().zip(truths) {
        let place = estimates.place(channel).expect("it is estimated");
        let errors = late.clone().map(|k| estimates.canonical_mean(k, place) - truth);
        *square += rms(&errors.collect::<Vec<_>>()).powi(2);
    }
    sums.nees += Diagnostics::new(estimates, run.record()).nees()[estimates.len() - 1];
    sums.seeds += 1;
    for k in late {
        let is_outlier = run.record().measured(0)[k] != clean.record().measured(0)[k];
        let is_left_out = estimates.innovation(k)[0].is_nan();
        let place = match (is_outlier, is_left_out) {
            (true, true) => 0,
            (false, true) => 1,
            (true, false) => 2,
            (false, false) => continue,
        };
        sums.flags[place] += 1;
    }
}

fn decides(robust: Robust) -> bool {
    [Robust::GATE, Robust::MIXTURE].contains(&robust)
}

fn judge(seeds: std::ops::RangeInclusive<u64>) {
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        let over = |robust: Robust, is_clean: bool| {
            let mut sums = Sums::default();
            seeds.clone().for_each(|seed| add(&mut sums, seed, kind, robust, is_clean));
            sums
        };
        let plain = over(Robust::NONE, true);
        let ratio = |sums: &Sums| [0, 1].map(|i| (sums.squares[i] / plain.squares[i]).sqrt());
        for robust in Robust::ALL {
            let (clean, sums) = (over(robust, true), over(robust, false));
            let [of_clean, with] = [&clean, &sums].map(ratio);
            let nees = [&clean, &sums].map(|sums| sums.nees / f64::from(sums.seeds));
            let [hit, wrong, missed] = sums.flags.map(f64::from);
            if !robust.is_on() {
                assert!(with[0] > 1.3, "the plain filter is misled: {with:?}");
                continue;
            }
            assert!(of_clean.iter().all(|ratio| *ratio <= LIMIT_CLEAN), "{robust:?}: {of_clean:?}");
            let limit = if decides(robust) { LIMIT_DECIDES } else { LIMIT };
            assert!(with.iter().all(|ratio| *ratio <= limit), "{robust:?}: {with:?}");
            // The mean of n NEES of four components has a standard deviation of √(8 / n).
            let right = plain.nees / f64::from(sums.seeds);
            assert!((right - 4.0).abs() < 3.0 * (8.0 / f64::from(sums.seeds)).sqrt(), "{right}");
            assert!(nees.iter().all(|nees| (nees - right).abs() < 0.8), "{robust:?}: {nees:?} for {right}");
            if decides(robust) {
                assert!(hit / (hit + wrong) >= 0.95 && hit / (hit + missed) >= 0.95, "{hit} {wrong} {missed}");
            }
        }
    }
}

/// Limits the late RMSE over the plain filter's on the clean record: a rule that decides errs until it knows the motion.
const LIMIT: f64 = 1.15;
const LIMIT_DECIDES: f64 = 1.3;
const LIMIT_CLEAN: f64 = 1.02;

#[test]
fn robust_filters_hold_where_a_tenth_of_the_readings_is_off() {
    judge(1..=20);
}

#[test]
fn robust_filters_over_two_hundred_seeds() {
    judge(3001..=3200);
}

#[test]
fn a_reading_that_counts_for_nothing_is_no_reason_to_stop() {
    for robust in Robust::ALL {
        for kind in ADAPTIVE {
            let mut filter = FilterSettings { kind, robust, ..FilterSettings::default() };
            let mut scenario = Scenario { duration: 20.0, filters: vec![filter.clone()], ..Scenario::default() };
            scenario.set_sensors(&[Quantity::DISPLACEMENT]);
            let std = scenario.sensors[0].noise_std;
            let far = |k: usize| if k > 1000 && k.is_multiple_of(50) { 30.0 * std } else { 0.0 };
            let record = simulate(&scenario).with_measured(|_, k, z| z + far(k));
            let estimates = &finished_on(&scenario, record).estimates()[0].clone();
            assert_eq!(estimates.stop(), None, "{kind:?} {robust:?}");
            // Nor is noise learnt from it.
            (filter.adaptation.process_noise, filter.sensor_std) = (true, vec![0.01, 0.06]);
            let learning = Scenario { duration: 20.0, filters: vec![filter], ..Scenario::default() };
            let far = |sensor, k: usize| if sensor == 0 && k.is_multiple_of(50) { 12.0 * std } else { 0.0 };
            let record = simulate(&learning).with_measured(|sensor, k, z| z + far(sensor, k));
            assert_eq!(finished_on(&learning, record).estimates()[0].stop(), None, "{kind:?} {robust:?}, learning");
            let left_out = (1001..estimates.len()).filter(|&k| estimates.innovation(k)[0].is_nan()).count();
            let expected = if robust.is_on() { 18..24 } else { 0..1 };
            assert!(expected.contains(&left_out), "{kind:?} {robust:?}: {left_out}");
        }
    }
}
