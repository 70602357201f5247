//! Work on threads against the same work in the frames.

use kalmanscope::session::{Budget, Mode, Session};
use kalmanscope_core::simulate;
use kalmanscope_core::{FilterKind, FilterSettings};

use super::*;

/// Limits the time until work is done, on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// A whole record of a cheap filter and of particle filters, which take long.
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
    session.compute_elsewhere(errands(&Context::default()));
    session.set_mode(Mode::Whole);
    session
}

/// Lets frames pass until all is computed; returns the shares that they show.
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
fn files_and_start_values_come_from_threads_as_from_the_frames() {
    let errands = errands(&Context::default());
    let mut text = "t,force,displacement\n".to_owned();
    let scenario = Scenario { duration: 200.0, ..Scenario::default() };
    let record = simulate(&scenario);
    for k in 0..record.len() {
        text.push_str(&format!("{},{},{}\n", record.time(k), record.force(k), record.measured(0)[k]));
    }
    let mut shares = Vec::new();
    let loaded = outcome(errands.loading(text.as_bytes()).expect("there is a thread"), &mut shares);
    let here = finished(Loading::new(text.clone().into_bytes())).map_err(|error| error.to_string());
    assert_eq!(loaded, here);
    assert!(shares.is_sorted() && shares.iter().all(|share| (0.0..=1.0).contains(share)), "{shares:?}");
    let bad = outcome(errands.loading(b"").expect("there is a thread"), &mut shares);
    assert_eq!(bad, finished(Loading::new(Vec::new())).map_err(|error| error.to_string()));
    assert!(bad.is_err());

    let suggest = errands.suggest(&scenario, &record).expect("there is a thread");
    let suggestion = outcome(suggest, &mut shares);
    assert_eq!(suggestion, finished(Suggest::new(&scenario, record.clone())));
}

#[test]
fn work_that_cannot_be_done_is_lost_and_a_thread_that_is_given_up_ends() {
    let errands =
        Errands { desks: Arc::new(Desks { free: Mutex::new(1), given_back: Condvar::new() }), ctx: Context::default() };
    let record = simulate(&Scenario { duration: 1.0, ..Scenario::default() });
    let mut none = errands.filter(&Scenario::default(), 99, &record).expect("there is a thread");
    let begin = Instant::now();
    while none.next() != Err(Lost) {
        assert!(begin.elapsed() < PATIENCE);
    }
    // Endless work, given up, makes room for the next.
    let endless = errands.begin("endless", |parts: &Parts<u8>| {
        while parts.put(1) {}
        false
    });
    drop(endless);
    let mut next = errands.begin("next", |parts: &Parts<u8>| parts.put(2)).expect("there is a thread");
    while next.next() != Ok(Some(2)) {
        assert!(begin.elapsed() < PATIENCE);
        thread::sleep(Duration::from_millis(1));
    }
    while Arc::strong_count(&errands.desks) > 1 {
        assert!(begin.elapsed() < PATIENCE);
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!((next.next(), next.next()), (Ok(None), Ok(None)), "the end is no loss");
}

fn finished<S: Task>(mut work: S) -> S::Outcome {
    while !work.advance(&mut || true) {}
    work.finish()
}

fn outcome<T>(mut work: Box<dyn Work<Report<T>>>, shares: &mut Vec<f64>) -> T {
    shares.clear();
    let begin = Instant::now();
    loop {
        match work.next() {
            Ok(Some(Report::Done(outcome))) => return outcome,
            Ok(Some(Report::Share(share))) => shares.push(share),
            Ok(None) => thread::sleep(Duration::from_millis(1)),
            Err(Lost) => panic!("it is lost"),
        }
        assert!(begin.elapsed() < PATIENCE);
    }
}
