//! Cells of a line, and the numbers in them.

use serde::{Deserialize, Serialize};

/// The delimiter between the cells of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delimiter {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// A tab.
    Tab,
    /// Blanks and tabs, any number of them.
    Blanks,
}

impl Delimiter {
    /// Every delimiter.
    pub const ALL: [Self; 4] = [Self::Comma, Self::Semicolon, Self::Tab, Self::Blanks];

    /// Its name, in the plural.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Blanks => "blanks",
        }
    }

    /// The cells of a line, without the blanks and quotes around them.
    pub fn cells(self, line: &str) -> Cells<'_> {
        let line = if self == Self::Tab { line.trim_end_matches(['\r', '\n']) } else { line.trim() };
        Cells { delimiter: self, rest: Some(line) }
    }

    fn is(self, character: char) -> bool {
        match self {
            Self::Comma => character == ',',
            Self::Semicolon => character == ';',
            Self::Tab => character == '\t',
            Self::Blanks => character == ' ' || character == '\t',
        }
    }
}

/// Iterates over the cells of a line.
pub struct Cells<'a> {
    delimiter: Delimiter,
    rest: Option<&'a str>,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest?;
        let start = rest.trim_start_matches(' ');
        // Within quotes a delimiter is a part of the cell; a quote that nothing ends is a character like others.
        let quoted = start.strip_prefix('"').and_then(|inner| inner.split_once('"'));
        let (cell, after) = match quoted {
            Some((cell, after)) => (cell, after.find(|c| self.delimiter.is(c)).map(|end| &after[end..])),
            None => match rest.find(|c| self.delimiter.is(c)) {
                Some(end) => (&rest[..end], Some(&rest[end..])),
                None => (rest, None),
            },
        };
        self.rest = after.map(|after| match self.delimiter {
            Delimiter::Blanks => after.trim_start_matches([' ', '\t']),
            _ => &after[1..],
        });
        Some(cell.trim())
    }
}

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

impl Decimal {
    /// The number in a cell: NaN in an empty one and for `nan` and the like, `None` in one with other text. Times of day
    /// such as `13:05:00.25`, with or without a date, are in seconds.
    pub fn number(self, cell: &str) -> Option<f64> {
        if cell.is_empty() {
            return Some(f64::NAN);
        }
        let parsed = match self {
            Self::Point => cell.parse().ok(),
            Self::Comma if cell.contains('.') && cell.contains(',') => None,
            Self::Comma => cell.replace(',', ".").parse().ok(),
        };
        parsed.or_else(|| if is_missing(cell) { Some(f64::NAN) } else { clock(cell, self) })
    }
}

/// Words of programs for a missing value.
fn is_missing(cell: &str) -> bool {
    ["na", "n/a", "null", "none", "-", "--", "#n/a", "#nv", "?"].iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// A time of day, or a date with one, in seconds: `hh:mm:ss`, `yyyy-mm-dd hh:mm:ss`, both with a fraction.
fn clock(cell: &str, decimal: Decimal) -> Option<f64> {
    let cell = cell.trim_end_matches('Z');
    let (date, time) = match cell.split_once(['T', ' ']) {
        Some((date, time)) => (Some(date), time.trim()),
        None => (None, cell),
    };
    let (hours, rest) = time.split_once(':')?;
    let (minutes, seconds) = rest.split_once(':')?;
    let whole = |text: &str| text.parse::<u32>().ok().map(f64::from);
    let seconds: f64 = match decimal {
        Decimal::Point => seconds.parse().ok()?,
        Decimal::Comma => seconds.replace(',', ".").parse().ok()?,
    };
    let day = date.map_or(Some(0.0), days)?;
    Some(day * 86_400.0 + whole(hours)? * 3600.0 + whole(minutes)? * 60.0 + seconds)
}

/// Days since 1 January 1970.
///
/// Source: Hinnant (2013), chrono-Compatible Low-Level Date Algorithms.
fn days(date: &str) -> Option<f64> {
    let mut parts = date.split(['-', '/']).map(|part| part.parse::<i64>().ok());
    let (year, month, day) = (parts.next()??, parts.next()??, parts.next()??);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1..=9999).contains(&year) || parts.next().is_some() {
        return None;
    }
    let year = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let day_of_era = of_era * 365 + of_era / 4 - of_era / 100 + day_of_year;
    Some((era * 146_097 + day_of_era - 719_468) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(delimiter: Delimiter, line: &str) -> Vec<&str> {
        delimiter.cells(line).collect()
    }

    #[test]
    fn lines_are_split_at_their_delimiter() {
        assert_eq!(cells(Delimiter::Comma, "1, 2,3,\r\n"), ["1", "2", "3", ""]);
        assert_eq!(cells(Delimiter::Semicolon, "1,5;;2,5"), ["1,5", "", "2,5"]);
        assert_eq!(cells(Delimiter::Tab, "\t1\t2\n"), ["", "1", "2"]);
        assert_eq!(cells(Delimiter::Blanks, "  1.0   2.0\t3.0 \n"), ["1.0", "2.0", "3.0"]);
        assert_eq!(cells(Delimiter::Comma, "\"Angle, left\",\"1,5\" ,x"), ["Angle, left", "1,5", "x"]);
        assert_eq!(cells(Delimiter::Blanks, "\"two words\" b"), ["two words", "b"]);
        assert_eq!(cells(Delimiter::Comma, "5\" pipe,2"), ["5\" pipe", "2"]);
        assert_eq!(cells(Delimiter::Comma, "\"open,2"), ["\"open", "2"]);
        assert_eq!(cells(Delimiter::Comma, ""), [""]);
    }

    #[test]
    fn numbers_are_read_with_their_decimal_character() {
        assert_eq!(Decimal::Point.number("-1.5e-3"), Some(-1.5e-3));
        assert_eq!(Decimal::Comma.number("-1,5E3"), Some(-1500.0));
        assert_eq!(Decimal::Comma.number("7"), Some(7.0));
        assert_eq!(Decimal::Point.number("1,5"), None);
        assert_eq!(Decimal::Comma.number("1.234,5"), None);
        assert_eq!(Decimal::Point.number("oops"), None);
        for missing in ["", "nan", "NaN", "N/A", "-"] {
            assert!(Decimal::Point.number(missing).unwrap().is_nan(), "{missing}");
        }
    }

    #[test]
    fn times_of_day_are_seconds() {
        assert_eq!(Decimal::Point.number("01:02:03.5"), Some(3723.5));
        assert_eq!(Decimal::Comma.number("00:00:01,25"), Some(1.25));
        let first = Decimal::Point.number("2024-02-28 23:59:59").unwrap();
        let next = Decimal::Point.number("2024-03-01T00:00:00Z").unwrap();
        assert_eq!(next - first, 86_401.0, "2024 is a leap year");
        assert_eq!(Decimal::Point.number("1970-01-02 00:00:00"), Some(86_400.0));
        assert_eq!(Decimal::Point.number("12:30"), None);
        assert_eq!(Decimal::Point.number("2024-13-01 00:00:00"), None);
    }
}
