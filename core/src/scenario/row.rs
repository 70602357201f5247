//! The row of a setting, and the values that it may have.

use std::fmt;

use crate::PlantKind;

/// A number, or a yes or no, of a `T`: a scenario or the settings of a filter.
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
    pub serves: fn(&T, &PlantKind) -> bool,
    /// Whether menus of maps and searches offer it.
    pub is_varied: bool,
    /// Reads it: 1 for yes, 0 for no, NaN where there is none.
    pub get: fn(&T) -> f64,
    /// Sets it. A number without fractions is rounded.
    pub set: fn(&mut T, f64),
}

impl<T> SettingInfo<T> {
    pub(crate) const fn new(key: &'static str, get: fn(&T) -> f64, set: fn(&mut T, f64)) -> Self {
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

macro_rules! by_key {
    ($row:ident $(, $T:ident)?) => {
        impl$(<$T>)? PartialEq for $row$(<$T>)? {
            fn eq(&self, other: &Self) -> bool {
                self.key == other.key
            }
        }

        impl$(<$T>)? std::fmt::Debug for $row$(<$T>)? {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.key)
            }
        }
    };
}
by_key!(SettingInfo, T);

pub(crate) trait Field {
    fn number(own: Self) -> f64;
    fn from_number(number: f64) -> Self;
}

macro_rules! field {
    ($($kind:ty: $own:ident => $to:expr, $number:ident => $from:expr;)*) => {
        $(impl Field for $kind {
            fn number($own: Self) -> f64 {
                $to
            }

            fn from_number($number: f64) -> Self {
                $from
            }
        })*
    };
}
field! {
    f64: own => own, number => number;
    bool: flag => f64::from(u8::from(flag)), number => number != 0.0;
    i32: whole => f64::from(whole), number => libm::round(number) as i32;
    u64: whole => whole as f64, number => libm::round(number) as u64;
    usize: whole => whole as f64, number => libm::round(number) as usize;
}

macro_rules! row {
    ($($field:ident).+, $name:literal, $($data:tt)*) => {
        SettingInfo {
            name: $name,
            $($data)*
            ..SettingInfo::new(
                stringify!($($field).+),
                |of| Field::number(of.$($field).+),
                |of, value| of.$($field).+ = Field::from_number(value),
            )
        }
    };
}

/// Declares settings: each field with its default, and behind it the rows of the numbers that it has.
macro_rules! settings {
    (
        $(#[$of:meta])*
        pub struct $T:ident {
            $(
                $(#[$attribute:meta])*
                pub $field:ident: $kind:ty = $default:expr;
                $($row:ident: $($path:ident).+, $name:literal { $($data:tt)* })*
            )*
        }
    ) => {
        $(#[$of])*
        pub struct $T {
            $(
                $(#[$attribute])*
                pub $field: $kind,
            )*
        }

        impl Default for $T {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        $($(
            #[doc = concat!("The ", $name, ".")]
            #[allow(unreachable_pub, reason = "most rows are named by no one")]
            pub static $row: SettingInfo<$T> = row! { $($path).+, $name, $($data)* };
        )*)*

        pub(crate) static ROWS: &[&SettingInfo<$T>] = &[$($(&$row,)*)*];
    };
}

pub(crate) use by_key;
pub(crate) use {row, settings};

/// The values that a setting may have. Its text ends the sentence that begins with "but must be".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// Any finite number.
    Finite,
    /// A finite number above this one.
    Above(f64),
    /// A finite number that is not below this one.
    AtLeast(f64),
    /// A number between these two.
    Between(f64, f64),
    /// A number from the first to the last.
    Within(f64, f64),
    /// A number without fractions, from the first to the last.
    Whole(i64, i64),
    /// Yes or no: 1 or 0.
    Flag,
}

impl Allowed {
    /// Whether a value is allowed.
    pub fn admits(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::Above(limit) => value > limit,
                Self::AtLeast(limit) => value >= limit,
                Self::Between(low, high) => value > low && value < high,
                Self::Within(low, high) => value >= low && value <= high,
                Self::Whole(first, last) => value >= first as f64 && value <= last as f64,
                Self::Flag => value == 0.0 || value == 1.0,
            }
    }

    /// Limits the values that are typed from below.
    pub fn least(self) -> f64 {
        match self {
            Self::Finite => f64::NEG_INFINITY,
            Self::AtLeast(limit) | Self::Within(limit, _) => limit,
            Self::Above(limit) | Self::Between(limit, _) => limit + 1e-9,
            Self::Whole(first, _) => first as f64,
            Self::Flag => 0.0,
        }
    }

    /// Whether the values have no fractions.
    pub fn is_whole(self) -> bool {
        matches!(self, Self::Whole(..) | Self::Flag)
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finite => f.write_str("a finite number"),
            Self::Above(limit) => write!(f, "a finite number above {limit}"),
            Self::AtLeast(limit) => write!(f, "a finite number, at least {limit}"),
            Self::Between(low, high) => write!(f, "between {low} and {high}"),
            Self::Within(first, last) => write!(f, "from {first} to {last}"),
            Self::Whole(first, last) => write!(f, "from {first} to {last}"),
            Self::Flag => f.write_str("true or false"),
        }
    }
}
