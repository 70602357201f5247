//! What readings tell as a series: noise, axis, mean, and values at equal steps.

use super::super::steps::Steps;
use crate::data::sorting::sort_numbers;

/// The share of half a swing, to either side, that a cubic follows; and the fewest and the most readings to either side.
const FOLLOWED: f64 = 1.0 / 3.0;
const FEWEST: usize = 3;
const MOST: usize = 12;

/// A reading is on this side of the mean from this many standard deviations on.
const CLEAR: f64 = 3.0;

/// The mean step of some times \[s\], and the values at equal steps; NaN at a step to which no reading is nearest.
///
/// Each reading goes to its nearest step, shifted by what the local cubic changes meanwhile.
pub(super) fn even(times: &[f64], values: &[f64], noise: f64) -> (f64, Vec<f64>) {
    let n = times.len();
    let dt = (times[n - 1] - times[0]) / (n - 1) as f64;
    let steps = Steps { start: times[0], dt, count: n };
    (dt, steps.of(times, values, side(values, noise)))
}

/// The readings to either side that a cubic follows.
pub(super) fn side(values: &[f64], noise: f64) -> usize {
    ((FOLLOWED * half_swing(values, noise)) as usize).clamp(FEWEST, MOST)
}

/// The readings in half a swing, by those that are clearly on one side of the mean.
fn half_swing(values: &[f64], noise: f64) -> f64 {
    let (mut turns, mut side) = (0, 0.0);
    let (mut first, mut last) = (None, 0);
    for (k, x) in values.iter().enumerate().filter(|(_, x)| x.abs() > CLEAR * noise) {
        if x.signum() != side {
            side = x.signum();
            turns += 1;
            first = first.or(Some(k));
            last = k;
        }
    }
    if turns > 1 { (last - first.unwrap_or(0)) as f64 / f64::from(turns - 1) } else { 0.0 }
}

/// The end of the part of this many seconds that begins at a place. It has at least one reading: above 2⁵³ s, adding a second changes nothing.
pub(super) fn end_of_part(times: &[f64], place: usize, seconds: f64) -> usize {
    (place + 1..times.len()).find(|&k| times[k] >= times[place] + seconds).unwrap_or(times.len())
}

/// The noise: about the mean in the quietest second, or that of third differences in a usual second, of which a slow swing has
/// next to none; the smaller. Source: Hamming (1973), *Numerical Methods*, chapter 10 (noise in a table of differences).
pub(super) fn noise_of(times: &[f64], along: &[f64]) -> f64 {
    let (mut least, mut differences) = (f64::INFINITY, Vec::new());
    let mut place = 0;
    while place < times.len() {
        let next = end_of_part(times, place, 1.0);
        if next - place >= 10 && times[next - 1] - times[place] > 0.5 {
            let values = &along[place..next];
            let middle = mean(values);
            let square = values.iter().map(|x| (x - middle) * (x - middle)).sum::<f64>();
            least = least.min(square / (values.len() - 1) as f64);
            let third = |x: &[f64]| (x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]).powi(2);
            // 1 + 9 + 9 + 1 noises.
            differences.push(values.windows(4).map(third).sum::<f64>() / (20 * (values.len() - 3)) as f64);
        }
        place = next;
    }
    sort_numbers(&mut differences);
    let usual = differences.get(differences.len() / 2).copied().unwrap_or(f64::INFINITY);
    let least = least.min(usual);
    if least.is_finite() { least.sqrt() } else { 0.0 }
}

/// The direction in which three accelerations vary most: the first eigenvector of their covariance, by repeated products. Its
/// largest component is positive.
pub(super) fn main_axis(readings: &[[f64; 4]]) -> [f64; 3] {
    let count = readings.len() as f64;
    let middle: [f64; 3] = std::array::from_fn(|i| readings.iter().map(|reading| reading[i + 1]).sum::<f64>() / count);
    let mut cov = [[0.0; 3]; 3];
    for reading in readings {
        for i in 0..3 {
            for j in 0..3 {
                cov[i][j] += (reading[i + 1] - middle[i]) * (reading[j + 1] - middle[j]) / count;
            }
        }
    }
    let largest = |axis: &[f64; 3]| (0..3).max_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
    let variances: [f64; 3] = std::array::from_fn(|i| cov[i][i]);
    let mut axis: [f64; 3] = std::array::from_fn(|i| cov[i][largest(&variances)]);
    for _ in 0..100 {
        let next: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| cov[i][j] * axis[j]).sum());
        let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            return [0.0, 0.0, 1.0];
        }
        axis = next.map(|x| x / length);
    }
    let sign = axis[largest(&axis)].signum();
    axis.map(|x| sign * x)
}

/// The mean of readings that swing, under a Hann window: the part of a swing at either end counts little.
pub(super) fn middle(values: &[f64]) -> f64 {
    let turn = std::f64::consts::TAU / values.len().max(1) as f64;
    let weight = |k: usize| 1.0 - libm::cos(turn * (k as f64 + 0.5));
    let (sum, weights) = values.iter().enumerate().fold((0.0, 0.0), |(sum, weights), (k, x)| {
        let weight = weight(k);
        (sum + weight * x, weights + weight)
    });
    sum / weights
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_has_a_reading_where_a_second_more_is_the_same_number() {
        for power in -9..=19 {
            let step = 10_f64.powi(power);
            for start in [0.0, 1.0, 1.714_564_8e18, 1e19] {
                let times: Vec<f64> = (0..50).map(|k| start + f64::from(k) * step).collect();
                let ends = (0..times.len()).map(|place| end_of_part(&times, place, 1.0));
                assert!(ends.enumerate().all(|(place, end)| end > place && end <= times.len()), "{start} {step}");
            }
        }
        assert_eq!(end_of_part(&[0.0, 0.4, 0.8, 1.2, 1.6], 0, 1.0), 3);
    }
}
