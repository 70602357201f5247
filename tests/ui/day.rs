//! A simulated day, played frame by frame, takes bounded memory: in a process without other tests.

use std::collections::BTreeSet;
use std::process::Command;

use kalmanscope::session::{Mode, Session, Wanted};
use kalmanscope_core::Scenario;
use kalmanscope_diagnosis::{Diagnosis, VerdictKind};

/// A day at 100 Hz with an EKF: 8.64 million samples.
fn day() -> Scenario {
    let mut scenario = Scenario { duration: 86_400.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    assert_eq!((scenario.dt, scenario.samples()), (0.01, 8_640_001));
    scenario
}

/// The peak memory of this process \[bytes\], where the system reports it.
fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().strip_suffix(" kB")?.parse::<usize>().ok()?)
}

/// Asserts that no per-sample history is longer than the kept samples.
fn assert_bounded(session: &Session) {
    let (run, record) = (session.run(), session.run().record());
    let mut lengths = BTreeSet::from([run.len(), record.len(), record.input().len()]);
    lengths.extend((0..record.sensors().len()).map(|sensor| record.measured(sensor).len()));
    lengths.extend(record.true_channels().into_iter().filter_map(|c| record.truth(c)).map(<[f64]>::len));
    for estimates in run.estimates() {
        lengths.extend([estimates.len(), estimates.nis().len(), estimates.determinant().len()]);
    }
    lengths.extend(session.diagnostics().iter().flat_map(|d| [d.len(), d.nees().len()]));
    lengths.extend(session.bounds().iter().map(|of| of.bound.len()));
    assert_eq!(lengths.len(), 1, "not all are as long as the others: {lengths:?}");
    assert!(run.len() <= Session::KEPT, "{} samples are kept", run.len());
    assert!(run.estimates()[0].remarks().len() < 100);
}

#[test]
fn a_day_passes_in_bounded_memory() {
    let mut alone = Command::new(std::env::current_exe().expect("this is a program"));
    let status = alone.args(["--exact", "day::alone", "--ignored"]).status().expect("it can be started again");
    assert!(status.success(), "{status}");
}

#[test]
#[ignore = "the test above starts it"]
fn alone() {
    let scenario = day();
    let mut session = Session::new(scenario.clone()).expect("the scenario is possible");
    assert!(!session.can_be_whole() && session.mode() == Mode::Live);
    session.want(Wanted { bounds: true, ..Wanted::default() });
    // Per frame, the number of samples of 200 s.
    session.set_speed(2000.0);
    let (mut frames, mut forgotten, mut generation) = (0, 0, session.generation());
    let mut early = None;
    while session.playing() {
        let (done, time) = (session.run().done(), session.time());
        session.advance(0.1);
        frames += 1;
        assert!(!session.behind() && session.run().done() <= done + 20_000, "a frame takes too much at once");
        assert!((session.time() - time - 200.0).abs() < 1e-6, "{} s after {time} s", session.time());
        assert_bounded(&session);
        let now = session.run().record().forgotten();
        assert_eq!(now != forgotten, session.generation() != generation, "indices changed their meaning unannounced");
        (forgotten, generation) = (now, session.generation());
        if frames == 20 {
            early = peak_memory();
        }
    }
    assert_eq!(frames, 432);
    if let (Some(early), Some(late)) = (early, peak_memory()) {
        // The estimates of a whole day are 2.5 GB.
        assert!(late < early + 10_000_000, "the memory has grown from {early} to {late} bytes");
    }

    let (run, last) = (session.run(), session.index());
    assert_eq!((session.position(), run.done(), run.samples()), (8_640_000, 8_640_001, 8_640_001));
    assert_eq!((session.time(), session.end(), run.record().time(last)), (86_400.0, 86_400.0, 86_400.0));
    assert_eq!(forgotten + last, 8_640_000);
    let ekf = &run.estimates()[0];
    assert_eq!((ekf.stop(), ekf.len()), (None, last + 1));
    let verdict = Diagnosis::new(&session.diagnostics()[0], ekf, run.record()).unwrap().verdict.unwrap();
    assert!(verdict.kind == VerdictKind::Consistent && !verdict.reason.contains("at first"), "{verdict}");
}
