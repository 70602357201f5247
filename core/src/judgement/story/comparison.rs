//! A filter beside itself before a change.

use super::phrase::{Phrase, Writer};
use crate::numbers::diagnostics::ErrorSums;
use crate::{Channel, Diagnostics};

/// Two errors that differ by less than this factor are equally large.
const EQUAL: f64 = 1.05;

/// Limits the filters that are compared.
const MOST: usize = 2;

/// How much larger or smaller the errors of filters were before a change.
pub(super) fn sentence(words: &str, filters: &[(u32, &str, &Diagnostics, &Diagnostics)]) -> Option<Vec<Phrase>> {
    let compared = filters.iter().filter_map(|(id, name, before, now)| {
        let channel = now.known().find(|channel| channel.is_parameter())?;
        let ratio = lately(before, channel)? / lately(now, channel)?;
        (ratio.is_finite() && ratio > 0.0).then_some((*id, *name, channel, ratio))
    });
    let mut text = Writer::default().say(format!("Before ({words})"));
    let mut is_empty = true;
    for (id, name, channel, ratio) in compared.take(MOST) {
        let begin = if is_empty { ", the error of " } else { ", and that of " };
        let (symbol, verb) = (channel.symbol(), if is_empty { " was " } else { " " });
        text = text.say(format!("{begin}{symbol} by ")).filter(id, name).say(verb);
        text = match ratio {
            ratio if ratio > EQUAL => text.result(times(ratio)).say(" times as large"),
            ratio if ratio < 1.0 / EQUAL => text.result(times(1.0 / ratio)).say(" times smaller"),
            _ => text.say("as large"),
        };
        is_empty = false;
    }
    (!is_empty).then(|| text.say(".").done())
}

/// The root mean square error over the last third.
fn lately(diagnostics: &Diagnostics, channel: Channel) -> Option<f64> {
    diagnostics.tally(channel, diagnostics.last_third()).map(ErrorSums::rmse).filter(|error| *error > 0.0)
}

fn times(ratio: f64) -> String {
    if ratio < 9.95 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}
