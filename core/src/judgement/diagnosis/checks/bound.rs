//! Whether σ is below what any filter could reach.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// Limits the ratio of the bound to σ.
const TOLERANCE: f64 = 3.0;

pub(super) static TEST: Test = Test {
    name: "σ against the Cramér-Rao bound",
    statistic: "the bound over σ of a parameter, at last",
    distribution: "none: it is at most 1 for a filter that takes no more for true than is so",
    source: "Tichavský, Muravchik and Nehorai (1998)",
    reading: "above 1: the filter claims to know more than the record can tell",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(bound) = case.bound else { return };
    let Some(last) = case.last().filter(|last| *last < bound.len()) else { return };
    for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
        let Some(floor) = bound.place(channel).map(|of_bound| bound.std(last, of_bound)) else { continue };
        let std = case.estimates.std(last, place);
        if !(floor > 0.0 && std > 0.0) {
            continue;
        }
        let ratio = floor / std;
        let sentence =
            format!("σ of the {} is {} times the least that any filter can reach", channel.name(), short(1.0 / ratio));
        let evidence = Evidence::new(test, Subject::Channel(channel), case);
        let one = evidence.certain(VerdictKind::Overconfident, ratio / TOLERANCE, sentence);
        found.push(Evidence { statistic: ratio, ..one });
    }
}
