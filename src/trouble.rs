//! Why a filter or the truth has stopped, remarks on the filters, the times without readings, and why an edited scenario cannot be run.

use kalmanscope_core::{Quantity, Remark, Trouble};

use crate::session::Session;
use crate::text::{sentence, significant};

pub(crate) struct FilterTrouble {
    pub(crate) sentence: String,
    pub(crate) is_failure: bool,
}

pub(crate) fn troubles(session: &Session) -> Vec<FilterTrouble> {
    let record = session.run().record();
    let mut troubles = Vec::new();
    let mut say = |is_failure, sentence| troubles.push(FilterTrouble { sentence, is_failure });
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
        let is_lasting = |remark: &&Remark| matches!(remark.what, Trouble::Moved(_) | Trouble::Rounded(_));
        if let Some(remark) = estimates.remarks().iter().find(is_lasting) {
            say(false, format!("{name}: {}.", remark.what));
        }
        // Gaps have their own sentence.
        let is_other =
            |remark: &&Remark| !is_lasting(remark) && !matches!(remark.what, Trouble::Widened | Trouble::Missing(_));
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

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    pub(crate) quantity: Quantity,
    /// The times of the first and of the last missing sample \[s\].
    pub(crate) times: (f64, f64),
    pub(crate) is_over: bool,
}

impl Gap {
    pub(crate) fn all(session: &Session) -> Vec<Self> {
        let run = session.run();
        let record = run.record();
        let mut gaps: Vec<Self> = Vec::new();
        for estimates in run.estimates() {
            for remark in estimates.remarks() {
                let Trouble::Missing(quantity) = remark.what else { continue };
                let is_over = remark.last + 1 < estimates.stop().map_or(run.done(), |stop| stop.sample);
                let [from, to] = [remark.sample, remark.last].map(|sample| record.time_of(sample));
                let gap = Self { quantity, times: (from, to), is_over };
                // Each filter with this sensor reports the same gap.
                if !gaps.contains(&gap) {
                    gaps.push(gap);
                }
            }
        }
        gaps
    }

    pub(crate) fn words(&self) -> String {
        let Self { quantity, times: (from, to), is_over } = self;
        let [from, to] = [from, to].map(|time| significant((time * 1e3).round() / 1e3, 6));
        let name = quantity.name();
        if *is_over { format!("no {name} from {from} to {to} s") } else { format!("no {name} since {from} s") }
    }
}
