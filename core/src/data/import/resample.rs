//! More samples, or fewer.

use std::f64::consts::PI;

use super::butterworth::band_pass;
use super::limits::MOST;
use crate::data::record::Input;
use crate::{Hold, Record};

/// The samples on each side from which a value between two samples is made.
const REACH: isize = 32;
/// The shape of the window: side lobes below -80 dB.
const KAISER: f64 = 8.0;
/// The low-pass before a decimation, as a share of the new Nyquist frequency.
pub(super) const GUARD: f64 = 0.8;

/// The low-pass before every `every`-th value is kept. All values must be finite.
pub(super) fn anti_alias(values: &mut Vec<f64>, every: usize) {
    if every > 1 {
        band_pass(values, 0.0, GUARD * 0.5 / every as f64);
    }
}

/// Keeps every `every`-th value unchanged.
pub(super) fn keep_every(values: &mut Vec<f64>, every: usize) {
    let mut place = 0;
    values.retain(|_| {
        place += 1;
        (place - 1) % every.max(1) == 0
    });
}

/// Puts `steps` steps in place of one, by a band-limited interpolation: a sinc under a Kaiser window. The original
/// values stay unchanged. All values must be finite.
///
/// Source: Smith and Gossett (1984), A flexible sampling-rate conversion method.
pub(super) fn interpolate(values: &[f64], steps: usize) -> Vec<f64> {
    let n = values.len() as isize;
    if steps <= 1 || n < 2 {
        return values.to_vec();
    }
    let (first, last) = (values[0], values[values.len() - 1]);
    // Turned about the ends, so that value and slope go on.
    let at = |place: isize| match place {
        place if place < 0 => 2.0 * first - values[place.unsigned_abs().min(values.len() - 1)],
        place if place >= n => 2.0 * last - values[(2 * (n - 1) - place).max(0) as usize],
        place => values[place as usize],
    };
    let weights: Vec<Vec<f64>> = (1..steps).map(|step| kernel(step as f64 / steps as f64)).collect();
    let mut finer = Vec::with_capacity((values.len() - 1) * steps + 1);
    for k in 0..n - 1 {
        finer.push(values[k as usize]);
        for weights in &weights {
            let terms = weights.iter().zip(k - REACH + 1..).map(|(weight, place)| weight * at(place));
            finer.push(terms.sum());
        }
    }
    finer.push(last);
    finer
}

/// Puts `steps` steps in place of one of an input that has this course between its values.
///
/// Lines through the values of a curve lie inside of its bends: of a swing they have the share
/// `sinc²(ωh/2) ≈ 1 - (ωh)²/12`. Values between those of the file move outwards by as much; those of the file stay, since an accelerometer
/// feels them.
pub(super) fn finer_input(values: &[f64], steps: usize, hold: Hold) -> Vec<f64> {
    let curve = interpolate(values, steps);
    if steps <= 1 || hold == Hold::Zero {
        return curve;
    }
    let outwards = steps as f64 / (12.0 * (steps - 1) as f64);
    let mut finer = curve.clone();
    for (k, around) in curve.windows(3).enumerate().filter(|(k, _)| (k + 1) % steps != 0) {
        finer[k + 1] -= outwards * (around[2] - 2.0 * around[1] + around[0]);
    }
    finer
}

/// The measurements with `steps` steps in place of one, missing in between.
pub(super) fn spread(values: &[f64], steps: usize) -> Vec<f64> {
    let mut finer = vec![f64::NAN; values.len().saturating_sub(1) * steps + values.len().min(1)];
    finer.iter_mut().step_by(steps).zip(values).for_each(|(fine, value)| *fine = *value);
    finer
}

/// A record with `steps` steps in place of one, as [`super::Mapping::interpolate`] makes it. `None` if it would be too long, or its
/// readings have times of their own.
pub(crate) fn finer(record: &Record, steps: usize) -> Option<Record> {
    if record.clocks().is_some() || record.len().saturating_mul(steps) > MOST {
        return None;
    }
    let values = finer_input(record.input(), steps, record.hold());
    let input = Input { kind: record.input_kind(), hold: record.hold(), values };
    let columns = record.sensors().iter().enumerate();
    let columns = columns.map(|(place, quantity)| (*quantity, spread(record.measured(place), steps))).collect();
    Some(Record::new(record.dt() / steps as f64, input, columns).ok()?.starting_at(record.time(0)))
}

/// The weights of the samples from `1 - REACH` to `REACH` for the value at `share` of the way from sample 0 to sample 1.
fn kernel(share: f64) -> Vec<f64> {
    let weight = |place: isize| {
        let distance = share - place as f64;
        let window = distance / REACH as f64;
        let sinc = libm::sin(PI * distance) / (PI * distance);
        sinc * bessel(KAISER * libm::sqrt((1.0 - window * window).max(0.0))) / bessel(KAISER)
    };
    let weights: Vec<f64> = (1 - REACH..=REACH).map(weight).collect();
    // A constant stays constant.
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// I₀, the modified Bessel function of the first kind, by its series.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
    while term > 1e-17 * sum {
        k += 1.0;
        term *= (0.5 * x / k) * (0.5 * x / k);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_below_the_nyquist_frequency_is_found_between_its_samples() {
        let sine = |time: f64| (2.0 * PI * 0.4 * time + 0.3).sin();
        let values: Vec<f64> = (0..400).map(|k| sine(f64::from(k))).collect();
        let finer = interpolate(&values, 4);
        assert_eq!(finer.len(), 399 * 4 + 1);
        for (k, value) in finer.iter().enumerate().skip(200).take(1200) {
            assert!((value - sine(k as f64 / 4.0)).abs() < 1e-3, "{k}");
        }
        for (k, value) in values.iter().enumerate() {
            assert_eq!(finer[4 * k], *value);
        }
    }

    #[test]
    fn lines_through_a_finer_input_have_all_of_a_swing() {
        // Ten and twenty-five samples a swing; the share that lines through its values have, by the integral with its own sine.
        for (per_swing, most) in [(10.0, 1e-4), (25.0, 1e-4)] {
            let w = 2.0 * PI / per_swing;
            let values: Vec<f64> = (0..=400).map(|k| libm::sin(w * f64::from(k))).collect();
            let share = |fine: &[f64]| {
                let (mut product, mut square, parts) = (0.0, 0.0, 50);
                for k in 4 * 100..4 * 300 {
                    for part in 0..parts {
                        let at = (f64::from(part) + 0.5) / f64::from(parts);
                        let sine = libm::sin(w * 0.25 * (k as f64 + at));
                        product += sine * (fine[k] + at * (fine[k + 1] - fine[k]));
                        square += sine * sine;
                    }
                }
                product / square
            };
            let [held, linear] = [Hold::Zero, Hold::First].map(|hold| finer_input(&values, 4, hold));
            let lost = (w / 4.0) * (w / 4.0) / 12.0;
            assert!((share(&held) - 1.0 + lost).abs() < 0.1 * lost, "{per_swing}: {} {lost}", share(&held));
            assert!((share(&linear) - 1.0).abs() < most, "{per_swing}: {}", share(&linear));
            assert!(values.iter().enumerate().all(|(k, value)| linear[4 * k] == *value), "{per_swing}");
        }
    }

    #[test]
    fn lines_go_through_up_to_the_ends() {
        let values: Vec<f64> = (0..50).map(|k| 2.0 * f64::from(k)).collect();
        for (k, value) in interpolate(&values, 8).iter().enumerate() {
            assert!((value - 2.0 * k as f64 / 8.0).abs() < 0.05, "{k}: {value}");
        }
        assert_eq!(interpolate(&[1.0, 1.0], 2), [1.0, 1.0, 1.0]);
        assert_eq!(interpolate(&[5.0], 4), [5.0]);
    }

    #[test]
    fn fast_parts_do_not_fold_back() {
        let fast: Vec<f64> = (0..1000).map(|k| (2.0 * PI * 0.23 * f64::from(k)).sin()).collect();
        let mut fewer = fast;
        anti_alias(&mut fewer, 4);
        keep_every(&mut fewer, 4);
        assert_eq!(fewer.len(), 250);
        assert!(fewer[20..230].iter().all(|value| value.abs() < 0.02));
        let mut kept = vec![0.0, 1.0, 2.0, 3.0, 4.0];
        keep_every(&mut kept, 2);
        assert_eq!(kept, [0.0, 2.0, 4.0]);
    }
}
