//! The row of a setting.

use std::fmt;

use super::Allowed;
use crate::PlantKind;

/// A number, or a yes or no, of a `T`: a scenario or the settings of a filter.
#[non_exhaustive]
pub struct SettingInfo<T> {
    /// The key in scenario files and addresses.
    pub key: &'static str,
    /// The symbol in formulas; empty where it has none.
    pub symbol: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// The text beside its control, where it is not the name.
    pub label: fn(&T) -> Option<&'static str>,
    /// The unit, empty for a pure number.
    pub unit: &'static str,
    /// The values that it may have.
    pub allowed: Allowed,
    /// A remark on the allowed values, for those who have set another one; empty for none.
    pub note: &'static str,
    /// Limits of a slider.
    pub slider: (f64, f64),
    /// Whether the slider is logarithmic.
    pub is_logarithmic: bool,
    /// An explanation in one sentence.
    pub hint: &'static str,
    /// Whether it has an effect in a `T`, beside a truth of this kind.
    pub serves: fn(&T, PlantKind) -> bool,
    /// Whether menus of maps and searches offer it.
    pub is_varied: bool,
    /// Reads it: 1 for yes, 0 for no, NaN where there is none.
    pub get: fn(&T) -> f64,
    /// Sets it. A number without fractions is rounded.
    pub set: fn(&mut T, f64),
}

impl<T> SettingInfo<T> {
    /// A setting without words that always has an effect.
    pub(super) const fn new(key: &'static str, get: fn(&T) -> f64, set: fn(&mut T, f64)) -> Self {
        Self {
            key,
            symbol: "",
            name: "",
            label: |_| None,
            unit: "",
            allowed: Allowed::Finite,
            note: "",
            slider: (0.0, 1.0),
            is_logarithmic: false,
            hint: "",
            serves: |_, _| true,
            is_varied: false,
            get,
            set,
        }
    }
}

impl<T> PartialEq for SettingInfo<T> {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl<T> fmt::Debug for SettingInfo<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key)
    }
}

/// A field that is read and set as a number.
pub(super) trait Field {
    fn number(&self) -> f64;
    fn put(&mut self, value: f64);
}

macro_rules! field {
    ($($kind:ty: $number:expr),*) => {
        $(impl Field for $kind {
            fn number(&self) -> f64 {
                let number: fn($kind) -> f64 = $number;
                number(*self)
            }

            fn put(&mut self, value: f64) {
                *self = libm::round(value) as $kind;
            }
        })*
    };
}
field!(u64: |whole| whole as f64, usize: |whole| whole as f64, i32: f64::from);

impl Field for f64 {
    fn number(&self) -> f64 {
        *self
    }

    fn put(&mut self, value: f64) {
        *self = value;
    }
}

impl Field for bool {
    fn number(&self) -> f64 {
        f64::from(u8::from(*self))
    }

    fn put(&mut self, value: f64) {
        *self = value != 0.0;
    }
}

/// A row of a field, with its key and other data.
macro_rules! row {
    ($key:literal, $($field:ident).+, $($data:tt)*) => {
        SettingInfo {
            $($data)*
            ..SettingInfo::new(
                $key,
                |of| Field::number(&of.$($field).+),
                |of, value| Field::put(&mut of.$($field).+, value),
            )
        }
    };
}
pub(super) use row;
