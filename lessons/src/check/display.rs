//! A check in words, for the message of a failed claim.

use std::fmt;

use super::{Check, Times};
use crate::value::Expected;

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = |Times { at, from, to }: Times| {
            let one = |word: &str, t: Option<f64>| t.map_or(String::new(), |t| format!(" {word} {t} s"));
            one("at", at) + &one("from", from) + &one("to", to)
        };
        let hindsight = |smoothed: bool| if smoothed { ", smoothed" } else { "" };
        write!(f, "{} of {}{}", self.measure.key(), self.filter, hindsight(self.smoothed))?;
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
        for (word, limit) in [("above", self.above), ("below", self.below)] {
            if let Some(limit) = limit {
                write!(f, ", {word} {limit:?}")?;
            }
        }
        match &self.is {
            Some(Expected::Flag(flag)) => write!(f, ", {flag}"),
            Some(Expected::Word(word)) => write!(f, ", {word}"),
            Some(Expected::OneOf(words)) => write!(f, ", {}", words.join(" or ")),
            None => Ok(()),
        }
    }
}
