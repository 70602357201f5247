//! R is too small or too large.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::parts;
use crate::judgement::diagnosis::words::short;

/// Smaller factors on a variance are not worth a trial.
const TOLERANCE: f64 = 1.15;

/// Limits the factors on a variance that may come first: a larger one silences the sensor.
const SILENCE: f64 = 100.0;

/// The least estimate of R, relative to R.
const LEAST: f64 = 1e-4;

pub(super) static CAUSE: Cause = Cause {
    key: "sensor_noise",
    name: "R of a sensor",
    hint: "R is the variance of a sensor's noise. Where the innovations are larger than S, or smaller, and S is mostly R, set R \
           to what they are.",
    likely_causes,
};

/// Matches covariances: the mean square of e is H P Hᵀ + R, whatever R was assumed.
///
/// Source: Mehra (1972), Approaches to adaptive filtering, section IV.
fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let (case, assumed) = (bad.case, &bad.filter.sensor_std);
    let m = assumed.len();
    let mut factors = vec![(1.0, 1.0); m];
    for (i, (factors, std)) in factors.iter_mut().zip(assumed).enumerate() {
        let (mut square, mut expected, mut count) = (0.0, 0.0, 0.0);
        for k in (0..parts::PARTS).filter(|&part| case.kept[part]).flat_map(|part| case.part(part)) {
            let innovation = case.estimates.innovation(k)[i];
            if !innovation.is_nan() {
                square += innovation * innovation;
                expected += case.estimates.innovation_cov(k)[i * (m + 1)];
                count += 1.0;
            }
        }
        if count > 0.0 {
            let matched = (square - expected) / (count * std * std) + 1.0;
            *factors = (matched.max(LEAST), (square / expected).max(LEAST));
        }
    }
    let mut propose = |which: &dyn Fn(usize) -> f64| {
        let turned: Vec<f64> = (0..m).map(|i| assumed[i] * which(i).sqrt()).collect();
        let changed: Vec<usize> = (0..m).filter(|&i| far(which(i))).collect();
        if changed.is_empty() {
            return;
        }
        // The change since the user's own settings.
        let turned_since = |i: usize| assumed[i] / bad.origin.sensor_std.get(i).unwrap_or(&assumed[i]);
        let since = |i: usize| which(i) * turned_since(i) * turned_since(i);
        let of = |i: usize| {
            let (name, factor) = (case.sensors[i].sensor.key(), since(i));
            let (word, factor) = if factor > 1.0 { ("small", factor) } else { ("large", 1.0 / factor) };
            format!("R of the {name} is {} times too {word}", short(factor))
        };
        let told = (0..m).filter(|&i| far(since(i)));
        let sentence = told.map(of).collect::<Vec<_>>().join(", ");
        let weight = changed.iter().map(|&i| far_by(case.sensors[i].level(&case.kept))).fold(0.0, f64::max);
        let edits = vec![bad.edit("sensor_std", turned)];
        let silences = (0..m).any(|i| since(i) > SILENCE);
        found.push(LikelyCause { silences, ..LikelyCause::new(cause, weight, changed.len() as f64, edits, sentence) });
    };
    if m > 1 {
        propose(&|i| factors[i].0);
        propose(&|i| factors[i].1);
    }
    for place in 0..m {
        propose(&|i| if i == place { factors[i].0 } else { 1.0 });
        propose(&|i| if i == place { factors[i].1 } else { 1.0 });
    }
}

fn far(factor: f64) -> bool {
    factor.is_finite() && libm::log(factor).abs() > libm::log(TOLERANCE)
}

fn far_by(level: f64) -> f64 {
    let size = libm::log(level).abs();
    if size.is_nan() { 0.0 } else { size / (1.0 + size) }
}
