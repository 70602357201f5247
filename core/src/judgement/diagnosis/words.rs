//! Numbers in sentences.

/// A number to two digits or so.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_is_longer_than_can_be_read() {
        assert_eq!([0.0, 0.01, 2.0, 12.3, 1e45, f64::INFINITY].map(short), ["0", "0.010", "2.0", "12", "1.0e45", "∞"]);
        assert_eq!([-0.01, -2.0, -1e-9, f64::NEG_INFINITY].map(short), ["-0.010", "-2.0", "-1.0e-9", "-∞"]);
        assert_eq!([0.001, 0.5, 0.999, 1e40].map(percent), ["less than 1 %", "50 %", "more than 99 %", "1.0e42 %"]);
    }
}
