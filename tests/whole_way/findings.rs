//! Stages of a case: each has a name and may take a limited time. A wrong result is a panic, which ends the case.

use std::cell::Cell;

use crate::clock::Moment;

/// Limits the processor time of one stage, in an explorer without optimisation, which takes at least twice as long as a release
/// \[ms\]: of one that a screen cannot interrupt, such as a frame, and of one that is divided on a screen, such as a run or the
/// search for remedies.
const FREEZE: [f64; 2] = [2000.0, 20_000.0];

/// The stages that a screen divides into slices of time.
const DIVIDED: [&str; 8] = [
    "running",
    "running over the record",
    "analysis",
    "causes",
    "free runs",
    "report",
    "start values",
    "estimates as CSV",
];

thread_local! {
    static STAGE: Cell<&'static str> = const { Cell::new("") };
}

/// The stage that this thread is in.
pub(crate) fn current() -> &'static str {
    STAGE.get()
}

/// Does a part of a case.
pub(crate) fn stage<T>(name: &'static str, work: impl FnOnce() -> T) -> T {
    STAGE.set(name);
    let begin = Moment::now();
    let result = work();
    let cpu = begin.elapsed().cpu;
    assert!(cpu <= FREEZE[usize::from(DIVIDED.contains(&name))], "it takes {cpu:.0} ms");
    result
}

/// Refuses in a sentence, or panics where there is none.
pub(crate) fn accepted<T, E: ToString>(result: Result<T, E>) -> Option<T> {
    let refused = |error: E| {
        let error = error.to_string();
        let is_sentence = error.split_whitespace().count() > 2 && !error.contains("panicked");
        assert!(is_sentence, "it refuses without a sentence: {error}");
    };
    result.map_err(refused).ok()
}
