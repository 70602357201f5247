//! Loops written out: numbers of a thread stand in registers only where the compiler knows each index.

use std::fmt::Write as _;

/// A text in WGSL in which loops of the form `for (var i = FIRST; i < END; i++) {` are written out, where constants give their
/// bounds. The body begins on the next line and ends with a line of its own. Any other loop stays, as one with `i += 1u` does.
pub(crate) fn unrolled(text: &str, constants: &[(&str, usize)]) -> String {
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
        let mut next = 0;
        while let Some(line) = lines.get(next) {
            next += 1;
            let line = self.substituted(line);
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

    /// The value of a sum of numbers and constants.
    fn value(&self, text: &str) -> Option<usize> {
        let term = |term: &str| {
            let known = self.known.iter().find(|(name, _)| name == term).map(|(_, value)| *value);
            known.or_else(|| term.strip_suffix('u')?.parse().ok())
        };
        text.split(" + ").map(|text| term(text.trim())).sum()
    }

    /// A line with the values of the loops' variables in place of their names.
    fn substituted(&self, line: &str) -> String {
        let mut out = String::with_capacity(line.len());
        for word in words(line) {
            match self.variables.iter().rev().find(|(name, _)| name == word) {
                Some((_, value)) => write!(out, "{value}u").unwrap_or_default(),
                None => out.push_str(word),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_with_constant_bounds_are_written_out() {
        let text =
            "for (var i = 0u; i < N; i++) {\n  for (var k = i + 1u; k <= N; k++) {\n    a[i] += b.i * k;\n  }\n}\n";
        let expected =
            "{\n{\n    a[0u] += b.i * 1u;\n}\n{\n    a[0u] += b.i * 2u;\n}\n}\n{\n{\n    a[1u] += b.i * 2u;\n}\n}\n";
        assert_eq!(unrolled(text, &[("N", 2)]), expected);
    }

    #[test]
    fn other_loops_stay() {
        for text in ["for (var i = 0u; i < N; i += 1u) {\n  a += i;\n}\n", "for (; k < settings.end; k++) {\n}\n"] {
            assert_eq!(unrolled(text, &[("N", 2)]), text);
        }
    }
}
