//! Consistency over many runs: the mean NEES and NIS of 200 seeds are inside their χ² bounds for every filter and plant that
//! are claimed to be consistent, and errors are as small as they can be.
//!
//! Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4.2.

use kalmanscope_core::diagnostics::chi_squared;
use kalmanscope_core::filter::Normal;
use kalmanscope_core::{Channel, Diagnostics, FilterKind, FilterSettings, Pass, PlantKind, Scenario, Scores};

use crate::numbers::ADAPTIVE;
use crate::run::{bound, finished};
use crate::threads::on_two_threads;

const SEEDS: u64 = 200;

/// Limits NEES over its upper bound: filters that linearise are a little too sure, and those that sample err.
const APPROXIMATE: f64 = 1.25;

fn scenario(plant: &PlantKind, kind: FilterKind, seed: u64) -> Scenario {
    let mut scenario = Scenario { seed, duration: 6.0, dt: 0.02, ..Scenario::default() };
    scenario.plant.kind = plant.clone();
    scenario.plant.disturbance_std = 1.0;
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    let mut filter = FilterSettings { kind, fading: 1.0, ensemble_size: 400, ..FilterSettings::default() };
    (filter.sensor_std, filter.process_std) = scenario.true_noise();
    let mut normal = Normal::from_seed(seed + 77);
    for &channel in plant.channels() {
        let (truth, std) = match scenario.plant.parameter(channel) {
            Some(signal) => (signal.at(0.0), 0.05 * signal.at(0.0)),
            None if channel == Channel::HYSTERETIC_DISPLACEMENT => (0.0, 1e-4),
            None => (0.0, 1e-3),
        };
        // Motions begin at rest, and the filter knows it but for a trace.
        let drawn = if channel.is_parameter() && !filter.knows(channel) { std * normal.sample() } else { 0.0 };
        filter.initial_mean[channel] = truth + drawn;
        filter.initial_std[channel] = std;
        if filter.process_std[channel] == 0.0 && !channel.is_parameter() {
            filter.process_std[channel] = 1e-6;
        }
    }
    Scenario { filters: vec![filter], ..scenario }
}

/// Sums and degrees of freedom of NEES and NIS, and for each parameter the square of the last error over that of the bound.
fn outcome(plant: &PlantKind, kind: FilterKind, seed: u64) -> ([(f64, u32); 2], Vec<f64>) {
    let scenario = scenario(plant, kind, seed);
    let run = finished(&scenario);
    let (estimates, record) = (&run.estimates()[0], run.record());
    assert_eq!(estimates.stop(), None, "{} {} seed {seed}", plant.key(), kind.name());
    let last = estimates.len() - 1;
    let diagnostics = Diagnostics::new(estimates, record);
    let total = diagnostics.nees_within(last..last + 1);
    let mut scores = Scores::new(&Pass::history(&scenario, 0).unwrap(), record);
    Pass::new(&scenario, 0, record).unwrap().follow(record, usize::MAX, &mut scores.against(record));
    let bound = bound(&scenario, 0, record);
    let over = |(place, &channel): (usize, &Channel)| {
        let floor = bound.std(last, bound.place(channel)?);
        let error = estimates.canonical_mean(last, place) - record.truth(channel)?[last];
        (channel.is_parameter() && floor > 0.0 && estimates.std(last, place) > 0.0).then(|| (error / floor).powi(2))
    };
    let over_bound = estimates.channels().iter().enumerate().filter_map(over).collect();
    let nis = &scores.outcome().nis;
    ([(total.sum, total.degrees), (nis.sum, nis.degrees)], over_bound)
}

#[track_caller]
fn assert_consistent(plant: &PlantKind, kind: FilterKind, slack: f64) {
    let seeds: Vec<u64> = (1..=SEEDS).collect();
    let outcomes = on_two_threads(&seeds, |seed| outcome(plant, kind, *seed));
    let name = format!("{} {}", plant.key(), kind.name());
    for (place, what) in ["NEES", "NIS"].into_iter().enumerate() {
        let degrees: u32 = outcomes.iter().map(|(sums, _)| sums[place].1).sum();
        let level = outcomes.iter().map(|(sums, _)| sums[place].0).sum::<f64>() / f64::from(degrees);
        let quantile = |p| chi_squared::quantile(p, degrees).unwrap() / f64::from(degrees);
        let (low, high) = (quantile(0.0005), quantile(0.9995));
        let slack = if what == "NEES" { slack } else { 1.0 + 0.1 * (slack - 1.0) };
        assert!((low / slack..=high * slack).contains(&level), "{name}: mean {what} {level} outside {low} … {high}");
    }
    for place in 0..outcomes[0].1.len() {
        let ratio = (outcomes.iter().map(|(_, over_bound)| over_bound[place]).sum::<f64>() / SEEDS as f64).sqrt();
        // The bound is that of one trajectory, which the errors of a short record of a chain stay below on average.
        let least = if plant.masses() == 1 { 0.85 } else { 0.7 };
        assert!((least..1.35).contains(&ratio), "{name}: rms error of parameter {place} is {ratio} times the bound");
    }
}

#[test]
fn the_kalman_filter_and_those_that_linearise_or_have_sigma_points_are_consistent() {
    assert_consistent(&PlantKind::SDOF, FilterKind::KF, 1.0);
    for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::SHEAR_2] {
        for kind in ADAPTIVE {
            assert_consistent(&plant, kind, APPROXIMATE);
        }
    }
}

#[test]
fn an_ensemble_is_consistent() {
    assert_consistent(&PlantKind::SDOF, FilterKind::ENKF, 1.4);
}
