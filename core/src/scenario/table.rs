//! The tables of a filter: a number for each channel, or one for each sensor.

use kalmanscope_filters::channel::Channel;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::quantity::Quantity;

use super::row::{Allowed, by_key};
use super::{FilterSettings, Sensor, Values};

/// A table of a filter.
pub struct TableInfo {
    /// The key in scenario files and addresses.
    pub key: &'static str,
    /// The symbol in formulas, before that of a channel or a quantity.
    pub symbol: &'static str,
    /// The words on an axis, before "of" and that symbol.
    pub words: &'static str,
    /// The name in running text, before "of" and that of a channel or a quantity.
    pub name: &'static str,
    /// The symbol of all its numbers together, where a factor on them is a setting: of standard deviations.
    pub factor: Option<&'static str>,
    /// The numbers that it may have.
    pub allowed: Allowed,
    /// An explanation in one sentence.
    pub hint: &'static str,
    column: SettingColumn,
    /// The number of each sensor where the list is empty, if it may be.
    otherwise: Option<f64>,
    unit: Option<&'static str>,
}

enum SettingColumn {
    Channels(fn(&FilterSettings) -> &Values, fn(&mut FilterSettings) -> &mut Values),
    Sensors(fn(&FilterSettings) -> &Vec<f64>, fn(&mut FilterSettings) -> &mut Vec<f64>),
}

/// The channel or the sensor whose number an entry of a table is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// A channel of the filter.
    Channel(Channel),
    /// The sensor of a quantity.
    Sensor(Quantity),
}

macro_rules! table {
    ($field:ident in $column:ident, $symbol:literal, $($data:tt)*) => {
        TableInfo {
            $($data)*
            ..TableInfo::new(
                stringify!($field),
                $symbol,
                SettingColumn::$column(|filter| &filter.$field, |filter| &mut filter.$field),
            )
        }
    };
}

/// The mean of the initial belief.
pub static INITIAL_MEAN: TableInfo = table! { initial_mean in Channels, "guess",
    name: "initial guess",
    hint: "Mean of the initial belief",
};

/// The standard deviations of the initial belief.
pub static INITIAL_STD: TableInfo = table! { initial_std in Channels, "± σ",
    words: "σ of the guess",
    name: "initial std",
    factor: Some("√P₀"),
    allowed: Allowed::AtLeast(0.0),
    hint: "How uncertain the guess is",
};

/// The standard deviations of the process noise per step.
pub static PROCESS_STD: TableInfo = table! { process_std in Channels, "√Q",
    name: "process std",
    factor: Some("√Q"),
    allowed: Allowed::AtLeast(0.0),
    hint: "0: the model is exact",
};

/// The times over which the noise of a sensor's bias, or a force that is not recorded, is correlated.
pub static CORRELATION_TIME: TableInfo = table! { correlation_time in Channels, "τ",
    words: "correlation time",
    name: "correlation time",
    allowed: Allowed::AtLeast(0.0),
    hint: "A bias with this correlation time models coloured noise; 0: a constant bias",
    unit: Some("s"),
};

/// The standard deviations that the filter assumes of the sensors.
pub static SENSOR_STD: TableInfo = table! { sensor_std in Sensors, "√R",
    name: "sensor std",
    factor: Some("√R"),
    allowed: Allowed::Above(0.0),
    hint: "Standard deviation of the sensor's noise that the filter assumes",
};

/// The times by which the filter takes the sensors to be late.
pub static SENSOR_DELAY: TableInfo = table! { sensor_delay in Sensors, "delay",
    name: "sensor delay",
    allowed: Allowed::Within(-LATEST, LATEST),
    hint: "How late the readings are; negative if they are early",
    otherwise: Some(0.0),
    unit: Some("s"),
};

/// Limits the time by which a sensor is late \[s\].
const LATEST: f64 = 10.0;

/// All tables of a filter.
pub static TABLES: [&TableInfo; 6] =
    [&INITIAL_MEAN, &INITIAL_STD, &PROCESS_STD, &CORRELATION_TIME, &SENSOR_STD, &SENSOR_DELAY];

impl TableInfo {
    const fn new(key: &'static str, symbol: &'static str, column: SettingColumn) -> Self {
        Self {
            key,
            symbol,
            words: symbol,
            name: symbol,
            factor: None,
            allowed: Allowed::Finite,
            hint: "",
            column,
            otherwise: None,
            unit: None,
        }
    }

    /// The table with a key.
    pub fn from_key(key: &str) -> Option<&'static Self> {
        TABLES.into_iter().find(|table| table.key == key)
    }

    pub(crate) fn entry(
        key: &str,
        channel: &dyn Fn(&str) -> Option<Channel>,
        sensor: &dyn Fn(&str) -> Option<Quantity>,
    ) -> Option<(&'static Self, Entry)> {
        let (table, entry) = key.split_once('.')?;
        let table = Self::from_key(table)?;
        let entry = if table.is_of_sensors() { Entry::Sensor(sensor(entry)?) } else { Entry::Channel(channel(entry)?) };
        Some((table, entry))
    }

    /// The unit of an entry, empty for a pure number.
    pub fn unit_of(&self, entry: Entry) -> &'static str {
        self.unit.unwrap_or(entry.unit())
    }

    /// Whether the table has a number for each sensor, and not for each channel.
    pub fn is_of_sensors(&self) -> bool {
        matches!(self.column, SettingColumn::Sensors(..))
    }

    /// The number of an entry in a filter beside these sensors; `None` where the table has no such entry.
    pub fn get(&self, filter: &FilterSettings, entry: Entry, sensors: &[Sensor]) -> Option<f64> {
        match (&self.column, entry) {
            (SettingColumn::Channels(of, _), Entry::Channel(channel)) => Some(of(filter)[channel]),
            (SettingColumn::Sensors(of, _), Entry::Sensor(quantity)) => {
                let place = place(sensors, quantity)?;
                of(filter).get(place).copied().or(self.otherwise)
            }
            _ => None,
        }
    }

    /// The same, to be set.
    pub fn get_mut<'a>(&self, filter: &'a mut FilterSettings, entry: Entry, sensors: &[Sensor]) -> Option<&'a mut f64> {
        match (&self.column, entry) {
            (SettingColumn::Channels(_, of), Entry::Channel(channel)) => Some(&mut of(filter)[channel]),
            (SettingColumn::Sensors(_, of), Entry::Sensor(quantity)) => {
                let (place, list) = (place(sensors, quantity)?, of(filter));
                if let Some(otherwise) = self.otherwise.filter(|_| list.len() < sensors.len()) {
                    list.resize(sensors.len(), otherwise);
                }
                list.get_mut(place)
            }
            _ => None,
        }
    }

    /// The numbers of a filter that have been set, in their order.
    pub fn numbers(&self, filter: &FilterSettings) -> Vec<f64> {
        match self.column {
            SettingColumn::Channels(of, _) => of(filter).iter().map(|(_, number)| number).collect(),
            SettingColumn::Sensors(of, _) => of(filter).clone(),
        }
    }

    pub(crate) fn first_refused(&self, filter: &FilterSettings) -> Option<(String, f64)> {
        let is_refused = |value: f64| !self.allowed.admits(value);
        match self.column {
            SettingColumn::Channels(of, _) => {
                let (channel, value) = of(filter).iter().find(|&(_, value)| is_refused(value))?;
                Some((format!(".{}", channel.key()), value))
            }
            SettingColumn::Sensors(of, _) => {
                let place = of(filter).iter().position(|&number| is_refused(number))?;
                Some((format!("[{place}]"), of(filter)[place]))
            }
        }
    }

    /// The common factor of a filter's numbers over those of its base; NaN where they do not have one.
    pub(crate) fn factor_over(&self, base: &FilterSettings, filter: &FilterSettings) -> f64 {
        let (base, now) = (self.numbers(base), self.numbers(filter));
        let at = base.iter().position(|value| *value > 0.0);
        let Some(factor) = at.and_then(|at| Some(now.get(at)? / base[at])) else { return f64::NAN };
        let is_common = |(base, now): (&f64, &f64)| (now - factor * base).abs() <= 1e-9 * now.abs();
        if base.len() == now.len() && base.iter().zip(&now).all(is_common) { factor } else { f64::NAN }
    }

    pub(crate) fn scale(&self, base: &FilterSettings, filter: &mut FilterSettings, factor: f64) {
        match self.column {
            SettingColumn::Channels(of, of_mut) => {
                for (channel, std) in of(base).iter() {
                    of_mut(filter)[channel] = factor * std;
                }
            }
            SettingColumn::Sensors(of, of_mut) => *of_mut(filter) = mapped(of(base), &|number| factor * number),
        }
    }
}

by_key!(TableInfo);

impl Entry {
    fn of(self, channel: fn(Channel) -> &'static str, sensor: fn(Quantity) -> &'static str) -> &'static str {
        match self {
            Self::Channel(own) => channel(own),
            Self::Sensor(own) => sensor(own),
        }
    }

    /// The key in scenario files and addresses.
    pub fn key(self) -> &'static str {
        self.of(Channel::key, Quantity::key)
    }

    /// The symbol in formulas.
    pub fn symbol(self) -> &'static str {
        self.of(Channel::symbol, Quantity::symbol)
    }

    /// The name in running text.
    pub fn name(self) -> &'static str {
        self.of(Channel::name, Quantity::key)
    }

    /// The unit, empty for a pure number.
    pub fn unit(self) -> &'static str {
        self.of(Channel::unit, Quantity::unit)
    }
}

fn place(sensors: &[Sensor], quantity: Quantity) -> Option<usize> {
    sensors.iter().position(|sensor| sensor.measures == quantity)
}
