//! A check in words, for the message of a failed claim.

use std::fmt;

use kalmanscope_core::Times;

use super::Check;
use crate::cells::Cells;
use crate::value::Expected;

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = |Times { at, from, to }: Times| {
            let one = |word: &str, t: Option<f64>| t.map_or(String::new(), |t| format!(" {word} {t} s"));
            one("at", at) + &one("from", from) + &one("to", to)
        };
        let hindsight = |smoothed: bool| if smoothed { ", smoothed" } else { "" };
        write!(f, "{} of {}{}", self.measure, self.filter, hindsight(self.smoothed))?;
        if let Some(channel) = self.channel {
            write!(f, " in {}", channel.key())?;
        }
        write!(f, "{}", time(self.times()))?;
        if self.is_relative() {
            let before = if self.before { " before" } else { "" };
            let other = self.than.as_deref().unwrap_or("that");
            write!(f, ", over {other}{}{before}", hindsight(self.than_smoothed))?;
            if self.reference_times() != self.times() {
                write!(f, "{}", time(self.reference_times()))?;
            }
        }
        if let Some(Cells { x, y, above, below, is }) = &self.cells {
            limits(f, *above, *below, is.as_ref())?;
            write!(f, "; share of the cells of {x}")?;
            if let Some(y) = y {
                write!(f, " and {y}")?;
            }
        }
        limits(f, self.above, self.below, self.is.as_ref())
    }
}

/// Writes the limits of a number or the expected words.
fn limits(f: &mut fmt::Formatter<'_>, above: Option<f64>, below: Option<f64>, is: Option<&Expected>) -> fmt::Result {
    for (word, limit) in [("above", above), ("below", below)] {
        if let Some(limit) = limit {
            write!(f, ", {word} {limit:?}")?;
        }
    }
    match is {
        Some(Expected::Flag(flag)) => write!(f, ", {flag}"),
        Some(Expected::Word(word)) => write!(f, ", {word}"),
        Some(Expected::OneOf(words)) => write!(f, ", {}", words.join(" or ")),
        None => Ok(()),
    }
}
