//! Traces of Rigol's oscilloscopes: the numbers of the samples, with start and increment of the time in the header.
//!
//! Source: Rigol, DS1000Z and MSO5000 user's guides, "To store a waveform: CSV".

use super::{Layout, Rows};
use crate::data::import::unit::name_and_unit;

pub(super) fn find(lines: &[&str]) -> Option<Layout> {
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
    let mut rows = Rows::new(if is_header { 3 } else { 2 });
    rows.even = Some((start, step));
    let cell = |(place, name): (usize, &&str)| {
        let unit = below.get(place).filter(|_| is_header).map(|unit| (*unit).to_owned());
        let (name, own) = name_and_unit(name);
        name.to_ascii_uppercase().starts_with("CH").then(|| (name, own.or(unit)))
    };
    rows.cells = names.iter().enumerate().map(cell).collect();
    is_first.then_some(Layout::Rows(rows))
}

#[cfg(test)]
mod tests {
    use super::super::tests::table_of;

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
}
