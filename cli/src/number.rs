//! Numbers for people to read.

/// The sign for a value that is not finite: a dash for NaN, and ∞ for infinity.
fn no_number(value: f64) -> Option<&'static str> {
    match value {
        _ if value.is_nan() => Some("–"),
        f64::INFINITY => Some("∞"),
        f64::NEG_INFINITY => Some("-∞"),
        _ => None,
    }
}

/// A number with this many decimals, or in scientific notation if it has too many digits.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    match no_number(value) {
        Some(sign) => sign.to_owned(),
        None if value.abs() < 1e9 => format!("{value:.decimals$}"),
        None => format!("{value:.3e}"),
    }
}

/// The decimals that show two digits of a standard deviation. `None` if fixed notation would be illegible.
fn decimals(spread: f64) -> Option<usize> {
    let exponent = spread.log10().floor();
    (-8.0..7.0).contains(&exponent).then(|| (1.0 - exponent).max(0.0) as usize)
}

/// A value and twice its standard deviation, both to the last digit that the standard deviation supports: `4.812`,
/// `0.035`.
pub fn with_spread(value: f64, std: f64) -> (String, String) {
    let spread = 2.0 * std;
    if spread == 0.0 {
        return (plain(value), "0".to_owned());
    }
    match decimals(spread).filter(|_| value.abs() < 1e9) {
        Some(decimals) => (format!("{value:.decimals$}"), format!("{spread:.decimals$}")),
        None => (significant(value, 4, 9), significant(spread, 2, 9)),
    }
}

pub(crate) fn scientific(value: f64, decimals: usize) -> String {
    no_number(value).map_or_else(|| format!("{value:.decimals$e}"), str::to_owned)
}

/// A difference from the truth, to one more digit than the standard deviation supports.
pub(crate) fn deviation(error: f64, std: f64) -> String {
    match decimals(2.0 * std).filter(|_| error.abs() < 1e9) {
        Some(decimals) => format!("{error:+.0$}", decimals + 1),
        None if error == 0.0 => "0".to_owned(),
        None if error > 0.0 && error.is_finite() => format!("+{}", significant(error, 2, 6)),
        None => significant(error, 2, 6),
    }
}

/// A positive number to three digits.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&value) {
        return scientific(value, 2);
    }
    let decimals = (2.0 - value.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

/// A number with this many significant digits and without trailing zeros: in fixed-point notation from 1e-4 to below
/// `10^most`, else with an exponent.
pub fn significant(value: f64, digits: usize, most: i32) -> String {
    if let Some(sign) = no_number(value) {
        return sign.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..most).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        return trimmed(&format!("{value:.decimals$}")).to_owned();
    }
    let text = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{exponent}", trimmed(mantissa))
}

fn trimmed(text: &str) -> &str {
    // Without a point the zeros count: 100 must not become 1.
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A number to six digits, without trailing zeros.
pub(crate) fn plain(value: f64) -> String {
    significant(value, 6, 9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_the_digits_that_its_spread_supports() {
        let text = |value, std| {
            let (value, spread) = with_spread(value, std);
            format!("{value} ± {spread}")
        };
        assert_eq!(text(4.812_34, 0.017_3), "4.812 ± 0.035");
        assert_eq!(text(-0.012_345, 0.000_49), "-0.01235 ± 0.00098");
        assert_eq!(text(512.3, 20.0), "512 ± 40");
        assert_eq!(text(6.0, 0.0), "6 ± 0");
        assert_eq!(text(1e-12, 1e-12), "1e-12 ± 2e-12");
        assert_eq!(text(3e20, 1e-3), "3e20 ± 0.002");
        assert_eq!(text(f64::NAN, f64::NAN), "– ± –");
        assert_eq!(text(1e308, 1e308), "1e308 ± ∞");
    }

    #[test]
    fn deviations_have_a_sign() {
        assert_eq!(deviation(0.012_34, 0.002), "+0.01234");
        assert_eq!(deviation(-0.012_34, 0.0), "-0.012");
        assert_eq!(deviation(0.0, 0.0), "0");
    }

    #[test]
    fn short_numbers_have_three_digits() {
        let shown = [0.0123456, 1.5, 123.4, 98_765.4, 1e-7, 2e7, 0.0].map(short);
        assert_eq!(shown, ["0.0123", "1.50", "123", "98765", "1.00e-7", "2.00e7", "0"]);
        assert_eq!([f64::NAN, f64::INFINITY].map(short), ["–", "∞"]);
    }

    #[test]
    fn no_number_is_longer_than_can_be_read() {
        assert_eq!([1e9, -1e45, f64::MAX].map(|x| fixed(x, 2)), ["1.000e9", "-1.000e45", "1.798e308"]);
        assert_eq!([12.345, f64::NAN, f64::NEG_INFINITY].map(|x| fixed(x, 1)), ["12.3", "–", "-∞"]);
        assert_eq!([f64::NAN, f64::NEG_INFINITY].map(plain), ["–", "-∞"]);
        assert_eq!([f64::NAN, f64::INFINITY].map(|error| deviation(error, 1.0)), ["–", "∞"]);
    }

    #[test]
    fn plain_numbers_have_no_needless_zeros() {
        let shown = [0.01, 60.0, 6000.0, 1.0 / 3.0, 1e-7, 123_456_789.4, -4.8, 1e12].map(plain);
        assert_eq!(shown, ["0.01", "60", "6000", "0.333333", "1e-7", "123456789", "-4.8", "1e12"]);
    }
}
