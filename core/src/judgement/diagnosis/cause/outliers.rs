//! Some readings have nothing to do with the motion.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::readings::Readings;
use crate::judgement::diagnosis::words::{percent, short};

/// The rules that are tried, by their keys.
const RULES: [&str; 2] = ["student_t", "gate"];

pub(super) static CAUSE: Cause = Cause {
    key: "outliers",
    name: "outliers of a sensor",
    hint: "Single readings are far off, and those beside them are not. A larger R would weaken all readings for the sake of a few: let \
           the filter weigh each by how well it fits.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.filter.robust.is_on() || !bad.filter.can_weigh() || bad.filter.walk > 0.0 {
        return;
    }
    let marked = (0..bad.case.sensors.len()).filter_map(|place| {
        let marked = Readings::of(bad.case, place)?.outliers()?;
        Some((bad.case.sensors[place].sensor.key(), marked))
    });
    let told: Vec<(f64, String)> = marked
        .map(|(name, marked)| {
            let [there, elsewhere] = marked.levels;
            let sentence = format!(
                "{} of the readings of the {name} stand alone and far off: their innovations² are {} times what is expected, those of \
                 the others {}",
                percent(marked.share),
                short(there),
                short(elsewhere)
            );
            (there, sentence)
        })
        .collect();
    let Some(most) = told.iter().map(|(there, _)| *there).reduce(f64::max) else { return };
    let sentence = told.into_iter().map(|(_, sentence)| sentence).collect::<Vec<_>>().join("; ");
    for (place, rule) in RULES.into_iter().enumerate() {
        let weight = (1.0 - 1.0 / most) * if place == 0 { 1.0 } else { 0.9 };
        let likely = LikelyCause::new(cause, weight, 1.0, vec![bad.edit("robust", rule)], sentence.clone());
        found.push(LikelyCause { certain: true, ..likely });
    }
}
