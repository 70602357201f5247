//! Random runs by the graphics processor beside the single filter of the core.

use crate::common::{Tally, gpu};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Force, Plant, Quantity, Scenario, Sensor, Signal, Values, simulate,
};
use kalmanscope_gpu::{LaneRun, serves};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};

const SCENARIOS: usize = 40;
const FILTERS: usize = 12;

const CHANNELS: [Channel; 4] =
    [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

fn values(of: [f64; 4]) -> Values {
    Values::ZERO.with(CHANNELS.into_iter().zip(of))
}

fn size(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    exponents.prop_map(|e| 10_f64.powf(e))
}

fn zero_or(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 5 => size(exponents)]
}

fn filter(kind: FilterKind, sensors: usize, [frequency, damping]: [f64; 2]) -> impl Strategy<Value = FilterSettings> {
    (
        prop_oneof![Just(1.0), 1.0..1.02],
        proptest::collection::vec(size(-2.0..-0.5), sensors),
        (-0.2..0.2, -0.5..0.5, 0.5..1.6, 0.0..0.2),
        [zero_or(-2.0..0.0), zero_or(-2.0..0.0), zero_or(-1.0..0.5), zero_or(-2.0..-0.5)],
        [zero_or(-5.0..-2.0), zero_or(-4.0..-1.0), zero_or(-6.0..-3.0), zero_or(-7.0..-4.0)],
        -3..4,
    )
        .prop_map(move |(fading, sensor_std, (x, v, wn, zeta), initial_std, process_std, input_delay)| {
            let is_known = kind == FilterKind::KF;
            let known = |[x, v, wn, zeta]: [f64; 4]| if is_known { [x, v, 0.0, 0.0] } else { [x, v, wn, zeta] };
            FilterSettings {
                kind,
                fading,
                sensor_std,
                initial_mean: values(if is_known { [x, v, frequency, damping] } else { [x, v, wn * frequency, zeta] }),
                initial_std: values(known(initial_std)),
                process_std: values(known(process_std)),
                input_delay,
                ..FilterSettings::default()
            }
        })
}

fn ensemble() -> impl Strategy<Value = Scenario> {
    let quantities = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];
    (
        proptest::sample::subsequence(quantities.to_vec(), 1..=3).prop_shuffle(),
        proptest::sample::select(vec![FilterKind::KF, FilterKind::EKF, FilterKind::UKF]),
        (0..1_u64 << 40, 0.005..0.03, 200_u32..1200),
        (3.0..12.0, 0.01..0.2, 0.5..5.0),
    )
        .prop_flat_map(|(measured, kind, (seed, dt, steps), (wn, zeta, force))| {
            let filters = proptest::collection::vec(filter(kind, measured.len(), [wn, zeta]), FILTERS);
            filters.prop_map(move |filters| Scenario {
                seed,
                dt,
                duration: f64::from(steps) * dt,
                plant: Plant::default()
                    .with(CHANNELS[2], Signal::Constant(wn))
                    .with(CHANNELS[3], Signal::Constant(zeta)),
                force: Force::WhiteNoise { std: force },
                sensors: measured.iter().map(|&measures| Sensor::new(measures, 0.02)).collect(),
                filters,
                ..Scenario::default()
            })
        })
}

fn tally(seed: u64) -> Tally {
    let config = Config { rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Config::default() };
    let mut source = TestRunner::new(config);
    let mut tally = Tally::default();
    for nth in 0..SCENARIOS {
        let scenario = ensemble().new_tree(&mut source).unwrap().current();
        let gap = nth % 4;
        let is_missing = |sensor: usize, k: usize| k.wrapping_mul(2_654_435_761 + 977 * sensor) >> 3 & 7 < gap;
        let record = simulate(&scenario).with_gaps(is_missing);
        let record = if nth % 5 > 0 { record } else { record.without_truth() };
        let runs: Vec<LaneRun<'_>> =
            (0..FILTERS).map(|place| LaneRun { scenario: &scenario, place, record: &record }).collect();
        assert!(runs.iter().all(serves), "{scenario:?}");
        let outcomes = pollster::block_on(gpu().outcomes(&runs, &|| true)).unwrap();
        for (place, outcome) in outcomes.iter().enumerate() {
            let exact = Outcome::at(&scenario, place, &record, &[]).unwrap();
            let frequency = scenario.plant.parameter(CHANNELS[2]).unwrap().at(0.0);
            let near = |outcome: &Outcome| (outcome.mean[2].abs() - frequency).abs() <= 0.05 * frequency;
            let class = |outcome: &Outcome| (outcome.stop.is_some(), outcome.diverged, near(outcome));
            tally.take([outcome.as_ref().unwrap(), &exact], class, |class| class == (false, false, true));
        }
    }
    tally
}

/// The limits were chosen on the seeds 1 to 3.
#[test]
fn random_runs_are_the_single_filters() {
    let Tally { runs, same, kept: converged, close, worst: (worst, score), .. } = tally(11);
    println!(
        "of {runs} runs {same} of the same class; of {converged} converged {close} close, the worst by {worst:.1e}: {score}"
    );
    assert_eq!(runs, SCENARIOS * FILTERS);
    assert!(same as f64 >= 0.99 * runs as f64);
    assert!(converged > runs / 3 && close as f64 >= 0.97 * converged as f64);
}

#[test]
fn a_filter_that_overflows_stops() {
    let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 1e9;
    scenario.filters[0].initial_mean[Channel::DAMPING_RATIO] = -1.0;
    let record = simulate(&scenario);
    let run = LaneRun { scenario: &scenario, place: 0, record: &record };
    let exact = Outcome::at(&scenario, 0, &record, &[]).unwrap();
    let outcome = pollster::block_on(gpu().outcomes(&[run], &|| true)).unwrap().remove(0).unwrap();
    assert!(exact.stop.is_some_and(|stop| stop.sample == 1), "{exact:?}");
    assert_eq!((outcome.stop, outcome.samples, outcome.diverged), (exact.stop, 1, true));
    assert_eq!((outcome.nis.degrees, outcome.nees.samples), (0, exact.nees.samples));
}
