//! Functions in WGSL from a list of operations: values, derivatives, and differences; loops with constant bounds written out.

use std::fmt::Write as _;

use kalmanscope_core::internals::engine::{Builder, Function, Node, Operation};

/// Operations on a state `y` of some components and a force `f`, which is the input after them.
pub(crate) struct ShaderText<'a> {
    pub(crate) builder: &'a Builder,
    pub(crate) size: usize,
}

impl ShaderText<'_> {
    /// `NAME(y, f)`: numbers at their places in an array, zeros elsewhere. `None` if a constant does not fit single precision.
    /// Or `NAME(y, d, f)`: the changes from y to y + d, without a difference of numbers that are almost the same:
    /// ```text
    /// (a + α)(b + β) - a b = α (b + β) + a β,  sin(a + α) - sin(a) = 2 cos(a + α/2) sin(α/2), ...
    /// ```
    pub(crate) fn function(&self, name: &str, array: &str, outputs: &[(usize, Node)], changes: bool) -> Option<String> {
        let by = if changes { "d: array<f32, N>, " } else { "" };
        let mut text = format!("fn {name}(y: array<f32, N>, {by}f: f32) -> {array} {{\n  var out: {array};\n");
        for place in self.needed(outputs) {
            writeln!(text, "  let v{place} = {};", self.value(place)?).ok()?;
            if changes && self.change_name(Node::at(place)).is_some() {
                writeln!(text, "  let d{place} = {};", self.change(place)?).ok()?;
            }
        }
        for &(to, node) in outputs {
            let out = if changes { self.change_name(node) } else { Some(self.name(node)?) };
            out.into_iter().for_each(|out| _ = writeln!(text, "  out[{to}] = {out};"));
        }
        Some(text + "  return out;\n}\n")
    }

    fn operation(&self, place: usize) -> Operation {
        self.builder.operations()[place]
    }

    /// The places of the operations that have a line: constants and inputs have none.
    fn needed(&self, outputs: &[(usize, Node)]) -> Vec<usize> {
        let mut is_needed = vec![false; self.builder.operations().len()];
        outputs.iter().for_each(|(_, node)| is_needed[node.place()] = true);
        for place in (0..is_needed.len()).rev() {
            if is_needed[place] {
                for node in self.operation(place).operands().into_iter().flatten() {
                    is_needed[node.place()] = true;
                }
            }
        }
        let has_line = |&place: &usize| is_needed[place] && self.operation(place).operands()[0].is_some();
        (0..is_needed.len()).filter(has_line).collect()
    }

    fn name(&self, node: Node) -> Option<String> {
        match self.operation(node.place()) {
            Operation::Constant(bits) => literal(f64::from_bits(bits)),
            Operation::Input(input) if input as usize == self.size => Some("f".to_owned()),
            Operation::Input(input) => Some(format!("y[{input}]")),
            _ => Some(format!("v{}", node.place())),
        }
    }

    fn change_name(&self, node: Node) -> Option<String> {
        let of_state = (1_u64 << self.size) - 1;
        (self.builder.needs(node) & of_state != 0).then(|| match self.operation(node.place()) {
            Operation::Input(input) => format!("d[{input}]"),
            _ => format!("d{}", node.place()),
        })
    }

    fn value(&self, place: usize) -> Option<String> {
        let name = |node| self.name(node);
        Some(match self.operation(place) {
            Operation::Constant(_) | Operation::Input(_) => return None,
            Operation::Add(a, b) => format!("{} + {}", name(a)?, name(b)?),
            Operation::Subtract(a, b) => format!("{} - {}", name(a)?, name(b)?),
            Operation::Multiply(a, b) => format!("{} * {}", name(a)?, name(b)?),
            Operation::Divide(a, b) => format!("{} / {}", name(a)?, name(b)?),
            Operation::Negative(a) => format!("-{}", name(a)?),
            Operation::Call(function, a) => {
                let (of, _, more) = called(function)?;
                format!("{of}({}{more})", name(a)?)
            }
        })
    }

    fn change(&self, place: usize) -> Option<String> {
        let name = |node| self.name(node);
        let change = |node| self.change_name(node);
        Some(match self.operation(place) {
            Operation::Constant(_) | Operation::Input(_) => return None,
            Operation::Add(a, b) => match (change(a), change(b)) {
                (Some(da), Some(db)) => format!("{da} + {db}"),
                (da, db) => da.or(db)?,
            },
            Operation::Subtract(a, b) => match (change(a), change(b)) {
                (Some(da), Some(db)) => format!("{da} - {db}"),
                (Some(da), None) => da,
                (None, db) => format!("-{}", db?),
            },
            Operation::Multiply(a, b) => match (change(a), change(b)) {
                (Some(da), Some(db)) => format!("{da} * ({} + {db}) + {} * {db}", name(b)?, name(a)?),
                (Some(da), None) => format!("{da} * {}", name(b)?),
                (None, db) => format!("{} * {}", name(a)?, db?),
            },
            Operation::Divide(a, b) => match (change(a), change(b)) {
                (Some(da), Some(db)) => format!("({da} - v{place} * {db}) / ({} + {db})", name(b)?),
                (Some(da), None) => format!("{da} / {}", name(b)?),
                (None, Some(db)) => format!("-(v{place} * {db}) / ({} + {db})", name(b)?),
                (None, None) => return None,
            },
            Operation::Negative(a) => format!("-{}", change(a)?),
            Operation::Call(function, a) => {
                let (_, apart, more) = called(function)?;
                format!("{apart}({}, {}{more})", name(a)?, change(a)?)
            }
        })
    }
}

fn called(function: Function) -> Option<(&'static str, String, String)> {
    if let Function::Power(exponent) = function {
        let exponent = f64::from_bits(exponent);
        let parity = match exponent {
            whole if whole.fract() != 0.0 => 2,
            even if even % 2.0 == 0.0 => 0,
            _ => 1,
        };
        return Some(("power_of", "power_apart".to_owned(), format!(", {}, {parity}u", literal(exponent)?)));
    }
    let (_, name) = Function::NAMED.into_iter().find(|(other, _)| *other == function)?;
    let of = match function {
        Function::Log => "log_of",
        Function::Sqrt => "root_of",
        Function::Tanh => "tanh_of",
        _ => name,
    };
    Some((of, format!("{name}_apart"), String::new()))
}

/// A number in single precision. `None` if it overflows there.
pub(crate) fn literal(number: f64) -> Option<String> {
    let single = number as f32;
    let is_there = single.is_normal() || number == 0.0;
    let text = if single < 0.0 { format!("({single:?})") } else { format!("{:?}", single.abs()) };
    is_there.then_some(text)
}

/// A text in WGSL in which loops of the form `for (var i = FIRST; i < END; i++) {` are unrolled, if constants give their bounds. The
/// closing bracket of the body has its own line. Any other loop stays, as one with `i += 1u` does.
pub fn unrolled(text: &str, constants: &[(&str, usize)]) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let mut out = String::with_capacity(4 * text.len());
    let known = constants.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
    Unroller { known, variables: Vec::new() }.write(&lines, &mut out);
    out
}

struct Unroller {
    known: Vec<(String, usize)>,
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

    fn constant(&self, line: &str) -> Option<(String, usize)> {
        let (name, value) = line.trim().strip_prefix("let ")?.strip_suffix(';')?.split_once(" = ")?;
        (!self.variables.is_empty()).then_some((name.to_owned(), self.value(value)?))
    }

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

    fn substituted(&self, line: &str) -> String {
        if self.variables.is_empty() {
            return line.to_owned();
        }
        let value = |word: &str| self.variables.iter().rev().find(|(name, _)| name == word).map(|(_, value)| value);
        let named = |word: &str| value(word).map_or_else(|| word.to_owned(), |value| format!("{value}u"));
        let named: String = words(line).map(named).collect();
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

fn body(lines: &[&str]) -> usize {
    let mut depth = 1;
    let mut closes = |c: char| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        depth == 0
    };
    lines.iter().position(|line| line.chars().any(&mut closes)).unwrap_or(lines.len())
}

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
