//! Traces of Tektronix' oscilloscopes of the series TDS: settings in the first three cells of the first lines, then time and value.
//!
//! Source: Tektronix, TDS2MEM storage memory module user manual, "Spreadsheet file formats".

use super::{Layout, Rows};

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
    let cells = |line: &&str| line.split(',').map(|cell| cell.trim().trim_matches('"').to_owned()).collect::<Vec<_>>();
    let head: Vec<Vec<String>> = lines.iter().take(30).map(cells).collect();
    let begins = |place: usize, word: &str| head.get(place).is_some_and(|cells| cells[0] == word && cells.len() >= 5);
    if !(begins(0, "Record Length") && begins(1, "Sample Interval")) {
        return None;
    }
    let setting = |key: &str| {
        let line = head.iter().find(|cells| cells[0] == key)?;
        line.get(1).filter(|value| !value.is_empty()).cloned()
    };
    let mut rows = Rows::new(1);
    let (time, value) =
        (("time".to_owned(), setting("Horizontal Units")), setting("Source").unwrap_or("CH1".to_owned()));
    rows.cells = vec![None, None, None, Some(time), Some((value, setting("Vertical Units")))];
    Some(Layout::Rows(rows))
}

#[cfg(test)]
mod tests {
    use super::super::tests::table_of;

    #[test]
    fn settings_are_no_columns() {
        let text = "Record Length,2.500000e+03,,-0.005000000000,  0.00000,\nSample Interval,4.000000e-06,,-0.004996000000,  0.00160,\n\
                    Trigger Point,1.250000000000e+03,,-0.004992000000, -0.00320,\n,,,-0.004988000000,  0.00480,\n,,,-0.004984000000,  0.00160,\n\
                    ,,,-0.004980000000,  0.00160,\nSource,CH2,,-0.004976000000,  0.00000,\nVertical Units,V,,-0.004972000000,  0.00160,\n\
                    Vertical Scale,2.000000e-02,,-0.004968000000,  0.00160,\nHorizontal Units,s,,-0.004964000000,  0.00000,\n\
                    ,,,-0.004960000000,  0.00160,\n";
        let (table, names) = table_of(text);
        assert_eq!(names, ["time", "CH2"]);
        assert_eq!((table.rows(), table.columns[0].values[2], table.columns[1].values[3]), (11, -0.004992, 0.0048));
        assert_eq!((table.columns[0].unit.as_deref(), table.columns[1].unit.as_deref()), (Some("s"), Some("V")));
    }
}
