//! Filters of the engine: every lane has the bits of a single number, at every instruction set, and the single filter's numbers
//! to rounding.

mod common;

use std::path::Path;

use kalmanscope_core::filter::{Adaptation, Robust};
use kalmanscope_core::internals::engine::Setup;
use kalmanscope_core::record::{Clocks, Timed};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::signal::Step;
use kalmanscope_core::{
    Aspect, Channel, FilterError, FilterKind, FilterSettings, ForcedMass, Hold, PlantKind, Propagation, Quantity,
    Record, Scenario, Signal, Values, simulate,
};
use kalmanscope_lanes::{InstructionSet, LaneRun, outcomes, serves};

use common::{Draw, PLANTS, check, check_alone, ensemble, runs_of, truth};

#[derive(Default)]
struct Compared {
    together: usize,
    stopped: usize,
    alone: usize,
    reasons: Vec<FilterError>,
}

impl Compared {
    /// The filters of an ensemble, over a record each or a common one.
    fn take(&mut self, seed: u64, scenario: &Scenario, records: &[Record]) -> Vec<Outcome> {
        let run = |place| LaneRun { scenario, place, record: &records[place % records.len()] };
        let setup = |run: &LaneRun<'_>| Setup::new(run.scenario, run.place, run.record).unwrap();
        let is_timed = records[0].clocks().is_some();
        let is_served = |run: &LaneRun<'_>| setup(run).is_some_and(|setup| setup.is_timed == is_timed);
        let runs: Vec<LaneRun<'_>> = (0..scenario.filters.len()).map(run).filter(is_served).collect();
        if runs.is_empty() {
            return Vec::new();
        }
        assert!(runs.iter().all(|run| serves(run).unwrap()));
        let what = format!("seed {seed} {:?} {:?}", scenario.plant.kind, scenario.filters[0]);
        let outcomes = check(&runs, &what);
        self.alone += check_alone(scenario, &records[0], &what).len();
        self.together += outcomes.len();
        for stop in outcomes.iter().filter_map(|outcome| outcome.stop) {
            self.stopped += 1;
            if !self.reasons.contains(&stop.reason) {
                self.reasons.push(stop.reason);
            }
        }
        outcomes
    }

    fn assert_many(&self, least: usize, share: usize) {
        let Self { together, stopped, alone, reasons } = self;
        assert!(*together > least, "{together} runs go in lanes");
        assert!(*stopped > together / share && *stopped < together / 2, "{stopped} of {together} runs stop");
        assert!(*alone > least, "{alone} filters are compared with themselves alone");
        assert!(reasons.len() >= 3 || share > 20, "they stop for these reasons: {reasons:?}");
    }
}

#[test]
fn lanes_have_the_bits_of_a_single_number() {
    let mut compared = Compared::default();
    for seed in 0..120 {
        let scenario = ensemble(seed);
        let own = simulate(&scenario);
        let record = |i: usize| {
            let record = match seed % 3 {
                0 => simulate(&Scenario { seed: seed + i as u64, ..scenario.clone() }),
                _ => own.clone(),
            };
            let record = if seed % 2 == 0 { record } else { record.without_truth() };
            record.with_gaps(|sensor, k| seed % 4 < 3 && (k + 3 * i * sensor + sensor) % 7 < 2)
        };
        let records = if seed % 3 == 1 { 1 } else { scenario.filters.len().max(1) };
        compared.take(seed, &scenario, &(0..records).map(record).collect::<Vec<_>>());
    }
    compared.assert_many(500, 20);
}

#[test]
fn a_cell_of_a_map_has_the_bits_of_the_run_alone() {
    use Channel as C;
    type Case<'a> = (&'a [Channel], fn(&mut FilterSettings));
    let bias = Quantity::DISPLACEMENT.bias();
    let cases: [Case<'_>; 6] = [
        (&[], |_| ()),
        (&[C::INPUT_GAIN], |filter| filter.propagation = Some(Propagation::RungeKutta)),
        (&[C::INPUT_GAIN, C::INPUT_OFFSET, bias], |_| ()),
        (&[C::UNKNOWN_FORCE], |filter| filter.substeps = 3),
        (&[C::WHITE_FORCE], |filter| filter.substeps = 2),
        (&[C::INPUT_GAIN, C::WHITE_FORCE], |filter| filter.eta = 0.02),
    ];
    let sensors: [&[Quantity]; 3] = [
        &[Quantity::DISPLACEMENT, Quantity::VELOCITY],
        &[Quantity::DISPLACEMENT, Quantity::ACCELERATION],
        &[Quantity::new(Aspect::DRIFT, 0), Quantity::VELOCITY, Quantity::TOTAL_ACCELERATION],
    ];
    let is_missing = |sensor, k| k > 0 && ((k % 5 == 0 && sensor == 0) || k % 11 == 0);
    for plant in PLANTS {
        for (quantities, hold) in sensors.into_iter().flat_map(|q| [(q, Hold::Zero), (q, Hold::First)]) {
            for (augment, change) in cases {
                let mut scenario = truth(plant.clone(), quantities, augment, hold);
                (scenario.duration, scenario.filters[0].fading, scenario.filters[0].input_delay) = (0.3, 1.002, 1);
                change(&mut scenario.filters[0]);
                let record = simulate(&scenario).without_truth().with_gaps(is_missing);
                for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF, FilterKind::CKF] {
                    scenario.filters[0].kind = kind;
                    check_alone(&scenario, &record, &format!("{plant:?} {kind:?} {quantities:?} {hold:?} {augment:?}"));
                }
            }
        }
    }
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
        let samples = check_alone(&scenario, &record, &format!("{plant:?} {kind:?}"));
        assert!(samples.iter().all(|samples| *samples > 900));
    }
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
    check_alone(&scenario, &record, "a truth with a gap");
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
    assert!(serves(&missing).is_err() && outcomes(InstructionSet::best(), &[runs[0], missing], &[]).is_err());
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
        check_alone(&scenario, &record, &format!("{kind:?} {std} {frequency}"));
        let lanes = outcomes(InstructionSet::best(), &runs_of(&scenario, &record), &[]).unwrap();
        reasons.push(lanes[1].stop.unwrap().reason);
        assert_eq!(lanes[0].stop.is_none(), record.measured(0)[40] < 1e100);
    }
    let expected = [FilterError::SingularInnovation, FilterError::ImpossibleMeasurement];
    assert_eq!(reasons[..2], expected, "{reasons:?}");
}

fn gallery() -> Vec<(String, Scenario)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/equations");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let read = |path: std::path::PathBuf| {
        let scenario = Scenario::from_toml(&std::fs::read_to_string(&path).unwrap()).unwrap();
        (path.display().to_string(), Scenario { duration: 3.0, ..scenario })
    };
    files.map(read).collect()
}

#[test]
fn filters_of_equations_and_those_that_divide_their_steps_go_side_by_side() {
    let mut all = gallery();
    assert_eq!(all.len(), 12);
    for kind in [PlantKind::DUFFING, PlantKind::BOUC_WEN] {
        let mut scenario = Scenario { duration: 3.0, ..Scenario::default() };
        scenario.set_plant(kind.clone());
        all.push((kind.key().to_owned(), scenario));
    }
    for (name, mut scenario) in all {
        let record = simulate(&scenario);
        let first = scenario.filters.remove(0);
        for kind in [FilterKind::EKF, FilterKind::UKF, FilterKind::CKF] {
            let guess = |i: u32| {
                let mut filter = FilterSettings { kind, id: i + 1, name: format!("{i}"), ..first.clone() };
                for channel in scenario.plant.kind.parameters() {
                    filter.initial_mean[channel] *= 1.0 + 0.02 * f64::from(i);
                }
                filter
            };
            scenario.filters = (0..8).map(guess).collect();
            let runs = runs_of(&scenario, &record);
            assert!(runs.iter().all(|run| serves(run).unwrap()), "{name} {kind:?}");
            let stopped = check(&runs, &name).iter().filter(|outcome| outcome.stop.is_some()).count();
            assert_eq!((check_alone(&scenario, &record, &name).len(), stopped), (8, 0), "{name} {kind:?}");
        }
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
fn lanes_over_readings_with_times_have_the_bits_of_a_single_number() {
    let (mut compared, mut twice) = (Compared::default(), 0);
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
        let readings: usize = record.clocks().unwrap().readings.iter().map(|timed| timed.times.len()).sum();
        let told = |outcome: &Outcome| outcome.nis.degrees as usize == readings;
        let outcomes = compared.take(seed, &scenario, &[record]);
        twice += usize::from(outcomes.iter().any(|outcome| outcome.stop.is_none() && told(outcome)));
    }
    compared.assert_many(400, 30);
    assert!(twice > 10, "all readings count in {twice} records");
}

#[test]
fn lanes_over_forces_on_single_masses_have_the_bits_of_a_single_number() {
    let mut compared = Compared::default();
    for seed in 4000..4060 {
        let mut scenario = ensemble(seed);
        let mut draw = Draw(seed);
        for filter in &mut scenario.filters {
            filter.adaptation = Adaptation::default();
            filter.augment.retain(|channel| *channel != Channel::WHITE_FORCE);
        }
        let mut record = simulate(&scenario);
        if draw.once_in(2) {
            record = with_own_times(record, &mut draw);
        }
        let mass = ForcedMass::new(draw.below(scenario.plant.kind.masses())).unwrap();
        let force = (0..record.len()).map(|_| draw.between(-5.0, 5.0)).collect();
        compared.take(seed, &scenario, &[record.with_forces(vec![(mass, force)]).unwrap()]);
    }
    compared.assert_many(200, 10);
}
