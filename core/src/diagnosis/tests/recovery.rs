//! Whether a part of the record was bad, and the filter has come back from it.

use crate::diagnosis::case::Case;
use crate::diagnosis::evidence::{Evidence, Subject, Test};
use crate::diagnosis::verdict_kind::VerdictKind;
use crate::diagnosis::words::short;

pub(super) static TEST: Test = Test {
    name: "recovery",
    statistic: "the parts of the record whose errors are too large, or innovations too large or too small, if the last part is good",
    distribution: "none",
    source: "Basseville and Nikiforov (1993), Detection of Abrupt Changes",
    reading: "a run of surprises that ends: something changed, and the filter followed",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(samples) = case.forgiven_samples() else { return };
    let [from, to] = [samples.start, samples.end].map(|k| short(case.record.time(k.min(case.samples.end - 1))));
    let level = case.nis(&case.forgiven).0;
    // Of a sensor, where all sensors together are as expected.
    let distance = |level: f64| libm::log(level).abs();
    let farthest = case.sensors.iter().map(|one| (one.level(&case.forgiven), one.sensor.key()));
    let farthest = farthest.max_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
    let (level, whose) = match farthest {
        Some((of_sensor, key)) if (0.9..1.1).contains(&level) => (of_sensor, format!(" of the {key}")),
        _ => (level, String::new()),
    };
    let sentence = format!(
        "between {from} s and {to} s innovations²{whose} are {} times what the filter expects; it has recovered",
        short(level)
    );
    let one = Evidence::new(test, Subject::All, case).certain(VerdictKind::Recovered, 1.0, sentence);
    found.push(Evidence { statistic: level, samples, ..one });
}
