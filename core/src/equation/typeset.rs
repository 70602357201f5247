//! Equations as they are printed, in runs of text on the line, above it and below it: `x'' + 2 zeta wn x' = f` is `ẍ + 2ζωₙẋ = f`.

use super::EquationError;
use super::parse::{Tree, parse};
use super::token::{dots, parts};
use kalmanscope_filters::engine::number::Function;
use kalmanscope_filters::lists::mapped;

/// The place of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextLevel {
    /// On the line.
    Line,
    /// A power.
    Above,
    /// A subscript.
    Below,
}

/// Text in one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextRun {
    /// The characters.
    pub text: String,
    /// Their place.
    pub level: TextLevel,
}

/// The equations of a text, each as runs from left to right.
///
/// # Errors
/// [`EquationError`] where the text is none.
pub fn typeset(text: &str) -> Result<Vec<Vec<TextRun>>, EquationError> {
    let equations = parse(text).map_err(|error| error.within(text))?;
    Ok(mapped(&equations, &|equation| {
        let mut line = Line::default();
        line.put(&equation.left, Tie::Sum);
        line.write(" = ");
        line.put(&equation.right, Tie::Sum);
        line.0
    }))
}

/// A looser term needs brackets within a tighter one.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Tie {
    Sum,
    Quotient,
    Product,
    Power,
    Atom,
}

fn tie(tree: &Tree) -> Tie {
    match tree {
        _ if is_negative(tree) => Tie::Sum,
        Tree::Negative(_) | Tree::Binary('+' | '-', ..) => Tie::Sum,
        Tree::Binary('/', ..) => Tie::Quotient,
        Tree::Binary(..) => Tie::Product,
        Tree::Power(..) => Tie::Power,
        Tree::Number(number) if is_scaled(*number) => Tie::Product,
        Tree::Number(_) | Tree::Name(..) | Tree::Call(..) => Tie::Atom,
    }
}

fn is_negative(tree: &Tree) -> bool {
    match tree {
        Tree::Negative(_) => true,
        Tree::Binary('*' | '/', a, _) => is_negative(a),
        _ => false,
    }
}

fn is_scaled(number: f64) -> bool {
    number != 0.0 && !(1e-4..1e6).contains(&number)
}

#[derive(Default)]
struct Line(Vec<TextRun>);

impl Line {
    fn write(&mut self, text: &str) {
        self.write_at(text, TextLevel::Line);
    }

    fn write_at(&mut self, text: &str, level: TextLevel) {
        match self.0.last_mut() {
            _ if text.is_empty() => {}
            Some(last) if last.level == level => last.text.push_str(text),
            _ => self.0.push(TextRun { text: text.to_owned(), level }),
        }
    }

    fn put(&mut self, tree: &Tree, least: Tie) {
        if tie(tree) < least {
            self.enclosed("(", tree, ")");
            return;
        }
        match tree {
            Tree::Number(number) => self.number(*number),
            Tree::Name(key, primes, _) => self.name(key, *primes),
            Tree::Negative(a) => {
                self.write("−");
                self.put(a, Tie::Quotient);
            }
            Tree::Call(Function::Abs, a) => self.enclosed("|", a, "|"),
            Tree::Call(Function::Sqrt, a) => {
                self.write("√");
                self.put(a, Tie::Atom);
            }
            Tree::Call(function, a) => {
                let name = Function::NAMED.iter().find(|(other, _)| other == function).map_or("", |(_, name)| name);
                self.write(name);
                self.enclosed("(", a, ")");
            }
            Tree::Power(a, exponent) => {
                self.put(a, Tie::Atom);
                self.write_at(&exponent.to_string().replace('-', "−"), TextLevel::Above);
            }
            Tree::Binary(sign @ ('+' | '-'), a, b) => {
                self.put(a, Tie::Sum);
                self.write(if *sign == '+' { " + " } else { " − " });
                self.put(b, Tie::Quotient);
            }
            Tree::Binary('/', a, b) => {
                self.first_factor(a);
                self.write("/");
                self.put(b, Tie::Power);
            }
            Tree::Binary(_, a, b) => {
                self.first_factor(a);
                self.write(between(a, b));
                self.put(b, Tie::Product);
            }
        }
    }

    fn first_factor(&mut self, tree: &Tree) {
        match tree {
            Tree::Negative(a) => {
                self.write("−");
                self.put(a, Tie::Product);
            }
            _ if is_negative(tree) => self.put(tree, Tie::Sum),
            _ => self.put(tree, Tie::Product),
        }
    }

    fn enclosed(&mut self, open: &str, tree: &Tree, close: &str) {
        self.write(open);
        self.put(tree, Tie::Sum);
        self.write(close);
    }

    fn number(&mut self, number: f64) {
        let text = if number == std::f64::consts::PI { "π".to_owned() } else { number.to_string() };
        let scaled = format!("{number:e}");
        match scaled.split_once('e').filter(|_| is_scaled(number)) {
            Some((mantissa, exponent)) => {
                self.write(&if mantissa == "1" { "10".to_owned() } else { format!("{mantissa}·10") });
                self.write_at(&exponent.replace('-', "−"), TextLevel::Above);
            }
            None => self.write(&text),
        }
    }

    fn name(&mut self, key: &str, primes: usize) {
        let (letters, below) = parts(key);
        let mut all = letters.chars();
        match (all.next(), all.next()) {
            (Some(letter), None) => self.write(&dots(letter, primes)),
            _ => self.write(&(letters + &"′".repeat(primes))),
        }
        self.write_at(&below, TextLevel::Below);
    }
}

fn between(a: &Tree, b: &Tree) -> &'static str {
    fn first(tree: &Tree) -> &Tree {
        match tree {
            Tree::Binary('*', a, _) | Tree::Power(a, _) => first(a),
            other => other,
        }
    }
    fn last(tree: &Tree) -> &Tree {
        match tree {
            Tree::Binary('*', _, b) | Tree::Negative(b) | Tree::Power(b, _) => last(b),
            other => other,
        }
    }
    let is_letter = |tree: &Tree| matches!(tree, Tree::Name(key, ..) if parts(key).0.chars().count() == 1);
    match (last(a), first(b)) {
        (_, Tree::Number(number)) if *number != std::f64::consts::PI => " · ",
        (left, right) if is_letter(right) && (is_letter(left) || matches!(left, Tree::Number(_))) => "",
        _ => " ",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(text: &str) -> String {
        let lines = typeset(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let run = |run: &TextRun| match run.level {
            TextLevel::Line => run.text.clone(),
            TextLevel::Above => format!("^{{{}}}", run.text),
            TextLevel::Below => format!("_{{{}}}", run.text),
        };
        lines.iter().map(|line| line.iter().map(run).collect()).collect::<Vec<String>>().join("; ")
    }

    #[test]
    fn an_equation_is_printed_with_dots_powers_and_subscripts() {
        for (text, expected) in [
            ("x'' + 2 zeta wn x' + wn^2 x = f", "ẍ + 2ζω_{n}ẋ + ω_{n}^{2}x = f"),
            ("x1'' + k_1*(x1 - x2) = f; x2'' = 0", "ẍ_{1} + k_{1} (x_{1} − x_{2}) = f; ẍ_{2} = 0"),
            ("x'' + d tanh(x'/0.02) + k x = f", "ẍ + d tanh(ẋ/0.02) + kx = f"),
            ("x'' + k x (1 - l/sqrt(1+x²)) = f", "ẍ + kx (1 − l/√(1 + x^{2})) = f"),
            ("z' = x' - b abs(x') z", "z\u{307} = ẋ − b |ẋ| z"),
            ("x'' + 2 pi ka x = f", "ẍ + 2 π ka x = f"),
            ("x'' + x^-0.5 + x' * 3 = f", "ẍ + x^{−0.5} + ẋ · 3 = f"),
            ("x'' + 1e-9 x + 2.5e7 x = f", "ẍ + 10^{−9}x + 2.5·10^{7}x = f"),
            ("x'' + heat = f; heat' = x", "ẍ + heat = f; heat′ = x"),
        ] {
            assert_eq!(printed(text).replace('ż', "z\u{307}"), expected, "{text}");
        }
    }

    #[test]
    fn brackets_stand_where_the_meaning_needs_them() {
        for (text, expected) in [
            ("x'' = 1/2 a b", "ẍ = (1/2) ab"),
            ("x'' = a/(b c)", "ẍ = a/(bc)"),
            ("x'' = a/b/c", "ẍ = (a/b)/c"),
            ("x'' = a*(b/c)*d", "ẍ = a (b/c) d"),
            ("x'' = a - (b - c) - -d", "ẍ = a − (b − c) − (−d)"),
            ("x'' = (-x)^2 - (a b)^2", "ẍ = (−x)^{2} − (ab)^{2}"),
            ("x'' = -(a + b) (c + d)", "ẍ = −(a + b) (c + d)"),
            ("x'' = -(a/b) c - (-a b) d - b (-a c)", "ẍ = −(a/b) c − (−abd) − b (−ac)"),
            ("x'' = ((x))", "ẍ = x"),
            ("x'' = a * -b", "ẍ = a (−b)"),
            ("x'' = (x^2)^3", "ẍ = (x^{2})^{3}"),
            ("x'' = 3 * 4 x", "ẍ = 3 · 4x"),
        ] {
            assert_eq!(printed(text), expected, "{text}");
        }
    }

    #[test]
    fn what_is_printed_can_be_read_again() {
        for text in [
            "x'' + 2 ζ ωₙ x' + ωₙ² (0.2 x + 0.8 z) = f; z' = x' - b abs(x') z - g x' abs(z)",
            "x'' + c x' + k x (1 - l / sqrt(1 + x²)) = f",
            "x1'' + c x1' + k x1 - r (ka (x2 - x1) + ca (x2' - x1')) = f; x2'' + ka (x2 - x1) + ca (x2' - x1') = 0",
            "x'' - a/(b c)*d^-2/(x^2 - -x) + (2/3) x/4 = f",
        ] {
            let plain = |run: &TextRun| match run.level {
                TextLevel::Line => run.text.clone(),
                TextLevel::Above => format!("^({})", run.text),
                TextLevel::Below => format!("_{} ", run.text).replace("_1 ", "1 ").replace("_2 ", "2 "),
            };
            let lines = typeset(text).expect("an equation");
            let again: Vec<String> = lines.iter().map(|line| line.iter().map(plain).collect()).collect();
            let spread = |text: &str| {
                let spaced = text.replace("|ẋ|", "abs(ẋ)").replace("|z|", "abs(z)").replace("√(", "sqrt(");
                ["ω", "ẋ", "x", "ζ", "b", "c", "d", "z"].iter().fold(spaced, |text, letter| {
                    let is_word = ["ca", "abs", "sqrt"].iter().any(|word| text.contains(word) && word.contains(letter));
                    if is_word { text } else { text.replace(letter, &format!(" {letter}")) }
                })
            };
            let again = spread(&again.join("; "));
            let second = typeset(&again).unwrap_or_else(|error| panic!("{again}: {error}"));
            assert_eq!(second, lines, "{text}: {again}");
        }
    }
}
