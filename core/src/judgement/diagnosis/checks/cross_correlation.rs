//! Whether the innovations are correlated with the input: then the filter models its effect wrongly.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::distributions::normal_p;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::parts::{CROSS_LAGS, FIRST_CROSS_LAG};

/// Limits the correlations that do no harm.
const TOLERANCE: f64 = 0.08;

pub(super) static TEST: Test = Test {
    name: "cross-correlation of innovations and input",
    statistic: "the largest of |Σ ν_k f_(k - l)| / √(Σ ν² Σ f²) over the lags l = -4 … 15, times √N",
    distribution: "the largest of 20 standard normal numbers",
    source: "Ljung (1999), System Identification, section 16.6",
    reading: "at lags of 0 or 1 alone: the input is late, early or held wrongly; at many positive lags: its gain or the plant is \
              wrong",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    for one in &case.sensors {
        let count = one.count(&case.kept);
        let correlation = one.cross_correlation(&case.kept);
        let lags = (FIRST_CROSS_LAG..).zip(correlation);
        let Some((lag, largest)) = lags.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else { continue };
        if largest == 0.0 {
            continue;
        }
        let statistic = largest.abs() * count.sqrt();
        let sensor = one.sensor.key();
        found.push(Evidence {
            statistic,
            p_value: (CROSS_LAGS as f64 * normal_p(statistic)).min(1.0),
            effect: largest.abs() / TOLERANCE,
            speaks_for: case.pattern(one),
            sentence: format!(
                "the innovations of the {sensor} follow the input: correlation {largest:.2} at lag {lag}"
            ),
            ..Evidence::new(test, Subject::Sensor(one.sensor), case)
        });
    }
}
