//! Remarks on a filter as lines of text.

use kalmanscope_core::{Record, Remark, Trouble};

use crate::number::plain;

/// Troubles that a filter has survived and changes that it has made, each with its time.
pub(crate) fn remarks(remarks: &[Remark], record: &Record) -> Vec<String> {
    let line = |remark: &Remark| {
        let [from, to] = [remark.sample, remark.last].map(|number| plain(record.time_of(number)));
        match remark.what {
            Trouble::Widened => format!("let its parameters move at {from} s, where its innovations grew at once"),
            what @ (Trouble::Moved(_) | Trouble::Rounded(_)) => what.to_string(),
            what => format!("from {from} s to {to} s: {what}"),
        }
    };
    remarks.iter().map(line).collect()
}
