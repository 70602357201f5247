//! Filters that widen P once where their innovations grow at once.

use kalmanscope_core::signal::Step;
use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Quantity, Run, Scenario, Sensor, Signal, Trouble,
};

use crate::numbers::rms;
use crate::run::{finished, last, oscillator, truth, values};

const NATURAL_FREQUENCY: Channel = Channel::NATURAL_FREQUENCY;
const DAMPING_RATIO: Channel = Channel::DAMPING_RATIO;

/// 40 s of an oscillator whose ωₙ steps from 6 to another value [rad/s] at 20 s, under white noise of a force.
fn stepping(seed: u64, to: f64, sensors: &[(Quantity, f64)]) -> Scenario {
    let wn = Signal::Step(Step { from: 6.0, to, at: 20.0 });
    let mut scenario = Scenario { seed, duration: 40.0, plant: oscillator(wn, 0.05), ..Scenario::default() };
    scenario.plant.disturbance_std = 0.5;
    scenario.sensors = sensors.iter().map(|&(measures, noise_std)| Sensor::new(measures, noise_std)).collect();
    scenario
}

const BOTH: [(Quantity, f64); 2] = [(Quantity::DISPLACEMENT, 0.01), (Quantity::VELOCITY, 0.06)];

fn filter(kind: FilterKind, sensors: &[(Quantity, f64)]) -> FilterSettings {
    FilterSettings {
        kind,
        sensor_std: sensors.iter().map(|(_, noise)| *noise).collect(),
        initial_mean: values([0.0, 0.0, 6.6, 0.07]),
        initial_std: values([0.05, 0.3, 1.2, 0.03]),
        process_std: values([2.5e-5, 5e-3, 6e-6, 5e-8]),
        ..FilterSettings::default()
    }
}

/// Of the natural frequency [rad/s].
fn errors(run: &Run, place: usize) -> Vec<f64> {
    let (estimates, truth) = (&run.estimates()[place], truth(run.record(), NATURAL_FREQUENCY));
    let of = estimates.place(NATURAL_FREQUENCY).unwrap();
    (0..estimates.len()).map(|k| estimates.canonical_mean(k, of) - truth[k]).collect()
}

fn jump_times(estimates: &Estimates) -> Vec<usize> {
    estimates.jumps().collect()
}

#[test]
fn the_error_is_below_two_thirds_and_the_lag_a_fifth_of_that_of_fading() {
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        let (mut before, mut after, mut lags, mut within) = ([0.0; 2], [0.0; 2], [Vec::new(), Vec::new()], 0);
        for seed in 301..313 {
            let to = if seed % 2 == 0 { 4.8 } else { 7.5 };
            let mut scenario = stepping(seed, to, &BOTH);
            let settings = filter(kind, &BOTH);
            scenario.filters = vec![
                FilterSettings { fading: 1.005, ..settings.clone() },
                FilterSettings { jump: true, ..settings.clone() },
                settings,
            ];
            let run = finished(&scenario);
            let [_, jumping, plain] = run.estimates() else { panic!("three filters") };
            let jumps = jump_times(jumping);
            let is_right = jumps.first().is_some_and(|k| (2010..2300).contains(k)) && jumps.len() < 3;
            assert!(is_right, "{kind:?}, seed {seed}: {jumps:?}");
            assert!(jump_times(plain).is_empty());
            // Until then the filter is the one without a jump, bit by bit.
            assert!((0..jumps[0]).all(|k| jumping.mean(k) == plain.mean(k) && jumping.cov(k) == plain.cov(k)));
            for place in 0..2 {
                let errors = errors(&run, place);
                before[place] += rms(&errors[1500..2000]).powi(2);
                after[place] += rms(&errors[3500..4000]).powi(2);
                let last_off = errors[2000..].iter().rposition(|error| error.abs() > 0.05 * to);
                lags[place].push(last_off.map_or(0.0, |k| 0.01 * (k + 1) as f64));
            }
            let is_within = |channel: Channel| {
                let (mean, std) = last(jumping, channel);
                (mean - truth(run.record(), channel)[jumping.len() - 1]).abs() < 3.0 * std
            };
            within += usize::from(is_within(NATURAL_FREQUENCY) && is_within(DAMPING_RATIO));
        }
        let [slow, quick] = lags.map(|mut lags: Vec<f64>| {
            lags.sort_by(f64::total_cmp);
            lags[lags.len() / 2]
        });
        let ratios = [before[1] / before[0], after[1] / after[0]].map(f64::sqrt);
        assert!(ratios[0] < 0.65 && ratios[1] < 0.7, "{kind:?}: {ratios:?}");
        assert!(quick < 0.2 * slow, "{kind:?}: {quick} of {slow}");
        assert!(within >= 11, "{kind:?}: within 3σ {within}");
    }
}

#[test]
fn a_well_tuned_filter_never_jumps() {
    let sets: [&[(Quantity, f64)]; 3] =
        [&BOTH[..1], &BOTH, &[(Quantity::DISPLACEMENT, 0.01), (Quantity::VELOCITY, 0.2)]];
    for seed in 401..411 {
        for sensors in sets {
            let mut scenario = stepping(seed, 6.0, sensors);
            let of = |kind| FilterSettings { jump: true, ..filter(kind, sensors) };
            scenario.filters = [FilterKind::EKF, FilterKind::UKF].map(of).to_vec();
            for estimates in finished(&scenario).estimates() {
                assert!(jump_times(estimates).is_empty(), "seed {seed}, {sensors:?}, {:?}", estimates.kind);
            }
        }
    }
}

#[test]
fn a_small_change_is_found_and_a_wrong_r_does_not_make_a_filter_jump_over_and_over() {
    for seed in 501..506 {
        let mut scenario = stepping(seed, 5.7, &BOTH);
        let settings = FilterSettings { jump: true, ..filter(FilterKind::EKF, &BOTH) };
        let wrong = FilterSettings { sensor_std: vec![0.005, 0.03], ..settings.clone() };
        scenario.filters = vec![settings, wrong];
        let run = finished(&scenario);
        let jumps = jump_times(&run.estimates()[0]);
        assert!(jumps.first().is_some_and(|k| (2010..3000).contains(k)), "seed {seed}: {jumps:?}");
        let jumps = jump_times(&run.estimates()[1]);
        assert!(jumps.iter().filter(|k| **k < 2000).count() <= 1 && jumps.len() <= 3, "seed {seed}: {jumps:?}");
    }
}

#[test]
fn every_kind_jumps_and_says_when() {
    let mut scenario = stepping(601, 4.5, &BOTH);
    let kinds = FilterKind::ALL.into_iter().filter(|kind| *kind != FilterKind::KF);
    let of = |kind| FilterSettings { jump: true, ensemble_size: 300, ..filter(kind, &BOTH) };
    scenario.filters = kinds.map(of).collect();
    for estimates in finished(&scenario).estimates() {
        let (kind, jumps) = (estimates.kind, jump_times(estimates));
        assert!(jumps.iter().any(|k| (2010..2150).contains(k)), "{kind:?}: {jumps:?}");
        let first = jumps[0];
        let remark = estimates.remarks().iter().find(|remark| remark.what == Trouble::Widened).unwrap();
        assert_eq!((remark.sample, remark.last), (first, first));
        let place = estimates.place(NATURAL_FREQUENCY).unwrap();
        assert!(estimates.std(first, place) > 2.0 * estimates.std(first - 1, place), "{kind:?}");
    }
}

#[test]
fn hindsight_jumps_with_its_filter() {
    let mut scenario = stepping(603, 4.8, &BOTH);
    let settings = FilterSettings { smoother: true, ..filter(FilterKind::EKF, &BOTH) };
    scenario.filters = vec![FilterSettings { jump: true, ..settings.clone() }, settings];
    let smoothed = finished(&scenario).smoothed();
    let at = |place: usize, k: usize| {
        let of = smoothed[place].place(NATURAL_FREQUENCY).unwrap();
        (smoothed[place].mean(k)[of], smoothed[place].std(k, of))
    };
    for (k, truth) in [(1000, 6.0), (1900, 6.0), (2300, 4.8), (3500, 4.8)] {
        let (mean, std) = at(0, k);
        assert!((mean - truth).abs() < 4.0 * std && std < 0.03, "{mean} ± {std} at {k}");
        assert!((at(1, k).0 - truth).abs() > 10.0 * at(1, k).1, "the one without a jump is wrong at {k}");
    }
}

#[test]
fn a_jump_is_written_where_it_is_asked_for_and_a_kalman_filter_may_widen_a_gain() {
    let gain = "[[filters]]\nkind = \"kf\"\njump = true\naugment = [\"input_gain\"]";
    assert!(Scenario::from_toml(gain).unwrap().filters[0].jump);
    let written = Scenario::from_toml("[[filters]]\njump = true").unwrap().to_toml().unwrap();
    assert!(written.contains("jump = true"));
    assert!(!Scenario::default().to_toml().unwrap().contains("jump"), "what is not said is not written");
}
