//! The limits of a measured value.

use crate::value::{Expected, Value};

/// The limits of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits<'a> {
    pub(crate) above: Option<f64>,
    pub(crate) below: Option<f64>,
    pub(crate) is: Option<&'a Expected>,
}

impl Limits<'_> {
    /// Whether a value keeps within the limits.
    pub(crate) fn hold(self, value: &Value) -> bool {
        match (value, self.is) {
            (Value::Number(value), _) => {
                !value.is_nan()
                    && self.above.is_none_or(|limit| *value > limit)
                    && self.below.is_none_or(|limit| *value < limit)
            }
            (Value::Flag(value), Some(Expected::Flag(expected))) => value == expected,
            (Value::Words(words), Some(Expected::Word(expected))) => words.contains(&expected.as_str()),
            (Value::Words(words), Some(Expected::OneOf(all))) => all.iter().any(|one| words.contains(&one.as_str())),
            _ => false,
        }
    }
}
