use kalmanscope_core::{
    Channel, CramerRao, FilterKind, FilterSettings, PlantKind, Quantity, Run, Scenario, Task as _, Values, simulate,
};
use kalmanscope_lab::next_sensor::{DURATIONS, SensorForecast, SensorPlan, SensorRow, WHOLE};
use kalmanscope_lab::{in_parts, processors};

/// A filter that neither forgets nor lets anything walk: its errors have the bound once it has settled.
fn scenario(plant: PlantKind, measured: &[Quantity], kind: FilterKind, duration: f64) -> Scenario {
    let mut scenario = Scenario { duration, ..Scenario::default() };
    scenario.filters = vec![FilterSettings { kind, ..FilterSettings::default() }];
    scenario.set_plant(plant);
    scenario.set_sensors(measured);
    if scenario.plant.kind == PlantKind::SDOF {
        scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    }
    scenario.filters[0].process_std = Values::ZERO;
    scenario
}

fn forecast(plan: &SensorPlan, scenario: &Scenario) -> SensorForecast {
    plan.clone().forecast(scenario, 0).unwrap().run()
}

/// The root mean square errors and σ of 200 runs after the whole and the double duration, whose inputs are not those of the forecast;
/// without the few runs that the filter loses, from 8σ on.
fn errors_and_bands(scenario: &Scenario, channels: &[Channel], stds: &[&f64]) -> Vec<[f64; 2]> {
    let ends = DURATIONS.map(|factor| (factor * scenario.duration / scenario.dt).round() as usize);
    let seeds: Vec<u64> = (1001..=1200).collect();
    let of_seed = |seed: &u64| {
        let mut run =
            Run::new(&Scenario { seed: *seed, duration: 2.0 * scenario.duration, ..scenario.clone() }).unwrap();
        run.finish();
        let (estimates, record) = (&run.estimates()[0], run.record());
        let of = |k: usize, channel: Channel| {
            let place = estimates.place(channel).unwrap();
            let error = estimates.canonical_mean(k, place) - record.truth(channel).unwrap()[k];
            [error, estimates.std(k, place)]
        };
        ends[WHOLE..].iter().flat_map(|k| channels.iter().map(|channel| of(*k, *channel))).collect::<Vec<_>>()
    };
    let all = in_parts(&seeds, processors(), 1, |seeds| seeds.iter().flat_map(of_seed).collect());
    let rms = |(at, std): (usize, &&f64)| {
        let own = all.iter().skip(at).step_by(stds.len()).filter(|[error, _]| error.abs() < 8.0 * **std);
        let count = own.clone().count();
        assert!(count >= 197, "{count}");
        [0, 1].map(|of| (own.clone().map(|pair| pair[of] * pair[of]).sum::<f64>() / count as f64).sqrt())
    };
    stds.iter().enumerate().map(rms).collect()
}

/// The shares of forecasts within 10 % of the filters' σ, of those within 10 % of their errors, and of pairs of choices that differ by more
/// than 10 % whose order is right.
fn shares_right(scenario: &Scenario) -> [f64; 3] {
    let plan = SensorPlan::default();
    let forecast = forecast(&plan, scenario);
    let of = |row: &SensorRow| {
        let with = row.sensor.map_or(scenario.clone(), |sensor| plan.with(sensor, scenario));
        let stds: Vec<&f64> = row.std[WHOLE..].iter().flatten().collect();
        let found = errors_and_bands(&with, &forecast.channels, &stds);
        stds.into_iter().zip(found).map(|(std, [error, band])| [*std, error, band]).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<[f64; 3]>> = forecast.rows.iter().map(of).collect();
    let close = |to: usize| rows.iter().flatten().map(|all| (all[to] / all[0] - 1.0).abs() < 0.1).collect::<Vec<_>>();
    let pairs = rows.iter().enumerate().flat_map(|(place, one)| rows[..place].iter().map(move |other| (one, other)));
    let ratios = pairs.flat_map(|(one, other)| one.iter().zip(other).map(|(a, b)| [a[0] / b[0], a[1] / b[1]]));
    let differing = ratios.filter(|[forecast, _]| forecast.ln().abs() > 0.1);
    let ordered: Vec<bool> = differing.map(|[forecast, error]| (forecast > 1.0) == (error > 1.0)).collect();
    [close(2), close(1), ordered].map(|right| right.iter().filter(|right| **right).count() as f64 / right.len() as f64)
}

#[test]
fn the_present_sensors_have_the_mean_of_their_bounds_and_a_kalman_filter_the_riccati_equation() {
    for kind in [FilterKind::EKF, FilterKind::KF] {
        let scenario = scenario(PlantKind::SDOF, &[Quantity::DISPLACEMENT], kind, 3.0);
        let forecast = forecast(&SensorPlan::default(), &scenario);
        let bound = |seed: u64| {
            let record = simulate(&Scenario { seed, ..scenario.clone() });
            let mut bound = CramerRao::new(&scenario, 0, scenario.dt).unwrap();
            assert!(bound.follow_to(record.len(), &record));
            forecast.channels.iter().map(|channel| bound.std(300, bound.place(*channel).unwrap())).collect::<Vec<_>>()
        };
        let bounds: Vec<Vec<f64>> = (1..=forecast.inputs).map(bound).collect();
        for (place, now) in forecast.now.iter().enumerate() {
            let mean = bounds.iter().map(|std| std[place] * std[place]).sum::<f64>() / bounds.len() as f64;
            assert_eq!(*now, mean.sqrt());
            assert_eq!(*now, forecast.rows[0].std[WHOLE][place]);
        }
        if kind == FilterKind::KF {
            // Its covariance depends on no reading, and its errors have it.
            assert_eq!((forecast.inputs, &forecast.channels[..]), (1, &[Channel::DISPLACEMENT, Channel::VELOCITY][..]));
        } else {
            assert_eq!(forecast.channels.len(), 2);
            assert!((32..=256).contains(&forecast.inputs), "{}", forecast.inputs);
        }
    }
}

#[test]
fn a_forecast_has_the_same_bits_however_it_is_divided() {
    let scenario = scenario(PlantKind::SDOF, &[Quantity::DISPLACEMENT], FilterKind::EKF, 2.0);
    for rate in [0.5, 2.0] {
        let plan = SensorPlan { rate, ..SensorPlan::default() };
        let whole = forecast(&plan, &scenario);
        let mut divided = plan.forecast(&scenario, 0).unwrap();
        let mut pieces = 0;
        while !divided.advance(&mut || false) {
            pieces += 1;
        }
        assert!(pieces > 100, "{pieces}");
        assert_eq!(divided.finish(), whole);
    }
}

#[test]
fn more_readings_and_longer_records_narrow_and_a_faster_rate_is_that_of_shorter_steps() {
    let mut scenario = scenario(PlantKind::SDOF, &[Quantity::DISPLACEMENT], FilterKind::KF, 3.0);
    scenario.plant.disturbance_std = 0.0;
    let stds =
        |rate: f64| forecast(&SensorPlan { rate, ..SensorPlan::default() }, &scenario).rows[0].std[WHOLE].clone();
    let of = [0.25, 0.5, 1.0, 2.0].map(stds);
    assert!(of.windows(2).all(|pair| pair[1][0] < pair[0][0]), "{of:?}");
    // A Kalman filter's covariance does not depend on the force, so that of a scenario with half the step is the same.
    let finer = Scenario { dt: 0.5 * scenario.dt, ..scenario.clone() };
    let finer = forecast(&SensorPlan::default(), &finer).now;
    for (one, other) in of[3].iter().zip(finer) {
        assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
    }
    let std = &forecast(&SensorPlan::default(), &scenario).rows[0].std;
    assert!(std.windows(2).all(|pair| pair[1][0] < pair[0][0]), "{std:?}");
}

#[test]
fn a_forecast_is_near_the_bands_and_errors_of_200_runs() {
    let scenario = scenario(PlantKind::SDOF, &[Quantity::DISPLACEMENT], FilterKind::EKF, 30.0);
    let [bands, close, ordered] = shares_right(&scenario);
    assert!(bands == 1.0 && close >= 0.8 && ordered == 1.0, "{bands} {close} {ordered}");
}

#[test]
fn the_band_of_a_filter_that_forgets_is_forecast_too() {
    let scenario = Scenario { duration: 20.0, ..Scenario::default() };
    assert!(scenario.filters[0].fading > 1.0);
    let [bands, ..] = shares_right(&scenario);
    assert!(bands >= 0.8, "{bands}");
}

#[test]
fn the_places_on_a_chain_are_forecast() {
    let kind = PlantKind::from_key("shear_3").unwrap();
    let third = Quantity::from_key("acceleration_3").unwrap();
    let mut chain = scenario(kind.clone(), &[Quantity::DISPLACEMENT, third], FilterKind::EKF, 20.0);
    for channel in kind.parameters() {
        let truth = chain.plant.parameter(channel).unwrap().at(0.0);
        chain.filters[0].initial_mean[channel] = 1.1 * truth;
        chain.filters[0].initial_std[channel] = 0.2 * truth;
    }
    let [bands, close, ordered] = shares_right(&chain);
    assert!(bands == 1.0 && close >= 0.8 && ordered >= 0.9, "{bands} {close} {ordered}");
}
