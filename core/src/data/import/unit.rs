//! Units in headers of files.

/// The dimension of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// A time \[s\].
    Time,
    /// A length \[m\].
    Length,
    /// A velocity \[m/s\].
    Velocity,
    /// An acceleration \[m/s²\].
    Acceleration,
    /// An angle \[rad\].
    Angle,
    /// A force \[N\].
    Force,
    /// A voltage \[V\].
    Voltage,
}

/// Spellings, dimension and size in SI units. Spellings are compared without case where they have two letters or more.
const UNITS: [(&[&str], Dimension, f64); 28] = [
    (&["s", "sec", "secs", "second", "seconds", "sek"], Dimension::Time, 1.0),
    (&["ms", "msec", "milliseconds"], Dimension::Time, 1e-3),
    (&["us", "µs", "μs", "microseconds"], Dimension::Time, 1e-6),
    (&["ns"], Dimension::Time, 1e-9),
    (&["min", "minutes"], Dimension::Time, 60.0),
    (&["h", "hours"], Dimension::Time, 3600.0),
    (&["m", "meter", "metre", "meters", "metres"], Dimension::Length, 1.0),
    (&["mm"], Dimension::Length, 1e-3),
    (&["cm"], Dimension::Length, 1e-2),
    (&["um", "µm", "μm"], Dimension::Length, 1e-6),
    (&["in", "inch", "inches"], Dimension::Length, 0.0254),
    (&["ft", "feet"], Dimension::Length, 0.3048),
    (&["m/s", "m/sec", "ms-1", "m s-1"], Dimension::Velocity, 1.0),
    (&["mm/s", "mm/sec"], Dimension::Velocity, 1e-3),
    (&["cm/s", "cm/sec"], Dimension::Velocity, 1e-2),
    (&["in/s"], Dimension::Velocity, 0.0254),
    (&["m/s²", "m/s2", "m/s^2", "m/s/s", "m/s**2", "m/sec2", "m/sec^2", "ms-2", "m s-2"], Dimension::Acceleration, 1.0),
    (&["mm/s²", "mm/s2", "mm/s^2", "mm/s/s", "mm/sec2"], Dimension::Acceleration, 1e-3),
    (
        &["cm/s²", "cm/s2", "cm/s^2", "cm/s/s", "cm/s**2", "cm/sec2", "cm/sec^2", "cm/sec/sec", "gal"],
        Dimension::Acceleration,
        1e-2,
    ),
    (&["g", "gn"], Dimension::Acceleration, STANDARD_GRAVITY),
    (&["mg"], Dimension::Acceleration, 1e-3 * STANDARD_GRAVITY),
    (&["rad", "radians"], Dimension::Angle, 1.0),
    (&["°", "deg", "degree", "degrees", "grad"], Dimension::Angle, std::f64::consts::PI / 180.0),
    (&["mrad"], Dimension::Angle, 1e-3),
    (&["N", "newton"], Dimension::Force, 1.0),
    (&["kN"], Dimension::Force, 1e3),
    (&["V", "volt", "volts", "voltage"], Dimension::Voltage, 1.0),
    (&["mV"], Dimension::Voltage, 1e-3),
];

/// The acceleration of free fall, by definition \[m/s²\].
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// Dimension and size in SI units of a unit's spelling, if it is known.
pub fn unit(text: &str) -> Option<(Dimension, f64)> {
    let text = text.trim();
    let same = |spelling: &&str| {
        if text.chars().count() < 2 { *spelling == text } else { spelling.to_lowercase() == text.to_lowercase() }
    };
    UNITS.iter().find(|(spellings, ..)| spellings.iter().any(same)).map(|&(_, dimension, size)| (dimension, size))
}

/// The unit in a cell of a line of units, such as `mm` in `[mm]` and `Voltage` in `Voltage (unscaled)`.
pub(super) fn in_words(cell: &str) -> &str {
    let bare = cell.trim().trim_matches(['(', ')', '[', ']', '<', '>']).trim();
    match cell.trim().split_once([' ', '(', '[']) {
        Some((first, _)) if unit(bare).is_none() && unit(first).is_some() => first,
        _ => bare,
    }
}

/// A column's name and unit from its header, such as `acc (g)`, `Weg [mm]`, `t in ms`, `force_N`.
pub(super) fn name_and_unit(header: &str) -> (String, Option<String>) {
    let header = header.trim();
    for (open, close) in [('(', ')'), ('[', ']'), ('<', '>')] {
        if let Some((before, rest)) = header.split_once(open)
            && let Some((inner, after)) = rest.split_once(close)
            && !inner.trim().is_empty()
        {
            let name = [before.trim(), after.trim()].join(" ").trim().to_owned();
            return (if name.is_empty() { inner.trim().to_owned() } else { name }, Some(inner.trim().to_owned()));
        }
    }
    for mark in [" in ", "_", "/", " "] {
        if let Some((name, last)) = header.rsplit_once(mark)
            && unit(last).is_some()
            && !name.trim().is_empty()
        {
            return (name.trim().to_owned(), Some(last.trim().to_owned()));
        }
    }
    (header.to_owned(), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_spellings_are_known() {
        assert_eq!(unit("ms"), Some((Dimension::Time, 1e-3)));
        assert_eq!(unit("g"), Some((Dimension::Acceleration, 9.80665)));
        assert_eq!(unit("M/S^2"), Some((Dimension::Acceleration, 1.0)));
        assert_eq!(unit("mV"), Some((Dimension::Voltage, 1e-3)));
        assert_eq!(unit("S"), None, "a siemens is no second");
        assert_eq!(unit("Angle"), None);
    }

    #[test]
    fn names_and_units_are_told_apart() {
        let split = |header: &str| {
            let (name, unit) = name_and_unit(header);
            (name, unit.unwrap_or_default())
        };
        let pair = |name: &str, unit: &str| (name.to_owned(), unit.to_owned());
        assert_eq!(split("acc (g)"), pair("acc", "g"));
        assert_eq!(split("Angle, Ch 1+2 (rad) Run #13"), pair("Angle, Ch 1+2 Run #13", "rad"));
        assert_eq!(split("Weg [mm]"), pair("Weg", "mm"));
        assert_eq!(split("t in ms"), pair("t", "ms"));
        assert_eq!(split("force_N"), pair("force", "N"));
        assert_eq!(split("ground_acceleration"), pair("ground_acceleration", ""));
        assert_eq!(split("V1"), pair("V1", ""));
        assert_eq!(split("(s)"), pair("s", "s"));
    }
}
