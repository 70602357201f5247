//! Measurement files of LabVIEW: a header of the file, one of the segment, a line of names, then rows.
//!
//! Source: National Instruments (2010), Specification for the LabVIEW measurement file (.lvm).

use super::{Layout, Rows};
use crate::data::import::{Decimal, Delimiter};

const END: &str = "***End_of_Header***";

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
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
    let mut rows = Rows::new(last + 3);
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
}
