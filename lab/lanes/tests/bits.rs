//! Every lane has the bits of the single filter.

use crate::common::{CHANNELS, Shaken, size, values};
use crate::outcome_bits::bits;
use kalmanscope_core::score::Outcome;
use kalmanscope_core::simulate;
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, PlantKind, Propagation, Quantity, Record, Scenario, Values,
};
use kalmanscope_lanes::{LaneRun, Level, outcomes_with, serves};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngSeed, TestRunner};

/// The same cases every time, so that a failure is reproducible.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(20_261_122), failure_persistence: None, ..Default::default() }
}

fn zero_or(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 7 => size(exponents)]
}

/// Numbers of one kind for all channels.
fn per_channel<S: Strategy<Value = f64>>(of: impl Fn() -> S) -> impl Strategy<Value = Values> {
    [of(), of(), of(), of()].prop_map(values)
}

/// A filter of a kind, tame or wild in its numbers.
fn filter(kind: FilterKind, sensors: usize, decays: bool, wild: bool) -> impl Strategy<Value = FilterSettings> {
    let eta = if decays { (0.001..2.0).boxed() } else { Just(0.0).boxed() };
    let frequency = if wild { (-300.0..300.0).boxed() } else { prop_oneof![5 => 2.0..20.0, 1 => -20.0..-2.0].boxed() };
    let spread = if wild { -6.0..3.0 } else { -2.0..0.5 };
    let noise = if wild { -5.0..2.0 } else { -2.5..-1.0 };
    (
        prop_oneof![Just(1.0), 1.0..1.2],
        eta,
        proptest::collection::vec(size(noise), sensors),
        (-1.0..1.0, -1.0..1.0, frequency, -0.1..1.0),
        per_channel(move || zero_or(spread.clone())),
        per_channel(|| zero_or(-9.0..-2.0)),
        -3..4,
    )
        .prop_map(move |(fading, eta, sensor_std, (x, v, wn, zeta), initial_std, process_std, input_delay)| {
            FilterSettings {
                kind,
                fading,
                eta,
                sensor_std,
                initial_mean: values([x, v, wn, zeta]),
                initial_std,
                process_std,
                input_delay,
                ..FilterSettings::default()
            }
        })
}

/// Mean, std and process std of a filter's cubic stiffness.
fn cubic_stiffness(wild: bool) -> impl Strategy<Value = [f64; 3]> {
    let mean = if wild { -1e5..1e5 } else { -50.0..800.0 };
    (mean, zero_or(if wild { -2.0..6.0 } else { 0.0..2.5 }), zero_or(-5.0..1.0)).prop_map(|(a, b, c)| [a, b, c])
}

/// The scenario with an oscillator of the cubic stiffness `truth`, and one filter for each initial guess.
fn with_cubic_spring(mut scenario: Scenario, truth: f64, filters: &[[f64; 3]]) -> Scenario {
    let channel = Channel::CUBIC_STIFFNESS;
    scenario.plant = scenario.plant.of_kind(PlantKind::DUFFING).with(channel, truth);
    for (filter, &[mean, std, process]) in scenario.filters.iter_mut().zip(filters) {
        // The lanes of the oscillators take the single steps of the book.
        (filter.propagation, filter.substeps) = (Some(Propagation::LocalLinearisation), 1);
        filter.initial_mean[channel] = mean;
        filter.initial_std[channel] = std;
        filter.process_std[channel] = process;
    }
    scenario
}

/// A scenario with filters that differ in numbers only.
fn ensemble() -> impl Strategy<Value = Scenario> {
    let cubic = any::<bool>().prop_flat_map(|wild| proptest::collection::vec(cubic_stiffness(wild), 16));
    (linear_ensemble(), proptest::option::of((-20.0..400.0, cubic))).prop_map(|(scenario, cubic)| match cubic {
        Some((truth, filters)) => with_cubic_spring(scenario, truth, &filters),
        None => scenario,
    })
}

/// [`ensemble`] of the linear oscillator.
fn linear_ensemble() -> impl Strategy<Value = Scenario> {
    let quantities = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];
    (
        proptest::sample::subsequence(quantities.to_vec(), 0..=3).prop_shuffle(),
        proptest::sample::select(vec![FilterKind::KF, FilterKind::EKF, FilterKind::UKF]),
        (any::<bool>(), any::<bool>()),
        (0..1_u64 << 40, size(-2.5..-0.7), 20_u32..200),
        (1.0..20.0, 0.0..0.3, 0.5..5.0),
        1_usize..17,
    )
        .prop_flat_map(|(measured, kind, (decays, wild), (seed, dt, steps), (wn, zeta, force), lanes)| {
            let filters = proptest::collection::vec(filter(kind, measured.len(), decays, wild), lanes);
            let shaken = Shaken { seed, steps: (dt, steps), parameters: [wn, zeta], force };
            filters.prop_map(move |filters| shaken.watched(&measured, filters))
        })
}

/// Holds every lane at every instruction set to the single filter. Returns the number of runs that stopped early.
fn check(runs: &[LaneRun<'_>]) -> Result<usize, TestCaseError> {
    let last = runs[0].record.len() - 1;
    let samples = [0, 0, 1, 2, last / 3, last / 3, last / 2, last, last, last + 3];
    let single: Vec<Outcome> =
        runs.iter().map(|run| Outcome::at(run.scenario, run.place, run.record, &samples).unwrap()).collect();
    for level in Level::available() {
        let lanes = outcomes_with(level, runs, &samples).unwrap();
        prop_assert_eq!(lanes.len(), single.len());
        for (place, (lane, single)) in lanes.iter().zip(&single).enumerate() {
            prop_assert_eq!(
                bits(lane),
                bits(single),
                "run {} of {} at {:?}\n{:?}\n{:?}",
                place,
                runs.len(),
                level,
                lane,
                single
            );
        }
    }
    Ok(single.iter().filter(|outcome| outcome.stop.is_some()).count())
}

fn all<'a>(scenario: &'a Scenario, record: &'a Record) -> Vec<LaneRun<'a>> {
    (0..scenario.filters.len()).map(|place| LaneRun { scenario, place, record }).collect()
}

proptest! {
    #![proptest_config(config(160))]

    #[test]
    fn lanes_have_the_bits_of_the_single_filter(scenario in ensemble(), gap in 2_usize..9, keeps_truth: bool) {
        let record = simulate(&scenario);
        check(&all(&scenario, &record))?;
        let record = if keeps_truth { record } else { record.without_truth() };
        let gaps = record.with_gaps(|sensor, k| k.wrapping_mul(2_654_435_761 + sensor) >> 3 & 7 < gap);
        check(&all(&scenario, &gaps))?;
    }

    #[test]
    fn a_record_of_its_own_for_each_lane(scenario in ensemble(), gap in 0_usize..4) {
        let records: Vec<Record> = (0..scenario.filters.len())
            .map(|i| {
                let record = simulate(&Scenario { seed: scenario.seed + i as u64, ..scenario.clone() });
                record.with_gaps(|sensor, k| (k + i * sensor) % 7 < gap)
            })
            .collect();
        let runs: Vec<LaneRun> = (records.iter().enumerate())
            .map(|(place, record)| LaneRun { scenario: &scenario, place, record })
            .collect();
        check(&runs)?;
    }
}

/// The random ensembles above are of all kinds: lanes serve most runs, some stop, some need doubled steps.
#[test]
fn random_ensembles_are_of_all_kinds() {
    let mut runner = TestRunner::new(config(1));
    let (mut all_runs, mut served, mut stopped, mut mirrored, mut long, mut left_over) = (0, 0, 0, 0, 0, 0);
    let mut cubic = 0;
    for _ in 0..120 {
        let scenario = ensemble().new_tree(&mut runner).unwrap().current();
        let record = simulate(&scenario);
        left_over += usize::from(scenario.filters.len() % 8 > 1);
        for run in all(&scenario, &record) {
            let outcome = Outcome::of(run.scenario, run.place, run.record).unwrap();
            all_runs += 1;
            let is_served = serves(&run).unwrap();
            served += usize::from(is_served);
            cubic += usize::from(is_served && scenario.plant.kind == PlantKind::DUFFING);
            stopped += usize::from(outcome.stop.is_some());
            mirrored += usize::from(outcome.mean[2] < 0.0);
            let frequency = scenario.filters[run.place].initial_mean[CHANNELS[2]];
            long += usize::from(frequency.abs() * scenario.dt > 0.25);
        }
    }
    let shares = [served, stopped, mirrored, long, cubic].map(|count| count as f64 / f64::from(all_runs));
    assert!(shares[0] > 0.7 && shares[1..].iter().all(|share| *share > 0.05), "{shares:?} of {all_runs}");
    assert!(left_over > 40, "{left_over} of 120 ensembles leave lanes over");
}

#[test]
fn filters_of_several_plants_run_beside_each_other() {
    let linear = Scenario { duration: 3.0, ..Scenario::default() };
    let truth = with_cubic_spring(linear.clone(), 300.0, &[[100.0, 200.0, 0.01]; 2]);
    let mut mixed = truth.clone();
    let believes_linear = linear.filters.iter().map(|f| FilterSettings { plant: Some(PlantKind::SDOF), ..f.clone() });
    mixed.filters.extend(believes_linear);
    let record = simulate(&mixed);
    let runs = [all(&mixed, &record), all(&mixed, &record)].concat();
    assert!(runs.iter().all(|run| serves(run).unwrap()));
    assert_eq!(check(&runs).unwrap(), 0);
}

#[test]
fn filters_that_stop_and_filters_that_do_not_share_a_batch() {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    let good = scenario.filters[0].clone();
    // Lanes with a covariance that overflows sooner or later, beside lanes that continue.
    scenario.filters = (0..16)
        .map(|i| {
            let mut filter = good.clone();
            if i % 3 == 1 {
                filter.initial_mean[CHANNELS[3]] = -40.0 * f64::from(i);
                filter.initial_mean[CHANNELS[2]] = 300.0;
                filter.sensor_std = vec![1e3, 1e3];
            }
            filter
        })
        .collect();
    let record = simulate(&scenario);
    let stopped = check(&all(&scenario, &record)).unwrap();
    assert!((1..16).contains(&stopped), "{stopped} of 16 filters stopped");
}

#[test]
fn a_determinant_out_of_range_is_taken_from_the_covariance() {
    let mut scenario = Scenario { duration: 5.0, ..Scenario::default() };
    let good = scenario.filters[0].clone();
    scenario.filters = [1e-80, 1.0, 1e-77, 1e40, 1e76, 1e-3, 1e60, 1e-40]
        .map(|std| {
            let mut filter = FilterSettings { sensor_std: vec![std; 2], ..good.clone() };
            if std < 1e-20 {
                filter.initial_std = values([std, std, 1e-9, 1e-9]);
                filter.process_std = Values::ZERO;
            }
            filter
        })
        .to_vec();
    let record = simulate(&scenario);
    check(&all(&scenario, &record)).unwrap();
}

#[test]
fn a_truth_that_is_missing_at_times_is_left_to_the_single_filter() {
    let scenario = Scenario { duration: 4.0, ..Scenario::default() };
    let record = simulate(&scenario);
    let mut truth = record.truth(CHANNELS[2]).unwrap().to_vec();
    truth[100..150].fill(f64::NAN);
    let channels = [Channel::DISPLACEMENT, Channel::VELOCITY, CHANNELS[3]];
    let mut columns = channels.map(|channel| (channel, record.truth(channel).unwrap().to_vec())).to_vec();
    columns.push((CHANNELS[2], truth));
    let record = record.clone().with_truth(columns).unwrap();
    let runs = [LaneRun { scenario: &scenario, place: 0, record: &record }; 3];
    assert!(serves(&runs[0]).unwrap());
    check(&runs).unwrap();
}

#[test]
fn other_filters_run_by_themselves() {
    let mut scenario = Scenario { duration: 3.0, ..Scenario::default() };
    let good = scenario.filters[0].clone();
    let of = |kind| FilterSettings { kind, ensemble_size: 30, ..good.clone() };
    let bank = FilterSettings { walk: 0.5, ..good.clone() };
    let guesses = FilterSettings { guesses: 3, ..good.clone() };
    let considers = FilterSettings { consider: vec![Channel::DAMPING_RATIO], ..good.clone() };
    let substeps = FilterSettings { substeps: 2, ..good.clone() };
    let other = [of(FilterKind::CKF), of(FilterKind::PF), bank, substeps, guesses, considers];
    scenario.filters.extend(other);
    let record = simulate(&scenario);
    let runs = all(&scenario, &record);
    let served: Vec<bool> = runs.iter().map(|run| serves(run).unwrap()).collect();
    assert_eq!(served, [true, true, false, false, false, true, false, false], "substeps go in lanes");
    check(&runs).unwrap();
    let missing = LaneRun { place: 9, ..runs[0] };
    assert!(serves(&missing).is_err() && outcomes_with(Level::best(), &[runs[0], missing], &[]).is_err());
}
