//! The header of a file: the units of its columns, and step, unit and scale of its numbers.

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
    /// An angular velocity \[rad/s\].
    AngularVelocity,
    /// An angular acceleration \[rad/s²\].
    AngularAcceleration,
    /// A voltage \[V\].
    Voltage,
    /// Neither one of a motion nor of a force: a pressure, a temperature, a share.
    Other,
}

/// Sizes in SI units. Spellings of two letters or more are compared without case.
const UNITS: [(&str, Dimension, f64); 35] = [
    ("s, sec, secs, second, seconds, sek", Dimension::Time, 1.0),
    ("ms, msec, msecs, millis, milliseconds", Dimension::Time, 1e-3),
    ("us, µs, μs, usec, usecs, micros, microsec, microseconds", Dimension::Time, 1e-6),
    ("ns, nsec, nsecs, nanos, nanosec, nanoseconds", Dimension::Time, 1e-9),
    ("min, minutes", Dimension::Time, 60.0),
    ("h, hours", Dimension::Time, 3600.0),
    ("day, days", Dimension::Time, 86_400.0),
    ("m, meter, metre, meters, metres", Dimension::Length, 1.0),
    ("mm", Dimension::Length, 1e-3),
    ("cm", Dimension::Length, 1e-2),
    ("um, µm, μm", Dimension::Length, 1e-6),
    ("in, inch, inches", Dimension::Length, 0.0254),
    ("ft, feet", Dimension::Length, 0.3048),
    ("m/s, m/sec, ms-1, m s-1", Dimension::Velocity, 1.0),
    ("mm/s, mm/sec", Dimension::Velocity, 1e-3),
    ("cm/s, cm/sec", Dimension::Velocity, 1e-2),
    ("in/s", Dimension::Velocity, 0.0254),
    ("km/h, kmh, kph", Dimension::Velocity, 1.0 / 3.6),
    ("m/s², m/s2, m/s^2, m/s/s, m/s**2, m/sec2, m/sec^2, ms-2, m s-2, m_s2", Dimension::Acceleration, 1.0),
    ("mm/s², mm/s2, mm/s^2, mm/s/s, mm/sec2", Dimension::Acceleration, 1e-3),
    ("cm/s², cm/s2, cm/s^2, cm/s/s, cm/s**2, cm/sec2, cm/sec^2, cm/sec/sec, gal", Dimension::Acceleration, 1e-2),
    ("g, G, gn", Dimension::Acceleration, STANDARD_GRAVITY),
    ("mg", Dimension::Acceleration, 1e-3 * STANDARD_GRAVITY),
    ("rad, radians", Dimension::Angle, 1.0),
    ("°, deg, degree, degrees, grad", Dimension::Angle, DEGREE),
    ("mrad", Dimension::Angle, 1e-3),
    ("rad/s, rad/sec, rad s-1, rad_s", Dimension::AngularVelocity, 1.0),
    ("°/s, deg/s, deg/sec, degrees/s, deg_s, dps", Dimension::AngularVelocity, DEGREE),
    ("rad/s², rad/s2, rad/s^2, rad/sec^2", Dimension::AngularAcceleration, 1.0),
    ("°/s², °/s^2, deg/s², deg/s2, deg/s^2", Dimension::AngularAcceleration, DEGREE),
    ("N, newton", Dimension::Force, 1.0),
    ("kN", Dimension::Force, 1e3),
    ("V, volt, volts, voltage", Dimension::Voltage, 1.0),
    ("mV", Dimension::Voltage, 1e-3),
    (
        "Pa, hPa, kPa, MPa, GPa, bar, mbar, psi, atm, mmHg, K, °C, degC, deg C, celsius, C, °F, degF, l, L, ml, m³, m3, m^3, %, \
         %rH, ppm, rpm, 1/min, Hz, kHz, bpm, lx, lux, dB, dBA, A, mA, µA, W, mW, kW, J, Wh, mAh, Ω, ohm, T, mT, µT, μT, uT, gauss, \
         counts/s, baud",
        Dimension::Other,
        1.0,
    ),
];

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// The acceleration of free fall, by definition \[m/s²\].
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// Dimension and size in SI units of a unit's spelling, if it is known.
pub fn unit(text: &str) -> Option<(Dimension, f64)> {
    let text = text.trim();
    let same = |spelling: &&str| {
        if text.chars().count() < 2 { *spelling == text } else { spelling.to_lowercase() == text.to_lowercase() }
    };
    let found = UNITS.iter().find(|(spellings, ..)| spellings.split(", ").any(|spelling| same(&spelling)));
    found.map(|&(_, dimension, size)| (dimension, size))
}

/// `mm` in `[mm]`, `Voltage` in `Voltage (unscaled)`
pub(super) fn in_words(cell: &str) -> &str {
    let bare = cell.trim().trim_matches(['(', ')', '[', ']', '<', '>']).trim();
    match cell.trim().split_once([' ', '(', '[']) {
        Some((first, _)) if unit(bare).is_none() && unit(first).is_some() => first,
        _ => bare,
    }
}

/// The A of `Channel A` is no unit, nor the G of the seventh.
fn is_behind_a_name(word: &str) -> bool {
    match unit(word) {
        Some((Dimension::Other, _)) => word.chars().count() > 2 && word.contains(char::is_uppercase),
        found => found.is_some() && word != "G",
    }
}

/// Of `acc (g)`, `Weg [mm]`, `t in ms`, `force_N`, `accel_m_s2[0]`, `gFx`.
pub(super) fn name_and_unit(header: &str) -> (String, Option<String>) {
    let header = header.trim();
    let is_index = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    for (open, close) in [('(', ')'), ('[', ']'), ('<', '>')] {
        if let Some((before, rest)) = header.split_once(open)
            && let Some((inner, after)) = rest.split_once(close)
            && !is_index(inner.trim())
        {
            let name = [before.trim(), after.trim()].join(" ").trim().to_owned();
            return (if name.is_empty() { inner.trim().to_owned() } else { name }, Some(inner.trim().to_owned()));
        }
    }
    let indexed = header.rsplit_once('[').filter(|(_, rest)| rest.strip_suffix(']').is_some_and(is_index));
    let (base, index) = indexed.map_or((header, ""), |(base, _)| header.split_at(base.len()));
    for mark in [" in ", "_", "/", " "] {
        // The longest unit: m_s2, not s2.
        let mut parts = base.match_indices(mark).map(|(place, _)| (base[..place].trim(), &base[place + mark.len()..]));
        if let Some((name, unit)) = parts.find(|(name, last)| !name.is_empty() && is_behind_a_name(last)) {
            return (format!("{name}{index}"), Some(unit.trim().to_owned()));
        }
    }
    let is_in_g = ["gFx", "gFy", "gFz"].contains(&header);
    (header.to_owned(), is_in_g.then(|| "g".to_owned()))
}

/// 0.005 in `DT= .0050 SEC` behind `DT=`; without regard to case.
pub(super) fn number_after(line: &str, word: &str) -> Option<f64> {
    let place = line.to_ascii_lowercase().find(&word.to_ascii_lowercase())? + word.len();
    let rest = line.get(place..)?.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c))).unwrap_or(rest.len());
    rest[..end].trim_end_matches(['e', 'E', '.']).parse().ok()
}

pub(super) struct Facts {
    /// \[s\]
    pub(super) step: Option<f64>,
    pub(super) unit: Option<String>,
    pub(super) scale: Option<f64>,
}

pub(super) const RATES: &str = "sampling freq, sampling rate, sample rate, samplerate, sample freq, abtastrate, samprate, \
                                samples per second, fs";
pub(super) const STEPS: &str = "sampling interval, sample interval, sampling period, sampling time, sample time, sampling step, \
                                time step, timestep, abtastzeit, time interval, intervals of, spaced at, delta t, delta, dt";

impl Facts {
    pub(super) fn of(header: &[&str]) -> Self {
        let lines: Vec<String> = header
            .iter()
            .map(|line| line.to_lowercase().replace('_', " ").replace(", ", "; "))
            .map(|line| if line.starts_with("rate") { format!("sample {line}") } else { line })
            .map(|line| {
                line.split(',').fold(String::new(), |text, part| match text.chars().last() {
                    None => part.to_owned(),
                    // A number with a decimal point ends at a comma.
                    Some(last) => {
                        let is_whole = !text.rsplit([' ', ';']).next().is_some_and(|word| word.contains('.'));
                        format!("{text}{}{part}", if is_whole && last.is_ascii_digit() { '.' } else { ' ' })
                    }
                })
            })
            .collect();
        let rate = lines.iter().find_map(|line| number_behind(line, RATES).or_else(|| number_before_rate(line)));
        let rate = rate.map(|(rate, unit)| if unit.contains("khz") { 1e3 * rate } else { rate });
        let step = lines.iter().find_map(|line| number_behind(line, STEPS)).map(|(step, words)| {
            let is = |of: &[&str]| words.split(|c: char| !c.is_alphanumeric()).any(|word| of.contains(&word));
            let size = [(1e-3, is(&["ms", "msec", "milliseconds"])), (1e-6, is(&["us", "µs", "usec", "microseconds"]))];
            size.into_iter().find(|(_, is)| *is).map_or(1.0, |(size, _)| size) * step
        });
        let is_usual = |step: &f64| (1e-7..=10.0).contains(step);
        let step = rate.map(|rate| 1.0 / rate).filter(is_usual).or(step.filter(is_usual));
        let motion = |text: &str| {
            let known = unit(text).filter(|_| text != "in")?.0;
            use Dimension::{Acceleration, Angle, AngularVelocity, Length, Velocity};
            matches!(known, Acceleration | Velocity | Length | Angle | AngularVelocity).then(|| text.to_lowercase())
        };
        let words = |text: &str| -> Vec<String> {
            text.split([' ', ',', ';', '(', ')', '[', ']', '=', '\t'])
                .map(|word| word.trim_end_matches('.').to_owned())
                .collect()
        };
        let is_about = |line: &&&str| {
            let line = line.to_lowercase();
            ["scale", "acc", "vel", "displ", "ampl"].iter().any(|word| line.contains(word))
        };
        let behind = |line: &&str| {
            let place = line.to_lowercase().find("unit")?;
            words(line.get(place..)?.split_once([':', ' ', '=', '('])?.1).iter().find_map(|word| motion(word))
        };
        let long = |word: &String| word.len() > 2;
        let about = |line: &&str| words(line).iter().filter(|word| long(word)).find_map(|word| motion(word));
        let unit = header.iter().find_map(behind).or_else(|| header.iter().filter(is_about).find_map(about));
        let scale = lines.iter().find_map(|line| {
            let (scale, behind) = number_behind(line, "scale factor, scalefactor, scaling factor")?;
            let below = behind.split_once('/').map_or(Some(1.0), |(_, below)| number_after(below, ""))?;
            Some(scale / below).filter(|scale| scale.is_finite() && *scale != 0.0)
        });
        Self { step, unit, scale }
    }
}

fn number_behind(line: &str, words: &str) -> Option<(f64, String)> {
    const BETWEEN: usize = 24;
    words.split(", ").find_map(|word| {
        let place = line.find(word).filter(|place| !line[..*place].ends_with(char::is_alphanumeric))? + word.len();
        let rest = &line[place..];
        let digit = rest.find(|c: char| c.is_ascii_digit())?;
        let begin = rest[..digit].trim_end_matches(['.', '-', '+']).len();
        let number = number_after(&rest[begin..], "").or_else(|| number_after(&rest[digit..], ""))?;
        let end =
            rest[digit..].find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c))).unwrap_or(rest.len() - digit);
        // A long number of a date behind another word is none. The number may be in the next cell.
        (begin <= BETWEEN && (!rest[..begin].contains(';') || begin == 1) && number > 0.0)
            .then(|| (number, format!("{} {}", &rest[..begin], &rest[digit + end..])))
    })
}

/// `100 sps`, `50 samples/s`, and in the header of a GSE file behind form and number of the samples.
fn number_before_rate(line: &str) -> Option<(f64, String)> {
    if line.starts_with("wid2 ") {
        return Some((line.split_whitespace().skip_while(|word| *word != "int").nth(2)?.parse().ok()?, String::new()));
    }
    let place = ["sps", "samples/s", "samples per s", "samples / s"].iter().find_map(|word| line.find(word))?;
    let rate = line[..place].split_whitespace().next_back()?.parse().ok().filter(|rate| *rate > 0.0)?;
    Some((rate, String::new()))
}
