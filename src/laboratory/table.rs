//! The numbers of a map as CSV.

use std::fmt::Write as _;

use super::Survey;

impl Survey {
    pub fn to_csv(&self) -> String {
        let ensemble = self.ensemble();
        let [only, ..] = &ensemble.scenario().filters[..] else { return String::new() };
        let key = |key: &str| match (self.filters().len(), key.strip_prefix("filters.*.")) {
            (1, Some(rest)) => format!("filters.{}.{rest}", only.name),
            _ => ensemble.scenario().address_by_name(key),
        };
        let keys = ensemble.plan().axes.iter().map(|axis| key(&axis.key));
        let names: Vec<String> = keys.chain(ensemble.columns()).map(|name| quoted(&name)).collect();
        let mut text = names.join(",");
        text.push('\n');
        for cell in 0..ensemble.cells() {
            let row = self.sheet().row(cell);
            let unknown = vec![f64::NAN; ensemble.width()];
            let numbers = ensemble.values(cell).into_iter().chain(row.unwrap_or(&unknown).iter().copied());
            for (at, number) in numbers.enumerate() {
                let comma = if at > 0 { "," } else { "" };
                // Writing to a string cannot fail.
                let _ = if number.is_nan() { write!(text, "{comma}") } else { write!(text, "{comma}{number}") };
            }
            text.push('\n');
        }
        text
    }
}

pub(super) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
