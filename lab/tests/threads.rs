use std::sync::{Arc, Barrier, Mutex, mpsc};

use kalmanscope_core::{Scenario, Source};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{Ensemble, EnsembleRows, Lost, Priority, Runner, Slice, Threads, WorkStep};

use crate::ensemble::plan;

fn runner() -> Arc<Runner> {
    let scenario = Scenario { duration: 3.0, ..Scenario::default() };
    let measures = [Measure::NIS, Measure::LOG_LIKELIHOOD];
    let plan = plan(&[0], &measures, &["seed=1:3:3", "filters.EKF.initial_mean.natural_frequency=2:20:40"]);
    Arc::new(Runner::new(Ensemble::new(scenario, plan).unwrap(), Source::Simulated).unwrap())
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let runner = runner();
    let cells: Vec<usize> = (0..runner.ensemble().cells()).collect();
    let expected = runner.rows(&cells);
    for threads in [1, 2, 5] {
        let team = Threads::new(threads, 0).unwrap();
        let work = team.rows(Priority::Map, &runner, runner.ensemble().coarse_to_fine(), |_| {});
        let mut sheet = EnsembleRows::new(runner.ensemble());
        while let Some(Slice { cells, rows }) = work.wait() {
            sheet.fill(&cells, &rows);
        }
        assert!(sheet.is_complete());
        let rows: Vec<f64> = cells.iter().flat_map(|&cell| sheet.row(cell).unwrap().to_vec()).collect();
        assert_eq!(rows, expected);
        assert_eq!(work.take(), Ok(None), "the end is no loss");
    }
}

#[test]
fn dropped_work_ends() {
    let team = Threads::new(1, 0).unwrap();
    let runner = runner();
    let order: Vec<usize> = (0..120).cycle().take(2_000_000).collect();
    let work = team.rows(Priority::Map, &runner, order, |_| {});
    assert!(work.wait().is_some());
    drop(work);
    let next = team.rows(Priority::Seeds, &runner, vec![5], |_| {});
    assert_eq!(next.wait().unwrap(), Slice { cells: vec![5], rows: runner.rows(&[5]) });
    assert!(next.wait().is_none());
}

#[test]
fn the_hand_comes_before_the_map_and_the_map_before_causes() {
    let team = Threads::new(1, 0).unwrap();
    let (begun, seen) = (Arc::new(Barrier::new(2)), Arc::new(Mutex::new(Vec::new())));
    let gate = Arc::clone(&begun);
    let busy = team.begin(Priority::Hand, [move |_| (gate.wait(), WorkStep::Last(())).1], |_| {});
    let work = [Priority::Causes, Priority::Map, Priority::Seeds, Priority::Hand].map(|priority| {
        let (seen, mut left) = (Arc::clone(&seen), 2);
        let step = move |_| {
            seen.lock().unwrap().push(priority);
            left -= 1;
            if left > 0 { WorkStep::Part(()) } else { WorkStep::Last(()) }
        };
        team.begin(priority, [step], |_| {})
    });
    begun.wait();
    assert_eq!(busy.wait(), Some(()));
    for work in work {
        while work.wait().is_some() {}
    }
    assert!(seen.lock().unwrap().is_sorted() && seen.lock().unwrap().len() == 8);
}

#[test]
fn a_thread_for_the_hand_does_not_wait_for_a_map() {
    let team = Threads::new(1, 1).unwrap();
    let (begun, ended) = (Arc::new(Barrier::new(2)), Arc::new(Barrier::new(2)));
    let (begin, end) = (Arc::clone(&begun), Arc::clone(&ended));
    let map = team.begin(Priority::Map, [move |_| (begin.wait(), end.wait(), WorkStep::Last(1)).2], |_| {});
    begun.wait();
    assert_eq!(team.begin(Priority::Hand, [|_| WorkStep::Last(2)], |_| {}).wait(), Some(2));
    ended.wait();
    assert_eq!(map.wait(), Some(1));
}

#[test]
fn work_that_fails_is_lost_and_the_team_goes_on() {
    let team = Threads::new(1, 0).unwrap();
    let failed = team.begin(Priority::Hand, [|_| WorkStep::<u8>::Failed], |_| {});
    let broken = team.begin(Priority::Hand, [|_| -> WorkStep<u8> { panic!("a test of a panic") }], |_| {});
    assert_eq!((failed.wait(), broken.wait()), (None, None));
    assert_eq!((failed.take(), broken.take()), (Err(Lost), Err(Lost)));
    assert_eq!(team.begin(Priority::Hand, [|_| WorkStep::Last(3)], |_| {}).wait(), Some(3));
}

#[test]
fn work_that_waits_when_the_team_ends_is_lost() {
    let team = Threads::new(1, 0).unwrap();
    let (begun, ended) = (Arc::new(Barrier::new(2)), Arc::new(Barrier::new(2)));
    let (begin, end) = (Arc::clone(&begun), Arc::clone(&ended));
    let busy = team.begin(Priority::Hand, [move |_| (begin.wait(), end.wait(), WorkStep::Part(1)).2], |_| {});
    let (sender, woken) = mpsc::channel();
    let waits = team.begin(Priority::Map, [|_| WorkStep::Last(2)], move |is_over| sender.send(is_over).unwrap());
    begun.wait();
    drop(team);
    assert_eq!((woken.recv(), waits.take()), (Ok(true), Err(Lost)));
    ended.wait();
    assert_eq!((busy.wait(), busy.wait(), busy.take()), (Some(1), None, Err(Lost)));
}
