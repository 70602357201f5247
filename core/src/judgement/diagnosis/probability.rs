//! The probability that a cause is the right one.

use super::remedy::Remedy;

/// The weights of what is seen of a remedy in the logarithm of its odds: a constant, that it stands first, the lead of its gain over
/// all others on a logarithmic scale, that it explains the verdict, that another one does, that it is certain, that another one
/// is, and that it has further causes.
///
/// They are those with which 1,920 situations of the benchmark `diagnosis`, from seed 500,000 on, are likeliest. Source: Platt (1999),
/// Probabilistic outputs for support vector machines.
const WEIGHTS: [f64; 8] = [-0.7, 2.6, 0.5, 0.3, -0.4, 5.3, -1.5, -3.3];

/// The gain in log likelihood over which the scale of leads is logarithmic.
const SCALE: f64 = 8.0;

/// Limits a gain.
const MOST: f64 = 1e6;

/// A probability as it is read: never quite none or all.
pub fn in_percent(probability: f64) -> String {
    match 100.0 * probability {
        least if least < 1.0 => "< 1 %".to_owned(),
        most if most > 99.0 => "> 99 %".to_owned(),
        usual => format!("{usual:.0} %"),
    }
}

impl Remedy {
    /// The probability of each of some remedies, the likeliest first, that its first cause is the right one: how often it was where
    /// one of the faults that are known was put into random situations. Each stands for itself, and their sum is not 1.
    ///
    /// ```text
    /// p = 1 / (1 + exp(-Σ w x))
    /// ```
    pub fn probabilities(remedies: &[Self]) -> Vec<f64> {
        let gain = |remedy: &Self| if remedy.gain.is_nan() { 0.0 } else { remedy.gain.clamp(-MOST, MOST) };
        let of = |(place, remedy): (usize, &Self)| {
            let others = || remedies.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, other)| other);
            let lead = gain(remedy) - others().map(gain).fold(0.0, f64::max);
            let flag = |is: bool| f64::from(u8::from(is));
            let seen = [
                1.0,
                flag(place == 0),
                libm::copysign(libm::log1p(lead.abs() / SCALE), lead),
                flag(remedy.explains()),
                flag(others().any(Self::explains)),
                flag(remedy.first.certain),
                flag(others().any(|other| other.first.certain)),
                flag(!remedy.then.is_empty()),
            ];
            let odds: f64 = WEIGHTS.iter().zip(seen).map(|(weight, seen)| weight * seen).sum();
            1.0 / (1.0 + libm::exp(-odds))
        };
        remedies.iter().enumerate().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judgement::diagnosis::{CAUSES, LikelyCause};

    fn remedy(gain: f64) -> Remedy {
        let first = LikelyCause::new(CAUSES[0], 0.5, 1.0, Vec::new(), String::new());
        Remedy { first, then: Vec::new(), edits: Vec::new(), gain, after: None }
    }

    #[test]
    fn a_lead_makes_a_cause_probable_and_others_less_so() {
        let of = |gains: &[f64]| Remedy::probabilities(&gains.iter().map(|gain| remedy(*gain)).collect::<Vec<_>>());
        let (near, far) = (of(&[100.0, 90.0]), of(&[1000.0, 90.0]));
        assert!(far[0] > near[0] && far[1] < near[1] && near[0] > near[1], "{near:?} {far:?}");
        for gains in [&[f64::NAN, 5.0][..], &[f64::INFINITY], &[1e300, -1e300, f64::NAN], &[]] {
            let all = of(gains);
            assert!(all.len() == gains.len() && all.iter().all(|p| (0.0..=1.0).contains(p)), "{gains:?}: {all:?}");
        }
        assert_eq!([0.001, 0.5, 0.999].map(in_percent), ["< 1 %", "50 %", "> 99 %"]);
    }
}
