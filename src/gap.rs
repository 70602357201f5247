//! The times in which a sensor delivers nothing.

use kalmanscope_core::{Quantity, Trouble};

use crate::session::Session;
use crate::text::significant;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    pub(crate) quantity: Quantity,
    /// The times of the first and of the last missing sample \[s\].
    pub(crate) times: (f64, f64),
    pub(crate) is_over: bool,
}

impl Gap {
    /// All gaps so far, each once: a sensor is silent for all filters.
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
