//! Why a filter or the truth has stopped, remarks on the filters, and why an edited scenario cannot be run.

use kalmanscope_core::{Remark, Trouble as Told};

use crate::gap::Gap;
use crate::session::Session;
use crate::text::sentence;

pub(crate) struct Trouble {
    pub(crate) sentence: String,
    pub(crate) is_failure: bool,
}

pub(crate) fn troubles(session: &Session) -> Vec<Trouble> {
    let record = session.run().record();
    let mut troubles = Vec::new();
    let mut say = |is_failure, sentence| troubles.push(Trouble { sentence, is_failure });
    if let Some(stop) = session.run().truth_stop() {
        let time = record.time_of(stop.sample);
        say(true, format!("The record ends before {time:.2} s: {}.", stop.reason));
    }
    for estimates in session.run().estimates() {
        let name = estimates.name();
        if let Some(stop) = estimates.stop() {
            let time = record.time_of(stop.sample);
            say(true, format!("{name} stopped at {time:.2} s: {}.", stop.reason));
        }
        let jumps: Vec<String> = estimates.jumps().map(|sample| format!("{:.2}", record.time_of(sample))).collect();
        if let [others @ .., last] = jumps.as_slice() {
            let times = if others.is_empty() { last.clone() } else { format!("{} and {last}", others.join(", ")) };
            say(false, format!("{name} let its parameters move at {times} s, where its innovations grew at once."));
        }
        // It is so from the beginning to the end.
        if let Some(remark) =
            estimates.remarks().iter().find(|remark| matches!(remark.what, Told::Moved(_) | Told::Rounded(_)))
        {
            say(false, format!("{name}: {}.", remark.what));
        }
        // Gaps have their own sentence.
        let is_other = |remark: &&Remark| {
            !matches!(remark.what, Told::Widened | Told::Missing(_) | Told::Moved(_) | Told::Rounded(_))
        };
        if let Some(remark) = estimates.remarks().iter().rfind(is_other) {
            let time = record.time_of(remark.sample);
            say(false, format!("{name} from {time:.2} s: {}.", remark.what));
        }
    }
    // A gap that is over is marked on the time axis.
    for gap in Gap::all(session).iter().filter(|gap| !gap.is_over) {
        say(false, format!("{}.", sentence(&gap.words())));
    }
    if let Some(problem) = session.problem() {
        say(true, problem.to_owned());
    }
    troubles
}
