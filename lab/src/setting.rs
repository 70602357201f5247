//! The numbers of a scenario, by key.

mod key;
mod member;

use kalmanscope_core::{Channel, Scenario, Signal};
use thiserror::Error;

use member::Member;

/// A number of a scenario that an axis can vary, or a factor on several of them.
///
/// Keys are those of lessons: `filters.EKF.initial_mean.natural_frequency`, `sensors.velocity.noise_std`, `seed`. A
/// filter is found by its name, or by its id as in `filters#1.fading`; `*` stands for all of them. A whole table of standard deviations, such as
/// `filters.EKF.process_std` or `filters.EKF.sensor_std`, stands for a factor on each of its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    key: String,
    place: Place,
}

/// The reason why a key names no setting.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the scenario has no number `{key}` to vary{filters}")]
pub struct UnknownSetting {
    /// The key.
    pub key: String,
    /// The end of the sentence: the filters that there are, where the key is of none of them.
    filters: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    Scenario(Global),
    Parameter(Channel),
    Noise(usize),
    Filters(Vec<usize>, Member),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Global {
    Seed,
    Dt,
    Duration,
    Disturbance,
    InputDelay,
    Displacement,
    Velocity,
    RecordGain,
}

/// The gain of the input of a measured record, if the scenario names one with an input.
pub(crate) fn record_gain(scenario: &Scenario) -> Option<f64> {
    Some(scenario.record.as_ref()?.input.as_ref()?.gain)
}

impl Setting {
    /// The setting of a scenario with this key. A factor is relative to the scenario's present numbers.
    ///
    /// # Errors
    /// [`UnknownSetting`] where the scenario has no such number.
    pub fn new(scenario: &Scenario, key: &str) -> Result<Self, UnknownSetting> {
        let place = key::place(scenario, key)
            .ok_or_else(|| UnknownSetting { key: key.to_owned(), filters: scenario.filters_instead_of(key) })?;
        Ok(Self { key: key.to_owned(), place })
    }

    /// Whether another setting is of the same numbers, whatever its key is.
    pub fn is_same_as(&self, other: &Self) -> bool {
        self.place == other.place
    }

    /// The key.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Whether the setting belongs to filters: the record stays the same whatever its value.
    pub fn is_of_filters(&self) -> bool {
        matches!(self.place, Place::Filters(..))
    }

    /// Whether a given record can follow the setting: it stays as it is, or its input is multiplied.
    pub fn suits_given_record(&self) -> bool {
        self.is_of_filters() || self.place == Place::Scenario(Global::RecordGain)
    }

    /// Whether the setting is a number without fractions, such as a seed.
    pub fn is_whole(&self) -> bool {
        use Member::{EnsembleSize, InputDelay, Iterations};
        matches!(
            self.place,
            Place::Scenario(Global::Seed | Global::InputDelay)
                | Place::Filters(_, InputDelay | EnsembleSize | Iterations)
        )
    }

    /// A value as the setting takes it: a number without fractions is rounded, and a seed is not negative.
    pub fn rounded(&self, value: f64) -> f64 {
        match self.place {
            Place::Scenario(Global::Seed) => libm::round(value).max(0.0),
            _ if self.is_whole() => libm::round(value),
            _ => value,
        }
    }

    /// Whether the setting multiplies the numbers of a table.
    pub fn is_factor(&self) -> bool {
        matches!(self.place, Place::Filters(_, Member::Factor(..)))
    }

    /// The channel that the setting is of, if it is of one.
    pub fn channel(&self) -> Option<Channel> {
        match &self.place {
            Place::Parameter(c)
            | Place::Filters(_, Member::InitialMean(c) | Member::InitialStd(c) | Member::ProcessStd(c)) => Some(*c),
            _ => None,
        }
    }

    /// The unit, empty for a pure number.
    pub fn unit(&self, scenario: &Scenario) -> &'static str {
        match &self.place {
            Place::Scenario(Global::Dt | Global::Duration) => "s",
            Place::Scenario(Global::Disturbance) => "m/s²",
            Place::Scenario(Global::Displacement) => "m",
            Place::Scenario(Global::Velocity) => "m/s",
            Place::Scenario(Global::Seed) => "",
            Place::Scenario(Global::InputDelay) | Place::Filters(_, Member::InputDelay) => "samples",
            Place::Noise(sensor) | Place::Filters(_, Member::SensorStd(sensor)) => {
                scenario.sensors.get(*sensor).map_or("", |sensor| sensor.measures.unit())
            }
            Place::Filters(_, Member::Eta) => "1/s",
            _ => self.channel().map_or("", Channel::unit),
        }
    }

    /// The present value in a scenario, that of the first filter where there are several; of a parameter that moves, the
    /// first value.
    pub fn get(&self, scenario: &Scenario) -> f64 {
        match &self.place {
            Place::Scenario(global) => match global {
                Global::Seed => scenario.seed as f64,
                Global::Dt => scenario.dt,
                Global::Duration => scenario.duration,
                Global::Disturbance => scenario.plant.disturbance_std,
                Global::InputDelay => f64::from(scenario.plant.input_delay),
                Global::Displacement => scenario.plant.initial.displacement,
                Global::Velocity => scenario.plant.initial.velocity,
                Global::RecordGain => record_gain(scenario).unwrap_or(f64::NAN),
            },
            Place::Parameter(channel) => scenario.plant.parameter(*channel).map_or(f64::NAN, |signal| signal.at(0.0)),
            Place::Noise(sensor) => scenario.sensors.get(*sensor).map_or(f64::NAN, |sensor| sensor.noise_std),
            Place::Filters(places, member) => {
                let filter = places.first().and_then(|&place| scenario.filters.get(place));
                filter.map_or(f64::NAN, |filter| member.get(filter))
            }
        }
    }

    /// Sets the value. A whole number is rounded; a signal becomes constant. The scenario may then be impossible.
    pub fn set(&self, scenario: &mut Scenario, value: f64) {
        match &self.place {
            Place::Scenario(global) => match global {
                Global::Seed => scenario.seed = libm::round(value) as u64,
                Global::Dt => scenario.dt = value,
                Global::Duration => scenario.duration = value,
                Global::Disturbance => scenario.plant.disturbance_std = value,
                Global::InputDelay => scenario.plant.input_delay = libm::round(value) as i32,
                Global::Displacement => scenario.plant.initial.displacement = value,
                Global::Velocity => scenario.plant.initial.velocity = value,
                Global::RecordGain => {
                    if let Some(input) = scenario.record.as_mut().and_then(|record| record.input.as_mut()) {
                        input.gain = value;
                    }
                }
            },
            Place::Parameter(channel) => scenario.plant.set(*channel, Signal::Constant(value)),
            Place::Noise(sensor) => {
                if let Some(sensor) = scenario.sensors.get_mut(*sensor) {
                    sensor.noise_std = value;
                }
            }
            Place::Filters(places, member) => {
                for (nth, place) in places.iter().enumerate() {
                    if let Some(filter) = scenario.filters.get_mut(*place) {
                        member.set(filter, nth, value);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_setting_is_set_and_read_back() {
        let mut scenario = Scenario::default();
        for (key, value) in [
            ("seed", 12.0),
            ("dt", 0.02),
            ("duration", 20.0),
            ("plant.disturbance_std", 0.3),
            ("plant.input_delay", 2.0),
            ("plant.initial.displacement", 0.1),
            ("plant.natural_frequency", 5.0),
            ("sensors.velocity.noise_std", 0.2),
            ("filters.EKF.fading", 1.01),
            ("filters.EKF.eta", 0.1),
            ("filters.UKF.input_delay", -1.0),
            ("filters.EKF.sensor_std.velocity", 0.5),
            ("filters.EKF.sensor_std.0", 0.25),
            ("filters.UKF.initial_mean.natural_frequency", 12.0),
            ("filters.*.initial_std.damping_ratio", 0.3),
            ("filters.EKF.process_std.velocity", 1e-3),
        ] {
            let setting = Setting::new(&scenario, key).unwrap();
            setting.set(&mut scenario, value);
            assert_eq!(setting.get(&scenario), value, "{key}");
            assert_eq!(Setting::new(&scenario, key).unwrap().get(&scenario), value, "{key} is found again");
            scenario.validate().unwrap();
        }
        assert!(scenario.filters.iter().all(|f| f.initial_std[Channel::DAMPING_RATIO] == 0.3));
    }

    #[test]
    fn a_factor_multiplies_the_present_numbers() {
        let before = Scenario::default();
        let mut scenario = before.clone();
        for key in ["filters.*.process_std", "filters.EKF.sensor_std", "filters.UKF.initial_std"] {
            let setting = Setting::new(&before, key).unwrap();
            assert_eq!(setting.get(&scenario), 1.0);
            setting.set(&mut scenario, 4.0);
            setting.set(&mut scenario, 3.0);
            assert!((setting.get(&scenario) - 3.0).abs() < 1e-12, "{key}");
        }
        let [ekf, ukf] = &scenario.filters[..] else { panic!("two filters") };
        assert_eq!(ekf.sensor_std, before.filters[0].sensor_std.iter().map(|s| 3.0 * s).collect::<Vec<_>>());
        assert_eq!(ukf.sensor_std, before.filters[1].sensor_std);
        assert_eq!(ukf.initial_std[Channel::VELOCITY], 3.0 * before.filters[1].initial_std[Channel::VELOCITY]);
        scenario.filters[0].sensor_std[0] *= 2.0;
        let setting = Setting::new(&before, "filters.EKF.sensor_std").unwrap();
        assert!(setting.get(&scenario).is_nan(), "one sensor alone has another factor");
    }

    #[test]
    fn only_settings_of_filters_leave_the_record_as_it_is() {
        let scenario = Scenario::default();
        let of_filters = |key| Setting::new(&scenario, key).unwrap().is_of_filters();
        assert!(of_filters("filters.EKF.fading") && of_filters("filters.*.process_std"));
        assert!(!of_filters("seed") && !of_filters("plant.damping_ratio") && !of_filters("sensors.velocity.noise_std"));
    }

    #[test]
    fn a_setting_by_id_is_found_whatever_the_filter_is_called() {
        let mut scenario = Scenario::default();
        (scenario.filters[0].name, scenario.filters[1].name) = ("UKF".to_owned(), "EKF".to_owned());
        let setting = Setting::new(&scenario, "filters#2.process_std.velocity").unwrap();
        setting.set(&mut scenario, 0.25);
        assert_eq!(scenario.filters[1].process_std[Channel::VELOCITY], 0.25);
        assert_eq!(setting.channel(), Some(Channel::VELOCITY));
    }

    #[test]
    fn names_with_dots_are_found() {
        let mut scenario = Scenario::default();
        scenario.filters[1].name = "EKF.2".to_owned();
        let setting = Setting::new(&scenario, "filters.EKF.2.fading").unwrap();
        setting.set(&mut scenario, 1.5);
        assert_eq!((scenario.filters[0].fading, scenario.filters[1].fading), (1.005, 1.5));
    }

    #[test]
    fn unknown_keys_are_refused() {
        for key in [
            "",
            "plant.mass",
            "plant.input_gain",
            "filters.KF.fading",
            "filters.EKF",
            "filters.EKF.fadng",
            "filters.EKF.sensor_std.acceleration",
            "filters.EKF.sensor_std.2",
            "filters.EKF.initial_mean.cubic_stiffness",
            "sensors.acceleration.noise_std",
        ] {
            let unknown = Setting::new(&Scenario::default(), key).unwrap_err();
            let instead = if key.starts_with("filters.KF.") { "; its filters are `EKF` and `UKF`" } else { "" };
            assert_eq!(unknown.to_string(), format!("the scenario has no number `{key}` to vary{instead}"));
        }
    }
}
