//! Whether innovations are white, as they are with the right gain.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::innovations::SensorInnovations;
use crate::judgement::diagnosis::parts::LAGS;
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::numbers::diagnostics::chi_squared;

/// Limits the correlations that do no harm.
const TOLERANCE: f64 = 0.08;

/// A first correlation smaller than this share of the largest one gives no direction.
const SLIGHT: f64 = 0.5;

pub(super) static TEST: Test = Test {
    name: "whiteness of the innovations",
    statistic: "N (N + 2) Σ r_l² / (N - l) over the lags l = 1 … 20",
    distribution: "χ² with 20 degrees of freedom",
    source: "Ljung and Box (1978); Mehra (1970), On the identification of variances and adaptive Kalman filtering",
    reading: "positive at lag 1: the gain is too low, and each innovation leaves something for the next; negative: it is too \
              high",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    for one in &case.sensors {
        for span in case.spans() {
            let count = one.count(&span.parts);
            if count < 2.0 * LAGS as f64 {
                continue;
            }
            let correlation = one.autocorrelation(&span.parts);
            let terms = correlation.iter().zip(1..).map(|(r, lag)| r * r / (count - f64::from(lag)));
            let statistic = count * (count + 2.0) * terms.sum::<f64>();
            let largest = (1..).zip(correlation).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let (lag, largest) = largest.unwrap_or((1, 0.0));
            let first = correlation[0];
            let telling = if first.abs() < SLIGHT * largest.abs() { largest } else { first };
            let also = if lag == 1 { String::new() } else { format!(", {largest:.2} at lag {lag}") };
            let (sensor, when) = (one.sensor.key(), span.words);
            found.push(Evidence {
                statistic,
                p_value: chi_squared::upper_tail(statistic, LAGS as u32 - 1).unwrap_or(1.0),
                effect: largest.abs() / TOLERANCE,
                speaks_for: direction(case, one, telling, one.level(&span.parts)),
                sentence: format!("the innovations of the {sensor} are correlated{when}: {first:.2} at lag 1{also}"),
                ..Evidence::over(test, Subject::Sensor(one.sensor), &span)
            });
        }
    }
}

/// Limits the innovations² of all sensors, relative to their expectation, up to which those of one sensor may decide.
const ABOUT_RIGHT: f64 = 1.05;

/// The verdict that a correlation supports. If innovations are smaller than expected and alternate, the filter trusts its sensors
/// too little.
fn direction(case: &Case<'_>, one: &SensorInnovations, correlation: f64, own: f64) -> VerdictKind {
    let (level, _) = case.nis(&case.kept);
    let are_small = level < 1.0 || own < 1.0 && level < ABOUT_RIGHT;
    if correlation < 0.0 && are_small { VerdictKind::Underconfident } else { case.pattern(one) }
}
