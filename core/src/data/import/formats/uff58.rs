//! Universal files of modal analysis: data sets 58 with functions of time, as text.
//!
//! Source: University of Cincinnati, Structural Dynamics Research Laboratory, Universal file formats for modal analysis testing, data
//! set 58.

use super::super::series::Series;
use super::Layout;

/// The lines of a data set's header, with the number 58.
const HEADER: usize = 12;

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
    let begins = |pair: &[&str]| pair[0].trim() == "-1" && pair[1].trim() == "58";
    (lines.first()?.trim() == "-1" && lines.windows(2).any(begins)).then_some(Layout::Series(next))
}

fn next(header: &[String]) -> Option<Series> {
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

    fn set(function: u32, quantity: u32, [kind, count, is_even]: [usize; 3], data: &str) -> String {
        format!(
            "    -1\n    58\nBeam\nNONE\n01-May-24 12:00:00\nNONE\nNONE\n\
             {function:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n\
             {kind:10}{count:10}{is_even:10}{:13.5e}{:13.5e}{:13.5e}\n\
             {:10}{:5}{:5}{:5} {:<20} {:<20}\n{quantity:10}{:5}{:5}{:5} {:<20} {:<20}\n\
             {:10}{:5}{:5}{:5} {:<20} {:<20}\n{:10}{:5}{:5}{:5} {:<20} {:<20}\n{data}    -1\n",
            1,
            0,
            0,
            "NONE",
            7,
            3,
            "NONE",
            1,
            3,
            0.0,
            0.005,
            0.0,
            17,
            0,
            0,
            0,
            "Time",
            "s",
            0,
            0,
            0,
            "Response",
            "m/s^2",
            0,
            0,
            0,
            0,
            "NONE",
            "NONE",
            0,
            0,
            0,
            0,
            "NONE",
            "NONE"
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
