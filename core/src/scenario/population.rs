//! Populations: scenarios of which some numbers are drawn at random, another one for each seed.

use std::collections::BTreeMap;

use kalmanscope_filters::random::{Normal, Purpose};
use kalmanscope_records::hash::Hash;
use serde::{Deserialize, Serialize};

use super::{Scenario, ScenarioError};
use crate::setting::{Address, DT, DURATION, SEED, UnknownSetting};

/// The digits of a drawn number, so that a text of it is short and exact.
const DIGITS: usize = 9;

/// The law of a number that is drawn, each with two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "one of normal, lognormal, uniform and log_uniform, with two numbers")]
pub enum Law {
    /// Mean and standard deviation.
    Normal([f64; 2]),
    /// Median, and standard deviation of the natural logarithm.
    Lognormal([f64; 2]),
    /// From, to.
    Uniform([f64; 2]),
    /// From, to, both above 0: the logarithm is uniform.
    LogUniform([f64; 2]),
}

/// The words of a kind of laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawInfo {
    /// The key in scenario files.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// The names of its two numbers.
    pub numbers: [&'static str; 2],
}

impl Law {
    /// A law of each kind, as it is offered for a number: about its value, spread by this share of it, or by as much where it is 0.
    pub fn about(value: f64, share: f64) -> [Self; 4] {
        let std = if value == 0.0 { share } else { share * value.abs() };
        let positive = if value > 0.0 { value } else { 1.0 };
        let uniform = [value - 2.0 * std, value + 2.0 * std];
        let factor = 1.0 + 2.0 * share;
        [
            Self::Normal([value, std]),
            Self::Lognormal([positive, share]),
            Self::Uniform(uniform),
            Self::LogUniform([positive / factor, positive * factor]),
        ]
        .map(|law| law.with(law.numbers().map(short)))
    }

    /// The words of its kind.
    pub fn info(&self) -> LawInfo {
        let (key, name, numbers) = match self {
            Self::Normal(_) => ("normal", "normal", ["mean", "σ"]),
            Self::Lognormal(_) => ("lognormal", "lognormal", ["median", "σ of the logarithm"]),
            Self::Uniform(_) => ("uniform", "uniform", ["from", "to"]),
            Self::LogUniform(_) => ("log_uniform", "log-uniform", ["from", "to"]),
        };
        LawInfo { key, name, numbers }
    }

    /// Its two numbers.
    pub fn numbers(&self) -> [f64; 2] {
        let (Self::Normal(numbers) | Self::Lognormal(numbers) | Self::Uniform(numbers) | Self::LogUniform(numbers)) =
            *self;
        numbers
    }

    /// The law of the same kind with other numbers.
    #[must_use]
    pub fn with(&self, numbers: [f64; 2]) -> Self {
        match self {
            Self::Normal(_) => Self::Normal(numbers),
            Self::Lognormal(_) => Self::Lognormal(numbers),
            Self::Uniform(_) => Self::Uniform(numbers),
            Self::LogUniform(_) => Self::LogUniform(numbers),
        }
    }

    /// The numbers that it may have, if its own are others.
    pub fn problem(&self) -> Option<&'static str> {
        let [a, b] = self.numbers();
        if !(a.is_finite() && b.is_finite()) {
            return Some("two finite numbers");
        }
        let (holds, allowed) = match self {
            Self::Normal(_) => (b >= 0.0, "a mean and a standard deviation of at least 0"),
            Self::Lognormal(_) => (a > 0.0 && b >= 0.0, "a median above 0 and a standard deviation of at least 0"),
            Self::Uniform(_) => (a <= b, "two numbers, the first of which is not the larger one"),
            Self::LogUniform(_) => (0.0 < a && a <= b, "two numbers above 0, the first of which is not the larger one"),
        };
        (!holds).then_some(allowed)
    }

    fn draw(&self, random: &mut Normal) -> f64 {
        match *self {
            Self::Normal([mean, std]) => mean + std * random.sample(),
            Self::Lognormal([median, std]) => median * libm::exp(std * random.sample()),
            Self::Uniform([from, to]) => from + (to - from) * random.uniform(),
            Self::LogUniform([from, to]) => from * libm::exp(libm::log(to / from) * random.uniform()),
        }
    }
}

impl Scenario {
    /// The member of the population with a seed: its noise is that of the seed, its drawn numbers are set, and nothing of it is
    /// drawn any more. Each number has its own stream by its address, so that one more changes no other. A member may be
    /// impossible, as with a damping ratio below 0.
    #[must_use]
    pub fn member(&self, seed: u64) -> Self {
        let mut member = Self { seed, draw: BTreeMap::new(), ..self.clone() };
        for (address, value) in self.drawn(seed) {
            address.set(&mut member, value);
        }
        member
    }

    /// The drawn numbers of the member with a seed, in the order of their keys. A key that names no number draws none.
    pub fn drawn(&self, seed: u64) -> Vec<(Address, f64)> {
        let one = |(key, law): (&String, &Law)| {
            let address = Address::parse(self, key).ok()?;
            let mut hash = Hash::default();
            hash.add(address.to_string().as_bytes());
            let value = short(law.draw(&mut Normal::new(seed, Purpose::Draw(hash.value()))));
            let value = address.rounded(value);
            Some((address, value))
        };
        self.draw.iter().filter_map(one).collect()
    }

    /// Leaves out draws of numbers that the scenario does not have any more, and writes the keys of the others by the ids of
    /// filters. The filters must have ids.
    pub fn keep_draws(&mut self) {
        for (key, law) in std::mem::take(&mut self.draw) {
            if let Ok(address) = Address::parse(self, &key) {
                self.draw.insert(address.to_string(), law);
            }
        }
    }

    pub(super) fn read_draws(&mut self) -> Result<(), ScenarioError> {
        if self.draw.is_empty() {
            return Ok(());
        }
        let mut numbered = self.clone();
        numbered.number_filters();
        for key in self.draw.keys() {
            let address = Address::parse(&numbered, key)
                .map_err(|error: UnknownSetting| ScenarioError::Syntax(format!("draw: {error}")))?;
            if !is_drawable(&address) {
                return Err(ScenarioError::Syntax(format!(
                    "draw: `{key}` is the same for all members of a population"
                )));
            }
        }
        numbered.keep_draws();
        self.draw = numbered.draw;
        Ok(())
    }
}

/// Whether a number may be another one in each member: the seed, and the times of the samples, are not drawn.
pub fn is_drawable(address: &Address) -> bool {
    ![&SEED, &DT, &DURATION].into_iter().any(|info| address.is_of_scenario(info))
}

fn short(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn population(draw: &str) -> Result<Scenario, ScenarioError> {
        Scenario::from_toml(&format!("[[filters]]\nkind = \"ekf\"\n[[filters]]\nkind = \"ukf\"\n[draw]\n{draw}"))
    }

    #[test]
    fn each_seed_has_a_member_of_its_own() {
        let one = "\"plant.natural_frequency\" = { lognormal = [6.0, 0.2] }\n";
        let two = format!("{one}\"filters.1.initial_mean.natural_frequency\" = {{ normal = [8.0, 2.0] }}\n");
        let (one, two) = (population(one).unwrap(), population(&two).unwrap());
        let keys: Vec<&str> = two.draw.keys().map(String::as_str).collect();
        assert_eq!(keys, ["filters#1.initial_mean.natural_frequency", "plant.natural_frequency"]);
        let mut numbered = two.clone();
        numbered.number_filters();
        let member = numbered.member(7);
        assert_eq!((member.seed, member.draw.len()), (7, 0));
        assert_eq!(member, numbered.member(7));
        assert_ne!(member.plant, numbered.member(8).plant);
        assert_eq!(member.plant, one.member(7).plant);
        let guess = |scenario: &Scenario, place: usize| {
            scenario.filters[place].initial_mean[kalmanscope_filters::Channel::NATURAL_FREQUENCY]
        };
        assert_ne!(guess(&member, 0), guess(&numbered, 0));
        assert_eq!(guess(&member, 1), guess(&numbered, 1));
        assert_eq!(Scenario::from_toml(&two.to_toml().unwrap()).unwrap(), two);
    }

    #[test]
    fn numbers_have_their_laws() {
        for (law, is_log, mean, std) in [
            ("normal = [0.05, 0.01]", false, 0.05, 0.01),
            ("lognormal = [0.05, 0.2]", true, 0.05_f64.ln(), 0.2),
            ("uniform = [0.02, 0.08]", false, 0.05, 0.06 / 12.0_f64.sqrt()),
            ("log_uniform = [0.02, 0.08]", true, 0.04_f64.ln(), 4.0_f64.ln() / 12.0_f64.sqrt()),
        ] {
            let scale = |value: f64| if is_log { value.ln() } else { value };
            let scenario = population(&format!("\"plant.damping_ratio\" = {{ {law} }}")).unwrap();
            let n = 4000;
            let values: Vec<f64> = (0..n).map(|seed| scale(scenario.drawn(seed)[0].1)).collect();
            let of = values.iter().sum::<f64>() / n as f64;
            let spread = (values.iter().map(|value| (value - of).powi(2)).sum::<f64>() / n as f64).sqrt();
            assert!((of - mean).abs() < 4.0 * std / (n as f64).sqrt(), "{law}: {of}");
            assert!((spread / std - 1.0).abs() < 0.06, "{law}: {spread}");
            for value in scenario.drawn(3) {
                assert_eq!(format!("{:.8e}", value.1).parse::<f64>().unwrap(), value.1);
            }
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        let told = |draw: &str| population(draw).unwrap_err().to_string();
        assert!(told("\"plant.mass\" = { normal = [1.0, 0.1] }").contains("no number `plant.mass`"));
        assert!(told("\"filters.KF.fading\" = { normal = [1.0, 0.1] }").contains("its filters are `EKF` and `UKF`"));
        assert!(told("\"dt\" = { uniform = [0.1, 0.2] }").contains("the same for all members"));
        assert!(
            told("\"plant.damping_ratio\" = { normal = [0.1, -1.0] }").contains("standard deviation of at least 0")
        );
        assert!(told("\"plant.damping_ratio\" = { lognormal = [0.0, 1.0] }").contains("a median above 0"));
        assert!(told("\"plant.damping_ratio\" = { uniform = [0.2, 0.1] }").contains("the larger one"));
        assert!(told("\"plant.damping_ratio\" = { gamma = [0.2, 0.1] }").contains("gamma"));
    }

    #[test]
    fn a_draw_goes_with_its_filter() {
        let mut scenario = population("\"filters.UKF.fading\" = { uniform = [1.0, 1.01] }").unwrap();
        scenario.number_filters();
        scenario.filters[1].name = "other".to_owned();
        scenario.keep_draws();
        assert_eq!(scenario.drawn(1).len(), 1);
        scenario.filters.pop();
        scenario.keep_draws();
        assert!(scenario.draw.is_empty());
    }

    #[test]
    fn offered_laws_are_possible() {
        for value in [-3.0, 0.0, 1e-5, 6.0] {
            assert!(Law::about(value, 0.2).iter().all(|law| law.problem().is_none()), "{value}");
        }
    }
}
