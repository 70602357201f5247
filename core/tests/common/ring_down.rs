//! Free decays, with the start values that the core makes for them.

use kalmanscope_core::record::Input;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, InputKind, Quantity, Record};

use crate::random::Random;

/// A decay from an initial displacement.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingDown {
    /// ωₙ \[rad/s\] and ζ.
    pub(crate) natural_frequency: f64,
    pub(crate) damping_ratio: f64,
    /// Samples in a period, and periods in the record.
    pub(crate) rate: f64,
    pub(crate) periods: f64,
    pub(crate) sensor: Quantity,
    /// The noise over the largest reading.
    pub(crate) noise: f64,
    pub(crate) seed: u64,
}

pub(crate) const SENSORS: [Quantity; 3] = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];

impl RingDown {
    /// One of a grid, drawn from its seed.
    fn of(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut log = |low: f64, high: f64| low * (high / low).powf(random.uniform());
        Self {
            natural_frequency: log(1.0, 60.0),
            damping_ratio: log(0.005, 0.1),
            rate: log(8.0, 80.0),
            periods: log(12.0, 80.0),
            sensor: SENSORS[seed as usize % 3],
            noise: log(0.01, 0.1),
            seed,
        }
    }

    fn record(&self) -> Record {
        let Self { natural_frequency: wn, damping_ratio: zeta, rate, periods, sensor, noise, seed } = *self;
        let dt = std::f64::consts::TAU / wn / rate;
        let (rest, wd) = (zeta * wn, wn * (1.0 - zeta * zeta).sqrt());
        let clean = |k: usize| {
            let t = k as f64 * dt;
            let (decay, cos, sin) = ((-rest * t).exp(), (wd * t).cos(), (wd * t).sin());
            let (x, v) = (decay * (cos + rest / wd * sin), -decay * wn * wn / wd * sin);
            match sensor {
                q if q == Quantity::DISPLACEMENT => x,
                q if q == Quantity::VELOCITY => v,
                _ => -wn * wn * x - 2.0 * rest * v,
            }
        };
        let clean: Vec<f64> = (0..(rate * periods) as usize).map(clean).collect();
        let largest = clean.iter().fold(0.0_f64, |largest, y| largest.max(y.abs()));
        let mut random = Random::new(seed + 100_000);
        let measured: Vec<f64> = clean.iter().map(|y| y + noise * largest * random.normal()).collect();
        let input = Input { kind: InputKind::Force, hold: Hold::First, values: vec![0.0; measured.len()] };
        Record::new(dt, input, vec![(sensor, measured)]).unwrap()
    }

    /// Whether the start values are within 10 % of ωₙ and a factor of 1.3 of ζ, and in words.
    pub(crate) fn outcome(&self) -> (bool, String) {
        let record = self.record();
        let suggestion = suggest(&scenario_for(&record), &record);
        let filter = &suggestion.scenario.filters[0];
        let guess = filter.initial_mean[Channel::NATURAL_FREQUENCY] / self.natural_frequency;
        let damping = filter.initial_mean[Channel::DAMPING_RATIO] / self.damping_ratio;
        let is_white = filter.augment.contains(&Channel::WHITE_FORCE);
        let is_right = (guess - 1.0).abs() < 0.1 && (1.0 / 1.3..1.3).contains(&damping);
        (is_right, format!("{self:?}: ωₙ {guess:.3}, ζ {damping:.2}, white force {is_white}"))
    }
}

/// The share of right start values, with those that are wrong in words.
pub(crate) fn right(seeds: std::ops::Range<u64>) -> f64 {
    let all = seeds.end - seeds.start;
    let outcomes = seeds.map(|seed| RingDown::of(seed).outcome());
    let wrong: Vec<String> = outcomes.filter(|(is_right, _)| !is_right).map(|(_, text)| text).collect();
    wrong.iter().for_each(|text| println!("{text}"));
    1.0 - wrong.len() as f64 / all as f64
}
