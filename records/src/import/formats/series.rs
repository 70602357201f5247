//! Formats with series of numbers: ground motions, seismograms, and universal files of modal analysis.

use super::{Series, SeriesReader, field_width, number_after, numbers, text_after};
use crate::import::cell::clock;
use crate::import::{Dialect, Result, Table};

/// Sources: Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, OSMS 85-03; COSMOS (2001), Strong motion
/// data format, version 1.20: the step is the real-header value 34.
pub(super) fn is_strong_motion(lines: &[&str]) -> bool {
    lines.iter().any(|line| csmip(line).is_some() || cosmos(line).is_some())
}

/// `10100 points of accel data equally spaced at 0.010 sec, in cm/sec2. (8f10.5)`
fn csmip(line: &str) -> Option<(usize, String, f64)> {
    let lower = line.to_ascii_lowercase();
    let (count, rest) = lower.split_once("points of ")?;
    let dt = number_after(rest, "data equally spaced at")?;
    Some((count.trim().parse().ok()?, rest.split_whitespace().next()?.to_owned(), dt))
}

/// `26219 acceleration pts, approx  131 secs, units=cm/sec2(04),Format=(1E15.6)`
fn cosmos(line: &str) -> Option<(usize, String)> {
    let lower = line.to_ascii_lowercase();
    let (before, _) = lower.split_once(" pts, approx").filter(|(_, rest)| rest.contains("units="))?;
    let mut words = before.split_whitespace();
    Some((words.next()?.parse().ok()?, words.next()?.to_owned()))
}

pub(super) fn strong_motion(header: &[String]) -> Option<Series> {
    let line = header.last()?;
    let (count, kind, dt, unit) = match csmip(line) {
        Some((count, kind, dt)) => (count, kind, dt, text_after(line, ", in ", &['.', '('])),
        None => {
            let (count, kind) = cosmos(line)?;
            (count, kind, step(header)?, text_after(line, "units=", &['(', ',']))
        }
    };
    let channel = header.iter().rev().find_map(|line| label(line)).map(|label| format!("{label} ")).unwrap_or_default();
    // Velocities and displacements are integrals of the acceleration: no readings.
    let name = match kind.get(..3) {
        Some("vel") => "velocity, integrated",
        Some("dis") => "displacement, integrated",
        _ => "acceleration",
    };
    let name = format!("{channel}{name}");
    let unit = unit.map(str::to_ascii_lowercase);
    Some(Series { name, unit, dt, count: Some(count), width: field_width(line), ..Series::default() })
}

fn label(line: &str) -> Option<String> {
    let (number, rest) = line.split_once("Chan ").or_else(|| line.split_once("CHAN "))?.1.split_once(':')?;
    let direction: Vec<&str> = rest.split_whitespace().take(2).collect();
    (number.trim().len() <= 3).then(|| format!("channel {} {}", number.trim(), direction.join(" ")).trim().to_owned())
}

fn step(header: &[String]) -> Option<f64> {
    let place = header.iter().rposition(|line| line.to_ascii_lowercase().contains("real-header values follow"))?;
    let width = field_width(&header[place]);
    let values = header[place + 1..].iter().map_while(|line| numbers(line, width));
    values.flatten().nth(33).filter(|step| *step > 0.0)
}

/// `NPTS=  7807, DT=   .0050 SEC`, or in older files `7807    0.0050    NPTS, DT`
pub(super) fn size(line: &str) -> Option<(usize, f64)> {
    let upper = line.to_ascii_uppercase();
    let (_, behind) = upper.split_once("NPTS")?;
    let (count, dt) = match number_after(&upper, "NPTS=").or_else(|| number_after(&upper, "NPTS =")) {
        Some(count) => (count, number_after(behind, "DT=").or_else(|| number_after(behind, "DT ="))?),
        None if behind.contains("DT") => {
            let mut numbers = upper.split_whitespace().map_while(|word| word.trim_end_matches(',').parse::<f64>().ok());
            (numbers.next()?, numbers.next()?)
        }
        None => return None,
    };
    ((1.0..1e9).contains(&count) && dt > 0.0).then_some((count as usize, dt))
}

/// Source: PEER (2013), NGA-West2 ground motion database, files of the kinds AT2, VT2 and DT2.
pub(super) fn peer(header: &[String]) -> Option<Series> {
    let (count, dt) = size(header.last()?)?;
    let kind = header.iter().rev().find(|line| line.to_ascii_uppercase().contains("UNITS OF"));
    let unit = kind.and_then(|line| text_after(line, "units of", &[',', ';', ':', ')']));
    let unit = unit.map(str::to_ascii_lowercase);
    let words = kind.map(|line| line.to_ascii_lowercase()).unwrap_or_default();
    let name = ["velocity", "displacement"].into_iter().find(|word| words.contains(word)).unwrap_or("acceleration");
    Some(Series { name: name.to_owned(), unit, dt, count: Some(count), ..Series::default() })
}

/// Also as ObsPy writes them. Source: EarthScope Consortium, `timeseries` web service, format `ascii` (SLIST):
/// `TIMESERIES NL_HGN_02_BHZ_R, 11947 samples, 40 sps, 2003-05-29T02:13:22.043400, SLIST, FLOAT, Counts`.
pub(super) fn slist(header: &[String]) -> Option<Series> {
    let mut parts = header.last()?.strip_prefix("TIMESERIES ")?.split(',').map(str::trim);
    let name = parts.next()?.to_owned();
    let count = parts.next()?.strip_suffix("samples")?.trim().parse().ok()?;
    let rate: f64 = parts.next()?.strip_suffix("sps")?.trim().parse().ok()?;
    let (start, _) = clock(parts.next()?)?;
    // The services write units in capitals.
    let unit = parts.nth(2).filter(|unit| !unit.is_empty()).map(str::to_lowercase);
    Some(Series { name, unit, start, dt: 1.0 / rate, count: Some(count), ..Series::default() })
}

const HEADER: usize = 12;

/// Functions of time, as text. Source: University of Cincinnati, Universal file formats for modal analysis testing, data set 58.
pub(super) fn is_uff58(lines: &[&str]) -> bool {
    lines[0].trim() == "-1" && lines.windows(2).any(|pair| pair[0].trim() == "-1" && pair[1].trim() == "58")
}

pub(super) fn uff58(header: &[String]) -> Option<Series> {
    let begins = |pair: &[String]| pair[0].trim() == "-1" && pair[1].trim() == "58";
    let place = header.windows(2).rposition(begins)? + 1;
    if header.len() != place + HEADER {
        return None;
    }
    let record = |number: usize| header[place + number].as_str();
    let words = |number: usize| record(number).split_whitespace();
    let [function, response] = [words(6).next()?, words(6).nth(4)?];
    // The widths of record 6 are 5, 10, 5, 10, 1 + 10, 10, 4.
    let field = |from: usize, to: usize| record(6).get(from..to).map(str::trim).unwrap_or_default();
    let (entity, node, direction) = (field(31, 41), field(41, 51), field(51, 55));
    let mut sizes = words(7).map(str::parse::<f64>).map_while(Result::ok);
    let [kind, count, is_even, start, dt] = [sizes.next()?, sizes.next()?, sizes.next()?, sizes.next()?, sizes.next()?];
    let is_even = is_even == 1.0;
    let quantity = match words(9).next()? {
        "8" => "displacement",
        "11" => "velocity",
        "12" => "acceleration",
        "9" | "13" => "force",
        _ => "",
    };
    let known = |text: &str| !text.is_empty() && !text.eq_ignore_ascii_case("none");
    let unit = record(9).get(47..).map(str::trim).filter(|unit| known(unit));
    let title = Some(record(1).trim()).filter(|title| known(title));
    let entity = Some(entity).filter(|entity| known(entity)).unwrap_or_default();
    let place = if node.is_empty() { response.to_owned() } else { format!("{entity} {node} {}", axis(direction)) };
    let name = [title.unwrap_or_default(), quantity, place.trim()];
    let name = name.iter().filter(|part| !part.is_empty()).map(ToString::to_string).collect::<Vec<_>>().join(" ");
    // Function type 1 is one of time; complex numbers are none.
    let is_complex = kind > 4.0;
    let is_time = function == "1" && !is_complex;
    let width = match (kind, is_even) {
        (2.0, _) => Some(13),
        (4.0, true) => Some(20),
        _ => None,
    };
    let numbers = if is_complex { 2 } else { 1 } + if is_even { 0 } else { 1 };
    let no_record = match function {
        _ if is_time => None,
        "4" => Some("is a frequency response, not a function of time"),
        "2" | "3" | "9" | "12" | "22" | "23" => Some("is a spectrum, not a function of time"),
        _ => Some("is not a function of time"),
    };
    let (unit, count) = (unit.map(str::to_owned), Some((count as usize).saturating_mul(numbers)));
    Some(Series { name, unit, start, dt, count, width, has_times: !is_even, no_record })
}

pub(super) fn uff58b(bytes: &[u8]) -> Result<Table> {
    let mut reader = SeriesReader::new("universal file, data set 58b", Dialect::default(), uff58);
    let (mut rest, mut line, mut is_set) = (bytes, 0, false);
    let mut binary: Option<(usize, [usize; 4])> = None;
    while !rest.is_empty() {
        let end = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |end| end + 1);
        let text = String::from_utf8_lossy(&rest[..end]);
        (rest, line) = (&rest[end..], line + 1);
        match text.trim_start().strip_prefix("58b").filter(|_| is_set) {
            Some(sizes) => {
                let mut sizes = sizes.split_whitespace().map_while(|word| word.parse().ok());
                let sizes = [(); 4].map(|()| sizes.next().unwrap_or(0));
                binary = Some((line + HEADER - 1, sizes));
                reader.line("58", line)?;
            }
            None => reader.line(&text, line)?,
        }
        is_set = text.trim() == "-1";
        if let Some((_, [order, form, _, size])) = binary.filter(|(last, _)| *last == line) {
            // pyuff does not count the times of uneven functions.
            let ends = |size: &usize| rest.get(*size..).is_some_and(|rest| rest.trim_ascii_start().starts_with(b"-1"));
            let size = [size, size.saturating_mul(2)].into_iter().find(ends).unwrap_or(size);
            let part = &rest[..size.min(rest.len())];
            reader.bytes(part, size, order == 2, form);
            (rest, binary) = (&rest[part.len()..], None);
        }
    }
    reader.finish(line)
}

fn axis(direction: &str) -> &'static str {
    let place = direction.parse::<isize>().ok().and_then(|number| usize::try_from(number + 3).ok());
    place.and_then(|place| ["-Z", "-Y", "-X", "", "+X", "+Y", "+Z"].get(place)).unwrap_or(&"")
}

/// In lines: 70 numbers, 40 whole ones, and 23 texts.
const SAC: usize = 30;

/// Source: Lawrence Livermore National Laboratory, SAC users manual, "SAC data file format", alphanumeric.
pub(super) fn is_sac(lines: &[&str]) -> bool {
    sac(&lines.iter().take(SAC).map(ToString::to_string).collect::<Vec<_>>()).is_some()
}

pub(super) fn sac(header: &[String]) -> Option<Series> {
    let row = |line: usize| numbers(header.get(line)?, None).filter(|row| row.len() == 5);
    let all: Option<Vec<Vec<f64>>> = (0..22).map(row).collect();
    let all = all.filter(|all| header.len() == SAC && (6.0..=7.0).contains(&all[15][1]))?;
    let (dt, start, count, kind) = (all[0][0], all[1][0], all[15][4], all[17][1]);
    // Blanks at the end of a line may be gone.
    let text = |line: usize, nth: usize| {
        let rest = header[line].get(8 * nth..).unwrap_or_default();
        rest.get(..8).unwrap_or(rest).trim()
    };
    let kinds = [(6.0, "displacement"), (7.0, "velocity"), (8.0, "acceleration")];
    let kind = kinds.into_iter().find(|(number, _)| *number == kind).map_or("", |(_, kind)| kind);
    let words = [text(22, 0), text(28, 2), kind];
    // A header has -12345 where it has no value.
    let known = words.into_iter().filter(|word| !word.is_empty() && *word != "-12345").collect::<Vec<_>>().join(" ");
    let start = if start == -12_345.0 { 0.0 } else { start };
    Some(Series { name: known, start, dt, count: Some(count as usize), ..Series::default() })
}
