//! Numbers in sentences.

/// To two or three digits, and by its power of ten where it is very small or large.
pub fn short(value: f64) -> String {
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
pub fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p > 0.0 && p < 1.0 => "less than 1 %".to_owned(),
        p if p > 99.0 && p < 100.0 => "more than 99 %".to_owned(),
        p if p >= 1e6 => format!("{} %", short(p)),
        p => format!("{p:.0} %"),
    }
}

/// To four digits, without zeros at the end.
pub fn plain(value: f64) -> String {
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
pub fn percent_to_a_tenth(share: f64) -> String {
    match 100.0 * share.abs() {
        size if size < 0.1 => "less than 0.1 %".to_owned(),
        size if size < 9.95 => format!("{size:.1} %"),
        size if size < 1e4 => format!("{size:.0} %"),
        _ => "more than a hundred times".to_owned(),
    }
}

/// An estimate with its band, to the digits that the band leaves: `429.2 ± 0.1 rad/s`.
pub fn with_band(mean: f64, band: f64, unit: &str) -> String {
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

/// A time, with fewer decimals where it is longer.
pub fn seconds(time: f64) -> String {
    match time {
        time if time < 0.0995 => format!("{} s", plain(time)),
        time if time < 99.5 => format!("{time:.1} s"),
        time if time >= 1e6 => format!("{} s", plain(time)),
        time => format!("{time:.0} s"),
    }
}
