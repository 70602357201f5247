//! Seeded streams of standard normal numbers, one per purpose.
//!
//! The Box-Muller transform is written out because bits must not depend on the build: `rand_distr` takes its logarithm from the
//! platform's library as soon as any crate of the build enables the feature `std` of `num-traits`.

use std::f64::consts::TAU;

use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Each purpose has its own stream, so that adding a sensor or a disturbance changes no other noise.
#[derive(Clone, Copy, Debug)]
pub enum Purpose {
    Force,
    ForceOn(crate::ForcedMass),
    Disturbance,
    Sensor(crate::Quantity),
    Fault(crate::Quantity, u64),
    Ensemble(usize),
    /// A number of a member of a population, by the hash of its key.
    Draw(u64),
}

/// The stream of the first ensemble; those of the others follow. Before it are the force's, the disturbance's and most sensors'.
const ENSEMBLES: u64 = 64;

const LATER_SENSORS: u64 = 1 << 32;

const FORCES_ON: u64 = 3 << 32;

/// The streams of each family of faults begin at a multiple of this number; each sensor has one of them.
const FAULTS: u64 = 1 << 40;

const DRAWS: u64 = 1 << 62;

/// From here on: streams of ensembles that do not fit before the sensors.
const FAR_ENSEMBLES: u64 = 1 << 63;

impl Purpose {
    const fn stream(self) -> u64 {
        match self {
            Self::Force => 0,
            Self::ForceOn(mass) => FORCES_ON + mass.mass() as u64,
            Self::Disturbance => 1,
            Self::Sensor(quantity) => quantity.stream(),
            Self::Fault(quantity, stream) => FAULTS * (1 + stream) + quantity.stream(),
            Self::Draw(hash) => DRAWS | (hash >> 2),
            Self::Ensemble(number) => match number as u64 {
                number if number < LATER_SENSORS - ENSEMBLES => ENSEMBLES + number,
                number => FAR_ENSEMBLES | number,
            },
        }
    }
}

/// An endless stream of independent standard normal numbers: the same for the same seed, on every platform.
#[derive(Clone, Debug)]
pub struct Normal {
    rng: ChaCha8Rng,
    spare: Option<f64>,
}

impl Normal {
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(purpose.stream());
        Self { rng, spare: None }
    }

    /// A stream with its own purpose.
    pub fn from_seed(seed: u64) -> Self {
        Self { rng: ChaCha8Rng::seed_from_u64(seed), spare: None }
    }

    /// A number uniform in (0, 1], of 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        ((self.rng.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// The next number.
    pub fn sample(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        let (sin, cos) = libm::sincos(TAU * self.uniform());
        self.spare = Some(radius * sin);
        radius * cos
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channel::MAX_MASSES;
    use crate::{ForcedMass, Quantity};

    #[test]
    fn moments_are_those_of_the_standard_normal() {
        let mut normal = Normal::new(7, Purpose::Force);
        let n = 200_000;
        let draws: Vec<f64> = (0..n).map(|_| normal.sample()).collect();
        let moment = |p: i32| draws.iter().map(|x| x.powi(p)).sum::<f64>() / f64::from(n);
        assert!(moment(1).abs() < 0.01, "mean {}", moment(1));
        assert!((moment(2) - 1.0).abs() < 0.015, "variance {}", moment(2));
        assert!(moment(3).abs() < 0.03, "skewness {}", moment(3));
        assert!((moment(4) - 3.0).abs() < 0.1, "kurtosis {}", moment(4));
    }

    #[test]
    fn no_two_purposes_share_a_stream() {
        let sensors = Quantity::all().iter().map(|&quantity| Purpose::Sensor(quantity));
        let ensembles = (0..1000).map(Purpose::Ensemble);
        let purposes = [Purpose::Force, Purpose::Disturbance, Purpose::Draw(0), Purpose::Draw(u64::MAX)]
            .into_iter()
            .chain(sensors)
            .chain((0..MAX_MASSES).filter_map(ForcedMass::new).map(Purpose::ForceOn))
            .chain(ensembles);
        let streams: Vec<u64> = purposes.map(Purpose::stream).collect();
        let different: std::collections::HashSet<u64> = streams.iter().copied().collect();
        assert_eq!(different.len(), streams.len());
        assert_eq!((Purpose::Ensemble(0).stream(), Purpose::Ensemble(999).stream()), (64, 1063), "old bits");
    }

    proptest::proptest! {
        #[test]
        fn no_id_shares_a_stream(number in 0..=u32::MAX, back in 0_u32..200) {
            for number in [number, u32::MAX - back] {
                let stream = Purpose::Ensemble(number as usize).stream();
                let sensors = Quantity::all().iter().map(|&quantity| Purpose::Sensor(quantity).stream());
                proptest::prop_assert!(stream > 1 && sensors.into_iter().all(|other| other != stream));
                let other = Purpose::Ensemble(number.wrapping_sub(1 + back) as usize).stream();
                proptest::prop_assert_ne!(stream, other);
            }
        }
    }
}
