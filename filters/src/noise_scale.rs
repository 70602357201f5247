//! How large noise is, from the likelihoods of filters that assume it smaller and larger.

use crate::lists::numbers;
/// The posterior of u = ln s, where the noise has s times the standard deviation of the settings, over a grid of filters.
///
/// ```text
/// Lⱼ ← a Lⱼ + ln Λⱼ              Λⱼ = N(eⱼ; 0, Sⱼ), of the filter with uⱼ
/// p(u) ∝ exp(c L(u))             c = Σ aᵏ / Σ a²ᵏ, over the samples so far
/// wⱼ = ∫ p(u) hatⱼ(u) du         the share of filter j in what all of them tell
/// ```
///
/// u is evenly likely before the first sample. L(u) is a polynomial through the six nearest of the grid, held between the chords
/// of its neighbours, as of a concave function. With a < 1 old samples count less than new ones: the most likely u then varies
/// less than L is curved, and c makes up for it: without it, bands would be √2 too wide.
///
/// Source: Magill (1965), Optimal adaptive estimation of sampled stochastic processes; Yuen, Liang and Kuok (2013), Online estimation
/// of noise parameters for Kalman filter (the posterior of noise parameters while the filter runs). c is from the variance of a
/// weighted mean.
#[derive(Clone, Debug)]
pub struct NoiseScale {
    /// uⱼ, even, in rising order.
    pub grid: Vec<f64>,
    /// Lⱼ; -∞ of a filter that has failed.
    log_likelihood: Vec<f64>,
    /// Each filter's share, all of them together 1.
    pub weights: Vec<f64>,
    pub moments: [f64; 2],
    sums: [f64; 2],
}

/// s is from 1 / REACH to REACH.
pub const REACH: f64 = 30.0;

/// The points of the posterior between two filters: after many samples it is narrower than their distance.
const POINTS: usize = 12;

/// A polynomial through as many points on both sides of its place, so an even number.
const NODES: usize = 6;

/// Where the posterior is less than e⁻⁴⁰ of its top, it is below the rounding of the sum.
const NOTHING: f64 = 40.0;

impl NoiseScale {
    /// Before the first sample, over this many filters, at least two.
    pub fn new(filters: usize) -> Self {
        let reach = libm::log(REACH);
        let filters = filters.max(2);
        let grid = numbers(filters, &|j| reach * (2.0 * j as f64 / (filters - 1) as f64 - 1.0));
        let mut scale =
            Self { grid, log_likelihood: vec![0.0; filters], weights: Vec::new(), moments: [0.0; 2], sums: [0.0; 2] };
        scale.weigh();
        scale
    }

    /// Takes in the log likelihood of a sample's measurements in each filter, -∞ where it has failed. `keep` is a.
    pub fn take(&mut self, of_sample: impl Iterator<Item = f64>, keep: f64) {
        for (sum, of) in self.log_likelihood.iter_mut().zip(of_sample) {
            *sum = keep * *sum + of;
        }
        let finite = self.log_likelihood.iter().copied().filter(|sum| sum.is_finite());
        let best = finite.fold(f64::NEG_INFINITY, f64::max);
        // Only differences count. Of the plain sums of a long record, each exponential would be zero.
        if best.is_finite() {
            self.log_likelihood.iter_mut().for_each(|sum| *sum -= best);
        }
        let [one, two] = self.sums;
        self.sums = [keep * one + 1.0, keep * keep * two + 1.0];
        self.weigh();
    }

    fn weigh(&mut self) {
        let Self { grid, log_likelihood: all, weights, sums: [one, two], .. } = self;
        let power = if *two > 0.0 { *one / *two } else { 1.0 };
        let width = grid[1] - grid[0];
        weights.clear();
        weights.resize(grid.len(), 0.0);
        let mut moments = [0.0; 3];
        let mut add = |at: f64, j: usize, share: f64, density: f64| {
            weights[j] += density * (1.0 - share);
            if share > 0.0 {
                weights[j + 1] += density * share;
            }
            moments[0] += density;
            moments[1] += density * at;
            moments[2] += density * at * at;
        };
        // Between two filters L may be a little above the best of them.
        let density = |ln: f64| libm::exp((power * ln).max(-2.0 * NOTHING));
        for j in 0..grid.len() {
            let has_next = all.get(j + 1).is_some_and(|next| next.is_finite());
            if !all[j].is_finite() {
                continue;
            }
            let is_inside = j > 0 && all[j - 1].is_finite() && has_next;
            // Trapezoids: the first and the last point count half.
            add(grid[j], j, 0.0, density(all[j]) * if is_inside { 1.0 } else { 0.5 });
            if !has_next || power * all[j].max(all[j + 1]) < -NOTHING {
                continue;
            }
            for point in 1..POINTS {
                let share = point as f64 / POINTS as f64;
                add(grid[j] + share * width, j, share, density(between(all, j, share)));
            }
        }
        let [sum, first, second] = moments;
        if sum > 0.0 {
            weights.iter_mut().for_each(|weight| *weight /= sum);
            let mean = first / sum;
            // The difference of two near squares may round to less than zero.
            self.moments = [mean, (second / sum - mean * mean).max(0.0).sqrt()];
        }
    }
}

fn between(all: &[f64], j: usize, share: f64) -> f64 {
    let (from, to) = (all[j], all[j + 1]);
    let chord = from + share * (to - from);
    // Beyond its points the chord of a concave function is above it.
    let before = j.checked_sub(1).map(|i| all[i]).filter(|x| x.is_finite()).map(|x| from + share * (from - x));
    let after = all.get(j + 2).filter(|x| x.is_finite()).map(|x| to + (1.0 - share) * (to - x));
    let above = match (before, after) {
        (Some(one), Some(other)) => one.min(other),
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => return chord,
    };
    if above <= chord { chord } else { polynomial(all, j, share).max(chord).min(above) }
}

/// The polynomial through the points around those between which it is wanted (Neville).
fn polynomial(all: &[f64], j: usize, share: f64) -> f64 {
    let first = (j + 1).saturating_sub(NODES / 2).min(all.len().saturating_sub(NODES));
    let mut values = [0.0; NODES];
    let count = NODES.min(all.len() - first);
    let at = j as f64 + share - first as f64;
    for (value, known) in values.iter_mut().zip(&all[first..first + count]) {
        if !known.is_finite() {
            return all[j] + share * (all[j + 1] - all[j]);
        }
        *value = *known;
    }
    for order in 1..count {
        for i in 0..count - order {
            let (low, high) = (i as f64, (i + order) as f64);
            values[i] = ((at - low) * values[i + 1] - (at - high) * values[i]) / (high - low);
        }
    }
    values[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Normal;

    fn normal(x: f64, u: f64) -> f64 {
        -0.5 * x * x * libm::exp(-2.0 * u) - u
    }

    #[test]
    fn it_is_the_posterior_of_a_fine_grid() {
        for (scale, count, seed) in [(1.0, 300, 1), (0.2, 300, 2), (8.0, 1000, 3), (0.9, 20, 4), (12.0, 100, 5)] {
            let mut random = Normal::from_seed(seed);
            let numbers: Vec<f64> = (0..count).map(|_| scale * random.sample()).collect();
            let mut coarse = NoiseScale::new(17);
            let mut fine = NoiseScale::new(2001);
            for one in [&mut coarse, &mut fine] {
                let grid = one.grid.to_vec();
                for x in &numbers {
                    one.take(grid.iter().map(|u| normal(*x, *u)), 0.99);
                }
            }
            let [[mean, std], [expected, width]] = [&coarse, &fine].map(|one| one.moments);
            assert!((mean - expected).abs() < 0.1 * width, "{scale}: {mean} for {expected} ± {width}");
            assert!((std / width - 1.0).abs() < 0.06, "{scale}: {std} for {width}");
            assert!((coarse.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn two_sigma_hold_the_true_scale() {
        for (keep, count) in [(1.0, 200), (0.99, 150), (0.99, 1500), (0.998, 2000)] {
            let mut inside = 0;
            for seed in 0..600 {
                let mut random = Normal::from_seed(seed);
                let truth = libm::exp(4.0 * random.uniform() - 2.0);
                let mut scale = NoiseScale::new(17);
                let grid = scale.grid.to_vec();
                for _ in 0..count {
                    let x = truth * random.sample();
                    scale.take(grid.iter().map(|u| normal(x, *u)), keep);
                }
                let [mean, std] = scale.moments;
                inside += usize::from((mean - libm::log(truth)).abs() <= 2.0 * std);
            }
            let share = inside as f64 / 600.0;
            assert!((0.925..=0.98).contains(&share), "{keep}, {count}: {share}");
        }
    }

    #[test]
    fn likelihoods_that_are_no_numbers_spoil_nothing() {
        for wrong in [f64::INFINITY, f64::NAN, f64::NEG_INFINITY, -1e308] {
            let mut scale = NoiseScale::new(9);
            for k in 0..2000 {
                let grid = scale.grid.to_vec();
                let of = |(j, u): (usize, &f64)| if j == 3 && k == 7 { wrong } else { 900.0 + normal(1.0, *u) };
                scale.take(grid.iter().enumerate().map(of), 1.0);
            }
            let [mean, std] = scale.moments;
            assert!(mean.is_finite() && std.is_finite() && std < 1.0, "{wrong}: {mean} ± {std}");
            assert!((scale.weights.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{wrong}");
        }
    }

    #[test]
    fn filters_that_fail_have_no_share() {
        let mut scale = NoiseScale::new(9);
        for _ in 0..50 {
            let grid = scale.grid.to_vec();
            scale.take(grid.iter().map(|u| if *u < 1.0 { f64::NEG_INFINITY } else { normal(1.0, *u) }), 1.0);
        }
        let [mean, std] = scale.moments;
        assert!(mean >= 1.0 && std.is_finite());
        assert!(scale.grid.iter().zip(&scale.weights).all(|(u, weight)| *u >= 1.0 || *weight == 0.0));
    }
}
