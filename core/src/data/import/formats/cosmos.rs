//! Strong motions of the California Strong Motion Instrumentation Program (volume 2) and of COSMOS: pages of header,
//! then series of fixed width; their numbers may abut.
//!
//! Sources: Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, OSMS 85-03; COSMOS (2001), Strong motion
//! data format, version 1.20: the step is the real-header value 34.

use super::super::series::{Series, numbers};
use super::{Layout, field_width, number_after, text_after};

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
    lines.iter().find(|line| csmip(line).is_some() || cosmos(line).is_some())?;
    Some(Layout::Series(next))
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

fn next(header: &[String]) -> Option<Series> {
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
}
