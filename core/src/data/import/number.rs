//! The numbers in cells.

use serde::{Deserialize, Serialize};

use super::clock::clock;

/// The character between the whole part of a number and its fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decimal {
    /// `1.5`
    #[default]
    Point,
    /// `1,5`
    Comma,
}

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Found {
    /// A number.
    Number(f64),
    /// A number with thousands separators that has one reading only, such as `1.234,5`.
    Grouped(f64),
    /// A time \[s\]: since midnight, or with a date since 1970.
    Clock {
        /// The time.
        seconds: f64,
        /// Whether it has a date.
        is_dated: bool,
    },
    /// Nothing, or NaN and the like.
    Missing,
    /// A word by which an instrument says that it has no reading, such as `OVLD`.
    Word,
    /// Other text.
    Text,
}

impl Found {
    /// The value in a column: NaN where there is none.
    pub(super) fn value(self) -> f64 {
        match self {
            Self::Number(value) | Self::Grouped(value) | Self::Clock { seconds: value, .. } => value,
            Self::Missing | Self::Word | Self::Text => f64::NAN,
        }
    }
}

impl Decimal {
    /// The number in a cell: NaN in an empty one and for `nan`, `OVLD` and the like, `None` in one with other text.
    /// Thousands may be separated, as in `1.234,5`, and the exponent may be Fortran's, as in `1.5D-3`. Times of day
    /// such as `13:05:00.25`, with or without a date, are in seconds.
    pub fn number(self, cell: &str) -> Option<f64> {
        let found = self.read(cell, false);
        (found != Found::Text).then(|| found.value())
    }

    /// The content of a cell. With `thousands` a separator such as that in `1.234` is one of thousands.
    pub(super) fn read(self, cell: &str, thousands: bool) -> Found {
        if cell.is_empty() {
            return Found::Missing;
        }
        let plain = match self {
            Self::Point => cell.parse().ok(),
            Self::Comma if cell.contains('.') && (thousands || cell.contains(',')) => None,
            Self::Comma => cell.replace(',', ".").parse().ok(),
        };
        match plain {
            Some(value) => Found::Number(value),
            None => self.unusual(cell, thousands),
        }
    }

    fn unusual(self, cell: &str, thousands: bool) -> Found {
        if let Some((text, is_sure)) = self.ungrouped(cell)
            && (is_sure || thousands)
            && let Ok(value) = text.parse()
        {
            return Found::Grouped(value);
        }
        if let Some(value) = self.fortran(cell) {
            return Found::Number(value);
        }
        if is_missing(cell) {
            return Found::Missing;
        }
        if is_word(cell) {
            return Found::Word;
        }
        match clock(cell) {
            Some((seconds, is_dated)) => Found::Clock { seconds, is_dated },
            None => Found::Text,
        }
    }

    /// A number with thousands separators, in groups of three digits, as Rust writes it; and whether this is its only
    /// reading.
    fn ungrouped(self, cell: &str) -> Option<(String, bool)> {
        let (point, other) = match self {
            Self::Point => ('.', ','),
            Self::Comma => (',', '.'),
        };
        let unsigned = cell.trim_start_matches(['-', '+']);
        let (whole, fraction) = unsigned.split_once(point).unwrap_or((unsigned, ""));
        let is_group = |c: char| c == other || "'’ \u{A0}\u{2009}\u{202F}".contains(c);
        let separator = whole.chars().find(|&c| is_group(c))?;
        let mut groups = whole.split(separator);
        let first = groups.next()?;
        let is_number = |text: &str, most: usize| {
            (1..=most).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit())
        };
        let rest: Vec<&str> = groups.collect();
        let fits = is_number(first, 3)
            && !first.starts_with('0')
            && rest.iter().all(|group| is_number(group, 3) && group.len() == 3);
        if !fits || cell.len() - unsigned.len() > 1 {
            return None;
        }
        let sign = if cell.starts_with('-') { "-" } else { "" };
        let is_sure = unsigned.contains(point) || rest.len() > 1 || separator != other;
        let dot = if fraction.is_empty() { "" } else { "." };
        Some((format!("{sign}{first}{}{dot}{fraction}", rest.concat()), is_sure))
    }

    /// A number with Fortran's exponent of double precision.
    fn fortran(self, cell: &str) -> Option<f64> {
        let begins = cell.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c));
        let (mantissa, exponent) = cell.split_once(['d', 'D']).filter(|_| begins)?;
        let mantissa = if self == Self::Comma { mantissa.replace(',', ".") } else { mantissa.to_owned() };
        format!("{mantissa}e{exponent}").parse().ok()
    }
}

/// Words of programs for a missing value.
fn is_missing(cell: &str) -> bool {
    ["na", "n/a", "null", "none", "-", "--", "#n/a", "#nv", "?"].iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// Words of instruments and programs for a reading that failed: overload, an error, a number that does not fit its place.
fn is_word(cell: &str) -> bool {
    const WORDS: [&str; 18] = [
        "ovld",
        "ovl",
        "ovrld",
        "ovr",
        "ovrng",
        "overload",
        "overflow",
        "overrange",
        "over",
        "ol",
        "o.l",
        "o/l",
        "under",
        "error",
        "err",
        "inval",
        "invalid",
        "bad",
    ];
    // Of Windows and of spreadsheets.
    const PARTS: [&str; 6] = ["#ind", "#qnan", "#snan", "#inf", "#div/0", "#num"];
    let is_line = |mark: char| cell.chars().all(|c| c == mark);
    let lower = cell.to_ascii_lowercase();
    let bare = lower.trim_start_matches(['-', '+']);
    WORDS.contains(&bare)
        || PARTS.iter().any(|part| bare.contains(part))
        || ["#value!", "#wert!"].contains(&bare)
        || (cell.len() > 2 && (is_line('-') || is_line('*')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_with_their_decimal_character() {
        assert_eq!(Decimal::Point.number("-1.5e-3"), Some(-1.5e-3));
        assert_eq!(Decimal::Comma.number("-1,5E3"), Some(-1500.0));
        assert_eq!(Decimal::Comma.number("7"), Some(7.0));
        assert_eq!(Decimal::Point.number("1,5"), None);
        assert_eq!(Decimal::Point.number("oops"), None);
        for missing in ["", "nan", "NaN", "N/A", "-"] {
            assert!(Decimal::Point.number(missing).unwrap().is_nan(), "{missing}");
        }
    }

    #[test]
    fn thousands_may_be_apart_where_they_can_be_nothing_else() {
        use Decimal::{Comma, Point};
        assert_eq!(Comma.number("1.234,5"), Some(1234.5));
        assert_eq!(Comma.number("-12.345.678,25"), Some(-12_345_678.25));
        assert_eq!(Point.number("1,234.5"), Some(1234.5));
        assert_eq!(Point.number("+1,234,567"), Some(1_234_567.0));
        assert_eq!(Point.number("1'234.5"), Some(1234.5));
        assert_eq!(Comma.number("1\u{A0}234,5"), Some(1234.5));
        for text in ["1,23.4", "1,234,56", "0,123.5", "1.2,3.4", "12,3456.7", ",234.5", "--1,234.5"] {
            assert_eq!(Point.number(text), None, "{text}");
        }
        assert_eq!(Point.number("1,234"), None, "a decimal comma, or thousands");
        assert_eq!((Comma.number("1.234"), Comma.read("1.234", true)), (Some(1.234), Found::Grouped(1234.0)));
        assert_eq!(Point.read("1,234", true), Found::Grouped(1234.0));
    }

    #[test]
    fn exponents_may_be_those_of_fortran() {
        assert_eq!(Decimal::Point.number("-1.5D+02"), Some(-150.0));
        assert_eq!(Decimal::Point.number(".25d-1"), Some(0.025));
        assert_eq!(Decimal::Comma.number("1,5D3"), Some(1500.0));
        assert_eq!([Decimal::Point.number("D3"), Decimal::Point.number("3rd"), Decimal::Point.number("2d")], [None; 3]);
    }

    #[test]
    fn words_of_instruments_are_missing_readings() {
        for word in
            ["-1.#IND", "1.#QNAN00", "1.#INF", "OVLD", "-OL", "Overflow", "#DIV/0!", "#VALUE!", "---", "********"]
        {
            assert_eq!(Decimal::Point.read(word, false), Found::Word, "{word}");
        }
        assert_eq!(Decimal::Point.read("cold", false), Found::Text);
    }
}
