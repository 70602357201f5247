//! The input is not held as the filter assumes.

use super::{BadFilter, Cause, LikelyCause};
use crate::Hold;
use crate::data::setting::Edit;

pub(super) static CAUSE: Cause = Cause {
    key: "input_hold",
    name: "an input that is linear between samples, or held",
    hint: "A digital output holds its value between samples; a measured input does not, and is nearer to a line.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.input_size() == 0.0 {
        return;
    }
    let (value, sentence) = match bad.scenario.hold {
        Hold::Zero => ("first", "the input goes on between samples instead of being held"),
        Hold::First => ("zero", "the input is held between samples instead of going on"),
    };
    let case = bad.case;
    let near = case.sensors.iter().flat_map(|one| one.cross_correlation(&case.kept)[3..6].to_vec());
    let near = near.fold(0.0, |a: f64, b| a.max(b.abs()));
    let weight = 2.0 * near / (1.0 + 2.0 * near);
    found.push(LikelyCause::new(cause, weight, 0.0, vec![Edit::new("hold", value)], sentence.to_owned()));
}
