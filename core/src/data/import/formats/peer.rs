//! Ground motions of the Pacific Earthquake Engineering Research Center: four lines of header, then one series, five numbers a line.
//!
//! Source: PEER (2013), NGA-West2 ground motion database, files of the kinds AT2, VT2 and DT2.

use super::super::series::Series;
use super::{Layout, number_after, text_after};

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
    lines.iter().take(6).find(|line| size(line).is_some())?;
    Some(Layout::Series(next))
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

fn next(header: &[String]) -> Option<Series> {
    let (count, dt) = size(header.last()?)?;
    let kind = header.iter().rev().find(|line| line.to_ascii_uppercase().contains("UNITS OF"));
    let unit = kind.and_then(|line| text_after(line, "units of", &[',', ';', ':', ')']));
    // G is what others write as g.
    let unit = unit.map(str::to_ascii_lowercase);
    let words = kind.map(|line| line.to_ascii_lowercase()).unwrap_or_default();
    let name = ["velocity", "displacement"].into_iter().find(|word| words.contains(word)).unwrap_or("acceleration");
    Some(Series { name: name.to_owned(), unit, dt, count: Some(count), ..Series::default() })
}

#[cfg(test)]
mod tests {
    use super::super::tests::table_of;

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
}
