//! The time of whole maps, by all processors and by a graphics processor, and of Monte Carlo, in one run. A software adapter shows by its
//! name.
//!
//! ```text
//! cargo bench -p kalmanscope-gpu
//! ```
//!
//! The map is of a guess and the noise of a process. Each number is the least of a few repeats, but for the preparation: a kind of
//! filters is translated for the graphics processor once, before its first picture.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use kalmanscope_core::import::{build, read};
use kalmanscope_core::{Axis, FilterKind, PlantKind, Quantity, Scenario, Source};
use kalmanscope_diagnosis::Measure;
use kalmanscope_gpu::{Gpu, Software};
use kalmanscope_lab::{Ensemble, EnsembleRows, MonteCarlo, Plan, Priority, RunVerdicts, Runner, Threads, channels};

/// Cells along each axis of the maps, and of the largest one, and samples of a simulated record.
const SIDE: usize = 128;
const LARGE: usize = 512;
const SAMPLES: usize = 2000;

const SEEDS: usize = 10_000;
const LONG: usize = 6000;

const SMALLEST: &str = "linear oscillator";

const REPEATS: usize = 3;

const COARSE: usize = 64;

fn main() {
    let team = Threads::new(0, 0).expect("threads can be started");
    let gpu = pollster::block_on(Gpu::find(Software::Allowed));
    match &gpu {
        Ok(gpu) => println!("{} threads against {}, single precision\n", team.count, gpu.name),
        Err(error) => println!("{} threads, without a graphics processor: {error}\n", team.count),
    }
    println!(
        "| map | cells | threads | threads, first picture | preparation | graphics | graphics, first picture | times as fast |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, scenario, source) in situations() {
        for kind in [FilterKind::EKF, FilterKind::UKF] {
            let mut scenario = scenario.clone();
            scenario.filters[0].kind = kind;
            let sides: &[usize] = if name == SMALLEST { &[SIDE, LARGE] } else { &[SIDE] };
            for &side in sides {
                line(&format!("{name}, {}", kind.name()), &map(&scenario, &source, side), &team, gpu.as_ref().ok());
            }
        }
    }
    println!();
    monte_carlo(&team);
}

fn situations() -> Vec<(&'static str, Scenario, Source)> {
    let built_in = |plant: PlantKind| {
        let mut scenario = Scenario { duration: (SAMPLES - 1) as f64 * 0.01, ..Scenario::default() };
        scenario.filters.truncate(1);
        scenario.set_plant(plant.clone());
        scenario.set_sensors(&plant.quantities().take(2).collect::<Vec<Quantity>>());
        scenario
    };
    let mut pendulum = read_scenario("equations/pendulum.toml");
    (pendulum.duration, pendulum.dt) = ((SAMPLES - 1) as f64 * 0.01, 0.01);
    let circuit = read_scenario("scenarios/circuit.toml");
    let bytes = std::fs::read(asset("records/circuit.csv")).expect("the record is there");
    let table = read(bytes, None).expect("it is a table");
    let mapping = circuit.record.clone().expect("the scenario has a record");
    let built = build(&table, &mapping, circuit.input, circuit.hold, &[]);
    let record = built.expect("the record can be read").record;
    let mut situations = vec![
        (SMALLEST, built_in(PlantKind::SDOF), Source::Simulated),
        ("Duffing", built_in(PlantKind::DUFFING), Source::Simulated),
        ("Bouc-Wen", built_in(PlantKind::BOUC_WEN), Source::Simulated),
        ("two masses", built_in(PlantKind::SHEAR_2), Source::Simulated),
        ("pendulum as an equation", pendulum, Source::Simulated),
        ("measured circuit", circuit, Source::Measured(Arc::new(record))),
    ];
    for (_, scenario, _) in &mut situations {
        scenario.filters.truncate(1);
        scenario.filters[0].name = "filter".to_owned();
    }
    situations
}

fn asset(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(path)
}

fn read_scenario(path: &str) -> Scenario {
    let text = std::fs::read_to_string(asset(path)).expect("the scenario is there");
    Scenario::from_toml(&text).expect("the scenario is valid")
}

fn map(scenario: &Scenario, source: &Source, side: usize) -> Arc<Runner> {
    let parameter = scenario.plant.kind.parameters().next().expect("a plant has a parameter");
    let (key, guess) = (parameter.key(), scenario.filters[0].initial_mean[parameter]);
    let axes = [
        format!("filters.filter.initial_mean.{key}={}:{}:{side}", 0.5 * guess, 2.0 * guess),
        format!("filters.filter.process_std=0.01:100:{side}:log"),
    ];
    let axes = axes.iter().map(|text| Axis::parse(text).expect("the axis is right")).collect();
    let measures = Measure::of_sums(&channels(scenario, &[0]));
    let plan = Plan { filters: vec![0], measures, axes, ..Plan::default() };
    let ensemble = Ensemble::new(scenario.clone(), plan).expect("the map is possible");
    Arc::new(Runner::new(ensemble, source.clone()).expect("the map can run"))
}

fn line(name: &str, runner: &Arc<Runner>, team: &Threads, gpu: Option<&Gpu>) {
    let cells = runner.ensemble().cells();
    let (first, all) = least_of_pairs(|| fill(team, runner));
    print!("| {name} | {cells} | {} | {} ", seconds(all), seconds(first));
    let Some(gpu) = gpu.filter(|_| Gpu::serves(runner)) else {
        println!("| not served | | | |");
        return;
    };
    let order: Vec<usize> = runner.ensemble().coarse_to_fine();
    let time = |cells: &[usize]| {
        let begin = Instant::now();
        let rows = pollster::block_on(gpu.rows(runner, cells, &|| true));
        assert!(rows.is_ok_and(|(served, _)| served == cells));
        begin.elapsed()
    };
    let cold = time(&order[..COARSE]);
    let (coarse, whole) = least_of_pairs(|| (time(&order[..COARSE]), time(&order)));
    println!(
        "| {} | {} | {} | {:.1} |",
        seconds(cold.saturating_sub(coarse)),
        seconds(whole),
        seconds(coarse),
        all.as_secs_f64() / whole.as_secs_f64()
    );
}

fn monte_carlo(team: &Threads) {
    let scenario = Scenario { duration: LONG as f64 * 0.01, ..Scenario::default() };
    for times in [0, 60] {
        let ensemble = MonteCarlo::ensemble(scenario.clone(), vec![0], SEEDS, times, RunVerdicts::Not)
            .expect("Monte Carlo is possible");
        let runner = Arc::new(Runner::new(ensemble, Source::Simulated).expect("Monte Carlo can run"));
        let (_, all) = fill(team, &runner);
        let each = all.as_secs_f64() * 1e9 / (SEEDS * LONG) as f64;
        println!(
            "Monte Carlo of {SEEDS} seeds × {LONG} samples, looked at at {times} times, {} threads: {}, {each:.0} ns a sample",
            team.count,
            seconds(all),
        );
    }
}

fn fill(team: &Threads, runner: &Arc<Runner>) -> (Duration, Duration) {
    let begin = Instant::now();
    let mut sheet = EnsembleRows::new(runner.ensemble());
    let work = team.rows(Priority::Map, runner, runner.ensemble().coarse_to_fine(), |_| {});
    let mut first = None;
    while let Some(slice) = work.wait() {
        sheet.fill(&slice.cells, &slice.rows);
        if first.is_none() && sheet.covers_all() {
            first = Some(begin.elapsed());
        }
    }
    assert!(sheet.is_complete());
    (first.unwrap_or_default(), begin.elapsed())
}

fn least_of_pairs(mut measure: impl FnMut() -> (Duration, Duration)) -> (Duration, Duration) {
    (0..REPEATS).map(|_| measure()).fold((Duration::MAX, Duration::MAX), |(a, b), (c, d)| (a.min(c), b.min(d)))
}

fn seconds(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 1.0 { format!("{:.0} ms", 1e3 * seconds) } else { format!("{seconds:.2} s") }
}
