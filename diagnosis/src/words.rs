//! Numbers in sentences.

pub(crate) fn short(value: f64) -> String {
    match value.abs() {
        0.001..0.0995 => format!("{value:.3}"),
        0.0995..9.95 => format!("{value:.1}"),
        9.95..1e6 => format!("{value:.0}"),
        0.0 => "0".to_owned(),
        f64::INFINITY => if value < 0.0 { "-∞" } else { "∞" }.to_owned(),
        _ => format!("{value:.1e}"),
    }
}

/// A share in percent: `0 %` and `100 %` only for exactly none and all.
pub(crate) fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p > 0.0 && p < 1.0 => "less than 1 %".to_owned(),
        p if p > 99.0 && p < 100.0 => "more than 99 %".to_owned(),
        p if p >= 1e6 => format!("{} %", short(p)),
        p => format!("{p:.0} %"),
    }
}

pub(crate) fn plain(value: f64) -> String {
    let text = match value.abs() {
        0.0 => "0".to_owned(),
        size if !size.is_finite() => return short(value),
        size if (1e-3..1e6).contains(&size) => {
            let decimals = (3.0 - libm::floor(libm::log10(size))).clamp(0.0, 6.0) as usize;
            format!("{value:.decimals$}")
        }
        _ => return format!("{value:.1e}"),
    };
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A share in percent, with a decimal where it is small: `36 %`, `1.4 %`, `less than 0.1 %`.
pub(crate) fn percent_to_a_tenth(share: f64) -> String {
    match 100.0 * share.abs() {
        size if size < 0.1 => "less than 0.1 %".to_owned(),
        size if size < 9.95 => format!("{size:.1} %"),
        size if size < 1e4 => format!("{size:.0} %"),
        _ => "more than a hundred times".to_owned(),
    }
}

/// An estimate with its band, to the digits that the band leaves: `429.2 ± 0.1 rad/s`.
pub(crate) fn with_band(mean: f64, band: f64, unit: &str) -> String {
    let size = if band > 0.0 { band } else { 1e-3 * mean.abs() };
    let text = if size > 0.0 && size.is_finite() && mean.abs() < 1e7 && (1e-6..1e6).contains(&size) {
        // A band far below the last digit of the number says nothing more.
        let decimals = decimals(size.max(1e-7 * mean.abs()));
        match band {
            band if band <= 0.0 => format!("{mean:.decimals$}"),
            band if band < size.max(1e-7 * mean.abs()) => format!("{mean:.decimals$} ± {band:.0e}"),
            band => format!("{mean:.decimals$} ± {band:.decimals$}"),
        }
    } else if band > 0.0 {
        format!("{mean:.2e} ± {band:.0e}")
    } else {
        plain(mean)
    };
    format!("{text} {unit}").trim_end().to_owned()
}

fn decimals(band: f64) -> usize {
    let exponent = libm::floor(libm::log10(band));
    let is_one = band / libm::pow(10.0, exponent) < 1.95;
    (f64::from(u8::from(is_one)) - exponent).clamp(0.0, 8.0) as usize
}

pub(crate) fn seconds(time: f64) -> String {
    match time {
        time if time < 0.0995 => format!("{} s", plain(time)),
        time if time < 99.5 => format!("{time:.1} s"),
        time if time >= 1e6 => format!("{} s", plain(time)),
        time => format!("{time:.0} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_is_longer_than_can_be_read() {
        assert_eq!([0.0, 0.01, 2.0, 12.3, 1e45, f64::INFINITY].map(short), ["0", "0.010", "2.0", "12", "1.0e45", "∞"]);
        assert_eq!([-0.01, -2.0, -1e-9, f64::NEG_INFINITY].map(short), ["-0.010", "-2.0", "-1.0e-9", "-∞"]);
        assert_eq!([0.001, 0.5, 0.999, 1e40].map(percent), ["less than 1 %", "50 %", "more than 99 %", "1.0e42 %"]);
    }

    #[test]
    fn numbers_have_the_digits_that_one_reads() {
        assert_eq!(
            [8.0, 1.005, 0.05, 6.3456, 1500.0, 1e-7, -2.5].map(plain),
            ["8", "1.005", "0.05", "6.346", "1500", "1.0e-7", "-2.5"]
        );
        assert_eq!(
            [0.36, 0.014, 0.0002, 0.0, -0.5].map(percent_to_a_tenth),
            ["36 %", "1.4 %", "less than 0.1 %", "less than 0.1 %", "50 %"]
        );
        assert_eq!(with_band(429.2134, 0.12, "rad/s"), "429.21 ± 0.12 rad/s");
        assert_eq!(with_band(429.2134, 0.3, "rad/s"), "429.2 ± 0.3 rad/s");
        assert_eq!(with_band(0.0478, 0.003, ""), "0.048 ± 0.003");
        assert_eq!(with_band(1200.0, 45.0, "N"), "1200 ± 45 N");
        assert_eq!(with_band(6.0, 0.0, "rad/s"), "6.000 rad/s");
        assert_eq!(with_band(6.0, 1e-12, "rad/s"), "6.00e0 ± 1e-12 rad/s");
        assert_eq!(with_band(54_321.123_456, 1e-5, ""), "54321.123 ± 1e-5");
        assert_eq!([0.04, 2.44, 120.0].map(seconds), ["0.04 s", "2.4 s", "120 s"]);
    }
}
