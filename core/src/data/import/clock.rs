//! Times of day and dates in cells.

/// A time of day, or a date with one, in seconds, and whether there is a date: `hh:mm:ss` with a fraction, `AM` or `PM`
/// and a zone such as `+01:00` or `Z`, behind a date with the year first (`2024-05-01`), the day first (`01.05.2024`,
/// `01-May-2024`) or, with slashes, the month first if it can be one (`05/01/2024`).
pub(super) fn clock(cell: &str) -> Option<(f64, bool)> {
    let (date, time) = match cell.split_once(['T', ' ']) {
        Some((date, time)) if !date.contains(':') => (Some(date), time.trim()),
        _ => (None, cell),
    };
    let (time, half) = half_of_day(time);
    let (time, zone) = zone(time)?;
    let mut parts = time.trim().splitn(3, ':');
    let mut whole = |most: u32| parts.next()?.parse::<u32>().ok().filter(|number| *number <= most).map(f64::from);
    let (hours, minutes) = (whole(24)?, whole(59)?);
    let seconds: f64 = parts.next()?.replace(',', ".").parse().ok().filter(|seconds| (0.0..61.0).contains(seconds))?;
    let hours = match half {
        None => hours,
        Some(_) if !(1.0..=12.0).contains(&hours) => return None,
        Some(shift) => hours % 12.0 + shift,
    };
    let day = date.map_or(Some(0.0), days)?;
    Some((day * 86_400.0 + hours * 3600.0 + minutes * 60.0 + seconds - zone, date.is_some()))
}

/// A time without `AM` or `PM`, and the hours that this adds.
fn half_of_day(time: &str) -> (&str, Option<f64>) {
    let end = time.len().checked_sub(2).and_then(|place| time.split_at_checked(place));
    match end {
        Some((rest, word)) if word.eq_ignore_ascii_case("am") => (rest, Some(0.0)),
        Some((rest, word)) if word.eq_ignore_ascii_case("pm") => (rest, Some(12.0)),
        _ => (time, None),
    }
}

/// A time without its zone, and the zone's seconds ahead of Greenwich. `None` if it has no zone.
fn zone(time: &str) -> Option<(&str, f64)> {
    for word in ["Z", "UTC", "GMT"] {
        if let Some(rest) = time.strip_suffix(word) {
            return Some((rest, 0.0));
        }
    }
    let Some(place) = time.find(['+', '-']) else { return Some((time, 0.0)) };
    let (rest, zone) = time.split_at(place);
    let digits: String = zone[1..].chars().filter(|&c| c != ':').collect();
    let (hours, minutes) = digits.split_at_checked(2)?;
    let minutes: f64 = if minutes.is_empty() { 0.0 } else { minutes.parse::<u32>().ok().map(f64::from)? };
    let ahead = f64::from(hours.parse::<u32>().ok()?) * 3600.0 + minutes * 60.0;
    Some((rest, if zone.starts_with('-') { -ahead } else { ahead }))
}

/// Days since 1 January 1970.
///
/// Source: Hinnant (2013), chrono-Compatible Low-Level Date Algorithms.
fn days(date: &str) -> Option<f64> {
    const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    let parts: Vec<&str> = date.split(['-', '/', '.']).collect();
    let [first, second, third] = *parts.as_slice() else { return None };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(cell: &str) -> Option<f64> {
        clock(cell).map(|(seconds, _)| seconds)
    }

    #[test]
    fn times_of_day_are_seconds() {
        assert_eq!(clock("01:02:03.5"), Some((3723.5, false)));
        assert_eq!(clock("00:00:01,25"), Some((1.25, false)));
        let first = seconds("2024-02-28 23:59:59").unwrap();
        assert_eq!(seconds("2024-03-01T00:00:00Z").unwrap() - first, 86_401.0, "2024 is a leap year");
        assert_eq!(clock("1970-01-02 00:00:00"), Some((86_400.0, true)));
        for none in
            ["12:30", "2024-13-01 00:00:00", "12:61:00", "1:2", "::", "a:b:c", "2024-05 12:00:00", "12:00:00 XM"]
        {
            assert_eq!(clock(none), None, "{none}");
        }
    }

    #[test]
    fn zones_and_halves_of_the_day_are_known() {
        let noon = seconds("2024-05-01T12:00:00Z");
        for same in [
            "2024-05-01T12:00:00+00:00",
            "2024-05-01 14:00:00+02:00",
            "2024-05-01T08:30:00-0330",
            "2024-05-01 12:00:00 UTC",
        ] {
            assert_eq!(seconds(same), noon, "{same}");
        }
        assert_eq!(seconds("12:00:01.5 AM"), Some(1.5));
        assert_eq!(seconds("12:00:01.5 pm"), Some(43_201.5));
        assert_eq!(seconds("1:00:00 PM"), Some(46_800.0));
        assert_eq!(seconds("13:00:00 PM"), None);
    }

    #[test]
    fn dates_have_the_year_the_day_or_the_month_first() {
        let day = seconds("2024-05-01 00:00:00");
        let same = [
            "01.05.2024 00:00:00",
            "1-May-2024 00:00:00",
            "05/01/2024 00:00:00",
            "2024/05/01 00:00:00",
            "01.05.24 00:00:00",
        ];
        for same in same {
            assert_eq!(seconds(same), day, "{same}");
        }
        assert_eq!(seconds("31/12/2024 00:00:00"), seconds("2024-12-31 00:00:00"), "no month is the 31st");
    }
}
