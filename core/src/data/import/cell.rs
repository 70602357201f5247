//! Cells of a line.

use serde::{Deserialize, Serialize};

/// The delimiter between the cells of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delimiter {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// A tab.
    Tab,
    /// Blanks and tabs, any number of them.
    Blanks,
}

impl Delimiter {
    /// Every delimiter.
    pub const ALL: [Self; 4] = [Self::Comma, Self::Semicolon, Self::Tab, Self::Blanks];

    /// Its name, in the plural.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Blanks => "blanks",
        }
    }

    /// The cells of a line, without the blanks and quotes around them.
    pub fn cells(self, line: &str) -> Cells<'_> {
        let line = if self == Self::Tab { line.trim_end_matches(['\r', '\n']) } else { line.trim() };
        Cells { delimiter: self, rest: Some(line) }
    }

    fn is(self, character: char) -> bool {
        match self {
            Self::Comma => character == ',',
            Self::Semicolon => character == ';',
            Self::Tab => character == '\t',
            Self::Blanks => character == ' ' || character == '\t',
        }
    }
}

/// Iterates over the cells of a line.
pub struct Cells<'a> {
    delimiter: Delimiter,
    rest: Option<&'a str>,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest?;
        let start = rest.trim_start_matches(' ');
        // Within quotes a delimiter is a part of the cell; a quote that nothing ends is a character like others.
        let quoted = start.strip_prefix('"').and_then(|inner| inner.split_once('"'));
        let (cell, after) = match quoted {
            Some((cell, after)) => (cell, after.find(|c| self.delimiter.is(c)).map(|end| &after[end..])),
            None => match rest.find(|c| self.delimiter.is(c)) {
                Some(end) => (&rest[..end], Some(&rest[end..])),
                None => (rest, None),
            },
        };
        self.rest = after.map(|after| match self.delimiter {
            Delimiter::Blanks => after.trim_start_matches([' ', '\t']),
            _ => &after[1..],
        });
        Some(cell.trim())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(delimiter: Delimiter, line: &str) -> Vec<&str> {
        delimiter.cells(line).collect()
    }

    #[test]
    fn lines_are_split_at_their_delimiter() {
        assert_eq!(cells(Delimiter::Comma, "1, 2,3,\r\n"), ["1", "2", "3", ""]);
        assert_eq!(cells(Delimiter::Semicolon, "1,5;;2,5"), ["1,5", "", "2,5"]);
        assert_eq!(cells(Delimiter::Tab, "\t1\t2\n"), ["", "1", "2"]);
        assert_eq!(cells(Delimiter::Blanks, "  1.0   2.0\t3.0 \n"), ["1.0", "2.0", "3.0"]);
        assert_eq!(cells(Delimiter::Comma, "\"Angle, left\",\"1,5\" ,x"), ["Angle, left", "1,5", "x"]);
        assert_eq!(cells(Delimiter::Blanks, "\"two words\" b"), ["two words", "b"]);
        assert_eq!(cells(Delimiter::Comma, "5\" pipe,2"), ["5\" pipe", "2"]);
        assert_eq!(cells(Delimiter::Comma, "\"open,2"), ["\"open", "2"]);
        assert_eq!(cells(Delimiter::Comma, ""), [""]);
    }
}
