//! Whether the filter has stopped, or its errors have grown without bound.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// Limits an error, in standard deviations, if it is larger than the truth and the initial uncertainty.
const LOST: f64 = 10.0;

pub(super) static TEST: Test = Test {
    name: "divergence",
    statistic: "root mean square error over the last fifth, over σ",
    distribution: "none",
    source: "Fitzgerald (1971), Divergence of the Kalman filter, IEEE Transactions on Automatic Control 16",
    reading: "more than 10, and larger than the truth and all doubts at first: nothing is left of the truth",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let all = Evidence::new(test, Subject::All, case);
    if let Some(stop) = case.diagnostics.stop() {
        let time = short(case.record.time_of(stop.sample));
        let sentence = format!("{}; the filter stopped at {time} s", stop.reason);
        found.push(all.certain(VerdictKind::Diverged, f64::MAX, sentence));
    }
    for (channel, in_stds, size) in case.diagnostics.lost(case.estimates, LOST) {
        let unit = channel.unit();
        let space = if unit.is_empty() { "" } else { " " };
        let sentence = format!("the {} is off by {}{space}{unit}, {}σ", channel.name(), short(size), short(in_stds));
        let evidence = Evidence::new(test, Subject::Channel(channel), case);
        let one = evidence.certain(VerdictKind::Diverged, in_stds / LOST, sentence);
        found.push(Evidence { samples: case.late(), ..one });
    }
}
