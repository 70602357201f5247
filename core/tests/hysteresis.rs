//! Bouc-Wen hysteresis of exponent 1: the benchmark of Noël and Schoukens (2016), identified from its record.

use std::sync::Arc;

use kalmanscope_core::plant::PlantKind;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Force, Identified, Quantity, Record, Run, Scenario, Sensor, Signal,
};

use crate::run::finished;

/// 8 s at 750 Hz of the benchmark: m = 2 kg, c = 10 N s/m, k = α = 5e4 N/m, β = 1e3, γ = 0.8, δ = -1.1, ν = 1, noise of
/// 8e-6 m, under a force of 50 N from 5 to 150 Hz, here white to 375 Hz.
fn benchmark(seed: u64) -> Record {
    let mut scenario = Scenario { seed, dt: 1.0 / 750.0, duration: 8.0, filters: vec![], ..Scenario::default() };
    scenario.set_plant(PlantKind::BOUC_WEN_1);
    scenario.force = Force::WhiteNoise { std: 40.0 };
    scenario.plant.disturbance_std = 0.0;
    for (channel, value) in [
        (Channel::NATURAL_FREQUENCY, 223.607),
        (Channel::DAMPING_RATIO, 0.01118),
        (Channel::POST_YIELD_RATIO, 0.5),
        (Channel::YIELD_BETA, 800.0),
        (Channel::YIELD_GAMMA, -1100.0),
    ] {
        scenario.plant.set(channel, Signal::Constant(value));
    }
    scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 8e-6)];
    finished(&scenario).record().clone()
}

/// The root mean square error of the free run of a filter's final model over another record [m].
fn free_run(run: &Run, place: usize, record: &Record) -> f64 {
    let scenario = run.scenario();
    let estimates = &run.estimates()[place];
    let model = Identified::at(scenario, &scenario.filters[place], estimates, estimates.len() - 1);
    let free = model.run(record, 0..record.len());
    free.fit(record, Quantity::DISPLACEMENT).map_or(f64::INFINITY, |fit| fit.rms)
}

#[test]
fn the_benchmark_is_identified_better_than_by_a_linear_oscillator() {
    for seed in 901..904 {
        let (record, other) = (benchmark(seed), benchmark(seed + 50));
        let mut scenario = scenario_for(&record);
        let settings = FilterSettings { id: 0, ..scenario.filters[0].clone() };
        let of = |name: &str, kind, plant| FilterSettings { name: name.to_owned(), kind, plant, ..settings.clone() };
        scenario.filters = vec![
            of("linear", FilterKind::EKF, None),
            of("one", FilterKind::UKF, Some(PlantKind::BOUC_WEN_1)),
            of("two", FilterKind::UKF, Some(PlantKind::BOUC_WEN)),
        ];
        scenario.number_filters();
        let scenario = suggest(&scenario, &record).scenario;
        for (filter, name) in scenario.filters.iter().zip(["linear", "one", "two"]) {
            println!("{name}: {:?}\n  ± {:?}", filter.initial_mean, filter.initial_std);
        }
        let mut run = Run::on_record(&scenario, Arc::new(record.clone())).unwrap();
        run.finish();
        let errors = [0, 1, 2].map(|place| free_run(&run, place, &other));
        let one = &run.estimates()[1];
        let last = one.mean(one.len() - 1);
        println!("seed {seed}: free run of linear, exponent 1, exponent 2 {errors:?} m; {last:.4?}, {:?}", one.stop());
        assert!(errors[1] < 0.5 * errors[0], "seed {seed}: {errors:?}");
    }
}
