use std::sync::Arc;

use kalmanscope_core::diagnostics::MeanSquare;
use kalmanscope_core::document::read_toml;
use kalmanscope_core::scenario::Between;
use kalmanscope_core::{
    Channel, Diagnostics, FilterKind, FilterSettings, Hold, PlantKind, Quantity, Run, RunError, Scenario, Sensor,
    Source, Task, simulate,
};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{CellRun, Ensemble, EnsembleError, Plan, Runner, cell_task};
use kalmanscope_lanes::{LaneRun, serves};

use crate::ensemble::plan;

fn runner(axes: &[&str], measures: &[&str]) -> Arc<Runner> {
    runner_of(Scenario { duration: 5.0, ..Scenario::default() }, axes, measures, 0)
}

fn runner_of(scenario: Scenario, axes: &[&str], measures: &[&str], times: usize) -> Arc<Runner> {
    let measures: Vec<Measure> = measures.iter().map(|text| text.parse().unwrap()).collect();
    let ensemble = Ensemble::new(scenario, Plan { times, ..plan(&[0, 1], &measures, axes) }).unwrap();
    Arc::new(Runner::new(ensemble, Source::Simulated).unwrap())
}

#[test]
fn a_row_has_the_numbers_of_the_run_on_a_screen() {
    let channel = Channel::NATURAL_FREQUENCY;
    let per_degree = |square: Option<MeanSquare>| square.map_or(f64::NAN, |square| square.mean / square.expected);
    let runner = runner(
        &["seed=3:5:3", "filters.*.initial_mean.natural_frequency=2:14:4"],
        &["nis", "nees", "log_likelihood", "rmse.natural_frequency", "estimate.natural_frequency", "diverged"],
    );
    for cell in 0..12 {
        let row = runner.rows(&[cell]);
        let mut run = Run::new(&runner.ensemble().at(cell)).unwrap();
        run.finish();
        for (estimates, row) in run.estimates().iter().zip(row.chunks(6)) {
            let diagnostics = Diagnostics::new(estimates, run.record());
            let place = estimates.place(channel).unwrap();
            let expected = [
                per_degree(diagnostics.mean_nis()),
                per_degree(diagnostics.mean_nees()),
                diagnostics.log_likelihood(),
                diagnostics.tally(channel, 0..estimates.len()).unwrap().rmse(),
                estimates.canonical_mean(estimates.len() - 1, place),
            ];
            for (number, expected) in row.iter().zip(expected) {
                assert!((number - expected).abs() <= 1e-12 * expected.abs(), "{row:?}: {expected}");
            }
        }
    }
}

#[test]
fn a_cell_takes_the_time_of_its_filters_over_all_samples() {
    let of = |axes: &[&str]| runner(axes, &["nis"]).time_of_cell();
    let (short, many) = (of(&["seed=1:4:4"]), of(&["seed=1:9:9"]));
    assert_eq!(short, many, "a cell has no share in the others");
    // 501 samples, an EKF and a UKF.
    assert!((1e-4..3e-3).contains(&short), "{short}");
}

fn measured() -> Scenario {
    let mut scenario = Scenario { duration: 5.0, hold: Hold::First, ..Scenario::default() };
    scenario.filters.iter_mut().for_each(|filter| filter.augment = vec![Channel::INPUT_GAIN]);
    scenario
}

#[test]
fn rows_do_not_depend_on_their_order_or_on_those_beside_them_and_are_those_of_the_single_filter() {
    let mut duffing = Scenario { duration: 5.0, ..Scenario::default() };
    duffing.set_plant(PlantKind::DUFFING);
    let usual = Scenario { duration: 5.0, ..Scenario::default() };
    let [guess, coarse] = [11, 6].map(|count| format!("filters.*.initial_mean.natural_frequency=3:9:{count}"));
    for (scenario, axes, measures, limit) in [
        (
            usual,
            ["seed=1:4:4", "filters.EKF.process_std=0.1:10:5:log"],
            ["nis", "error.damping_ratio", "rmse.velocity"],
            1e-9,
        ),
        (measured(), ["seed=1:2:2", &guess], ["nis", "log_likelihood", "estimate.input_gain"], 1e-9),
        (duffing, ["seed=1:2:2", &coarse], ["nis", "nees", "estimate.cubic_stiffness"], 0.0),
    ] {
        let runner = runner_of(scenario, &axes, &measures, 0);
        let (cells, width): (Vec<usize>, usize) = ((0..runner.ensemble().cells()).collect(), runner.ensemble().width());
        for CellRun { scenario, record } in runner.runs(&cells).iter().flatten() {
            let is_served = |place| serves(&LaneRun { scenario, place, record });
            assert!(is_served(0).unwrap() && is_served(1).unwrap());
        }
        let all = runner.rows(&cells);
        for &cell in cells.iter().rev() {
            let row = &all[cell * width..(cell + 1) * width];
            assert_eq!(runner.rows(&[cell]), row);
            for (place, (number, single)) in row.iter().zip(cell_task(Arc::clone(&runner), cell).run()).enumerate() {
                // The NEES of lanes has another order of its factors.
                let limit = if place % 3 == 1 { f64::max(limit, 1e-12) } else { limit };
                assert!((number - single).abs() <= limit * single.abs(), "{cell}, {place}: {number} and {single}");
            }
        }
    }
}

#[test]
fn cells_that_lanes_take_are_computed_together() {
    let at_once = |scenario: Scenario, measure: Measure| {
        let ensemble = Ensemble::new(scenario, plan(&[0], &[measure], &[])).unwrap();
        Runner::new(ensemble, Source::Simulated).unwrap().at_once(0)
    };
    let changed = |change: fn(&mut FilterSettings)| {
        let mut scenario = measured();
        change(&mut scenario.filters[0]);
        scenario
    };
    assert_eq!(at_once(measured(), Measure::NIS), 8);
    assert_eq!(at_once(Scenario { duration: 5.0, ..Scenario::default() }, Measure::NIS), 8);
    assert_eq!(at_once(measured(), Measure::VERDICT), 1);
    const ENDS: Between = Between { least: Some(0.0), most: None };
    let bounded = changed(|filter| filter.bounds.set(Channel::DAMPING_RATIO, ENDS));
    assert_eq!(at_once(bounded, Measure::NIS), 1);
    assert_eq!(at_once(changed(|filter| filter.kind = FilterKind::SR_UKF), Measure::NIS), 1);
}

#[test]
fn the_row_of_an_impossible_scenario_is_empty() {
    let runner = runner(&["filters.EKF.fading=0.5:1.5:3"], &["nis"]);
    let rows = runner.rows(&[0, 1, 2]);
    assert!(rows[..2].iter().all(|number| number.is_nan()) && rows[2..].iter().all(|number| number.is_finite()));
}

#[test]
fn measures_of_histories_are_those_of_the_screen() {
    let runner = runner(&["filters.*.sensor_std=0.1:10:3:log"], &["verdict", "free_run.velocity", "one_step.velocity"]);
    let rows = runner.rows(&[0, 1, 2]);
    let (verdict, free_run, one_step) = (rows[6], rows[7], rows[8]);
    assert!(verdict >= 0.0 && free_run > 0.0 && (0.05..0.2).contains(&one_step), "{rows:?}");
}

#[test]
fn a_given_record_stays_as_it_is() {
    let scenario = Scenario { duration: 5.0, ..Scenario::default() };
    let record = Arc::new(simulate(&scenario));
    let runner = |key: &str, scenario: &Scenario| {
        let plan = plan(&[0], &[Measure::NIS], &[&format!("{key}=1:2:2")]);
        Runner::new(Ensemble::new(scenario.clone(), plan).unwrap(), Source::Measured(Arc::clone(&record)))
    };
    assert!(runner("filters.EKF.process_std", &scenario).is_ok());
    let refused = runner("seed", &scenario).err().unwrap();
    assert!(refused.to_string().contains("`seed`"), "{refused}");
    let mut other = scenario;
    other.remove_sensor(Quantity::VELOCITY);
    other.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.1));
    let refused = runner("filters.EKF.process_std", &other).err().unwrap();
    assert!(matches!(refused, EnsembleError::Run(RunError::MissingSensor(_))));
}

#[test]
fn a_given_record_follows_the_gain_of_its_input() {
    let mapping = "file = \"a.csv\"\n[time]\nrate = 100.0\n[input]\ncolumn = \"u\"\ngain = 2.0\n";
    let mapping = format!("{mapping}[sensors.displacement]\ncolumn = \"x\"\n[sensors.velocity]\ncolumn = \"v\"\n");
    let mapping = read_toml(&mapping).unwrap();
    let scenario = Scenario { duration: 5.0, ..Scenario::default() };
    let record = Arc::new(simulate(&scenario));
    let scenario = Scenario { record: Some(mapping), ..scenario };
    let plan = plan(&[0], &[Measure::NIS], &["record.input.gain=1:3:3"]);
    let source = Source::Measured(Arc::clone(&record));
    let runner = Runner::new(Ensemble::new(scenario, plan).unwrap(), source).unwrap();
    let runs = runner.runs(&[0, 1, 2]);
    for (run, factor) in runs.iter().zip([0.5, 1.0, 1.5]) {
        let input: Vec<f64> = record.input().iter().map(|u| factor * u).collect();
        assert_eq!(run.as_ref().unwrap().record.input(), input);
    }
    let nis = runner.rows(&[0, 1, 2]);
    assert!(nis[1] < nis[0] && nis[1] < nis[2], "the gain that the record has: {nis:?}");
}

const SLICED: [&str; 2] = ["seed=1:2:2", "filters.EKF.fading=0.5:1.5:3"];

fn in_slices(runner: &Arc<Runner>, cell: usize) -> (Vec<f64>, usize) {
    let (mut work, mut slices) = (cell_task(Arc::clone(runner), cell), 1);
    while !work.advance(&mut || false) {
        slices += 1;
    }
    (work.finish(), slices)
}

fn bits(row: &[f64]) -> Vec<u64> {
    row.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn a_cell_in_slices_has_the_row_of_one_in_one_go() {
    let scenario = Scenario { duration: 3.0, ..Scenario::default() };
    let mut causes = 0;
    for (measures, times) in [
        (&["nis", "nees", "log_likelihood"][..], 0),
        (&["rmse.velocity"], 5),
        (&["verdict", "nis"], 0),
        (&["verdict"], 5),
        (&["verdict", "cause", "nis"], 5),
    ] {
        let runner = runner_of(scenario.clone(), &SLICED, measures, times);
        for cell in 0..6 {
            let row = runner.rows(&[cell]);
            assert_eq!(bits(&in_slices(&runner, cell).0), bits(&row), "{measures:?} {times} {cell}");
            causes += usize::from(measures.contains(&"cause") && row[1].is_finite());
        }
    }
    assert!(causes > 0, "one of the filters is wrong");
}

#[test]
fn a_cell_of_a_large_particle_filter_or_of_a_hard_truth_is_interrupted() {
    let mut large = Scenario { duration: 1.0, ..Scenario::default() };
    (large.filters[1].kind, large.filters[1].ensemble_size) = (FilterKind::PF, 10_000);
    let hard = include_str!("../../tests/hostile/hard-truth.toml");
    let mut hard = Scenario { duration: 0.3, ..Scenario::from_toml(hard).unwrap() };
    hard.filters.insert(0, hard.filters[0].clone());
    hard.filters[0].name = "EKF".to_owned();
    hard.number_filters();
    for (scenario, least) in [(large, 100), (hard, 11)] {
        let runner = runner_of(scenario, &SLICED, &["nis"], 0);
        let (row, slices) = in_slices(&runner, 2);
        assert!(slices >= least, "{slices}");
        assert_eq!(bits(&row), bits(&runner.rows(&[2])));
    }
}
