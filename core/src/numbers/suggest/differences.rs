//! The noise of readings at times of their own.

use crate::data::record::Timed;
use crate::data::sorting::sort_numbers;

/// The readings of a difference: a motion has next to none of order seven, if it is measured some times a swing.
const READINGS: usize = 8;

/// The fewest differences that tell a noise.
const FEWEST: usize = 30;

/// The median of the size of a standard normal number.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// The standard deviation of the noise in some readings, by divided differences over their times; `None` if there are too few.
///
/// ```text
/// d = Σ cᵢ zᵢ / √Σ cᵢ²,  cᵢ = Π 1 / (tᵢ - tⱼ), j ≠ i;  σ = median |d| / 0.674
/// ```
///
/// Source: Hamming (1973), *Numerical Methods*, chapter 10 (noise in a table of differences).
pub(super) fn noise(Timed { times, values }: &Timed) -> Option<f64> {
    let mut sizes: Vec<f64> = times.windows(READINGS).zip(values.windows(READINGS)).map(|(t, z)| size(t, z)).collect();
    sizes.retain(|size| size.is_finite());
    if sizes.len() < FEWEST {
        return None;
    }
    sort_numbers(&mut sizes);
    Some(sizes[sizes.len() / 2] / MEDIAN)
}

fn size(times: &[f64], values: &[f64]) -> f64 {
    // In units of the window, so that no product leaves the range of numbers.
    let span = times[READINGS - 1] - times[0];
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let others = times.iter().enumerate().filter(|(j, _)| *j != i);
        let weight = others.map(|(_, time)| span / (times[i] - time)).product::<f64>();
        sum += weight * value;
        squares += weight * weight;
    }
    (sum / libm::sqrt(squares)).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::random::Normal;

    #[test]
    fn noise_is_told_from_motion_at_any_times() {
        let mut normal = Normal::from_seed(3);
        let mut time = 0.0;
        let (mut times, mut values) = (Vec::new(), Vec::new());
        for _ in 0..600 {
            time += 0.03 + 0.05 * libm::fabs(normal.sample());
            times.push(time);
            values.push(libm::sin(6.0 * time) + 0.01 * normal.sample());
        }
        let found = noise(&Timed { times: times.clone(), values }).unwrap();
        assert!((found / 0.01 - 1.0).abs() < 0.15, "{found}");
        let still = noise(&Timed { values: vec![0.0; times.len()], times }).unwrap();
        assert_eq!(still, 0.0);
        assert_eq!(noise(&Timed { times: vec![0.0, 1.0], values: vec![1.0, 2.0] }), None);
    }
}
