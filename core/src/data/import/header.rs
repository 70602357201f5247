//! What the lines above a table say about its numbers.

use super::unit::{Dimension, unit};

/// The first number behind a word, without regard to case: 0.005 in `DT= .0050 SEC` behind `DT=`.
pub(super) fn number_after(line: &str, word: &str) -> Option<f64> {
    let place = line.to_ascii_lowercase().find(&word.to_ascii_lowercase())? + word.len();
    let rest = line.get(place..)?.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c))).unwrap_or(rest.len());
    rest[..end].trim_end_matches(['e', 'E', '.']).parse().ok()
}

/// Step, unit and scale of the numbers below a header, as far as it states them.
#[derive(Default)]
pub(super) struct Facts {
    /// \[s\]
    pub(super) step: Option<f64>,
    pub(super) unit: Option<String>,
    pub(super) scale: Option<f64>,
}

/// Words before the samples in a second, and before the time between samples.
pub(super) const RATES: [&str; 9] = [
    "sampling freq",
    "sampling rate",
    "sample rate",
    "samplerate",
    "sample freq",
    "abtastrate",
    "samprate",
    "samples per second",
    "fs",
];
pub(super) const STEPS: [&str; 15] = [
    "sampling interval",
    "sample interval",
    "sampling period",
    "sampling time",
    "sample time",
    "sampling step",
    "time step",
    "timestep",
    "abtastzeit",
    "time interval",
    "intervals of",
    "spaced at",
    "delta t",
    "delta",
    "dt",
];

pub(super) fn stated_rate(lines: &[&str]) -> Option<f64> {
    Facts::of(lines).step.map(|step| 1.0 / step)
}

impl Facts {
    pub(super) fn of(header: &[&str]) -> Self {
        let mut facts = Self::default();
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
        let rate = lines.iter().find_map(|line| number_behind(line, &RATES).or_else(|| number_before_rate(line)));
        let rate = rate.map(|(rate, unit)| if unit.contains("khz") { 1e3 * rate } else { rate });
        let step = lines.iter().find_map(|line| number_behind(line, &STEPS)).map(|(step, words)| {
            let is = |of: &[&str]| words.split(|c: char| !c.is_alphanumeric()).any(|word| of.contains(&word));
            let size = [(1e-3, is(&["ms", "msec", "milliseconds"])), (1e-6, is(&["us", "µs", "usec", "microseconds"]))];
            size.into_iter().find(|(_, is)| *is).map_or(1.0, |(size, _)| size) * step
        });
        let is_usual = |step: &f64| (1e-7..=10.0).contains(step);
        facts.step = rate.map(|rate| 1.0 / rate).filter(is_usual).or(step.filter(is_usual));
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
        facts.unit = header.iter().find_map(behind).or_else(|| {
            header
                .iter()
                .filter(is_about)
                .find_map(|line| words(line).iter().filter(|word| long(word)).find_map(|word| motion(word)))
        });
        facts.scale = lines.iter().find_map(|line| {
            let (scale, behind) = number_behind(line, &["scale factor", "scalefactor", "scaling factor"])?;
            let below = behind.split_once('/').map_or(Some(1.0), |(_, below)| number_after(below, ""))?;
            Some(scale / below).filter(|scale| scale.is_finite() && *scale != 0.0)
        });
        facts
    }
}

/// The first number close behind one of some words, and the line from the word on without it.
fn number_behind(line: &str, words: &[&str]) -> Option<(f64, String)> {
    const BETWEEN: usize = 24;
    words.iter().find_map(|word| {
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

/// The number in `100 sps` and `50 samples/s`, and that in the header of a GSE file behind form and number of the samples.
fn number_before_rate(line: &str) -> Option<(f64, String)> {
    if line.starts_with("wid2 ") {
        return Some((line.split_whitespace().skip_while(|word| *word != "int").nth(2)?.parse().ok()?, String::new()));
    }
    let place = ["sps", "samples/s", "samples per s", "samples / s"].iter().find_map(|word| line.find(word))?;
    let rate = line[..place].split_whitespace().next_back()?.parse().ok().filter(|rate| *rate > 0.0)?;
    Some((rate, String::new()))
}
