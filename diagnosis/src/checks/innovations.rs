//! Whether innovations are as a consistent filter leaves them: as large as expected, zero on average, white, without the input.

use kalmanscope_core::diagnostics::chi_squared;

use super::{Evidence, Subject, Test};
use crate::VerdictKind;
use crate::case::{Case, chi_squared_p, normal_p};
use crate::sums::{CROSS_LAGS, FIRST_CROSS_LAG, LAGS, SensorInnovations};
use crate::words::short;

/// Limits the factor by which innovations² may differ from their expectation, even if the difference is significant.
const TOLERANCE: f64 = 1.12;

pub(super) static SENSORS: Test = Test {
    name: "innovations of a sensor (NIS)",
    statistic: "mean of ν² = e² / S",
    distribution: "χ² with one degree of freedom a measurement, over their number",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "1 is right; above 1, the sensor surprises the filter; below 1, the filter trusts it too little",
    run: |case, test, found| {
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
    },
};

pub(super) static TOGETHER: Test = Test {
    name: "innovations of all sensors (NIS)",
    statistic: "mean of eᵀ S⁻¹ e over the number of sensors",
    distribution: "χ² with one degree of freedom a measurement, over their number",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "1 is right; a sensor that is trusted too much can hide one that is trusted too little",
    run: |case, test, found| {
        let (level, degrees) = case.nis(&case.kept);
        if degrees > 0.0 && case.sensors.len() > 1 {
            let evidence = Evidence::new(test, Subject::All, case);
            found.push(sized(case, evidence, (level, degrees), "of all sensors together"));
        }
    },
};

fn sized(case: &Case<'_>, evidence: Evidence, (level, count): (f64, f64), whose: &str) -> Evidence {
    let effect = if level.is_nan() { f64::INFINITY } else { libm::log(level).abs() / libm::log(TOLERANCE) };
    let kind = if level < 1.0 { VerdictKind::Underconfident } else { case.surprise() };
    let sentence = format!("innovations² {whose} are {} times what the filter expects", short(level));
    Evidence { p_value: chi_squared_p(level, count), ..evidence.certain(kind, effect, level, sentence) }
}

/// The numbers are the statistic, its p-value and the effect.
fn pattern(case: &Case<'_>, test: &'static Test, one: &SensorInnovations, numbers: [f64; 3], said: &str) -> Evidence {
    let [statistic, p_value, effect] = numbers;
    let sentence = format!("prediction errors of the {} {said}", one.sensor.key());
    let evidence = Evidence::new(test, Subject::Sensor(one.sensor), case);
    Evidence { p_value, ..evidence.certain(case.pattern(one), effect, statistic, sentence) }
}

pub(super) static MEAN: Test = Test {
    name: "mean of the innovations",
    statistic: "mean of ν times √N",
    distribution: "standard normal",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "not zero: a sensor has a bias, or the input has an offset",
    run: |case, test, found| {
        for one in &case.sensors {
            let (count, mean) = (one.count(&case.kept), one.mean(&case.kept));
            if count > 0.0 {
                let statistic = mean * count.sqrt();
                let numbers = [statistic, normal_p(statistic), mean.abs() / 0.1];
                found.push(pattern(case, test, one, numbers, &format!("are {mean:.2}σ on average, not 0")));
            }
        }
    },
};

const CORRELATED: f64 = 0.08;

/// A first correlation smaller than this share of the largest one gives no direction.
const SLIGHT: f64 = 0.5;

pub(super) static WHITENESS: Test = Test {
    name: "whiteness of the innovations",
    statistic: "N (N + 2) Σ r_l² / (N - l) over the lags l = 1 … 20",
    distribution: "χ² with 20 degrees of freedom",
    source: "Ljung and Box (1978); Mehra (1970), On the identification of variances and adaptive Kalman filtering",
    reading: "positive at lag 1: the gain is too low, and a part of each error remains in the next; negative: the gain \
              is too high",
    run: |case, test, found| {
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
                let (next, first) = one.first_correlation(&span.parts);
                let telling = if first.abs() < SLIGHT * largest.abs() { largest } else { first };
                let also = if lag == next { String::new() } else { format!(", {largest:.2} at lag {lag}") };
                let degrees = correlation.iter().filter(|r| **r != 0.0).count() as u32;
                let p_value = chi_squared::upper_tail(statistic, degrees).unwrap_or(1.0);
                let said = format!("are correlated{}: {first:.2} at lag {next}{also}", span.words);
                found.push(Evidence {
                    speaks_for: direction(case, one, telling, one.level(&span.parts)),
                    samples: span.samples,
                    ..pattern(case, test, one, [statistic, p_value, largest.abs() / CORRELATED], &said)
                });
            }
        }
    },
};

pub(super) static PAIRS: Test = Test {
    name: "whiteness between two sensors",
    statistic: "N Σ r_l² over the lags l = ±1 … ±20 of one sensor's innovations against another's",
    distribution: "χ² with 40 degrees of freedom",
    source: "Mehra (1970); Bar-Shalom, Li and Kirubarajan (2001), section 5.4.2",
    reading: "an error of one sensor returns later in another: the model or Q is wrong, even if each is white alone",
    run: pairs,
};

fn pairs(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    for pair in case.pairs.iter().filter(|pair| pair.count >= 2.0 * LAGS as f64) {
        let sides = pair.correlation.iter().zip([pair.places, [pair.places[1], pair.places[0]]]);
        let lags = sides.flat_map(|(r, places)| (1..LAGS).map(move |lag| (r[lag], lag, places)));
        let sum: f64 = lags.clone().map(|(r, ..)| r * r).sum();
        let Some((r, lag, [later, earlier])) = lags.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())) else { continue };
        let [later, earlier] = [later, earlier].map(|place| &case.sensors[place]);
        let (statistic, sensor) = (pair.count * sum, earlier.sensor.key());
        let p_value = chi_squared::upper_tail(statistic, 2 * (LAGS as u32 - 1)).unwrap_or(1.0);
        let said = format!("depend on earlier ones of the {sensor} (correlation {r:.2} at lag {lag})");
        found.push(pattern(case, test, later, [statistic, p_value, r.abs() / CORRELATED], &said));
    }
}

pub(super) static AT_ONCE: Test = Test {
    name: "correlation of two sensors within a sample",
    statistic: "(r - ρ) √N / (1 - ρ²), r of their innovations, ρ the mean of that in S",
    distribution: "standard normal",
    source: "Fisher (1921), On the probable error of a coefficient of correlation",
    reading: "not 0: both sensors share noise, or both read a force that R lacks",
    run: |case, test, found| {
        for pair in case.pairs.iter().filter(|pair| pair.count >= 2.0 * LAGS as f64) {
            let (r, expected) = (pair.correlation[0][0], case.expected_correlation(pair.places));
            let [one, other] = pair.places.map(|place| &case.sensors[place]);
            let statistic = (r - expected) * pair.count.sqrt() / (1.0 - expected * expected).max(1e-3);
            let sensor = other.sensor.key();
            let said = format!("and the {sensor} are correlated by {r:.2}, not {expected:.2}, within a sample");
            let numbers = [statistic, normal_p(statistic), (r - expected).abs() / CORRELATED];
            found.push(pattern(case, test, one, numbers, &said));
        }
    },
};

/// Limits the innovations² of all sensors, relative to their expectation, up to which those of one sensor may decide.
const ABOUT_RIGHT: f64 = 1.05;

/// If innovations are smaller than expected and alternate, the filter trusts its sensors too little.
fn direction(case: &Case<'_>, one: &SensorInnovations, correlation: f64, own: f64) -> VerdictKind {
    let (level, _) = case.nis(&case.kept);
    let are_small = level < 1.0 || own < 1.0 && level < ABOUT_RIGHT;
    if correlation < 0.0 && are_small { VerdictKind::Underconfident } else { case.pattern(one) }
}

pub(super) static INPUT: Test = Test {
    name: "cross-correlation of innovations and input",
    statistic: "the largest of |Σ ν_k f_(k - l)| / √(Σ ν² Σ f²) over the lags l = -4 … 15, times √N",
    distribution: "the largest of 20 standard normal numbers",
    source: "Ljung (1999), System Identification, section 16.6",
    reading: "only at lag 0 or 1: the input is late, early or held wrongly; at many positive lags: its gain or the \
              plant is wrong",
    run: |case, test, found| {
        for one in &case.sensors {
            let count = one.count(&case.kept);
            let correlation = one.cross_correlation(&case.kept);
            let lags = (FIRST_CROSS_LAG..).zip(correlation);
            let Some((lag, largest)) = lags.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else { continue };
            if largest != 0.0 {
                let statistic = largest.abs() * count.sqrt();
                let p_value = (CROSS_LAGS as f64 * normal_p(statistic)).min(1.0);
                let said = format!("still depend on the input (correlation {largest:.2} at lag {lag})");
                found.push(pattern(case, test, one, [statistic, p_value, largest.abs() / CORRELATED], &said));
            }
        }
    },
};

pub(super) static LINES: Test = Test {
    name: "lines in the spectrum of the innovations",
    statistic: "the largest power of a Welch periodogram over the mean power",
    distribution: "the largest of L/2 sums of squares, χ² with two degrees of freedom a window",
    source: "Welch (1967), The use of fast Fourier transform for the estimation of power spectra",
    reading: "a peak: a mode that the model lacks, or has at another frequency",
    run: |case, test, found| {
        for one in &case.sensors {
            let Some((power, turn)) = one.periodogram.peak() else { continue };
            let statistic = power / one.periodogram.mean();
            if !statistic.is_finite() {
                continue;
            }
            let degrees = 2 * one.periodogram.windows as u32;
            let one_p = chi_squared::upper_tail(statistic * f64::from(degrees), degrees).unwrap_or(1.0);
            let p_value = (one_p * one.periodogram.power.len() as f64).min(1.0);
            let (times, frequency) = (short(statistic), short(turn / case.record.dt()));
            let said = format!("have a peak of {times} times the mean power at {frequency} rad/s");
            found.push(pattern(case, test, one, [statistic, p_value, statistic / 5.0], &said));
        }
    },
};
