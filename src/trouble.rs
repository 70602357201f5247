//! Why a filter or the truth has stopped, remarks on the filters, and why an edited scenario cannot be run.

use kalmanscope_core::{self as core, Remark};

use crate::session::Session;

/// One of them, as a sentence.
pub(crate) struct Trouble {
    pub(crate) sentence: String,
    /// Whether something has stopped or cannot be run.
    pub(crate) is_failure: bool,
}

/// All that there is to say.
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
            say(false, format!("{name} widened its parameters at {times} s, where its innovations grew at once."));
        }
        let is_trouble = |remark: &&Remark| remark.what != core::Trouble::Widened;
        if let Some(remark) = estimates.remarks().iter().rfind(is_trouble) {
            let time = record.time_of(remark.sample);
            say(false, format!("{name} from {time:.2} s: {}.", remark.what));
        }
    }
    if let Some(problem) = session.problem() {
        say(true, problem.to_owned());
    }
    troubles
}
