//! Unrolled loops: a thread's numbers are kept in registers only if the compiler knows each index.

use std::fmt::Write as _;

/// A text in WGSL in which loops of the form `for (var i = FIRST; i < END; i++) {` are unrolled, if constants give
/// their bounds. The body begins on the next line, and its closing bracket has its own line. Any other loop stays, as one with `i
/// += 1u` does.
pub fn unrolled(text: &str, constants: &[(&str, usize)]) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let mut out = String::with_capacity(4 * text.len());
    let known = constants.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
    Unroller { known, variables: Vec::new() }.write(&lines, &mut out);
    out
}

struct Unroller {
    known: Vec<(String, usize)>,
    /// The variables of the loops around, with their values.
    variables: Vec<(String, usize)>,
}

impl Unroller {
    fn write(&mut self, lines: &[&str], out: &mut String) {
        let (mut next, outside) = (0, self.variables.len());
        while let Some(line) = lines.get(next) {
            next += 1;
            let line = self.substituted(line);
            if let Some((name, value)) = self.constant(&line) {
                self.variables.push((name, value));
                continue;
            }
            let Some((variable, range)) = self.counted(&line) else {
                out.push_str(&line);
                out.push('\n');
                continue;
            };
            let length = body(&lines[next..]);
            for value in range {
                out.push_str("{\n");
                self.variables.push((variable.clone(), value));
                self.write(&lines[next..next + length], out);
                self.variables.pop();
                out.push_str("}\n");
            }
            next += length + 1;
        }
        self.variables.truncate(outside);
    }

    /// The name and the value of a constant in a loop.
    fn constant(&self, line: &str) -> Option<(String, usize)> {
        let (name, value) = line.trim().strip_prefix("let ")?.strip_suffix(';')?.split_once(" = ")?;
        (!self.variables.is_empty()).then_some((name.to_owned(), self.value(value)?))
    }

    /// The variable of a loop, and its values.
    fn counted(&self, line: &str) -> Option<(String, std::ops::Range<usize>)> {
        let head = line.trim().strip_prefix("for (var ")?.strip_suffix("++) {")?;
        let mut parts = head.split("; ");
        let (variable, first) = parts.next()?.split_once(" = ")?;
        let limit = parts.next()?.strip_prefix(variable)?;
        let (end, more) = match limit.strip_prefix(" <= ") {
            Some(end) => (end, 1),
            None => (limit.strip_prefix(" < ")?, 0),
        };
        Some((variable.to_owned(), self.value(first)?..self.value(end)? + more))
    }

    /// The value of sums of products of numbers and constants, less others, or of the place of an entry of a triangle.
    fn value(&self, text: &str) -> Option<usize> {
        if let Some(places) = text.strip_prefix("at(").and_then(|text| text.strip_suffix(')')) {
            let (row, column) = places.split_once(", ")?;
            let row = self.value(row)?;
            return Some(row * (row + 1) / 2 + self.value(column)?);
        }
        let factor = |factor: &str| {
            let known = self.known.iter().find(|(name, _)| name == factor).map(|(_, value)| *value);
            known.or_else(|| factor.strip_suffix('u')?.parse().ok())
        };
        let sum =
            |text: &str| text.split(" + ").map(|term| term.split(" * ").map(factor).product::<Option<usize>>()).sum();
        let mut parts = text.split(" - ").map(sum);
        let first: usize = parts.next()??;
        parts.try_fold(first, |rest, less: Option<usize>| rest.checked_sub(less?))
    }

    /// A line with the values of the loops' variables in place of their names, and those of indices.
    fn substituted(&self, line: &str) -> String {
        if self.variables.is_empty() {
            return line.to_owned();
        }
        let mut named = String::with_capacity(line.len());
        for word in words(line) {
            match self.variables.iter().rev().find(|(name, _)| name == word) {
                Some((_, value)) => write!(named, "{value}u").unwrap_or_default(),
                None => named.push_str(word),
            }
        }
        let mut out = String::with_capacity(named.len());
        let mut pieces = named.split('[');
        out.push_str(pieces.next().unwrap_or_default());
        for piece in pieces {
            out.push('[');
            match piece.split_once(']').and_then(|(index, rest)| Some((self.value(index)?, rest))) {
                Some((value, rest)) => write!(out, "{value}u]{rest}").unwrap_or_default(),
                None => out.push_str(piece),
            }
        }
        out
    }
}

/// The number of lines before the one that closes a block.
fn body(lines: &[&str]) -> usize {
    let mut depth = 1;
    for (length, line) in lines.iter().enumerate() {
        for c in line.chars() {
            depth += i32::from(c == '{') - i32::from(c == '}');
            if depth == 0 {
                return length;
            }
        }
    }
    lines.len()
}

/// A line as names and single characters; the name after a point belongs to it.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
    let mut rest = line;
    std::iter::from_fn(move || {
        let length = match rest.find(|c| !is_of_name(c)) {
            Some(0) => rest.chars().next()?.len_utf8(),
            Some(length) => length,
            None => rest.len(),
        };
        let (word, others) = rest.split_at(length);
        rest = others;
        (!word.is_empty()).then_some(word)
    })
}
