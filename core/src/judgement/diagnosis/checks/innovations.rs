//! Whether innovations are as large as the filter expects.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::distributions::chi_squared_p;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// Limits the factor by which innovations² may differ from their expectation, even if the difference is significant.
const TOLERANCE: f64 = 1.12;

pub(super) static SENSORS: Test = Test {
    name: "innovations of a sensor (NIS)",
    statistic: "mean of ν² = e² / S",
    distribution: "χ² with one degree of freedom a measurement, over their number",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "1 is right; above, the sensor surprises the filter, and below, the filter trusts it too little",
    run: sensors,
};

pub(super) static TOGETHER: Test = Test {
    name: "innovations of all sensors (NIS)",
    statistic: "mean of eᵀ S⁻¹ e over the number of sensors",
    distribution: "χ² with one degree of freedom a measurement, over their number",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "1 is right; a sensor that is trusted too much can hide one that is trusted too little",
    run: together,
};

fn sensors(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    for one in &case.sensors {
        for span in case.spans() {
            let (level, count) = (one.level(&span.parts), one.count(&span.parts));
            if count > 0.0 {
                let evidence = Evidence::over(test, Subject::Sensor(one.sensor), &span);
                let words = format!("of the {}{}", one.sensor.key(), span.words);
                found.push(sized(case, evidence, (level, count), &words));
            }
        }
    }
}

fn together(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let (level, degrees) = case.nis(&case.kept);
    if degrees > 0.0 && case.sensors.len() > 1 {
        found.push(sized(case, Evidence::new(test, Subject::All, case), (level, degrees), "of all sensors together"));
    }
}

fn sized(case: &Case<'_>, evidence: Evidence, (level, count): (f64, f64), whose: &str) -> Evidence {
    let effect = libm::log(level).abs() / libm::log(TOLERANCE);
    Evidence {
        statistic: level,
        p_value: chi_squared_p(level, count),
        effect: if level.is_nan() { f64::INFINITY } else { effect },
        speaks_for: if level < 1.0 { VerdictKind::Underconfident } else { case.surprise() },
        sentence: format!("innovations² {whose} are {} times what the filter expects", short(level)),
        ..evidence
    }
}
