//! A sensor cannot read beyond a value.

use super::sticking::marked_causes;
use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::readings::{Marked, Readings};
use crate::judgement::diagnosis::words::{percent, short};

pub(super) static CAUSE: Cause = Cause {
    key: "clipped",
    name: "a sensor that is clipped",
    hint: "Readings stop at the end of the sensor's range. Those at the end are no readings: leave them out, or take a sensor with a \
           wider range. A filter that weighs its readings does so as far as it can.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let sentence = |name: &str, Marked { share, levels: [there, elsewhere], .. }: &Marked| {
        format!(
            "{} of the readings of the {name} are at the end of its range, where innovations² are {} times what is expected ({} elsewhere)",
            percent(*share),
            short(*there),
            short(*elsewhere)
        )
    };
    marked_causes(bad, cause, Readings::clipped, &sentence, found);
}
