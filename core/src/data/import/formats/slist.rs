//! Series as ObsPy and the web services of seismological data centres write them: `TIMESERIES` and a line of numbers after the other.
//!
//! Source: EarthScope Consortium, `timeseries` web service, format `ascii` (SLIST).

use super::super::clock::clock;
use super::super::series::Series;
use super::Layout;

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
    let first = lines.first()?;
    (first.starts_with("TIMESERIES ") && first.contains(", SLIST,")).then_some(Layout::Series(next))
}

/// `TIMESERIES NL_HGN_02_BHZ_R, 11947 samples, 40 sps, 2003-05-29T02:13:22.043400, SLIST, FLOAT, Counts`.
fn next(header: &[String]) -> Option<Series> {
    let mut parts = header.last()?.strip_prefix("TIMESERIES ")?.split(',').map(str::trim);
    let name = parts.next()?.to_owned();
    let count = parts.next()?.strip_suffix("samples")?.trim().parse().ok()?;
    let rate: f64 = parts.next()?.strip_suffix("sps")?.trim().parse().ok()?;
    let (start, _) = clock(parts.next()?)?;
    // The services write units in capitals.
    let unit = parts.nth(2).filter(|unit| !unit.is_empty()).map(str::to_lowercase);
    Some(Series { name, unit, start, dt: 1.0 / rate, count: Some(count), ..Series::default() })
}

#[cfg(test)]
mod tests {
    use super::super::tests::table_of;

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
}
