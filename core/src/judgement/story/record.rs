//! The sentence of a measured record.

use super::number::seconds;
use super::phrase::{Phrase, Writer};
use crate::Run;

/// How long the record is, and of what.
pub(super) fn sentence(run: &Run) -> Vec<Phrase> {
    let (scenario, record) = (run.scenario(), run.record());
    let used: Vec<String> = scenario.sensors.iter().map(|sensor| sensor.measures.name()).collect();
    let of = match used.split_last() {
        None => "nothing".to_owned(),
        Some((only, [])) => only.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    };
    let length = record.dt() * run.samples().saturating_sub(1) as f64;
    let input = if has_input(run) { "" } else { ", and no input" };
    let (begin, so_far) =
        if run.is_live() { ("It is being measured: ", " so far") } else { ("A measured record: ", "") };
    let text = Writer::default().say(begin).result(seconds(length));
    text.say(format!(" of {of}{so_far}{input}.")).done()
}

/// Whether anything drives the record.
pub(super) fn has_input(run: &Run) -> bool {
    run.record().input().iter().any(|input| *input != 0.0)
}
