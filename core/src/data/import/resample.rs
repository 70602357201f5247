//! More samples, or fewer.

use std::f64::consts::PI;

use super::butterworth::band_pass;

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
