//! Formats with series of numbers: ground motions of strong-motion programs and seismological data centres, and universal files of modal
//! analysis.

use super::{Layout, Series, field_width, number_after, numbers, text_after};
use crate::data::import::cell::clock;

/// Strong motions of the California Strong Motion Instrumentation Program (volume 2) and of COSMOS: pages of header,
/// then series of fixed width; their numbers may abut.
///
/// Sources: Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, OSMS 85-03; COSMOS (2001), Strong motion
/// data format, version 1.20: the step is the real-header value 34.
pub(super) fn strong_motion(lines: &[&str]) -> Option<Layout> {
    lines.iter().find(|line| csmip(line).is_some() || cosmos(line).is_some())?;
    Some(Layout::Series(next_strong_motion))
}

/// `10100 points of accel data equally spaced at 0.010 sec, in cm/sec2. (8f10.5)`: count, kind and step.
fn csmip(line: &str) -> Option<(usize, String, f64)> {
    let lower = line.to_ascii_lowercase();
    let (count, rest) = lower.split_once("points of ")?;
    let dt = number_after(rest, "data equally spaced at")?;
    Some((count.trim().parse().ok()?, rest.split_whitespace().next()?.to_owned(), dt))
}

/// `26219 acceleration pts, approx  131 secs, units=cm/sec2(04),Format=(1E15.6)`: count and kind.
fn cosmos(line: &str) -> Option<(usize, String)> {
    let lower = line.to_ascii_lowercase();
    let (before, _) = lower.split_once(" pts, approx").filter(|(_, rest)| rest.contains("units="))?;
    let mut words = before.split_whitespace();
    Some((words.next()?.parse().ok()?, words.next()?.to_owned()))
}

fn next_strong_motion(header: &[String]) -> Option<Series> {
    let line = header.last()?;
    let (count, kind, dt, unit) = match csmip(line) {
        Some((count, kind, dt)) => (count, kind, dt, text_after(line, ", in ", &['.', '('])),
        None => {
            let (count, kind) = cosmos(line)?;
            (count, kind, step(header)?, text_after(line, "units=", &['(', ',']))
        }
    };
    let channel = header.iter().rev().find_map(|line| label(line)).map(|label| format!("{label} ")).unwrap_or_default();
    // Velocities and displacements are integrals of the acceleration: no readings of their own.
    let name = match kind.get(..3) {
        Some("vel") => "velocity, integrated",
        Some("dis") => "displacement, integrated",
        _ => "acceleration",
    };
    let name = format!("{channel}{name}");
    let unit = unit.map(str::to_ascii_lowercase);
    Some(Series { name, unit, dt, count: Some(count), width: field_width(line), ..Series::default() })
}

/// The channel in a line such as `Chan  1: 180 Deg`.
fn label(line: &str) -> Option<String> {
    let (number, rest) = line.split_once("Chan ").or_else(|| line.split_once("CHAN "))?.1.split_once(':')?;
    let direction: Vec<&str> = rest.split_whitespace().take(2).collect();
    (number.trim().len() <= 3).then(|| format!("channel {} {}", number.trim(), direction.join(" ")).trim().to_owned())
}

/// The step in the real header of COSMOS \[s\].
fn step(header: &[String]) -> Option<f64> {
    let place = header.iter().rposition(|line| line.to_ascii_lowercase().contains("real-header values follow"))?;
    let width = field_width(&header[place]);
    let values = header[place + 1..].iter().map_while(|line| numbers(line, width));
    values.flatten().nth(33).filter(|step| *step > 0.0)
}

/// Ground motions of the Pacific Earthquake Engineering Research Center: four lines of header, then one series, five numbers a line.
///
/// Source: PEER (2013), NGA-West2 ground motion database, files of the kinds AT2, VT2 and DT2.
pub(super) fn peer(lines: &[&str]) -> Option<Layout> {
    lines.iter().take(6).find(|line| size(line).is_some())?;
    Some(Layout::Series(next_peer))
}

/// Number and distance of the samples: `NPTS=  7807, DT=   .0050 SEC`, or in older files `7807    0.0050    NPTS, DT`.
fn size(line: &str) -> Option<(usize, f64)> {
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

fn next_peer(header: &[String]) -> Option<Series> {
    let (count, dt) = size(header.last()?)?;
    let kind = header.iter().rev().find(|line| line.to_ascii_uppercase().contains("UNITS OF"));
    let unit = kind.and_then(|line| text_after(line, "units of", &[',', ';', ':', ')']));
    // G is what others write as g.
    let unit = unit.map(str::to_ascii_lowercase);
    let words = kind.map(|line| line.to_ascii_lowercase()).unwrap_or_default();
    let name = ["velocity", "displacement"].into_iter().find(|word| words.contains(word)).unwrap_or("acceleration");
    Some(Series { name: name.to_owned(), unit, dt, count: Some(count), ..Series::default() })
}

/// Series as ObsPy and the web services of seismological data centres write them: `TIMESERIES` and a line of numbers after the other.
///
/// Source: EarthScope Consortium, `timeseries` web service, format `ascii` (SLIST).
pub(super) fn slist(lines: &[&str]) -> Option<Layout> {
    let first = lines.first()?;
    (first.starts_with("TIMESERIES ") && first.contains(", SLIST,")).then_some(Layout::Series(next_slist))
}

/// `TIMESERIES NL_HGN_02_BHZ_R, 11947 samples, 40 sps, 2003-05-29T02:13:22.043400, SLIST, FLOAT, Counts`.
fn next_slist(header: &[String]) -> Option<Series> {
    let mut parts = header.last()?.strip_prefix("TIMESERIES ")?.split(',').map(str::trim);
    let name = parts.next()?.to_owned();
    let count = parts.next()?.strip_suffix("samples")?.trim().parse().ok()?;
    let rate: f64 = parts.next()?.strip_suffix("sps")?.trim().parse().ok()?;
    let (start, _) = clock(parts.next()?)?;
    // The services write units in capitals.
    let unit = parts.nth(2).filter(|unit| !unit.is_empty()).map(str::to_lowercase);
    Some(Series { name, unit, start, dt: 1.0 / rate, count: Some(count), ..Series::default() })
}

/// The lines of a data set's header, with the number 58.
const HEADER: usize = 12;

/// Universal files of modal analysis: data sets 58 with functions of time, as text.
///
/// Source: University of Cincinnati, Structural Dynamics Research Laboratory, Universal file formats for modal analysis testing, data
/// set 58.
pub(super) fn uff58(lines: &[&str]) -> Option<Layout> {
    let begins = |pair: &[&str]| pair[0].trim() == "-1" && pair[1].trim() == "58";
    (lines.first()?.trim() == "-1" && lines.windows(2).any(begins)).then_some(Layout::Series(next_uff58))
}

fn next_uff58(header: &[String]) -> Option<Series> {
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
    let text = |number: usize, from: usize| record(number).get(from..).map(str::trim).unwrap_or_default();
    let unit = Some(text(9, 47)).filter(|unit| !unit.is_empty() && !unit.eq_ignore_ascii_case("none"));
    let title = Some(record(1).trim()).filter(|title| !title.is_empty() && !title.eq_ignore_ascii_case("none"));
    let entity = if entity.eq_ignore_ascii_case("none") { "" } else { entity };
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
    Some(Series {
        name,
        unit: unit.map(str::to_owned),
        start,
        dt,
        count: Some((count as usize).saturating_mul(numbers)),
        width,
        has_times: !is_even,
        no_record: (!is_time).then_some("is no function of time"),
    })
}

/// A direction: 1 to 3 along the axes, negative against them.
fn axis(direction: &str) -> String {
    match direction.parse::<i32>() {
        Ok(number @ (1..=3 | -3..=-1)) => {
            let sign = if number < 0 { '-' } else { '+' };
            format!("{sign}{}", [' ', 'X', 'Y', 'Z'][number.unsigned_abs() as usize])
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::table_of;

    fn v2(channel: u32, size: f64) -> String {
        let block = |kind: &str, unit: &str, form: &str, rows: &[[f64; 4]]| {
            let head = format!(
                " {} points of {kind} data equally spaced at 0.010 sec, in {unit}. ({form})    \n",
                4 * rows.len()
            );
            let row = |row: &[f64; 4]| row.map(|x| format!("{:10.3}", size * x)).concat() + "\n";
            head + &rows.iter().map(row).collect::<String>()
        };
        format!("Corrected accelerogram   89486-N2628-22354.08       Chan  {channel}: 180 Deg     from   \n")
            + "Uncorrected Accelerogram Data\n 8 points of instrument- and baseline-corrected accel, veloc and displ data \n"
            + "At equally-spaced intervals of   0.010  sec.\n"
            + &format!("89486-N2628-22354.08      Fortuna - 701 S. Fortuna Blvd.    Chan  {channel}: 180 Deg    \n")
            + "    1  100    1    3    3  200    1\n 0.0049020 0.7000000 101.00000-999.00000-999.00000\n"
            + &block("accel", "cm/sec2", "8f10.3", &[[-0.001, -1234.567, -2345.678, 12.0], [1.0, 2.0, 3.0, 123456.789]])
            + &block("veloc", "cm/sec", "8f10.3", &[[1.0, 2.0, 3.0, 4.0]; 2])
            + &block("displ", "cm", "8f10.3", &[[4.0, 3.0, 2.0, 1.0]; 2])
            + &format!("/&  ----------  End of data for channel  {channel}  ----------\n")
    }

    #[test]
    fn numbers_that_abut_and_several_channels_are_read() {
        let (table, names) = table_of(&(v2(1, 1.0) + &v2(2, -0.1)));
        let expected = ["acceleration", "velocity, integrated", "displacement, integrated"];
        let expected = [1, 2].map(|channel| expected.map(|kind| format!("channel {channel} 180 Deg {kind}"))).concat();
        assert_eq!(names[1..], expected);
        assert_eq!(table.columns[1].values, [-0.001, -1234.567, -2345.678, 12.0, 1.0, 2.0, 3.0, 123456.789]);
        assert_eq!(table.columns[4].values[7], -12345.679);
        assert_eq!((table.columns[1].unit.as_deref(), table.columns[0].values[3]), (Some("cm/sec2"), 0.03));
        assert_eq!(table.remarks, Vec::<String>::new());
    }

    #[test]
    fn the_step_of_cosmos_stands_among_the_real_values() {
        let values: String = (0..100)
            .map(|k| format!("{:15.6}{}", [-999.0, 0.01][usize::from(k == 33)], ["", "\n"][usize::from(k % 5 == 4)]))
            .collect();
        let text = format!(
            "Corrected acceleration    (Format v01.20 with 13 text lines)\nSta Chan   1:270 deg (Rcrdr Chan  1) Location:10\n\
             \x20100 Real-header values follow on  20 lines, Format= (5F15.6)\n{values}   1 Comment line(s) follow, each starting with a \"|\":\n\
             | Sensor: Kinemetrics_Episensor\n   12 acceleration pts, approx  0 secs, units=cm/s^2 (4),Format=(10F8.5)\n\
             -0.00003-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004\n 0.00001 0.00002\n\
             End-of-data for Chan  1 acceleration\n"
        );
        let (table, names) = table_of(&text);
        assert_eq!(names, ["time", "channel 1 270 deg acceleration"]);
        assert_eq!((table.rows(), table.columns[0].values[1], table.columns[1].values[11]), (12, 0.01, 0.00002));
        assert_eq!(table.columns[1].values[1], -0.00004);
    }

    const NEW: &str = "PEER NGA STRONG MOTION DATABASE RECORD\nImperial Valley-02, 5/19/1940, El Centro Array #9, 180\n\
                       ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=     7, DT=   .0100 SEC,\n\
                       \x20  .1234567E-02  -.2345678E-02   .3000000E-02   .4000000E-02  -.5000000E-02\n\
                       \x20  .6000000E-02   .7000000E-02\n";

    #[test]
    fn a_series_is_one_column_whatever_its_lines() {
        let (table, names) = table_of(NEW);
        assert_eq!(names, ["time", "acceleration"]);
        assert_eq!(table.columns[1].unit.as_deref(), Some("g"));
        assert_eq!(table.columns[1].values, [0.001234567, -0.002345678, 0.003, 0.004, -0.005, 0.006, 0.007]);
        assert_eq!(table.columns[0].values[6], 0.06);
        assert_eq!((table.line(0), table.line(5)), (5, 6));
        assert_eq!(table.form, "PEER (AT2): 1 series of 7 numbers, 0.01 s apart");
    }

    #[test]
    fn older_headers_and_velocities_are_known_and_what_is_missing_is_said() {
        let old = "PEER STRONG MOTION DATABASE\nVELOCITY TIME HISTORY IN UNITS OF CM/S\n    6    0.0200    NPTS, DT\n 1 2 3\n 4 5\n";
        let (table, names) = table_of(old);
        assert_eq!((names[1].as_str(), table.rows()), ("velocity", 5));
        assert_eq!(table.columns[1].unit.as_deref(), Some("cm/s"));
        assert_eq!(table.remarks, ["`velocity` has 5 numbers, but its header tells of 6"]);
        let more = NEW.replace("NPTS=     7", "NPTS=     5");
        let (table, _) = table_of(&more);
        assert_eq!((table.rows(), table.remarks.len()), (5, 1));
        assert!(table.remarks[0].contains("1 line(s) of numbers behind the last series"), "{:?}", table.remarks);
    }

    fn series(name: &str, start: &str, numbers: &str) -> String {
        let count = numbers.split_whitespace().count();
        format!("TIMESERIES {name}, {count} samples, 50 sps, 2024-05-01T00:00:{start}, SLIST, FLOAT, M/S\n{numbers}\n")
    }

    #[test]
    fn channels_stand_side_by_side_at_their_times() {
        let text =
            series("XX_A__HHZ_R", "01.000000", "1 2 3\n4 5 6") + &series("XX_A__HHN_R", "01.040000", "-1.5E-3 7\n8");
        let (table, names) = table_of(&text);
        assert_eq!(names, ["time", "XX_A__HHZ_R", "XX_A__HHN_R"]);
        assert_eq!(table.columns[1].values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(table.columns[2].values[2..5], [-0.0015, 7.0, 8.0]);
        assert!(table.columns[2].values[0].is_nan() && table.columns[2].values[5].is_nan());
        assert_eq!((table.columns[0].values[1], table.columns[1].unit.as_deref()), (0.02, Some("m/s")));
    }

    #[test]
    fn a_series_in_pieces_is_one_column_with_a_gap() {
        let text = series("XX_A__HHZ_R", "01.000000", "1 2") + &series("XX_A__HHZ_R", "01.080000", "5 6");
        let (table, names) = table_of(&text);
        assert_eq!(names, ["time", "XX_A__HHZ_R"]);
        assert_eq!(format!("{:?}", table.columns[1].values), "[1.0, 2.0, NaN, NaN, 5.0, 6.0]");
    }

    fn set(function: u32, quantity: u32, [kind, count, is_even]: [usize; 3], data: &str) -> String {
        format!(
            "    -1\n    58\nBeam\nNONE\n01-May-24 12:00:00\nNONE\nNONE\n\
             {function:5}         1    0         0 NONE               7   3 NONE               1   3\n\
             {kind:10}{count:10}{is_even:10}    0.00000e0   5.00000e-3    0.00000e0\n\
             \x20       17    0    0    0 Time                 s                   \n\
             {quantity:10}    0    0    0 Response             m/s^2               \n\
             \x20        0    0    0    0 NONE                 NONE                \n\
             \x20        0    0    0    0 NONE                 NONE                \n{data}    -1\n"
        )
    }

    #[test]
    fn functions_of_time_are_columns_and_others_are_left_out() {
        let numbers = "  1.00000e+00 -2.00000e+00  3.00000e+00  4.00000e+00  5.00000e+00  6.00000e+00\n  7.00000e+00\n";
        let forces: String =
            (0..7).map(|k| format!("{:20.12}{}", f64::from(k) + 0.25, ["", "\n"][usize::from(k % 4 == 3)])).collect();
        let spectrum = "  1.00000e+00  0.00000e+00  2.00000e+00  1.00000e+00\n";
        let units = "    -1\n   164\n         1  SI: Meter (newton)         2\n  1.0 1.0 1.0\n    -1\n";
        let text = units.to_owned()
            + &set(1, 12, [2, 7, 1], numbers)
            + &set(4, 12, [5, 2, 1], spectrum)
            + &set(1, 13, [4, 7, 1], &(forces + "\n"));
        let (table, names) = table_of(&text);
        assert_eq!(names, ["time", "Beam acceleration 7 +Z", "Beam force 7 +Z"]);
        assert_eq!(table.columns[1].values, [1.0, -2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        assert_eq!(table.columns[2].values[6], 6.25);
        assert_eq!((table.columns[0].values[2], table.columns[1].unit.as_deref()), (0.01, Some("m/s^2")));
        assert_eq!(table.remarks, ["`Beam acceleration 7 +Z` is no function of time; it is left out"]);
    }

    #[test]
    fn uneven_functions_bring_their_times() {
        let pairs = "  0.00000e+00  1.00000e+00  1.00000e-01  2.00000e+00  2.50000e-01  3.00000e+00\n";
        let (table, names) = table_of(&set(1, 8, [2, 3, 0], pairs));
        assert_eq!(names, ["time", "Beam displacement 7 +Z"]);
        assert_eq!(
            (table.columns[0].values.as_slice(), table.columns[1].values.as_slice()),
            (&[0.0, 0.1, 0.25][..], &[1.0, 2.0, 3.0][..])
        );
    }
}
