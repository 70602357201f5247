//! The input is recorded late or early.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::parts::FIRST_CROSS_LAG;

/// Limits the tried delays, in samples.
const MOST: i32 = 3;

pub(super) static CAUSE: Cause = Cause {
    key: "input_delay",
    name: "an input that is late or early",
    hint: "Where input and sensors pass different filters or clocks, one is late. Shift the input by whole samples.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.input_size() == 0.0 {
        return;
    }
    let case = bad.case;
    let mut near = 0.0_f64;
    for one in &case.sensors {
        for (lag, r) in (FIRST_CROSS_LAG..).zip(one.cross_correlation(&case.kept)) {
            near = if lag.abs() <= MOST { near.max(r.abs()) } else { near };
        }
    }
    for shift in (-MOST..=MOST).filter(|&shift| shift != 0) {
        let delay = bad.filter.input_delay + shift;
        // The change since the user's own settings.
        let since = delay - bad.origin.input_delay;
        let (count, word) = (since.abs(), if since < 0 { "late" } else { "early" });
        let plural = if count == 1 { "" } else { "s" };
        let sentence =
            if count == 0 { String::new() } else { format!("the recorded input is {count} sample{plural} {word}") };
        let weight = 2.0 * near / (1.0 + 2.0 * near) / f64::from(shift.abs()).sqrt();
        found.push(LikelyCause::new(cause, weight, 1.0, vec![bad.edit("input_delay", i64::from(delay))], sentence));
    }
}
