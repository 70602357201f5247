//! Maps and plants by the graphics processor have the classes and, where filters converge, the scores of the processor's.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Axis, Channel, FilterKind, Hold, PlantKind, Propagation, Quantity, Scenario, Source, simulate};
use kalmanscope_diagnosis::{Measure, ValueKind};
use kalmanscope_gpu::{Gpu, GpuError, LaneRun, Software, serves};
use kalmanscope_lab::{Ensemble, EnsembleRows, Plan, Priority, Runner, Slice, Threads};

use crate::common::{CLOSE, Tally, built_in, gpu};

const SAMPLES: usize = 2000;

fn scenario(kind: &str, samples: usize) -> Scenario {
    let mut scenario = Scenario { duration: (samples - 1) as f64 * 0.01, ..Scenario::default() };
    scenario.filters.retain(|filter| filter.name == kind);
    assert_eq!((scenario.filters.len(), scenario.samples()), (1, samples));
    scenario
}

fn map(scenario: Scenario, axes: &[String]) -> Arc<Runner> {
    let axes = axes.iter().map(|text| Axis::parse(text).unwrap()).collect();
    let measures = Measure::of_sums(&kalmanscope_lab::channels(&scenario, &[0]));
    let plan = Plan { filters: vec![0], measures, axes, ..Plan::default() };
    Arc::new(Runner::new(Ensemble::new(scenario, plan).unwrap(), Source::Simulated).unwrap())
}

fn tuning(kind: &str, seed: u64, side: usize) -> Arc<Runner> {
    let axes = [
        format!("filters.{kind}.process_std=0.01:100:{side}:log"),
        format!("filters.{kind}.sensor_std=0.05:20:{side}:log"),
    ];
    map(Scenario { seed, ..scenario(kind, SAMPLES) }, &axes)
}

fn guesses(kind: &str, seed: u64, side: usize) -> Arc<Runner> {
    let mut scenario = Scenario { seed, ..scenario(kind, SAMPLES) };
    scenario.remove_sensor(Quantity::VELOCITY);
    let axes = [
        format!("filters.{kind}.initial_mean.natural_frequency=0.5:40:{side}"),
        format!("filters.{kind}.initial_std.natural_frequency=0.1:20:{side}:log"),
    ];
    map(scenario, &axes)
}

fn compare(name: &str, runner: &Arc<Runner>) -> Tally {
    let ensemble = runner.ensemble();
    let cells: Vec<usize> = (0..ensemble.cells()).collect();
    let mut exact = EnsembleRows::new(ensemble);
    let begin = Instant::now();
    let team = Threads::new(0, 0).unwrap();
    let work = team.rows(Priority::Map, runner, cells.clone(), |_| {});
    while let Some(Slice { cells, rows }) = work.wait() {
        exact.fill(&cells, &rows);
    }
    let exact_time = begin.elapsed();
    assert!(Gpu::serves(runner));
    let begin = Instant::now();
    let (served, rows) = pollster::block_on(gpu().rows(runner, &cells, &|| true)).unwrap();
    let time = begin.elapsed();
    assert_eq!(served, cells);
    let mut tally = Tally::default();
    for (&cell, row) in cells.iter().zip(rows.chunks(ensemble.width())) {
        take_cell(&mut tally, &ensemble.plan().measures, &ensemble.at(cell), [exact.row(cell).unwrap(), row]);
    }
    let Tally { runs, same, kept, close, lost, worst: (worst, score) } = &tally;
    println!(
        "{name}: of {runs} cells {same} of the same class, {lost} lost; of {kept} converged {close} close, the worst by {worst:.1e}: \
         {score}; threads {exact_time:.2?}, {} {time:.2?}",
        gpu().name
    );
    tally
}

/// One class: stopped, lost, or converged within 5 % alike. Kept are the cells in which both have converged.
fn take_cell(tally: &mut Tally, measures: &[Measure], scenario: &Scenario, [exact, row]: [&[f64]; 2]) {
    let of = |row: &[f64], measure: Measure| row[measures.iter().position(|other| *other == measure).unwrap()];
    let channel = Channel::NATURAL_FREQUENCY;
    let truth = scenario.plant.parameter(channel).unwrap().at(scenario.duration);
    let class = |row: &[f64]| {
        let is_near = of(row, Measure::error(channel)).abs() <= 0.05 * truth;
        (of(row, Measure::STOPPED), of(row, Measure::DIVERGED), is_near)
    };
    let (class, other) = (class(exact), class(row));
    tally.runs += 1;
    tally.same += usize::from(class == other);
    tally.lost += usize::from(class.1 > 0.0);
    if class != (0.0, 0.0, true) || other != class {
        return;
    }
    let degrees = (scenario.sensors.len() * SAMPLES) as f64;
    let numbers = measures.iter().zip(exact.iter().zip(row)).filter_map(|(measure, (&exact, &number))| {
        let size = match (measure.info().kind, measure.channel()) {
            // These are about zero: a tenth of the standard deviation is close.
            (ValueKind::Error | ValueKind::Signed, Some(channel)) => 0.1 / CLOSE * of(row, Measure::std(channel)),
            (ValueKind::Share, _) => 1.0,
            // The time of the last error of 5 % jumps, and the other is about zero and follows the NIS.
            (ValueKind::Time | ValueKind::Distance, _) => return None,
            (ValueKind::LogLikelihood, _) => exact.abs().max(0.5 * degrees),
            _ => exact.abs(),
        };
        Some((measure.to_string(), number, exact, size))
    });
    tally.keep(numbers);
}

/// The seeds on which the limits below were chosen are 1 to 3.
const JUDGED: u64 = 11;

#[test]
fn maps_of_q_and_r_are_the_processors() {
    for kind in ["EKF", "UKF"] {
        let comparison = compare(&format!("{kind}, Q and R"), &tuning(kind, JUDGED, 64));
        assert!(comparison.same_share() >= 0.999, "{} of {}", comparison.same, comparison.runs);
        assert!(comparison.close_share() >= 0.995, "{} of {}", comparison.close, comparison.kept);
        assert!(comparison.kept > comparison.runs / 2);
    }
}

#[test]
fn maps_of_guesses_are_the_processors() {
    for (kind, side) in [("EKF", 128), ("UKF", 64)] {
        let comparison = compare(&format!("{kind}, guesses"), &guesses(kind, JUDGED, side));
        assert!(comparison.same_share() >= 0.99, "{} of {}", comparison.same, comparison.runs);
        assert!(comparison.close_share() >= 0.97, "{} of {}", comparison.close, comparison.kept);
        assert!(comparison.lost > comparison.runs / 20, "{} lost", comparison.lost);
    }
}

#[test]
fn rows_do_not_depend_on_the_portion() {
    let runner = tuning("UKF", 1, 12);
    let rows = |cells: &[usize]| pollster::block_on(gpu().rows(&runner, cells, &|| true)).unwrap().1;
    let width = runner.ensemble().width();
    let all = rows(&(0..144).collect::<Vec<_>>());
    let some: Vec<usize> = (0..144).rev().step_by(7).collect();
    for (cell, row) in some.iter().zip(rows(&some).chunks(width)) {
        let bits = |row: &[f64]| row.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(row), bits(&all[cell * width..(cell + 1) * width]));
    }
}

#[test]
fn a_record_of_its_own_for_each_cell() {
    let axes = ["seed=1:24:24".to_owned(), "filters.EKF.sensor_std=0.5:2:3".to_owned()];
    let runner = map(scenario("EKF", 500), &axes);
    let comparison = compare("seeds", &runner);
    assert_eq!((comparison.same, comparison.runs), (72, 72));
    assert!(comparison.kept > 36 && comparison.close == comparison.kept);
}

#[test]
fn cells_that_are_not_served_are_left_out() {
    // A fading factor below one is impossible, and sensors with almost no noise are not served.
    let axes = ["filters.EKF.fading=0.5:1:2".to_owned(), "filters.EKF.sensor_std=1e-40:1:3:log".to_owned()];
    let runner = map(scenario("EKF", 300), &axes);
    let (served, rows) = pollster::block_on(gpu().rows(&runner, &[0, 3, 4, 5], &|| true)).unwrap();
    let (exact, width) = (runner.rows(&[5]), runner.ensemble().width());
    assert_eq!(served, [0, 5]);
    assert!(rows[..width].iter().all(|number| number.is_nan()));
    assert_ne!(rows[width..], exact, "single precision");
    assert!(rows[width..].iter().zip(&exact).all(|(row, exact)| row.is_finite() == exact.is_finite()));
}

#[test]
fn work_that_is_not_wanted_ends() {
    let rows = pollster::block_on(gpu().rows(&tuning("EKF", 1, 2), &[0], &|| false));
    assert_eq!(rows, Err(GpuError::Unwanted));
}

#[test]
fn a_program_is_no_graphics_processor() {
    match pollster::block_on(Gpu::find(Software::Refused)) {
        Ok(gpu) => assert!(!gpu.name.to_lowercase().contains("llvmpipe"), "{}", gpu.name),
        Err(error) => assert!(matches!(error, GpuError::Software(_)), "{error}"),
    }
}

/// The filters of an ensemble: not a whole number of groups of threads.
const FILTERS: usize = 70;

fn with_guesses(mut scenario: Scenario, kind: FilterKind) -> Vec<Scenario> {
    scenario.filters.truncate(1);
    scenario.filters[0].kind = kind;
    let guess = |nth: usize| {
        let mut scenario = scenario.clone();
        for (at, channel) in scenario.plant.kind.parameters().enumerate() {
            let turn = (nth * (2 * at + 1) % FILTERS) as f64 / FILTERS as f64;
            scenario.filters[0].initial_mean[channel] *= 0.6 + 0.8 * turn;
        }
        scenario
    };
    (0..FILTERS).map(guess).collect()
}

fn tally(name: &str, scenarios: &[Scenario]) -> Tally {
    let record = simulate(&scenarios[0]);
    let run = |scenario| LaneRun { scenario, place: 0, record: &record };
    let runs: Vec<LaneRun<'_>> = scenarios.iter().map(run).collect();
    assert!(serves(&runs[0]), "{name}");
    let begin = Instant::now();
    let outcomes = pollster::block_on(gpu().outcomes(&runs, &|| true)).unwrap();
    let time = begin.elapsed();
    let mut tally = Tally::default();
    for (scenario, outcome) in scenarios.iter().zip(&outcomes) {
        let class = |outcome: &Outcome| (outcome.stop.is_some(), outcome.diverged);
        let exact = Outcome::at(scenario, 0, &record, &[]).unwrap();
        tally.take([outcome.as_ref().unwrap(), &exact], class, |class| class == (false, false));
    }
    let Tally { runs, same, kept, close, worst: (worst, score), .. } = &tally;
    println!(
        "{name}: of {runs} runs {same} of the same class; of {kept} kept {close} close, the worst by {worst:.1e}: {score}; {time:.1?}"
    );
    tally
}

fn check(name: &str, scenarios: &[Scenario]) {
    let Tally { runs, same, kept, close, .. } = tally(name, scenarios);
    assert!(same as f64 >= 0.96 * runs as f64, "{name}: {same} of {runs}");
    assert!(kept * 3 > runs && close as f64 >= 0.9 * kept as f64, "{name}: {close} of {kept}");
}

const KINDS: [FilterKind; 2] = [FilterKind::EKF, FilterKind::UKF];

#[test]
fn plants_and_what_surrounds_them_have_the_scores_of_the_processor() {
    use {FilterKind as Kind, PlantKind as Plant};
    type Change = fn(&mut Scenario);
    let both = [Quantity::DISPLACEMENT, Quantity::ACCELERATION];
    let augment = [Channel::INPUT_GAIN, Channel::INPUT_OFFSET, both[1].bias()];
    let usual: Change = |scenario| scenario.filters[0].propagation = Some(Propagation::LocalLinearisation);
    let runge_kutta: Change = |scenario| scenario.filters[0].propagation = Some(Propagation::RungeKutta);
    let white: Change = |Scenario { filters, .. }| {
        filters[0].augment.push(Channel::WHITE_FORCE);
        (filters[0].process_std[Channel::WHITE_FORCE], filters[0].initial_std[Channel::WHITE_FORCE]) = (0.3, 0.3);
    };
    let divided: Change = |scenario| (scenario.filters[0].substeps, scenario.filters[0].eta) = (2, 1e-3);
    let surrounded = || built_in(Plant::SDOF, &both, &augment, Hold::First);
    let duffing = || built_in(Plant::DUFFING, &both[..1], &[], Hold::Zero);
    let mut cases = vec![
        (surrounded(), Kind::EKF, usual),
        (surrounded(), Kind::EKF, runge_kutta),
        (surrounded(), Kind::UKF, usual),
        (surrounded(), Kind::CKF, usual),
        (built_in(Plant::SDOF, &both, &[], Hold::First), Kind::EKF, white),
        (built_in(Plant::SDOF, &both, &[], Hold::Zero), Kind::UKF, white),
    ];
    for kind in KINDS {
        cases.push((duffing(), kind, divided));
        cases.extend([Plant::DUFFING, Plant::BOUC_WEN, Plant::SHEAR_2].map(|plant| {
            let quantities: Vec<Quantity> = plant.quantities().take(2).collect();
            (built_in(plant, &quantities, &[], Hold::Zero), kind, (|_| ()) as Change)
        }));
        cases.extend(["pendulum", "dry-friction", "helmholtz"].map(|equation| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/equations").join(equation);
            let text = std::fs::read_to_string(path.with_extension("toml")).unwrap();
            (Scenario { duration: 10.0, ..Scenario::from_toml(&text).unwrap() }, kind, (|_| ()) as Change)
        }));
    }
    for (scenario, kind, change) in cases {
        let mut scenarios = with_guesses(scenario, kind);
        scenarios.iter_mut().for_each(change);
        check(&format!("{:?}, {:?}", scenarios[0].plant.kind, scenarios[0].filters[0]), &scenarios);
    }
}

#[test]
fn filters_that_are_lost_are_lost_on_both() {
    for kind in KINDS {
        let mut scenarios =
            with_guesses(built_in(PlantKind::DUFFING, &[Quantity::DISPLACEMENT], &[], Hold::Zero), kind);
        for (nth, scenario) in scenarios.iter_mut().enumerate() {
            scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] *= 0.1 + nth as f64 * 0.1;
        }
        let Tally { runs, same, kept, .. } = tally(&format!("lost, {kind:?}"), &scenarios);
        assert!(same as f64 >= 0.9 * runs as f64, "{kind:?}: {same} of {runs}");
        assert!(same - kept >= runs / 10, "{kind:?}: {} lost", same - kept);
    }
}
