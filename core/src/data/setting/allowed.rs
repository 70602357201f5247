//! The values that a setting may have.

use std::fmt;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_kept_and_said() {
        for (allowed, inside, outside, words) in [
            (Allowed::Finite, -1e300, f64::INFINITY, "a finite number"),
            (Allowed::Above(0.0), 1e-300, 0.0, "a finite number above 0"),
            (Allowed::AtLeast(1.0), 1.0, 0.999, "a finite number, at least 1"),
            (Allowed::Between(0.0, 1.0), 0.5, 1.0, "between 0 and 1"),
            (Allowed::Within(0.0, 1.0), 1.0, 1.001, "from 0 to 1"),
            (Allowed::Whole(2, 9), 9.0, 10.0, "from 2 to 9"),
            (Allowed::Flag, 1.0, 2.0, "true or false"),
        ] {
            assert!(allowed.admits(inside) && !allowed.admits(outside) && !allowed.admits(f64::NAN), "{allowed:?}");
            assert_eq!(allowed.to_string(), words);
            assert!(allowed == Allowed::Finite || allowed.admits(allowed.least()), "{allowed:?}");
        }
    }
}
