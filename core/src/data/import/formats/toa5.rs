//! Tables of Campbell Scientific's loggers: the station, names, units and processing in four lines.
//!
//! Source: Campbell Scientific (2019), LoggerNet instruction manual, appendix B.1.4, "TOA5 ASCII file format".

use super::{Layout, Rows};

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
    let is_toa5 =
        lines.first()?.trim_start_matches('\u{FEFF}').trim_matches('"').starts_with("TOA5") && lines.len() > 4;
    let mut rows = Rows::new(5);
    (rows.dialect.names, rows.dialect.units) = (2, 3);
    is_toa5.then_some(Layout::Rows(rows))
}

#[cfg(test)]
mod tests {
    use super::super::tests::table_of;

    #[test]
    fn names_and_units_stand_in_the_second_and_third_line() {
        let text = "\"TOA5\",\"Bridge\",\"CR6\",\"1234\",\"CR6.Std.08\",\"CPU:acc.CR6\",\"51234\",\"Fast\"\n\
                    \"TIMESTAMP\",\"RECORD\",\"Accel_1\",\"Batt_V\"\n\"TS\",\"RN\",\"m/s^2\",\"Volts\"\n\"\",\"\",\"Smp\",\"Smp\"\n\
                    \"2024-05-01 12:00:00\",0,0.125,12.5\n\"2024-05-01 12:00:00.02\",1,-0.25,12.5\n\
                    \"2024-05-01 12:00:00.04\",2,\"NAN\",12.5\n";
        let (table, names) = table_of(text);
        assert_eq!(names, ["TIMESTAMP", "RECORD", "Accel_1", "Batt"]);
        assert_eq!(table.columns[2].unit.as_deref(), Some("m/s^2"));
        assert_eq!((table.rows(), table.columns[2].values[1]), (3, -0.25));
        assert!(table.form.starts_with("Campbell TOA5: UTF-8, commas"), "{}", table.form);
        let (mapping, _) = crate::data::import::Mapping::guess(&table);
        assert_eq!(mapping.time.column.as_deref(), Some("TIMESTAMP"));
        assert!(mapping.input.is_none(), "neither the row's number nor the battery is a force");
    }
}
