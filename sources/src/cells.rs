//! The cells of a line.

use kalmanscope_core::Document;

/// The contents of a line.
pub(crate) enum Cells {
    Nothing,
    Names(Vec<String>),
    /// Numbers. Those of an object have names and are in the order of these.
    Numbers(Vec<f64>, Option<Vec<String>>),
}

impl Cells {
    /// Reads cells between commas, semicolons, tabs or blanks, or a JSON object. An empty line, a comment and a line of which only
    /// some cells are numbers are nothing.
    pub(crate) fn of(line: &[u8]) -> Self {
        let Ok(text) = std::str::from_utf8(line) else { return Self::Nothing };
        let text = text.trim().trim_start_matches('\u{feff}');
        match text.chars().next() {
            None | Some('#') => Self::Nothing,
            Some('{') => object(text),
            Some(_) => row(text),
        }
    }
}

fn object(text: &str) -> Cells {
    let Ok(Document::Table(entries)) = Document::from_json(text) else { return Cells::Nothing };
    let number = |(key, value): (String, Document)| match value {
        Document::Number(number) => Some((key, number)),
        Document::Integer(number) => Some((key, number as f64)),
        _ => None,
    };
    let mut numbers: Vec<(String, f64)> = entries.into_iter().filter_map(number).collect();
    // Objects may have their keys in any order.
    numbers.sort_by(|a, b| a.0.cmp(&b.0));
    let (names, numbers) = numbers.into_iter().unzip();
    Cells::Numbers(numbers, Some(names))
}

fn row(text: &str) -> Cells {
    let mark = [';', '\t', ','].into_iter().find(|mark| text.contains(*mark));
    let cells: Vec<&str> = match mark {
        Some(mark) => text.split(mark).map(|cell| cell.trim().trim_matches('"')).collect(),
        None => text.split_whitespace().collect(),
    };
    let number = |cell: &&str| match cell.parse::<f64>() {
        Ok(number) => Some(number),
        // A decimal comma can stand only where cells are divided otherwise.
        Err(_) if mark == Some(';') || mark == Some('\t') => cell.replacen(',', ".", 1).parse().ok(),
        Err(_) => None,
    };
    let numbers: Vec<Option<f64>> = cells.iter().map(number).collect();
    if let Some(numbers) = numbers.iter().copied().collect() {
        return Cells::Numbers(numbers, None);
    }
    if numbers.iter().all(Option::is_none) {
        return Cells::Names(cells.into_iter().map(str::to_owned).collect());
    }
    Cells::Nothing
}
