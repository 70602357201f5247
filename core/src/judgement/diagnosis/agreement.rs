//! Whether one sensor reads the change of another, without a model.

/// The comparison of the change of a quantity with the integral of its rate, over the same times.
#[derive(Clone, Copy, Debug)]
pub(super) struct Agreement {
    /// The factor of the change on the integral: 1 if both are right.
    pub(super) factor: f64,
    /// Its standard deviation.
    pub(super) std: f64,
    /// The time by which the rate is late, in samples.
    pub(super) late: f64,
    /// The standard deviation of that time.
    pub(super) late_std: f64,
}

/// Limits the lateness that is looked for, in samples.
const MOST_LATE: usize = 60;

/// The changes that are compared, of all that there are: more would tell little more.
const PAIRS: usize = 1000;

/// The least correlation by which two sensors can be compared.
const CLEAR: f64 = 0.9;

/// The spans over which changes are taken, in samples: the one in which both are most alike is used.
const SPANS: [usize; 8] = [2, 4, 8, 16, 32, 64, 128, 256];

impl Agreement {
    /// Compares readings of a quantity with those of its rate, `dt` \[s\] apart; `noise` is the standard deviation of the noise of the
    /// rate, as a filter takes it: where that is more than the readings are rough, their roughness counts. `None` where there are too few readings, or where the two are too unlike to be compared.
    ///
    /// ```text
    /// x(k + m) - x(k) = c + b ∫ v dt
    /// ```
    /// b by least squares, with the attenuation by the rate's noise undone.
    pub(super) fn of(values: &[f64], rates: &[f64], dt: f64, noise: f64) -> Option<Self> {
        let count = values.len().min(rates.len());
        let integral = integral(rates, dt);
        let spans = SPANS.into_iter().filter(|span| 20 * span < count);
        let at = |span: usize, late: isize| Sums::of(values, &integral, span, late);
        let lates = -(MOST_LATE as isize)..=MOST_LATE as isize;
        // Coarse in lateness first.
        let coarse = spans.flat_map(|span| lates.clone().step_by(5).map(move |late| (span, late)));
        let likeness = |sums: &Option<Sums>| sums.as_ref().map_or(0.0, |sums| sums.correlation().abs());
        let likenesses = coarse.map(|(span, late)| (likeness(&at(span, late)), span, late));
        let (_, span, near) = likenesses.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let fine = (near - 5).max(-(MOST_LATE as isize))..=(near + 5).min(MOST_LATE as isize);
        let likenesses = fine.map(|late| (likeness(&at(span, late)), late));
        let (_, best) = likenesses.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let sums = at(span, best)?;
        let r = sums.correlation();
        if r.abs() < CLEAR {
            return None;
        }
        // The peak of the parabola through three likenesses.
        let [before, here, after] = [best - 1, best, best + 1].map(|late| likeness(&at(span, late)));
        let curvature = before - 2.0 * here + after;
        let peak = if curvature < 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 };
        let independent = (count as f64 / span as f64).max(3.0);
        let noise = noise.min(roughness(rates));
        let attenuation = 1.0 - span as f64 * (dt * noise).powi(2) / sums.variances()[1];
        let factor = sums.slope() / attenuation.max(0.5);
        let std = factor.abs() * ((1.0 / (r * r) - 1.0) / independent).sqrt();
        // The scatter of the likeness, over its curvature.
        let scatter = ((1.0 - r * r) / independent).sqrt();
        let late_std =
            if curvature < 0.0 { (scatter * (1.0 - r * r).sqrt() / -curvature).sqrt() } else { f64::INFINITY };
        Some(Self { factor, std, late: best as f64 + peak, late_std })
    }
}

/// The standard deviation of white noise with the second differences of these readings: that of their own noise, and a little more.
fn roughness(readings: &[f64]) -> f64 {
    let squares =
        readings.windows(3).map(|three| three[0] - 2.0 * three[1] + three[2]).filter(|second| second.is_finite());
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), second| (sum + second * second, count + 1.0));
    // 1 + 4 + 1 times the variance of one reading.
    if count > 0.0 { (sum / (6.0 * count)).sqrt() } else { f64::INFINITY }
}

/// The integral of a rate up to each sample; its missing readings count as those before them.
fn integral(rates: &[f64], dt: f64) -> Vec<f64> {
    let mut last = rates.iter().copied().find(|rate| !rate.is_nan()).unwrap_or(0.0);
    let mut sum = 0.0;
    let step = |rate: &f64| {
        let before = last;
        if !rate.is_nan() {
            last = *rate;
        }
        sum += 0.5 * dt * (before + last);
        sum
    };
    rates.iter().map(step).collect()
}

/// The sums of the changes of two columns over a span, the second one late by some samples.
struct Sums {
    count: f64,
    means: [f64; 2],
    squares: [f64; 2],
    product: f64,
}

impl Sums {
    fn of(values: &[f64], integral: &[f64], span: usize, late: isize) -> Option<Self> {
        let count = values.len().min(integral.len());
        let first = late.min(0).unsigned_abs();
        let end = count.checked_sub(span + late.max(0).unsigned_abs())?;
        let stride = (end.saturating_sub(first) / PAIRS).max(1);
        let mut sums = Self { count: 0.0, means: [0.0; 2], squares: [0.0; 2], product: 0.0 };
        for k in (first..end).step_by(stride) {
            let other = k.checked_add_signed(late)?;
            let pair = [values[k + span] - values[k], integral[other + span] - integral[other]];
            if pair.iter().any(|x| !x.is_finite()) {
                continue;
            }
            // Welford (1962), Note on a method for calculating corrected sums of squares and products.
            sums.count += 1.0;
            let before = [pair[0] - sums.means[0], pair[1] - sums.means[1]];
            for (mean, difference) in sums.means.iter_mut().zip(before) {
                *mean += difference / sums.count;
            }
            let after = [pair[0] - sums.means[0], pair[1] - sums.means[1]];
            for ((square, before), after) in sums.squares.iter_mut().zip(before).zip(after) {
                *square += before * after;
            }
            sums.product += before[0] * after[1];
        }
        (sums.count > 50.0 && sums.squares.iter().all(|square| *square > 0.0)).then_some(sums)
    }

    fn correlation(&self) -> f64 {
        self.product / (self.squares[0] * self.squares[1]).sqrt()
    }

    fn slope(&self) -> f64 {
        self.product / self.squares[1]
    }

    fn variances(&self) -> [f64; 2] {
        self.squares.map(|square| square / self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::Normal;

    /// Displacement and velocity of two swings together, read with noise, changed in some way.
    fn readings(change: impl Fn(f64) -> [f64; 2], seed: u64) -> [Vec<f64>; 2] {
        let mut normal = Normal::from_seed(seed);
        let mut columns = [Vec::new(), Vec::new()];
        for k in 0..4000 {
            let [x, v] = change(0.01 * f64::from(k));
            columns[0].push(x + 0.01 * normal.sample());
            columns[1].push(v + 0.06 * normal.sample());
        }
        columns
    }

    fn x(t: f64) -> f64 {
        0.3 * (6.0 * t).sin() + 0.1 * (4.1 * t + 1.0).cos()
    }

    fn v(t: f64) -> f64 {
        1.8 * (6.0 * t).cos() - 0.41 * (4.1 * t + 1.0).sin()
    }

    fn agreement(change: impl Fn(f64) -> [f64; 2], seed: u64) -> Agreement {
        let [values, rates] = readings(change, seed);
        Agreement::of(&values, &rates, 0.01, 0.06).unwrap()
    }

    #[test]
    fn right_sensors_agree() {
        for seed in 0..20 {
            let Agreement { factor, std, late, late_std } = agreement(|t| [x(t), v(t)], seed);
            assert!((factor - 1.0).abs() < 4.0 * std + 0.005, "{factor} ± {std}");
            assert!(late.abs() < 4.0 * late_std + 0.3, "{late} ± {late_std}");
        }
    }

    #[test]
    fn scale_sign_and_lateness_are_found() {
        for seed in 0..5 {
            assert!((agreement(|t| [1.2 * x(t), v(t)], seed).factor / 1.2 - 1.0).abs() < 0.01);
            assert!((agreement(|t| [x(t), 1.2 * v(t)], seed).factor * 1.2 - 1.0).abs() < 0.01);
            assert!((agreement(|t| [x(t), -v(t)], seed).factor + 1.0).abs() < 0.01);
            for late in [-7.0, 3.0, 20.0] {
                let found = agreement(|t| [x(t), v(t - 0.01 * late)], seed);
                assert!((found.late - late).abs() < 0.5, "{late}: {found:?}");
            }
            assert!((agreement(|t| [x(t), v(t) + 0.5], seed).factor - 1.0).abs() < 0.01, "a bias");
        }
    }

    /// A filter that takes the noise for much larger than it is does not make a right sensor wrong.
    #[test]
    fn noise_that_is_taken_for_too_large_turns_no_factor() {
        for seed in 0..10 {
            let [values, rates] = readings(|t| [x(t), v(t)], seed);
            for times in [1.0, 5.0, 100.0] {
                let Agreement { factor, std, .. } = Agreement::of(&values, &rates, 0.01, 0.06 * times).unwrap();
                assert!((factor - 1.0).abs() < 4.0 * std + 0.005, "{times}: {factor} ± {std}");
            }
        }
    }

    #[test]
    fn what_cannot_be_compared_is_not() {
        let mut normal = Normal::from_seed(1);
        let noise: Vec<f64> = (0..1000).map(|_| normal.sample()).collect();
        assert!(Agreement::of(&noise, &noise, 0.01, 1.0).is_none());
        assert!(Agreement::of(&[], &[], 0.01, 1.0).is_none());
        assert!(Agreement::of(&[0.0; 500], &[0.0; 500], 0.01, 1.0).is_none());
    }
}
