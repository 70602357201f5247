//! Work of the team against the same work in the frames.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use kalmanscope::session::{Budget, Mode, ModelTime, Session};
use kalmanscope::team::{CellBatch, Dispatch, Finding, Lost, Precision, Priority};
use kalmanscope_core::simulate;
use kalmanscope_core::{Axis, FilterKind, FilterSettings, Scenario, Source};
use kalmanscope_diagnosis::{Measure, Wanted};
use kalmanscope_lab::{Ensemble, EnsembleRows, Plan, Runner};

use super::*;

const PATIENCE: Duration = Duration::from_secs(120);

fn desktop() -> Rc<dyn Team> {
    team(Software::Allowed, &Context::default())
}

fn scenario() -> Scenario {
    let mut scenario = Scenario { duration: 40.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    for size in [1000, 1500] {
        let name = format!("PF {size}");
        let filter =
            FilterSettings { id: 0, name, kind: FilterKind::PF, ensemble_size: size, ..scenario.filters[0].clone() };
        scenario.filters.push(filter);
    }
    scenario.number_filters();
    scenario
}

fn session(scenario: Scenario) -> Session {
    let mut session = Session::new(scenario).expect("it can be run");
    session.pause();
    session.set_budget(Budget::FRAME);
    session.work_with(desktop());
    session.set_mode(Mode::Whole);
    session
}

fn wait(session: &mut Session) -> Vec<f64> {
    let (begin, mut shares) = (Instant::now(), Vec::new());
    while let Some(share) = session.progress() {
        shares.push(share);
        session.advance(0.1);
        thread::sleep(Duration::from_millis(2));
        assert!(begin.elapsed() < PATIENCE, "{shares:?}");
    }
    shares
}

fn assert_right(session: &Session) {
    let mut at_once = Session::new(session.scenario().clone()).expect("it can be run");
    at_once.set_mode(Mode::Whole);
    assert!(!session.behind() && session.run().scenario() == session.scenario());
    assert_eq!(session.run().checksum(), at_once.run().checksum());
}

#[test]
fn long_filters_on_threads_have_the_bits_of_those_in_the_frames() {
    let mut session = session(scenario());
    let shares = wait(&mut session);
    assert!(shares.len() > 3 && shares.is_sorted(), "{shares:?}");
    assert_right(&session);
    // An edit while a thread is busy gives that work up.
    session.set_scenario(Scenario { seed: 7, ..session.scenario().clone() });
    session.advance(0.1);
    session.set_scenario(Scenario { seed: 8, ..session.scenario().clone() });
    wait(&mut session);
    assert_right(&session);
    // Esc keeps the picture before.
    session.set_scenario(Scenario { seed: 9, ..session.scenario().clone() });
    session.advance(0.1);
    assert!(session.cancel());
    assert_eq!(session.run().scenario().seed, 8);
}

#[test]
fn causes_free_runs_and_spectrograms_come_from_threads_as_from_the_frames() {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    scenario.number_filters();
    // A filter that is too sure of its sensors has causes.
    scenario.filters[0].sensor_std.iter_mut().for_each(|std| *std *= 0.2);
    let id = scenario.filters[0].id;
    let seen = |team: Option<Rc<dyn Team>>| {
        let mut session = Session::new(scenario.clone()).expect("it can be run");
        session.pause();
        team.into_iter().for_each(|team| session.work_with(team));
        session.set_mode(Mode::Whole);
        session.want(Wanted { diagnostics: true, ..Wanted::default() });
        session.want_trials(vec![id]);
        session.want_free_runs(Some(ModelTime::Last));
        session.want_spectrogram(true);
        let begin = Instant::now();
        while session.behind() || session.is_trying() || session.is_free_run_behind() || session.spectrogram().is_none()
        {
            session.advance(0.1);
            thread::sleep(Duration::from_millis(2));
            assert!(begin.elapsed() < PATIENCE);
        }
        let remedies = session.attempt(id).expect("it has a bad verdict").remedies.clone();
        assert!(!remedies.is_empty());
        format!("{remedies:?} {:?} {:?}", session.free_run(0), session.spectrogram().map(|(_, made)| made))
    };
    assert!(seen(Some(desktop())) == seen(None));
}

#[test]
fn a_filter_that_cannot_be_run_is_lost() {
    let team = desktop();
    let record = simulate(&Scenario { duration: 1.0, ..Scenario::default() });
    let mut none = team.filter(&Scenario::default(), 99, &record).expect("there is a thread");
    let begin = Instant::now();
    while none.take().map(|tape| assert!(tape.is_none())) != Err(Lost) {
        assert!(begin.elapsed() < PATIENCE);
    }
}

fn ensemble(side: usize) -> Ensemble {
    let scenario = Scenario { duration: 10.0, ..Scenario::default() };
    let axes = [format!("filters.EKF.process_std=0.1:10:{side}:log"), format!("filters.EKF.sensor_std=0.2:5:{side}")];
    let axes = axes.iter().map(|text| Axis::parse(text).expect("it is an axis")).collect();
    let plan = Plan { filters: vec![0], measures: vec![Measure::NIS], axes, ..Plan::default() };
    Ensemble::new(scenario, plan).expect("it is possible")
}

fn compute(team: &Rc<dyn Team>, ensemble: &Ensemble, precision: Precision) -> (EnsembleRows, HashMap<String, usize>) {
    let runner = Runner::new(ensemble.clone(), Source::Simulated).expect("it can be run");
    let (runner, order, priority) = (Arc::new(runner), ensemble.coarse_to_fine(), Priority::Map);
    let mut work = Dispatch::new(team, CellBatch { runner, order, precision, priority }, &Context::default());
    let (mut sheet, mut by, begin) = (EnsembleRows::new(ensemble), HashMap::new(), Instant::now());
    while !sheet.is_complete() {
        for rows in work.take() {
            sheet.fill(&rows.cells, &rows.numbers);
            *by.entry(rows.by.to_string()).or_default() += rows.cells.len();
        }
        assert!(begin.elapsed() < PATIENCE, "{} of {} cells, {by:?}", sheet.done(), sheet.len());
        thread::sleep(Duration::from_millis(2));
    }
    (sheet, by)
}

fn finding(team: &Rc<dyn Team>) -> Option<Finding> {
    team.graphics().map(|graphics| graphics.found())
}

fn is_by_graphics(by: &str) -> bool {
    by.starts_with("in single precision by ")
}

fn rows(ensemble: &Ensemble) -> Vec<f64> {
    let cells: Vec<usize> = (0..ensemble.cells()).collect();
    Runner::new(ensemble.clone(), Source::Simulated).expect("it is possible").rows(&cells)
}

fn all(sheet: &EnsembleRows) -> Vec<f64> {
    (0..sheet.len()).flat_map(|cell| sheet.row(cell).expect("it is known").to_vec()).collect()
}

/// Needs a Vulkan driver; a software one such as Mesa's lavapipe is enough.
#[test]
fn a_processor_that_is_found_serves_the_next_map() {
    let team = desktop();
    let ensemble = ensemble(24);
    assert_eq!(finding(&team), Some(Finding::Searching), "nobody looks before the first map");
    let begin = Instant::now();
    let (first, _) = compute(&team, &ensemble, Precision::Fastest);
    while finding(&team) == Some(Finding::Searching) && begin.elapsed() < PATIENCE {
        thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(finding(&team), Some(Finding::Ready));
    let (second, by) = compute(&team, &ensemble, Precision::Fastest);
    assert!(by.len() == 1 && by.keys().all(|by| is_by_graphics(by)), "{by:?}");
    for (number, exact) in all(&first).iter().chain(&all(&second)).zip(rows(&ensemble).iter().cycle()) {
        assert!((number - exact).abs() <= 1e-3 * exact, "{number} {exact}");
    }
    let (exact, by) = compute(&team, &ensemble, Precision::Double);
    assert!(by.keys().all(|by| !is_by_graphics(by)), "{by:?}");
    assert_eq!(all(&exact), rows(&ensemble));
}
