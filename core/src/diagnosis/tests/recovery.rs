//! Whether a part of the record was bad, and the filter has come back from it.

use crate::diagnosis::case::Case;
use crate::diagnosis::evidence::{Evidence, Subject, Test};
use crate::diagnosis::verdict_kind::VerdictKind;
use crate::diagnosis::words::short;

pub(super) static TEST: Test = Test {
    name: "recovery",
    statistic: "the parts of the record whose innovations or errors are too large, if the last part is good",
    distribution: "none",
    source: "Basseville and Nikiforov (1993), Detection of Abrupt Changes",
    reading: "a run of surprises that ends: something changed, and the filter followed",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(samples) = case.forgiven_samples() else { return };
    let [from, to] = [samples.start, samples.end].map(|k| short(case.record.time(k.min(case.samples.end - 1))));
    let level = case.nis(&case.forgiven).0;
    let sentence = format!(
        "between {from} s and {to} s innovations² are {} times what the filter expects; it has recovered",
        short(level)
    );
    let one = Evidence::new(test, Subject::All, case).certain(VerdictKind::Recovered, 1.0, sentence);
    found.push(Evidence { statistic: level, samples, ..one });
}
