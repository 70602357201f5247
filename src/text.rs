//! Numbers for people to read.

use std::f64::consts::TAU;

use kalmanscope_core::Length;
use kalmanscope_core::{Channel, Scenario};

/// A number with `digits` significant digits, in fixed-point notation where that is short, else with an exponent.
pub fn significant(x: f64, digits: usize) -> String {
    kalmanscope_cli::significant(x, digits, 6).replace('-', "−")
}

/// A count with a comma between its thousands.
pub(crate) fn grouped(count: usize) -> String {
    let (millions, thousands, rest) = (count / 1_000_000, count / 1000 % 1000, count % 1000);
    match count {
        0..10_000 => count.to_string(),
        10_000..1_000_000 => format!("{thousands},{rest:03}"),
        _ => format!("{millions},{thousands:03},{rest:03}"),
    }
}

pub fn fixed(x: f64, decimals: usize) -> String {
    if x.is_finite() && x.abs() < 1e6 { format!("{x:.decimals$}").replace('-', "−") } else { significant(x, 3) }
}

/// An angular frequency \[rad/s\] in hertz. `None` for another unit.
pub fn in_hertz(x: f64, unit: &str) -> Option<String> {
    (unit == "rad/s").then(|| format!("{} Hz", significant(x / TAU, 4)))
}

/// An error of an angular frequency \[rad/s\] in hertz, for one with `decimals`. `None` for another unit.
pub fn error_in_hertz(x: f64, unit: &str, decimals: usize) -> Option<String> {
    // A hertz is more than six radians a second.
    (unit == "rad/s").then(|| format!("{} Hz", fixed(x / TAU, decimals + 1)))
}

/// A unit with that of the record's motion in place of metres: a circuit swings in volts.
pub(crate) fn unit_in(scenario: &Scenario, unit: &'static str) -> &'static str {
    Length::of(scenario.record.as_ref()).in_place_of(unit)
}

/// Reads the output of [`significant`], and any number in Rust's notation.
pub fn parse(text: &str) -> Option<f64> {
    text.trim().replace('−', "-").replace(',', ".").parse().ok().filter(|x: &f64| x.is_finite())
}

/// A text with a capital at its beginning, unless it begins with a symbol such as λ, ωₙ or dt.
pub fn sentence(text: &str) -> String {
    let word = text.split([' ', ',', ':']).next().unwrap_or_default();
    if !word.is_ascii() || word.len() <= 2 && !word.contains(['a', 'e', 'i', 'o', 'u', 'y']) {
        return text.to_owned();
    }
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A time \[s\] in hours, minutes and whole seconds, `h:mm:ss`.
pub fn clock(time: f64) -> String {
    let seconds = time.abs().floor() as u64;
    let sign = if time < 0.0 && seconds > 0 { "−" } else { "" };
    format!("{sign}{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

pub fn parse_clock(text: &str) -> Option<f64> {
    let text = text.trim();
    let (sign, digits) = text.strip_prefix(['-', '−']).map_or((1.0, text), |rest| (-1.0, rest));
    let mut parts = digits.split(':').map(|part| parse(part).filter(|x| *x >= 0.0));
    let time = parts.by_ref().take(3).try_fold(0.0, |time, part| Some(60.0 * time + part?))?;
    parts.next().is_none().then_some(sign * time)
}

pub fn decimals(channel: Channel) -> usize {
    channel.usual().decimals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        let cases = [
            (0.0, "0"),
            (6.0, "6"),
            (4.8, "4.8"),
            (0.0001, "0.0001"),
            (3e-5, "3e−5"),
            (-0.125, "−0.125"),
            (1234.5678, "1235"),
            (1.005, "1.005"),
            (2.5e9, "2.5e9"),
            (f64::INFINITY, "∞"),
        ];
        for (x, text) in cases {
            assert_eq!(significant(x, 4), text);
        }
        assert_eq!(fixed(-1.5, 3), "−1.500");
    }

    #[test]
    fn times_are_hours_minutes_and_seconds() {
        for (time, text) in [(0.0, "0:00:00"), (3725.99, "1:02:05"), (86_400.0, "24:00:00"), (-61.0, "−0:01:01")] {
            assert_eq!(clock(time), text);
            assert_eq!(parse_clock(text), Some(time.trunc()));
        }
        for (text, time) in [("90", Some(90.0)), (" 1:30.5 ", Some(90.5)), ("1:2:3:4", None), ("1:x", None), ("", None)]
        {
            assert_eq!(parse_clock(text), time, "{text}");
        }
    }

    #[test]
    fn angular_frequencies_are_told_in_hertz() {
        assert_eq!(in_hertz(6.0, "rad/s").as_deref(), Some("0.9549 Hz"));
        assert_eq!(in_hertz(-0.1 * TAU, "rad/s").as_deref(), Some("−0.1 Hz"));
        assert_eq!(in_hertz(6.0, "m/s"), None);
        assert_eq!(error_in_hertz(-0.002_286, "rad/s", 3).as_deref(), Some("−0.0004 Hz"));
        assert_eq!(error_in_hertz(0.1, "m", 3), None);
    }

    #[test]
    fn written_numbers_can_be_read() {
        for x in [0.0, 4.8, 3e-5, -0.125, 2.5e9] {
            assert_eq!(parse(&significant(x, 6)), Some(x));
        }
        assert_eq!(parse("0,5"), Some(0.5));
        assert_eq!(parse("abc"), None);
        assert_eq!(parse("inf"), None);
    }
}
