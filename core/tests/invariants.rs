//! Invariants of every valid scenario.

use kalmanscope_core::scenario::Motion;
use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{
    Aspect, Channel, Estimates, FilterKind, FilterSettings, Force, Plant, Quantity, Scenario, Sensor, Signal, Values,
    simulate,
};

use proptest::prelude::*;

use crate::numbers::beliefs;
use crate::run::{cases, finished, finished_on, oscillator, shrinking, values};

fn size(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    exponents.prop_map(|e| 10_f64.powf(e))
}

fn zero_or(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 3 => size(exponents)]
}

fn signal(low: f64, high: f64) -> impl Strategy<Value = Signal> {
    let value = move || low..high;
    prop_oneof![
        value().prop_map(Signal::Constant),
        (value(), value(), 0.0..2.0).prop_map(|(from, to, at)| Signal::Step(Step { from, to, at })),
        (value(), value(), 0.0..1.0, 0.0..1.0)
            .prop_map(|(from, to, start, more)| { Signal::Ramp(Ramp { from, to, start, end: start + more }) }),
        (value(), 0.0..0.99, 0.1..5.0).prop_map(move |(mean, part, period)| {
            Signal::Sine(Sine { mean, amplitude: part * (mean - low), period })
        }),
    ]
}

fn force() -> impl Strategy<Value = Force> {
    let amplitude = || prop_oneof![Just(0.0), size(-2.0..3.0), size(-2.0..3.0).prop_map(|a| -a)];
    prop_oneof![
        Just(Force::None),
        zero_or(-2.0..3.0).prop_map(|std| Force::WhiteNoise { std }),
        (amplitude(), 0.0..50.0).prop_map(|(amplitude, frequency)| Force::Sine { amplitude, frequency }),
        (amplitude(), 0.0..50.0, 0.0..50.0, 0.1..5.0).prop_map(|(amplitude, from, to, sweep)| Force::Chirp {
            amplitude,
            from,
            to,
            sweep
        }),
        (amplitude(), 0.01..3.0).prop_map(|(impulse, period)| Force::ImpulseTrain { impulse, period }),
        (amplitude(), 0.0..2.0).prop_map(|(amplitude, at)| Force::Step { amplitude, at }),
    ]
}

fn sensors() -> impl Strategy<Value = Vec<Sensor>> {
    proptest::sample::subsequence(Quantity::all()[..3].to_vec(), 0..=3).prop_flat_map(|quantities| {
        let sensor = |measures| zero_or(-5.0..1.0).prop_map(move |noise_std| Sensor::new(measures, noise_std));
        quantities.into_iter().map(sensor).collect::<Vec<_>>()
    })
}

fn plant() -> impl Strategy<Value = Plant> {
    let motion = (-1.0..1.0, -5.0..5.0).prop_map(|(displacement, velocity)| Motion { displacement, velocity });
    (signal(0.1, 60.0), signal(0.0, 2.0), motion, zero_or(-3.0..1.0)).prop_map(
        |(wn, zeta, initial, disturbance_std)| {
            let mut plant = oscillator(wn, zeta);
            (plant.initial, plant.disturbance_std) = (initial, disturbance_std);
            plant
        },
    )
}

fn per_channel<S: Strategy<Value = f64>>(of: impl Fn() -> S) -> impl Strategy<Value = Values> {
    [of(), of(), of(), of()].prop_map(values)
}

fn initial_mean() -> impl Strategy<Value = Values> {
    [-1.0..1.0, -5.0..5.0, -5.0..80.0, -1.0..3.0].prop_map(values)
}

fn filter(sensors: usize) -> impl Strategy<Value = FilterSettings> {
    (
        proptest::sample::select(FilterKind::ALL.to_vec()),
        prop_oneof![Just(1.0), 1.0..1.5],
        (prop_oneof![Just(0.0), 0.0..2.0], prop_oneof![3 => Just(0.0), 1 => 0.0..2.0]),
        proptest::collection::vec(size(-5.0..2.0), sensors),
        initial_mean(),
        per_channel(|| zero_or(-6.0..2.0)),
        per_channel(|| zero_or(-9.0..0.0)),
    )
        .prop_map(|(kind, fading, (eta, walk), sensor_std, initial_mean, initial_std, process_std)| {
            FilterSettings {
                name: format!("any {}", kind.name()),
                kind,
                fading,
                walk: if kind.is_sampled() || kind == FilterKind::KF { 0.0 } else { walk },
                eta,
                sensor_std,
                initial_mean,
                initial_std,
                process_std,
                ensemble_size: 20,
                ..FilterSettings::default()
            }
        })
}

fn scenario() -> impl Strategy<Value = Scenario> {
    let basics = (0..1_u64 << 62, size(-3.0..-0.7), 1_u32..250);
    (basics, plant(), force(), sensors()).prop_flat_map(|((seed, dt, steps), plant, force, sensors)| {
        proptest::collection::vec(filter(sensors.len()), 0..4).prop_map(move |filters| Scenario {
            seed,
            dt,
            duration: f64::from(steps) * dt,
            plant: plant.clone(),
            force,
            sensors: sensors.clone(),
            filters,
            ..Scenario::default()
        })
    })
}

fn check_estimates(estimates: &Estimates, samples: usize) -> Result<(), TestCaseError> {
    prop_assert_eq!(estimates.len(), estimates.stop().map_or(samples, |stop| stop.sample));
    prop_assert!(!estimates.is_empty());
    prop_assert_eq!(estimates.determinant().len(), estimates.len());
    for k in 0..estimates.len() {
        prop_assert!(estimates.mean(k).iter().all(|x| x.is_finite()), "mean at {}", k);
        let cov = estimates.cov(k);
        for i in 0..4 {
            prop_assert!(estimates.std(k, i).is_finite(), "variance {} of {} at {}", cov[5 * i], i, k);
            for j in 0..4 {
                prop_assert!(cov[4 * i + j].is_finite());
                prop_assert_eq!(cov[4 * i + j].to_bits(), cov[4 * j + i].to_bits(), "cov {} {} at {}", i, j, k);
            }
        }
        let nis = estimates.nis()[k];
        prop_assert!(nis >= 0.0 || nis.is_nan(), "NIS {} at {}", nis, k);
        prop_assert_eq!(nis.is_nan(), estimates.innovation(k).iter().all(|e| e.is_nan()), "NIS {} at {}", nis, k);
        prop_assert_eq!(nis.is_nan(), k == 0 || estimates.sensors().is_empty(), "NIS {} at {}", nis, k);
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(20_240_607, 400))]

    #[test]
    fn beliefs_are_normal_distributions_until_a_filter_stops(scenario in scenario()) {
        let run = finished(&scenario);
        prop_assert_eq!(run.len(), scenario.samples());
        prop_assert_eq!(run.estimates().len(), scenario.filters.len());
        for estimates in run.estimates() {
            check_estimates(estimates, scenario.samples())?;
        }
    }

    #[test]
    fn known_channels_stay_exact(mut scenario in scenario(), which in 1_usize..4) {
        let known = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
        let known = match which { 1 => &known[..1], 2 => &known[1..], _ => &known[..] };
        for filter in &mut scenario.filters {
            filter.eta = 0.0;
            for &channel in known {
                filter.initial_std[channel] = 0.0;
                filter.process_std[channel] = 0.0;
            }
        }
        for (estimates, filter) in finished(&scenario).estimates().iter().zip(&scenario.filters) {
            for &channel in known {
                let place = estimates.place(channel).unwrap();
                for k in 0..estimates.len() {
                    prop_assert_eq!(estimates.mean(k)[place].to_bits(), filter.initial_mean[channel].to_bits());
                    prop_assert_eq!(estimates.std(k, place), 0.0);
                }
            }
        }
    }

    #[test]
    fn a_sensor_that_is_always_missing_is_no_sensor(mut scenario in scenario(), which in 0_usize..3) {
        // A bank weighs its filters by NIS and det S, whose last digits depend on the number of sensors.
        scenario.filters.iter_mut().for_each(|filter| filter.walk = 0.0);
        scenario.add_sensor(Sensor::new(Quantity::VELOCITY, 0.1));
        let which = which % scenario.sensors.len();
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

    #[test]
    fn a_missing_measurement_skips_its_sensor_only(scenario in scenario(), every in 2_usize..5) {
        let missing = |sensor: usize, k: usize| (k + sensor).is_multiple_of(every);
        let gaps = simulate(&scenario).with_gaps(missing);
        let run = finished_on(&scenario, gaps);
        for estimates in run.estimates() {
            for k in 1..estimates.len() {
                for (sensor, innovation) in estimates.innovation(k).iter().enumerate() {
                    prop_assert_eq!(innovation.is_nan(), missing(sensor, k));
                    let gain = &estimates.gain(k)[4 * sensor..4 * sensor + 4];
                    prop_assert!(!missing(sensor, k) || gain == [0.0; 4]);
                }
            }
        }
    }

    #[test]
    fn a_file_gives_the_scenario_back(mut scenario in scenario()) {
        scenario.number_filters();
        let text = scenario.to_toml().unwrap();
        prop_assert_eq!(Scenario::from_toml(&text), Ok(scenario), "{}", text);
    }

    #[test]
    fn fading_by_one_is_no_fading(scenario in scenario()) {
        let text = scenario.to_toml().unwrap();
        let line_with_fading = |line: &&str| line.starts_with("fading = ");
        prop_assert_eq!(text.lines().filter(line_with_fading).count(), scenario.filters.len());
        let without: Vec<&str> = text.lines().filter(|line| !line_with_fading(line)).collect();
        let default = Scenario::from_toml(&without.join("\n")).unwrap();
        let mut explicit = scenario;
        explicit.filters.iter_mut().for_each(|filter| filter.fading = 1.0);
        prop_assert_eq!(finished(&default).checksum(), finished(&explicit).checksum());
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
        let noise = |q| match q {
            q if q == Quantity::DISPLACEMENT => 0.01,
            q if q == Quantity::VELOCITY => 0.06,
            _ => 0.5,
        };
        let mut scenario = Scenario { seed, plant: oscillator(wn, zeta), ..Scenario::default() };
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

#[test]
fn rounding_makes_no_variance_negative() {
    for kind in FilterKind::ALL {
        let scenario = shrinking(kind);
        let estimates = &finished(&scenario).estimates()[0].clone();
        assert!(estimates.len() > 15, "{}", kind.name());
        for k in 0..estimates.len() {
            assert!((0..4).all(|i| estimates.std(k, i).is_finite()), "{} at {k}: {:?}", kind.name(), estimates.cov(k));
        }
    }
}
