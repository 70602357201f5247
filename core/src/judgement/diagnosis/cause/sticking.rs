//! A sensor repeats its last reading for a while.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::readings::{Marked, Readings};
use crate::judgement::diagnosis::words::{percent, short};

/// The least innovations² of the marked readings, relative to those elsewhere and to their expectation.
const RISE: f64 = 1.5;

pub(super) static CAUSE: Cause = Cause {
    key: "sticking",
    name: "a sensor that sticks",
    hint: "A logger writes the last reading again where none has come. Such readings are none: leave them out, as empty cells. A filter \
           that weighs its readings does so as far as it can.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let sentence = |name: &str, Marked { share, levels: [there, elsewhere], .. }: &Marked| {
        format!(
            "{} of the readings of the {name} repeat the last one, where innovations² are {} times what is expected ({} elsewhere)",
            percent(*share),
            short(*there),
            short(*elsewhere)
        )
    };
    marked_causes(bad, cause, Readings::stuck, &sentence, found);
}

/// A fault of the record for each sensor with readings that a look marks, where the filter misses them: alone, and with a rule
/// that weighs readings.
pub(super) fn marked_causes(
    bad: &BadFilter<'_>,
    cause: &'static Cause,
    look: fn(&Readings) -> Option<Marked>,
    sentence: &dyn Fn(&str, &Marked) -> String,
    found: &mut Vec<LikelyCause>,
) {
    for (place, one) in bad.case.sensors.iter().enumerate() {
        let Some(marked) = Readings::of(bad.case, place).as_ref().and_then(look) else { continue };
        let [there, elsewhere] = marked.levels;
        if there <= RISE * elsewhere.max(1.0) {
            continue;
        }
        let sentence = sentence(one.sensor.key(), &marked);
        let with = |edits| {
            let likely = LikelyCause::new(cause, 1.0 - 1.0 / there, 0.0, edits, sentence.clone());
            LikelyCause { certain: true, of_record: true, ..likely }
        };
        found.push(with(Vec::new()));
        if !bad.filter.robust.is_on() && bad.filter.can_weigh() && bad.filter.walk == 0.0 {
            found.push(with(vec![bad.edit("robust", "gate")]));
        }
    }
}
