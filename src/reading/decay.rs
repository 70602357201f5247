//! Frequency and damping by hand, from two peaks of a free oscillation.

/// Frequency and damping, computed from two peaks of a free decay.
///
/// ```text
/// δ = ln(x₁ / x₂) / n,  ζ = δ / √(4π² + δ²),  T = (t₂ - t₁) / n,  ωₙ = 2π / (T √(1 - ζ²))
/// ```
///
/// Source: Chopra (2012), *Dynamics of Structures*, section 2.2.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Decay {
    pub(crate) periods: usize,
    pub(crate) decrement: f64,
    pub(crate) damping_ratio: f64,
    /// Damped period \[s\].
    pub(crate) period: f64,
    /// Natural frequency \[rad/s\].
    pub(crate) natural_frequency: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoDecay {
    Forced,
    NoPeaks,
}

impl NoDecay {
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::Forced => "ζ by hand needs a free decay: no force between A and B",
            Self::NoPeaks => "ζ by hand needs two falling peaks: put A and B near them",
        }
    }
}

impl Decay {
    /// The decay from the peak next to sample `first` to the peak of the same side next to `last`, of a motion with the time
    /// step `dt` \[s\].
    pub(super) fn of(motion: &[f64], first: usize, last: usize, dt: f64) -> Result<Self, NoDecay> {
        let peaks: Vec<Peak> = peaks(motion);
        let nearest = |to: usize, side: Option<bool>| {
            let of_side = peaks.iter().filter(|peak| side.is_none_or(|side| peak.is_above() == side));
            of_side.min_by(|a, b| a.distance(to).total_cmp(&b.distance(to)))
        };
        let one = nearest(first, None).ok_or(NoDecay::NoPeaks)?;
        let other = nearest(last, Some(one.is_above())).ok_or(NoDecay::NoPeaks)?;
        let between = |peak: &&Peak| peak.at > one.at && peak.at <= other.at && peak.is_above() == one.is_above();
        let periods = peaks.iter().filter(between).count();
        let ratio = one.value / other.value;
        if periods == 0 || ratio.is_nan() || ratio <= 1.0 {
            return Err(NoDecay::NoPeaks);
        }
        let decrement = ratio.ln() / periods as f64;
        let damping_ratio = decrement / (decrement * decrement + 4.0 * std::f64::consts::PI.powi(2)).sqrt();
        let period = (other.at - one.at) * dt / periods as f64;
        let natural_frequency = std::f64::consts::TAU / (period * (1.0 - damping_ratio * damping_ratio).sqrt());
        Ok(Self { periods, decrement, damping_ratio, period, natural_frequency })
    }
}

struct Peak {
    at: f64,
    value: f64,
}

impl Peak {
    fn is_above(&self) -> bool {
        self.value > 0.0
    }

    fn distance(&self, sample: usize) -> f64 {
        (self.at - sample as f64).abs()
    }
}

fn peaks(motion: &[f64]) -> Vec<Peak> {
    let mut peaks = Vec::new();
    let mut start = 0;
    for part in motion.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0)) {
        let largest = (0..part.len()).max_by(|&i, &j| part[i].abs().total_cmp(&part[j].abs()));
        let k = start + largest.unwrap_or(0);
        if k > 0 && k + 1 < motion.len() {
            let [before, top, after] = [motion[k - 1], motion[k], motion[k + 1]];
            let curvature = before - 2.0 * top + after;
            if (top - before) * (after - top) <= 0.0 && curvature != 0.0 {
                let shift = 0.5 * (before - after) / curvature;
                peaks.push(Peak { at: k as f64 + shift, value: top - 0.25 * (before - after) * shift });
            }
        }
        start += part.len();
    }
    peaks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free(natural_frequency: f64, damping_ratio: f64, dt: f64) -> Vec<f64> {
        let damped = natural_frequency * (1.0 - damping_ratio * damping_ratio).sqrt();
        let at = |t: f64| (-damping_ratio * natural_frequency * t).exp() * (damped * t).cos();
        (0..2000).map(|k| at(f64::from(k) * dt)).collect()
    }

    #[test]
    fn two_peaks_of_a_free_decay_tell_frequency_and_damping() {
        for (natural_frequency, damping_ratio) in [(6.0, 0.05), (6.0, 0.01), (12.0, 0.1)] {
            let motion = free(natural_frequency, damping_ratio, 0.01);
            let decay = Decay::of(&motion, 90, 430, 0.01).unwrap();
            assert!((decay.damping_ratio / damping_ratio - 1.0).abs() < 0.01, "{decay:?}");
            assert!((decay.natural_frequency / natural_frequency - 1.0).abs() < 0.002, "{decay:?}");
            assert!(decay.periods >= 3);
        }
    }

    #[test]
    fn where_nothing_falls_there_is_no_decay() {
        let growing: Vec<f64> = free(6.0, 0.05, 0.01).into_iter().rev().collect();
        assert_eq!(Decay::of(&growing, 1500, 1800, 0.01), Err(NoDecay::NoPeaks));
        assert_eq!(Decay::of(&free(6.0, 0.05, 0.01), 100, 110, 0.01), Err(NoDecay::NoPeaks));
        for flat in [&[][..], &[0.0; 50], &[1.0; 50]] {
            assert_eq!(Decay::of(flat, 0, 40, 0.01), Err(NoDecay::NoPeaks));
        }
    }
}
