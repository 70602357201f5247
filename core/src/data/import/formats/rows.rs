//! Formats with rows, of instruments and loggers: LabVIEW, Rigol, Tektronix and Campbell Scientific.

use super::Layout;
use crate::data::import::table::Rows;
use crate::data::import::unit::name_and_unit;
use crate::data::import::{Decimal, Delimiter, Dialect};

const END: &str = "***End_of_Header***";

/// A table with commas between cells and decimal points; `data` is the first line of numbers, counted from 1.
fn rows_from(data: usize) -> Rows {
    Rows::of(Dialect { delimiter: Delimiter::Comma, decimal: Decimal::Point, data, ..Dialect::default() })
}

/// Measurement files of LabVIEW: a header of the file, one of the segment, a line of names, then rows.
///
/// Source: National Instruments (2010), Specification for the LabVIEW measurement file (.lvm).
pub(super) fn lvm(lines: &[&str]) -> Option<Layout> {
    if !lines.first()?.starts_with("LabVIEW Measurement") {
        return None;
    }
    let ends: Vec<usize> = (0..lines.len()).filter(|&place| lines[place].trim_end().starts_with(END)).take(2).collect();
    let [first, last] = *ends.as_slice() else { return None };
    let tag = |key: &str| lines[..first].iter().find_map(|line| line.strip_prefix(key)).map(str::trim);
    let delimiter =
        if tag("Separator").is_some_and(|word| word.starts_with("Comma")) { Delimiter::Comma } else { Delimiter::Tab };
    // The numbers of the segment's header, one a channel.
    let segment = |key: &str| -> Vec<String> {
        let line = lines[first..last].iter().find(|line| line.starts_with(key));
        line.map(|line| delimiter.cells(line).skip(1).map(str::to_owned).collect()).unwrap_or_default()
    };
    let mut rows = rows_from(last + 3);
    rows.dialect.delimiter = delimiter;
    if tag("Decimal_Separator") == Some(",") {
        rows.dialect.decimal = Decimal::Comma;
    }
    rows.ends = |line| line.starts_with("Channels") || line.starts_with(END);
    let names: Vec<&str> = delimiter.cells(lines.get(last + 1)?).collect();
    let units = segment("Y_Unit_Label");
    let number = |key: &str| rows.dialect.decimal.number(segment(key).first()?);
    let has_times = tag("X_Columns").is_none_or(|columns| columns != "No");
    if !has_times {
        let step = number("Delta_X").filter(|step| *step > 0.0)?;
        rows.even = Some((number("X0").unwrap_or(0.0), step));
    }
    let (mut channel, mut times) = (0, 0);
    let cell = |name: &&str| match *name {
        // With several columns of times all channels have the same step.
        "X_Value" => {
            times += 1;
            (times == 1 && has_times).then(|| ("time".to_owned(), Some("s".to_owned())))
        }
        "Comment" => None,
        name => {
            channel += 1;
            let unit = units.get(channel - 1).filter(|unit| !unit.is_empty()).cloned();
            Some((name.to_owned(), unit))
        }
    };
    let cells = names.iter().map(cell).collect();
    Some(Layout::Rows(Rows { cells, ..rows }))
}

/// Traces of Rigol's oscilloscopes: the numbers of the samples, with start and increment of the time in the header.
///
/// Source: Rigol, DS1000Z and MSO5000 user's guides, "To store a waveform: CSV".
pub(super) fn rigol(lines: &[&str]) -> Option<Layout> {
    let [names, second, ..] = lines else { return None };
    let names: Vec<&str> = names.trim().split(',').map(str::trim).collect();
    let is_first = ["X", "Time(s)"].contains(names.first()?);
    // `X,CH1,Start,Increment,` with the two numbers below, or `Time(s),CH1(V),t0 = -1e-3, tInc = 1e-6,`.
    let below: Vec<&str> = second.trim().split(',').map(str::trim).collect();
    let number = |word: &str, short: &str| {
        let place = names.iter().position(|name| *name == word);
        let inline = names.iter().find_map(|name| name.strip_prefix(short)?.trim_start().strip_prefix('='));
        place.and_then(|place| below.get(place).copied()).or(inline)?.trim().parse::<f64>().ok()
    };
    let (start, step) = (number("Start", "t0")?, number("Increment", "tInc").filter(|step| *step > 0.0)?);
    let is_header = below.first().is_some_and(|cell| cell.starts_with(char::is_alphabetic));
    let mut rows = rows_from(if is_header { 3 } else { 2 });
    rows.even = Some((start, step));
    let cell = |(place, name): (usize, &&str)| {
        let unit = below.get(place).filter(|_| is_header).map(|unit| (*unit).to_owned());
        let (name, own) = name_and_unit(name);
        name.to_ascii_uppercase().starts_with("CH").then(|| (name, own.or(unit)))
    };
    rows.cells = names.iter().enumerate().map(cell).collect();
    is_first.then_some(Layout::Rows(rows))
}

/// Traces of Tektronix' oscilloscopes of the series TDS: settings in the first three cells of the first lines, then time and value.
///
/// Source: Tektronix, TDS2MEM storage memory module user manual, "Spreadsheet file formats".
pub(super) fn tektronix(lines: &[&str]) -> Option<Layout> {
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
    let mut rows = rows_from(1);
    let (time, value) =
        (("time".to_owned(), setting("Horizontal Units")), setting("Source").unwrap_or("CH1".to_owned()));
    rows.cells = vec![None, None, None, Some(time), Some((value, setting("Vertical Units")))];
    Some(Layout::Rows(rows))
}

/// Tables of Campbell Scientific's loggers: the station, names, units and processing in four lines.
///
/// Source: Campbell Scientific (2019), LoggerNet instruction manual, appendix B.1.4, "TOA5 ASCII file format".
pub(super) fn toa5(lines: &[&str]) -> Option<Layout> {
    let is_toa5 =
        lines.first()?.trim_start_matches('\u{FEFF}').trim_matches('"').starts_with("TOA5") && lines.len() > 4;
    let mut rows = rows_from(5);
    (rows.dialect.names, rows.dialect.units) = (2, 3);
    is_toa5.then_some(Layout::Rows(rows))
}

#[cfg(test)]
mod tests {
    use super::super::tests::table_of;

    fn file(columns: &str, names: &str, rows: &str) -> String {
        format!(
            "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tYes\n\
             X_Columns\t{columns}\nTime_Pref\tRelative\nOperator\tLab\nDate\t2024/05/01\nTime\t12:00:00.0000000000000000000\n\
             ***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t2\t\nDate\t2024/05/01\t2024/05/01\t\nTime\t12:00:00.5\t12:00:00.5\t\n\
             Y_Unit_Label\tm/s^2\tN\t\nX_Dimension\tTime\tTime\t\nX0\t0.0000000000000000E+0\t0.0000000000000000E+0\t\n\
             Delta_X\t2.500000E-1\t2.500000E-1\t\n***End_of_Header***\t\t\t\n{names}\n{rows}"
        )
    }

    #[test]
    fn one_column_of_times_and_channels_of_unequal_length_are_read() {
        let text = file(
            "One",
            "X_Value\tAcceleration\tForce\tComment",
            "0.000000\t1.5\t2.5\tfirst\n0.250000\t1.25\t2.25\n0.500000\t1.0\t\n\t\t\t\n",
        );
        let (table, names) = table_of(&text);
        assert_eq!(names, ["time", "Acceleration", "Force"]);
        assert_eq!((table.columns[1].unit.as_deref(), table.columns[2].unit.as_deref()), (Some("m/s^2"), Some("N")));
        assert_eq!(table.columns[1].values, [1.5, 1.25, 1.0]);
        assert!(table.columns[2].values[2].is_nan());
    }

    #[test]
    fn without_times_the_step_of_the_header_counts_and_other_segments_are_told() {
        let rows = "\t1.5\t2.5\n\t1.25\t2.25\n\t1.0\t2.0\n\nChannels\t2\nSamples\t3\t3\n***End_of_Header***\nX_Value\tA\tB\n\t9\t9\n";
        let (table, names) = table_of(&file("No", "X_Value\tAcceleration\tForce\tComment", rows));
        assert_eq!(names, ["time", "Acceleration", "Force"]);
        assert_eq!((table.rows(), table.columns[0].values[2], table.columns[1].values[2]), (3, 0.5, 1.0));
        assert_eq!(table.remarks, ["line 28 begins another table; it is left out, with all below it"]);
        let comma = file("No", "X_Value\tA\tB", "\t1,5\t2\n\t1\t2\n")
            .replace("Decimal_Separator\t.", "Decimal_Separator\t,")
            .replace("2.500000E-1", "0,25");
        assert_eq!(table_of(&comma).0.columns[0].values[1], 0.25);
    }

    #[test]
    fn of_several_columns_of_times_the_first_counts() {
        let text = file("Multi", "X_Value\tA\tX_Value\tB\tComment", "0.0\t1\t0.0\t2\n0.25\t3\t0.25\t4\n");
        let (table, names) = table_of(&text);
        assert_eq!(names, ["time", "A", "B"]);
        assert_eq!(table.columns[2].values, [2.0, 4.0]);
    }

    #[test]
    fn times_follow_from_start_and_increment() {
        let (table, names) = table_of(
            "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-2.000000e-03,1.000000e-03\n0,1.0e-01,2.0e-02,,\n1,1.1e-01,2.1e-02,,\n2,1.2e-01,2.2e-02,,\n",
        );
        assert_eq!(names, ["time", "CH1", "CH2"]);
        assert_eq!(table.columns[0].values, [-0.002, -0.001, 0.0]);
        assert_eq!((table.columns[1].unit.as_deref(), table.columns[2].values[2]), (Some("Volt"), 0.022));
        let (table, names) = table_of("Time(s),CH1(V),t0 = -5e-01, tInc = 2.5e-01,\n,0.5,,\n,0.25,,\n,0.125,,\n");
        assert_eq!(names, ["time", "CH1"]);
        assert_eq!((table.columns[0].values[2], table.columns[1].values[2]), (0.0, 0.125));
    }

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
