//! Values that gather around two places.

use kalmanscope_core::internals::sort_numbers;

/// Two groups of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solutions {
    /// The mean of each group; the lower one first.
    pub means: [f64; 2],
    /// The share of the values in each group.
    pub shares: [f64; 2],
    /// The distance of the means over the root mean square of the standard deviations of both groups.
    pub distance: f64,
}

/// The smallest distance of two groups. The halves of a normal distribution are 2.6 apart, those of a uniform one 3.5.
const LEAST_DISTANCE: f64 = 5.0;

/// The smallest share of a group.
const LEAST_SHARE: f64 = 0.03;

impl Solutions {
    /// The two groups of some values, split where that leaves the least variance; `None` where they are one group.
    ///
    /// Source: Otsu (1979), A threshold selection method from gray-level histograms; Ashman, Bird and Zepf (1994), Detecting bimodality
    /// in astronomical datasets, for the distance.
    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
        sort_numbers(&mut values);
        let count = values.len();
        let total: f64 = values.iter().sum();
        let (mut sum, mut best) = (0.0, (0.0, 0));
        for (place, value) in values.iter().enumerate().take(count.saturating_sub(1)) {
            sum += value;
            let [below, above] = [place + 1, count - place - 1].map(|part| part as f64);
            let apart = (total - sum) / above - sum / below;
            let between = below * above * apart * apart;
            if between > best.0 {
                best = (between, place + 1);
            }
        }
        let groups = [&values[..best.1], &values[best.1..]];
        let shares = groups.map(|group| group.len() as f64 / count as f64);
        if shares.iter().any(|share| *share < LEAST_SHARE) {
            return None;
        }
        let means = groups.map(|group| group.iter().sum::<f64>() / group.len() as f64);
        let variance = |i: usize| {
            groups[i].iter().map(|value| (value - means[i]) * (value - means[i])).sum::<f64>() / groups[i].len() as f64
        };
        let distance = (means[1] - means[0]) / libm::sqrt(0.5 * (variance(0) + variance(1)));
        (distance > LEAST_DISTANCE).then_some(Self { means, shares, distance })
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::filter::Normal;

    use super::*;

    #[test]
    fn one_group_is_no_two_solutions_and_two_are() {
        for seed in 0..200 {
            let mut random = Normal::from_seed(seed);
            let count = 128 + (seed as usize % 3) * 128;
            let normal: Vec<f64> = (0..count).map(|_| random.sample()).collect();
            let uniform: Vec<f64> = (0..count).map(|_| random.uniform()).collect();
            let skewed: Vec<f64> = normal.iter().map(|x| libm::exp(0.6 * x)).collect();
            for values in [normal.clone(), uniform, skewed] {
                assert_eq!(Solutions::of(values), None, "seed {seed}");
            }
            let two = normal.iter().enumerate().map(|(i, x)| if i % 4 == 0 { 12.0 + x } else { 2.0 + x });
            let found = Solutions::of(two.collect()).expect("they are ten standard deviations apart");
            assert!((found.means[0] - 2.0).abs() < 0.3 && (found.means[1] - 12.0).abs() < 0.6, "{found:?}");
            assert!((found.shares[1] - 0.25).abs() < 0.01, "{found:?}");
        }
        assert_eq!(Solutions::of(vec![1.0; 64]), None);
        assert_eq!(Solutions::of(Vec::new()), None);
    }
}
