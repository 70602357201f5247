//! Stages of a case: a panic, a freeze or a wrong result in one is a finding, and the case goes on.

use std::backtrace::Backtrace;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::Mutex;

use crate::clock::{Elapsed, Moment};

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
    /// The last panic of this thread: its place and its message.
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps the panics of stages for [`Findings::stage`], in place of printing them.
/// With `aloud`, says where each of them comes from.
pub(crate) fn keep_panics(aloud: bool) {
    std::panic::set_hook(Box::new(move |info: &PanicHookInfo<'_>| {
        let place = info.location().map_or_else(String::new, |at| format!("{}:{}", at.file(), at.line()));
        let message = info.payload_as_str().unwrap_or_default();
        let panic = format!("{place}: {}", message.lines().next().unwrap_or_default());
        if aloud {
            println!("{panic}\n{}", Backtrace::force_capture());
        }
        PANIC.with_borrow_mut(|kept| {
            // A second panic ends the program.
            if let Some(first) = kept {
                let name = std::thread::current().name().unwrap_or_default().to_owned();
                eprintln!("{name} panics at {first}\nand then at {panic}");
            }
            *kept = Some(panic);
        });
    }));
}

/// The stage that each case is in, by the name of its thread.
static STAGES: Mutex<BTreeMap<String, &'static str>> = Mutex::new(BTreeMap::new());

pub(crate) fn stage_of(case: &str) -> &'static str {
    STAGES.lock().ok().and_then(|stages| stages.get(case).copied()).unwrap_or_default()
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Finding {
    pub(crate) stage: &'static str,
    /// The fault in words. Cases that go wrong in the same way have the same words.
    pub(crate) what: String,
    pub(crate) detail: String,
}

/// The findings of one case, and the processor time of its longest stage \[ms\].
#[derive(Default)]
pub(crate) struct Findings {
    pub(crate) all: Vec<Finding>,
    pub(crate) longest: f64,
}

impl Findings {
    /// Does a part of the case. `None` where it panics.
    pub(crate) fn stage<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> Option<T> {
        if let (Ok(mut stages), Some(name)) = (STAGES.lock(), std::thread::current().name()) {
            stages.insert(name.to_owned(), stage);
        }
        let begin = Moment::now();
        let result = catch_unwind(AssertUnwindSafe(work));
        let Elapsed { cpu, wall: _ } = begin.elapsed();
        self.longest = self.longest.max(cpu);
        if cpu > FREEZE[usize::from(DIVIDED.contains(&stage))] {
            self.add(stage, "takes too long", format!("{cpu:.0} ms"));
        }
        if result.is_err() {
            let panic = PANIC.with_borrow_mut(Option::take).unwrap_or_default();
            // Messages have numbers of this case.
            let (place, message) = panic.split_once(": ").unwrap_or((&panic, ""));
            self.add(stage, &format!("panics at {place}"), message.to_owned());
        }
        result.ok()
    }

    /// Notes a violated rule, whose name is `what`.
    pub(crate) fn require(&mut self, stage: &'static str, holds: bool, what: &str, detail: impl FnOnce() -> String) {
        if !holds {
            self.add(stage, what, detail());
        }
    }

    fn add(&mut self, stage: &'static str, what: &str, detail: String) {
        self.all.push(Finding { stage, what: what.to_owned(), detail });
    }
}
