//! Filters of the engine: every lane has the bits of a single number, at every instruction set, and the single filter's numbers
//! to rounding.

use std::path::Path;

use kalmanscope_core::filter::{Adaptation, Robust};
use kalmanscope_core::internals::engine::{self, Baseline, Setup};
use kalmanscope_core::record::{Clocks, Timed};
use kalmanscope_core::score::{Outcome, SampleScore};
use kalmanscope_core::signal::Step;
use kalmanscope_core::{
    Aspect, Channel, FilterError, FilterKind, FilterSettings, Hold, PlantKind, Propagation, Quantity, Record, Scenario,
    Signal, Values, simulate,
};
use kalmanscope_lanes::{InstructionSet, LaneRun, outcomes_with, serves};

use crate::common::{Draw, PLANTS, bits, check, check_alone, ensemble, runs_of, truth};

#[test]
fn lanes_have_the_bits_of_a_single_number() {
    let (mut runs_in_all, mut stopped, mut alone, mut kinds) = (0, 0, 0, Vec::new());
    for seed in 0..120 {
        let scenario = ensemble(seed);
        let own = simulate(&scenario);
        let records: Vec<Record> = (0..scenario.filters.len())
            .map(|i| {
                let record = match seed % 3 {
                    0 => simulate(&Scenario { seed: seed + i as u64, ..scenario.clone() }),
                    _ => own.clone(),
                };
                let record = if seed % 2 == 0 { record } else { record.without_truth() };
                record.with_gaps(|sensor, k| seed % 4 < 3 && (k + 3 * i * sensor + sensor) % 7 < 2)
            })
            .collect();
        let is_shared = seed % 3 == 1;
        let run = |place| LaneRun { scenario: &scenario, place, record: &records[if is_shared { 0 } else { place }] };
        let is_served = |run: &LaneRun<'_>| Setup::new(run.scenario, run.place, run.record).unwrap().is_some();
        let runs: Vec<LaneRun<'_>> = (0..scenario.filters.len()).map(run).filter(is_served).collect();
        if runs.is_empty() {
            continue;
        }
        assert!(runs.iter().all(|run| serves(run).unwrap()));
        let what = format!("seed {seed} {:?} {:?}", scenario.plant.kind, scenario.filters[0]);
        let outcomes = check(&runs, &what);
        alone += check_alone(&scenario, &records[0], &what);
        runs_in_all += outcomes.len();
        stopped += outcomes.iter().filter(|outcome| outcome.stop.is_some()).count();
        for reason in outcomes.iter().filter_map(|outcome| outcome.stop).map(|stop| stop.reason) {
            if !kinds.contains(&reason) {
                kinds.push(reason);
            }
        }
    }
    assert!(runs_in_all > 500, "{runs_in_all} runs go in lanes");
    assert!(stopped > runs_in_all / 20 && stopped < runs_in_all / 2, "{stopped} of {runs_in_all} runs stop");
    assert!(alone > 500, "{alone} filters are compared with themselves alone");
    assert!(kinds.len() >= 3, "they stop for these reasons: {kinds:?}");
}

fn beginning(record: &Record, samples: usize) -> Record {
    let is_missing = |sensor, k| k > 0 && ((k % 5 == 0 && sensor == 0) || k % 11 == 0);
    record.part(0..samples).without_truth().with_gaps(is_missing)
}

fn difference(a: &Outcome, b: &Outcome) -> f64 {
    assert_eq!((a.samples, a.stop, a.nis.degrees, a.nis.samples), (b.samples, b.stop, b.nis.degrees, b.nis.samples));
    let mut worst = 0.0_f64;
    for i in 0..a.mean.len() {
        // A component without a variance stays as it is.
        let size = a.mean[i].abs().max(a.std[i]);
        worst = worst.max(if a.mean[i] == b.mean[i] { 0.0 } else { (a.mean[i] - b.mean[i]).abs() / size });
        worst = worst.max(if a.std[i] == b.std[i] { 0.0 } else { (a.std[i] - b.std[i]).abs() / a.std[i] });
    }
    worst = worst.max((a.nis.sum - b.nis.sum).abs() / a.nis.sum.max(1.0));
    worst.max((a.log_likelihood - b.log_likelihood).abs() / a.log_likelihood.abs().max(1.0))
}

#[test]
fn a_cell_of_a_map_has_the_bits_of_the_run_alone() {
    use Channel as C;
    let bias = Quantity::DISPLACEMENT.bias();
    let augmentations: [&[Channel]; 6] = [
        &[],
        &[C::INPUT_GAIN],
        &[C::INPUT_GAIN, C::INPUT_OFFSET, bias],
        &[C::UNKNOWN_FORCE],
        &[C::WHITE_FORCE],
        &[C::INPUT_GAIN, C::WHITE_FORCE],
    ];
    let sensors: [&[Quantity]; 3] = [
        &[Quantity::DISPLACEMENT, Quantity::VELOCITY],
        &[Quantity::DISPLACEMENT, Quantity::ACCELERATION],
        &[Quantity::new(Aspect::DRIFT, 0), Quantity::VELOCITY, Quantity::TOTAL_ACCELERATION],
    ];
    let mut compared = 0;
    for plant in PLANTS {
        for (quantities, hold) in sensors.into_iter().flat_map(|q| [(q, Hold::Zero), (q, Hold::First)]) {
            for (nth, augment) in augmentations.into_iter().enumerate() {
                let mut scenario = truth(plant.clone(), quantities, augment, hold);
                (scenario.duration, scenario.filters[0].fading, scenario.filters[0].input_delay) = (0.3, 1.002, 1);
                let filter = &mut scenario.filters[0];
                match nth {
                    1 => filter.propagation = Some(Propagation::RungeKutta),
                    3 => filter.substeps = 3,
                    4 => filter.substeps = 2,
                    5 => filter.eta = 0.02,
                    _ => {}
                }
                let record = simulate(&scenario);
                for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF, FilterKind::CKF] {
                    scenario.filters[0].kind = kind;
                    let what = format!("{plant:?} {kind:?} {quantities:?} {hold:?} {augment:?}");
                    compared += check_alone(&scenario, &beginning(&record, 31), &what);
                }
            }
        }
    }
    assert!(compared > 1000, "{compared} are compared");
}

fn shaken(augment: &[Channel], kind: FilterKind, plant: PlantKind) -> (Scenario, Record) {
    let sensors = [Quantity::DISPLACEMENT, Quantity::VELOCITY];
    let mut scenario = truth(plant, &sensors, augment, Hold::First);
    scenario.duration = 10.0;
    let good = FilterSettings { kind, fading: 1.002, ..scenario.filters.remove(0) };
    for i in 0..3 {
        let mut filter = good.clone();
        filter.initial_std[Channel::DISPLACEMENT] *= 1.0 + f64::from(i);
        scenario.filters.push(filter);
    }
    let record = simulate(&scenario);
    (scenario, record)
}

#[test]
fn scores_against_a_truth_are_those_of_the_single_filter() {
    for (augment, kind, plant) in [
        (&[Channel::INPUT_GAIN][..], FilterKind::EKF, PlantKind::SDOF),
        (&[Channel::INPUT_GAIN, Channel::UNKNOWN_FORCE], FilterKind::UKF, PlantKind::SDOF),
        (&[Channel::INPUT_OFFSET], FilterKind::CKF, PlantKind::DUFFING),
        (&[], FilterKind::UKF, PlantKind::BOUC_WEN),
        (&[], FilterKind::EKF, PlantKind::SHEAR_2),
        (&[], FilterKind::EKF, PlantKind::SHEAR_10),
        (&[], FilterKind::UKF, PlantKind::SHEAR_7),
    ] {
        let (scenario, record) = shaken(augment, kind, plant.clone());
        let record = record.with_gaps(|sensor, k| k % 9 == sensor);
        let samples = check_scores(&scenario, &record, &format!("{plant:?} {kind:?}"), 1e-8);
        assert!(samples.iter().all(|samples| *samples > 900));
    }
}

/// Returns the samples that their NEES count.
fn check_scores(scenario: &Scenario, record: &Record, what: &str, limit: f64) -> Vec<u32> {
    let last = record.len() - 1;
    let samples = [0, 1, 9, 500, last];
    let runs = runs_of(scenario, record);
    assert!(runs.iter().all(|run| serves(run).unwrap()), "{what}");
    let compare = |(place, lane): (usize, Outcome)| {
        let single = Outcome::at(scenario, place, record, &samples).unwrap();
        let is_near = |a: f64, b: f64| (a.is_nan() && b.is_nan()) || (a - b).abs() <= limit * a.abs().max(1e-6);
        let what = format!("{what} {place}\n{lane:?}\n{single:?}");
        assert!(difference(&single, &lane) < limit, "{what}");
        assert_eq!((lane.nees.degrees, lane.nees.samples), (single.nees.degrees, single.nees.samples), "{what}");
        assert!(is_near(single.nees.sum, lane.nees.sum), "{what}");
        assert_eq!((lane.diverged, lane.channels.len()), (single.diverged, single.channels.len()), "{what}");
        for ((channel, a), (other, b)) in lane.channels.iter().zip(&single.channels) {
            assert_eq!((channel, a.settled), (other, b.settled), "{what}");
            let pairs = [(a.error, b.error), (a.std, b.std), (a.rmse, b.rmse), (a.coverage, b.coverage)];
            assert!(pairs.into_iter().all(|(a, b)| is_near(a, b)), "{what}");
        }
        assert_eq!(lane.sample_scores.len(), single.sample_scores.len());
        for (a, b) in lane.sample_scores.iter().zip(&single.sample_scores) {
            let numbers =
                |look: &SampleScore| [vec![look.nees, look.nis], look.channels.as_flattened().to_vec()].concat();
            assert!(numbers(a).into_iter().zip(numbers(b)).all(|(a, b)| is_near(a, b)), "{what}");
        }
        single.nees.samples
    };
    outcomes_with(InstructionSet::best(), &runs, &samples).unwrap().into_iter().enumerate().map(compare).collect()
}

fn troubled(plant: &PlantKind, kind: FilterKind) -> (Scenario, Record) {
    let (mut scenario, _) = shaken(&[], kind, plant.clone());
    let fast = [Channel::NATURAL_FREQUENCY, Channel::stiffness(0)];
    for channel in fast.into_iter().filter(|channel| plant.channels().contains(channel)) {
        let before = scenario.plant.parameter(channel).unwrap().at(0.0);
        scenario.plant.set(channel, Signal::Step(Step { from: before, to: 0.6 * before, at: 6.0 }));
    }
    let std = scenario.sensors[0].noise_std;
    let far = |k: usize| if k % 10 == 7 { std * (20.0 * ((k * k) as f64).sin()) } else { 0.0 };
    let record = simulate(&scenario).with_measured(|sensor, k, z| if sensor == 0 { z + far(k) } else { z });
    (scenario, record.with_gaps(|sensor, k| k % 9 == sensor))
}

#[test]
fn filters_that_learn_from_innovations_agree_with_the_single_filter() {
    let learnt =
        |sensor_noise, process_noise| Adaptation { sensor_noise, process_noise, forgetting: 0.98, training: 0.0 };
    let mut cases: Vec<(Robust, Adaptation, bool, bool)> =
        Robust::ALL.into_iter().map(|rule| (rule, Adaptation::default(), false, rule == Robust::HUBER)).collect();
    cases.extend([
        (Robust::NONE, learnt(true, false), false, false),
        (Robust::NONE, learnt(false, true), false, true),
        (Robust::NONE, learnt(true, true), true, false),
        (Robust::NONE, Adaptation::default(), true, false),
        (Robust::NONE, Adaptation::default(), true, true),
        (Robust::MIXTURE, Adaptation::default(), true, true),
        (Robust::HUBER, learnt(false, true), false, false),
    ]);
    for (plant, kind) in [
        (PlantKind::SDOF, FilterKind::EKF),
        (PlantKind::SDOF, FilterKind::UKF),
        (PlantKind::DUFFING, FilterKind::CKF),
        (PlantKind::BOUC_WEN, FilterKind::UKF),
        (PlantKind::SHEAR_2, FilterKind::EKF),
    ] {
        let (mut scenario, record) = troubled(&plant, kind);
        let mut seen: Vec<Outcome> = Vec::new();
        for &(robust, adaptation, jump, log_parameters) in &cases {
            for filter in &mut scenario.filters {
                *filter = FilterSettings { robust, adaptation, jump, log_parameters, ..filter.clone() };
            }
            let what = format!("{plant:?} {kind:?} {robust:?} {adaptation:?} {jump} {log_parameters}");
            check_scores(&scenario, &record, &what, 1e-7);
            check_alone(&scenario, &record, &what);
            let runs = runs_of(&scenario, &record);
            let outcome = check(&runs, &what).remove(0);
            let is_other = |other: &Outcome| (other.log_likelihood - outcome.log_likelihood).abs() > 0.01;
            assert!(seen.iter().all(is_other), "{what} makes a difference");
            seen.push(outcome);
        }
    }
}

#[test]
fn a_truth_that_is_missing_at_times_is_scored_as_by_the_single_filter() {
    let scenario = Scenario { duration: 4.0, ..Scenario::default() };
    let record = simulate(&scenario);
    let columns = scenario.plant.kind.channels().iter().map(|&channel| {
        let mut truth = record.truth(channel).unwrap().to_vec();
        if channel == Channel::NATURAL_FREQUENCY {
            truth[100..150].fill(f64::NAN);
        }
        (channel, truth)
    });
    let record = record.clone().with_truth(columns.collect()).unwrap();
    check_scores(&scenario, &record, "a truth with a gap", 1e-8);
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
    let runs = runs_of(&scenario, &record);
    let served: Vec<bool> = runs.iter().map(|run| serves(run).unwrap()).collect();
    assert_eq!(served, [true, true, true, false, false, true, false, false], "substeps go in lanes");
    check_alone(&scenario, &record, "all kinds");
    let missing = LaneRun { place: 9, ..runs[0] };
    assert!(serves(&missing).is_err() && outcomes_with(InstructionSet::best(), &[runs[0], missing], &[]).is_err());
}

#[test]
fn a_run_that_stops_tells_when_and_why_as_the_single_filter_does() {
    let (good, record) = shaken(&[Channel::INPUT_GAIN], FilterKind::UKF, PlantKind::SDOF);
    let spoilt = |sample, spoilt| {
        let change = |sensor, k, value| if (sensor, k) == (0, sample) { spoilt } else { value };
        record.clone().without_truth().with_measured(change)
    };
    let mut reasons = Vec::new();
    for (kind, std, frequency, record) in [
        (FilterKind::EKF, 1e-170, 8.0, record.clone()),
        (FilterKind::UKF, 0.01, 8.0, spoilt(40, 1e200)),
        (FilterKind::EKF, 1e3, 1e155, record.clone()),
        (FilterKind::UKF, 1e3, 1e80, record.clone()),
    ] {
        let mut scenario = good.clone();
        scenario.filters.iter_mut().for_each(|filter| filter.kind = kind);
        let bad = &mut scenario.filters[1];
        bad.sensor_std.fill(std);
        bad.initial_mean[Channel::NATURAL_FREQUENCY] = frequency;
        if std < 1e-100 {
            // Neither the belief nor the sensors can err.
            (bad.initial_std, bad.process_std) = (Values::ZERO, Values::ZERO);
        }
        let runs = runs_of(&scenario, &record);
        let lanes = outcomes_with(InstructionSet::best(), &runs, &[]).unwrap();
        let singles: Vec<Outcome> = (0..3).map(|place| Outcome::of(&scenario, place, &record).unwrap()).collect();
        for (lane, single) in lanes.iter().zip(&singles) {
            assert_eq!((lane.stop, lane.samples), (single.stop, single.samples), "{kind:?} {std} {frequency}");
        }
        reasons.push(lanes[1].stop.unwrap().reason);
        assert_eq!(lanes[0].stop.is_none(), record.measured(0)[40] < 1e100);
    }
    let expected = [FilterError::SingularInnovation, FilterError::ImpossibleMeasurement];
    assert_eq!(reasons[..2], expected, "{reasons:?}");
}

fn gallery() -> Vec<(String, Scenario)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/equations");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let read = |path: std::path::PathBuf| {
        let scenario = Scenario::from_toml(&std::fs::read_to_string(&path).unwrap()).unwrap();
        (path.display().to_string(), Scenario { duration: 3.0, ..scenario })
    };
    files.map(read).collect()
}

#[test]
fn filters_of_equations_go_side_by_side() {
    let gallery = gallery();
    assert_eq!(gallery.len(), 12);
    for (name, mut scenario) in gallery {
        let record = simulate(&scenario);
        let first = scenario.filters.remove(0);
        for kind in [FilterKind::EKF, FilterKind::UKF] {
            scenario.filters = (0..8).map(|_| first.clone()).collect();
            for (i, filter) in scenario.filters.iter_mut().enumerate() {
                (filter.kind, filter.id, filter.name) = (kind, i as u32 + 1, format!("{i}"));
                for channel in scenario.plant.kind.parameters() {
                    filter.initial_mean[channel] *= 1.0 + 0.02 * i as f64;
                }
            }
            let runs = runs_of(&scenario, &record);
            assert!(runs.iter().all(|run| serves(run).unwrap()), "{name}");
            let setups: Vec<Setup> =
                (0..8).map(|place| Setup::new(&scenario, place, &record).unwrap().unwrap()).collect();
            let single = |setup| {
                engine::outcomes::<f64, _>(Baseline, &[engine::SetupRun { setup, record: &record }], &[]).remove(0)
            };
            let singles: Vec<Outcome> = setups.iter().map(single).collect();
            for level in InstructionSet::available() {
                for (lane, single) in outcomes_with(level, &runs, &[]).unwrap().iter().zip(&singles) {
                    assert_eq!(bits(lane), bits(single), "{name} {kind:?} at {level:?}");
                }
            }
            for (place, one) in singles.iter().enumerate() {
                let book = Outcome::of(&scenario, place, &record).unwrap();
                assert_eq!((one.stop, book.stop), (None, None), "{name} {kind:?}");
                for i in 0..one.mean.len() {
                    let off = (one.mean[i] - book.mean[i]).abs() / book.std[i].max(1e-12);
                    assert!(off < 1e-7, "{name} {kind:?} {place}: component {i} is {off:e} standard deviations off");
                }
            }
        }
    }
}

#[test]
fn filters_that_divide_their_steps_have_the_bits_of_the_run_alone() {
    let mut all: Vec<(String, Scenario)> =
        gallery().into_iter().filter(|(_, scenario)| !scenario.plant.kind.info().is_linear).collect();
    assert!(all.len() > 4);
    for kind in [PlantKind::DUFFING, PlantKind::BOUC_WEN] {
        let mut scenario = Scenario { duration: 3.0, ..Scenario::default() };
        scenario.set_plant(kind.clone());
        all.push((kind.key().to_owned(), scenario));
    }
    for (name, mut scenario) in all {
        let record = simulate(&scenario);
        let first = scenario.filters.remove(0);
        scenario.filters = [FilterKind::EKF, FilterKind::UKF, FilterKind::CKF]
            .map(|kind| kalmanscope_core::FilterSettings { kind, name: kind.name().to_owned(), ..first.clone() })
            .into();
        scenario.number_filters();
        check(&runs_of(&scenario, &record)[..1], &name);
        assert_eq!(check_alone(&scenario, &record, &name), 3, "{name}");
    }
}

fn with_own_times(record: Record, draw: &mut Draw) -> Record {
    let reading = |column: usize, draw: &mut Draw| {
        let mut timed = Timed::default();
        for (k, value) in record.measured(column).iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let times = if draw.once_in(5) { draw.below(3) } else { 1 };
            for nth in 0..times {
                let time = k as f64 - 0.5 + 0.5 * nth as f64 + draw.between(0.0, 0.4);
                if timed.times.last().is_none_or(|last| *last < time) && time > 0.0 {
                    timed.times.push(time);
                    timed.values.push(value * (1.0 + 0.01 * nth as f64));
                }
            }
        }
        timed
    };
    let readings = (0..record.sensors().len()).map(|column| reading(column, draw)).collect();
    let input = draw.once_in(2).then(|| {
        let apart = draw.between(0.4, 2.5);
        let times: Vec<f64> = (0..).map(|k| apart * f64::from(k)).take_while(|t| *t < record.len() as f64).collect();
        let values = times.iter().map(|time| record.input()[*time as usize]).collect();
        Timed { times, values }
    });
    record.with_clocks(Clocks { input, readings }).unwrap()
}

#[test]
fn lanes_have_the_bits_of_a_single_number_and_of_the_filter_alone() {
    let (mut together, mut alone, mut stopped, mut twice) = (0, 0, 0, 0);
    for seed in 3000..3100 {
        let mut scenario = ensemble(seed);
        let mut draw = Draw(seed);
        let delay = scenario.filters.first().map_or(0, |filter| filter.input_delay);
        for filter in &mut scenario.filters {
            // Both count in samples.
            filter.adaptation = Adaptation::default();
            filter.augment.retain(|channel| *channel != Channel::WHITE_FORCE);
        }
        if draw.once_in(2) {
            scenario.filters.iter_mut().for_each(|filter| filter.input_delay = delay);
        }
        let record = with_own_times(simulate(&scenario), &mut draw);
        let setup = |run: &LaneRun<'_>| Setup::new(run.scenario, run.place, run.record).unwrap();
        let mut runs = runs_of(&scenario, &record);
        runs.retain(|run| setup(run).is_some_and(|setup| setup.is_timed));
        if runs.is_empty() {
            continue;
        }
        let what = format!("seed {seed} {:?} {:?}", scenario.plant.kind, scenario.filters[0]);
        let outcomes = check(&runs, &what);
        alone += check_alone(&scenario, &record, &what);
        together += outcomes.len();
        stopped += outcomes.iter().filter(|outcome| outcome.stop.is_some()).count();
        let readings: usize = record.clocks().unwrap().readings.iter().map(|timed| timed.times.len()).sum();
        let told = |outcome: &Outcome| outcome.nis.degrees as usize == readings;
        twice += usize::from(outcomes.iter().any(|outcome| outcome.stop.is_none() && told(outcome)));
    }
    assert!(together > 400, "{together} runs go in lanes");
    assert!(alone > 400, "{alone} filters are compared with themselves alone");
    assert!(stopped > together / 30 && stopped < together / 2, "{stopped} of {together} runs stop");
    assert!(twice > 10, "all readings count in {twice} records");
}
