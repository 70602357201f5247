//! Whether innovations are zero on average.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::distributions::normal_p;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};

/// Limits the mean innovation that does no harm, in standard deviations.
const TOLERANCE: f64 = 0.1;

pub(super) static TEST: Test = Test {
    name: "mean of the innovations",
    statistic: "mean of ν times √N",
    distribution: "standard normal",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "not zero: a sensor has a bias, or the input an offset",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    for one in &case.sensors {
        let (count, mean) = (one.count(&case.kept), one.mean(&case.kept));
        if count == 0.0 {
            continue;
        }
        let statistic = mean * count.sqrt();
        found.push(Evidence {
            statistic,
            p_value: normal_p(statistic),
            effect: mean.abs() / TOLERANCE,
            speaks_for: case.pattern(one),
            sentence: format!("the innovations of the {} are {mean:.2}σ on average, not 0", one.sensor.key()),
            ..Evidence::new(test, Subject::Sensor(one.sensor), case)
        });
    }
}
