//! Remarks on a filter as lines of text.

use kalmanscope_core::{Estimates, Record, Trouble};

use crate::number::plain;

/// What a filter has survived or done, each with its time.
pub(crate) fn remarks(estimates: &Estimates, record: &Record) -> Vec<String> {
    let line = |remark: &kalmanscope_core::Remark| {
        let [from, to] = [remark.sample, remark.last].map(|number| plain(record.time_of(number)));
        match remark.what {
            Trouble::Widened => format!("widened its parameters at {from} s, where its innovations grew at once"),
            what => format!("from {from} s to {to} s: {what}"),
        }
    };
    estimates.remarks().iter().map(line).collect()
}
