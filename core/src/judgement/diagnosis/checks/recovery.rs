//! Whether a part of the record was bad, and the filter has recovered from it.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::errors::ChannelErrors;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// The normal range of innovations², over their expectation.
const CALM: std::ops::Range<f64> = 0.8..1.25;

/// The least error of a channel that is mentioned, in standard deviations.
const OFF: f64 = 2.0;

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
    let (level, of_innovations) = innovations(case);
    let (off, of_errors) = errors(case);
    let is_error = off > OFF && CALM.contains(&level);
    let (statistic, what) = if is_error { (off, of_errors) } else { (level, of_innovations) };
    if !statistic.is_finite() {
        return;
    }
    let sentence = format!("between {from} s and {to} s {what}; it has recovered");
    let one = Evidence::new(test, Subject::All, case).certain(VerdictKind::Recovered, 1.0, sentence);
    found.push(Evidence { statistic, samples, ..one });
}

/// The innovations² in the forgiven parts, over their expectation, and words for them: those of one sensor, if all
/// sensors together are as expected.
fn innovations(case: &Case<'_>) -> (f64, String) {
    let level = case.nis(&case.forgiven).0;
    let distance = |level: f64| libm::log(level).abs();
    let farthest = case.sensors.iter().map(|one| (one.level(&case.forgiven), one.sensor.key()));
    let farthest = farthest.max_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
    let (level, whose) = match farthest {
        Some((of_sensor, key)) if (0.9..1.1).contains(&level) => (of_sensor, format!(" of the {key}")),
        _ => (level, String::new()),
    };
    (level, format!("innovations²{whose} are {} times what the filter expects", short(level)))
}

/// The largest root mean square error of a channel in the forgiven parts, in standard deviations, and words for it; 0
/// without a known truth.
fn errors(case: &Case<'_>) -> (f64, String) {
    let of = |one: &ChannelErrors| (one.level(&case.forgiven).sqrt(), one.channel.name());
    let known = case.errors.iter().map(of).filter(|(off, _)| !off.is_nan());
    let (off, name) = known.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, ""));
    (off, format!("the {name} is {} times its σ off", short(off)))
}
