//! The cells of a line: numbers, times of day, and words of instruments.

use super::header::{Dimension, unit};
use crate::mapping::{Decimal, Delimiter};

impl Delimiter {
    pub(super) const fn name(self) -> &'static str {
        ["commas", "semicolons", "tabs", "blanks"][self as usize]
    }

    /// The cells of a line, without the blanks and quotes around them.
    pub fn cells(self, line: &str) -> impl Iterator<Item = &str> {
        let mut line = Some(if self == Self::Tab { line.trim_end_matches(['\r', '\n']) } else { line.trim() });
        std::iter::from_fn(move || {
            let rest = line?;
            let start = rest.trim_start_matches(' ');
            // Within quotes a delimiter is a part of the cell; a quote without an end is an ordinary character.
            let quoted = start.strip_prefix('"').and_then(|inner| inner.split_once('"'));
            let (cell, after) = match quoted {
                Some((cell, after)) => (cell, after.find(|c| self.is(c)).map(|end| &after[end..])),
                None => match rest.find(|c| self.is(c)) {
                    Some(end) => (&rest[..end], Some(&rest[end..])),
                    None => (rest, None),
                },
            };
            line = after.map(|after| match self {
                Self::Blanks => after.trim_start_matches([' ', '\t']),
                _ => &after[1..],
            });
            Some(cell.trim())
        })
    }

    fn is(self, character: char) -> bool {
        [",", ";", "\t", " \t"][self as usize].contains(character)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Content {
    Number(f64),
    /// Has one reading, such as `1.234,5`.
    Grouped(f64),
    /// \[s\], and whether there is a date: since midnight, or with one since 1970.
    Clock(f64, bool),
    Missing,
    Word,
    Text,
}

impl Content {
    pub(super) fn value(self) -> f64 {
        match self {
            Self::Number(value) | Self::Grouped(value) | Self::Clock(value, _) => value,
            Self::Missing | Self::Word | Self::Text => f64::NAN,
        }
    }
}

impl Decimal {
    /// The number in a cell, or the seconds of a time of day; NaN in an empty one and for `nan`, `OVLD` and the like; `None` for other text.
    pub fn number(self, cell: &str) -> Option<f64> {
        let found = self.read(cell, false);
        (found != Content::Text).then(|| found.value())
    }

    /// With `thousands` the separator in `1.234` is one of thousands.
    pub(super) fn read(self, cell: &str, thousands: bool) -> Content {
        if cell.is_empty() {
            return Content::Missing;
        }
        if let Some(digits) = cell.strip_prefix(['+', '-']).filter(|digits| digits.starts_with(' ')) {
            return self.read(&format!("{}{}", &cell[..1], digits.trim_start()), thousands);
        }
        let plain = match self {
            Self::Point => cell.parse().ok(),
            Self::Comma if cell.contains('.') && (thousands || cell.contains(',')) => None,
            Self::Comma => cell.replace(',', ".").parse().ok(),
        };
        match plain {
            // A number that is too large has digits.
            Some(value) if f64::is_infinite(value) && !cell.contains(|c: char| c.is_ascii_digit()) => Content::Word,
            Some(value) => Content::Number(value),
            None => self.unusual(cell, thousands),
        }
    }

    fn unusual(self, cell: &str, thousands: bool) -> Content {
        if let Some((text, is_sure)) = self.ungrouped(cell)
            && (is_sure || thousands)
            && let Ok(value) = text.parse()
        {
            return Content::Grouped(value);
        }
        match self.fortran(cell) {
            Some(value) => Content::Number(value),
            None if is_missing(cell) => Content::Missing,
            None if is_word(cell) => Content::Word,
            None if let Some((seconds, is_dated)) = clock(cell) => Content::Clock(seconds, is_dated),
            None => self.duration(cell).map_or(Content::Text, Content::Number),
        }
    }

    /// Returns the number in Rust's form, and whether this is its only reading.
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

    fn duration(self, cell: &str) -> Option<f64> {
        if let Some(cell) = cell.strip_prefix("PT").and_then(|rest| rest.strip_suffix('S')) {
            let (minutes, seconds) = cell.split_once('M').unwrap_or(("0", cell));
            return Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?);
        }
        let number = cell.trim_end_matches(char::is_alphabetic);
        let Some((Dimension::Time, size)) = unit(&cell[number.len()..]) else { return None };
        let Content::Number(value) = self.read(number.trim_end(), false) else { return None };
        Some(size * value)
    }

    fn fortran(self, cell: &str) -> Option<f64> {
        let begins = cell.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c));
        let (mantissa, exponent) = cell.split_once(['d', 'D']).filter(|_| begins)?;
        let mantissa = if self == Self::Comma { mantissa.replace(',', ".") } else { mantissa.to_owned() };
        format!("{mantissa}e{exponent}").parse().ok()
    }
}

fn is_missing(cell: &str) -> bool {
    "na n/a null none nil missing - -- #n/a #nv ?".split(' ').any(|word| cell.eq_ignore_ascii_case(word))
}

fn is_word(cell: &str) -> bool {
    const WORDS: &str =
        "∞ ovld ovl ovrld ovr ovrng overload overflow overrange over ol o.l o/l under error err inval invalid bad";
    const PARTS: [&str; 6] = ["#ind", "#qnan", "#snan", "#inf", "#div/0", "#num"];
    let is_line = |mark: char| cell.chars().all(|c| c == mark);
    let lower = cell.to_ascii_lowercase();
    let bare = lower.trim_start_matches(['-', '+']);
    WORDS.split(' ').any(|word| word == bare)
        || PARTS.iter().any(|part| bare.contains(part))
        || ["#value!", "#wert!"].contains(&bare)
        || (cell.len() > 2 && (is_line('-') || is_line('*')))
}

/// Seconds, and whether there is a date: `hh:mm:ss.f`, `mm:ss.f`, `AM`, `PM`, `+01:00`, `Z`; `2024-05-01`, `20240501T080000`,
/// `01.05.2024`, `01-May-2024`; with slashes the month comes first if it can be one (`05/01/2024`).
pub(super) fn clock(cell: &str) -> Option<(f64, bool)> {
    // As pandas writes it: `0 days 00:00:01.5`.
    if let Some((days, (time, false))) = cell.split_once(" days ").and_then(|(days, rest)| Some((days, clock(rest)?))) {
        return Some((days.parse::<f64>().ok()? * 86_400.0 + time, false));
    }
    let (date, time) = match cell.split_once(['T', ' ']) {
        Some((date, time)) if !date.contains(':') => (Some(date), time.trim()),
        _ => (None, cell),
    };
    let (time, half) = half_of_day(time);
    let (time, zone) = zone(time)?;
    let time = time.trim();
    let [hours, minutes, seconds] = match *time.splitn(3, ':').collect::<Vec<&str>>() {
        [hours, minutes, seconds] => [hours, minutes, seconds],
        [minutes, seconds] if date.is_none() && seconds.find(['.', ',']) == Some(2) => ["0", minutes, seconds],
        [_] if date.is_some() => [time.get(..2)?, time.get(2..4)?, time.get(4..)?],
        _ => return None,
    };
    let whole = |text: &str, most: u32| text.parse::<u32>().ok().filter(|number| *number <= most).map(f64::from);
    let (hours, minutes) = (whole(hours, 24)?, whole(minutes, 59)?);
    let seconds: f64 = seconds.replace([',', ':'], ".").parse().ok().filter(|seconds| (0.0..61.0).contains(seconds))?;
    let hours = match half {
        None => hours,
        Some(_) if !(1.0..=12.0).contains(&hours) => return None,
        Some(shift) => hours % 12.0 + shift,
    };
    let day = date.map_or(Some(0.0), days)?;
    Some((day * 86_400.0 + hours * 3600.0 + minutes * 60.0 + seconds - zone, date.is_some()))
}

fn half_of_day(time: &str) -> (&str, Option<f64>) {
    match time.len().checked_sub(2).and_then(|place| time.split_at_checked(place)) {
        Some((rest, word)) if word.eq_ignore_ascii_case("am") => (rest, Some(0.0)),
        Some((rest, word)) if word.eq_ignore_ascii_case("pm") => (rest, Some(12.0)),
        _ => (time, None),
    }
}

fn zone(time: &str) -> Option<(&str, f64)> {
    if let Some(rest) = ["Z", "UTC", "GMT"].iter().find_map(|word| time.strip_suffix(word)) {
        return Some((rest, 0.0));
    }
    let Some(place) = time.find(['+', '-']) else { return Some((time, 0.0)) };
    let (rest, zone) = time.split_at(place);
    let digits: String = zone[1..].chars().filter(|&c| c != ':').collect();
    let (hours, minutes) = digits.split_at_checked(2)?;
    let minutes: f64 = if minutes.is_empty() { 0.0 } else { minutes.parse::<u32>().ok().map(f64::from)? };
    let ahead = f64::from(hours.parse::<u32>().ok()?) * 3600.0 + minutes * 60.0;
    Some((rest, if zone.starts_with('-') { -ahead } else { ahead }))
}

/// Days since 1 January 1970. Source: Hinnant (2013), chrono-Compatible Low-Level Date Algorithms.
fn days(date: &str) -> Option<f64> {
    const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    let [first, second, third] = match *date.split(['-', '/', '.']).collect::<Vec<&str>>() {
        [first, second, third] => [first, second, third],
        [date] if date.len() == 8 => [date.get(..4)?, date.get(4..6)?, date.get(6..)?],
        _ => return None,
    };
    let number = |text: &str| text.parse::<i64>().ok().filter(|number| *number >= 0);
    let named = MONTHS.iter().position(|month| second.eq_ignore_ascii_case(month)).map(|place| place as i64 + 1);
    let (year, month, day) = if first.len() == 4 {
        (number(first)?, number(second)?, number(third)?)
    } else {
        let year = number(third)? + if third.len() == 2 { 2000 } else { 0 };
        let (first, second) = (number(first)?, named.or_else(|| number(second))?);
        let is_month_first = date.contains('/') && first <= 12;
        if is_month_first { (year, first, second) } else { (year, second, first) }
    };
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1..=9999).contains(&year) {
        return None;
    }
    let year = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let day_of_era = of_era * 365 + of_era / 4 - of_era / 100 + day_of_year;
    Some((era * 146_097 + day_of_era - 719_468) as f64)
}
