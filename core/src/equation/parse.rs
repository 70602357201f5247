//! The trees of an equation.
//!
//! ```text
//! equations = equation (';' equation)*      sum = ['-'] product (('+' | '-') product)*
//! equation  = sum '=' sum                   product = power (('*' | '/' | nothing) power)*
//! power     = atom (superscripts | '^' number)      atom = number | name | function '(' sum ')' | '(' sum ')' | '-' power
//! ```

use super::EquationError;
use super::token::{Placed, Token, tokens};
use kalmanscope_filters::engine::number::Function;

// A bracket is a call within a call: without a limit, a text of brackets overflows the stack.
const DEPTH: usize = 40;

const EQUATIONS: usize = 30;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tree {
    Number(f64),
    /// A name, the number of its primes, and its place in the text.
    Name(String, usize, usize),
    Negative(Box<Tree>),
    Call(Function, Box<Tree>),
    Binary(char, Box<Tree>, Box<Tree>),
    Power(Box<Tree>, f64),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sides {
    pub(super) left: Tree,
    pub(super) right: Tree,
    pub(super) place: usize,
}

impl Tree {
    pub(super) fn names<'a>(&'a self, take: &mut dyn FnMut(&'a str, usize, usize)) {
        match self {
            Self::Number(_) => {}
            Self::Name(name, primes, place) => take(name, *primes, *place),
            Self::Negative(a) | Self::Call(_, a) | Self::Power(a, _) => a.names(take),
            Self::Binary(_, a, b) => {
                a.names(take);
                b.names(take);
            }
        }
    }
}

pub(super) fn parse(text: &str) -> Result<Vec<Sides>, EquationError> {
    let mut parser = EquationParser { tokens: tokens(text)?, at: 0, depth: 0 };
    let mut all = Vec::new();
    loop {
        let place = parser.place();
        let left = parser.sum()?;
        if !parser.eat('=') {
            return Err(parser.unexpected("an operator or `=`"));
        }
        all.push(Sides { left, right: parser.sum()?, place });
        if all.len() > EQUATIONS {
            return Err(EquationError::at(place, format!("there are at most {EQUATIONS} equations")));
        }
        match parser.next() {
            Token::Sign(';') if *parser.peek() == Token::End => return Ok(all),
            Token::Sign(';') => {}
            Token::End => return Ok(all),
            _ => {
                parser.at -= 1;
                return Err(parser.unexpected("an operator, `;` or the end"));
            }
        }
    }
}

struct EquationParser {
    tokens: Vec<Placed>,
    at: usize,
    depth: usize,
}

impl EquationParser {
    fn peek(&self) -> &Token {
        self.tokens.get(self.at).map_or(&Token::End, |(_, token)| token)
    }

    fn place(&self) -> usize {
        self.tokens.get(self.at).or(self.tokens.last()).map_or(0, |(place, _)| *place)
    }

    fn next(&mut self) -> Token {
        let token = self.peek().clone();
        self.at += 1;
        token
    }

    fn eat(&mut self, sign: char) -> bool {
        let is_it = *self.peek() == Token::Sign(sign);
        self.at += usize::from(is_it);
        is_it
    }

    fn unexpected(&self, expected: &str) -> EquationError {
        EquationError::at(self.place(), format!("{expected} is expected here"))
    }

    fn sum(&mut self) -> Result<Tree, EquationError> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(EquationError::at(self.place(), format!("there are at most {DEPTH} brackets within brackets")));
        }
        let mut left = self.product()?;
        while let Token::Sign(sign @ ('+' | '-')) = *self.peek() {
            self.at += 1;
            left = Tree::Binary(sign, Box::new(left), Box::new(self.product()?));
        }
        self.depth -= 1;
        Ok(left)
    }

    fn product(&mut self) -> Result<Tree, EquationError> {
        let mut left = self.power()?;
        loop {
            let sign = match self.peek() {
                Token::Sign(sign @ ('*' | '/')) => {
                    let sign = *sign;
                    self.at += 1;
                    sign
                }
                Token::Name(..) | Token::Sign('(') => '*',
                _ => return Ok(left),
            };
            left = Tree::Binary(sign, Box::new(left), Box::new(self.power()?));
        }
    }

    fn power(&mut self) -> Result<Tree, EquationError> {
        if *self.peek() == Token::Sign('-') || *self.peek() == Token::Sign('+') {
            let is_negative = self.next() == Token::Sign('-');
            self.depth += 1;
            if self.depth > DEPTH {
                return Err(EquationError::at(self.place(), format!("there are at most {DEPTH} signs in a row")));
            }
            let rest = self.power()?;
            self.depth -= 1;
            return Ok(if is_negative { Tree::Negative(Box::new(rest)) } else { rest });
        }
        let mut base = self.atom()?;
        loop {
            let exponent = match *self.peek() {
                Token::Power(power) => f64::from(power),
                Token::Sign('^') => {
                    self.at += 1;
                    let sign = if self.eat('-') { -1.0 } else { 1.0 };
                    let is_bracketed = self.eat('(');
                    let sign = if is_bracketed && self.eat('-') { -sign } else { sign };
                    let Token::Number(number) = *self.peek() else {
                        return Err(self.unexpected("a number as exponent"));
                    };
                    self.at += 1;
                    if is_bracketed && !self.eat(')') {
                        return Err(self.unexpected("`)`"));
                    }
                    // `2^3^2` has two readings.
                    if *self.peek() == Token::Sign('^') {
                        return Err(self.unexpected("an operator (a power of a power needs brackets)"));
                    }
                    base = Tree::Power(Box::new(base), sign * number);
                    continue;
                }
                _ => return Ok(base),
            };
            self.at += 1;
            base = Tree::Power(Box::new(base), exponent);
        }
    }

    fn atom(&mut self) -> Result<Tree, EquationError> {
        let place = self.place();
        match self.next() {
            Token::Number(number) => Ok(Tree::Number(number)),
            Token::Sign('(') => self.bracket(),
            Token::Name(name, 0) if *self.peek() == Token::Sign('(') && Function::from_key(&name).is_some() => {
                self.at += 1;
                let function = Function::from_key(&name).unwrap_or(Function::Abs);
                Ok(Tree::Call(function, Box::new(self.bracket()?)))
            }
            Token::Name(name, _) if Function::from_key(&name).is_some() => {
                Err(EquationError::at(place, format!("`{name}` is a function: {name}(…)")))
            }
            Token::Name(name, 0) if name == "pi" => Ok(Tree::Number(std::f64::consts::PI)),
            Token::Name(name, primes) => Ok(Tree::Name(name, primes, place)),
            _ => {
                self.at -= 1;
                Err(self.unexpected("a number, a name or a bracket"))
            }
        }
    }

    fn bracket(&mut self) -> Result<Tree, EquationError> {
        let inside = self.sum()?;
        if self.eat(')') { Ok(inside) } else { Err(self.unexpected("an operator or `)`")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(text: &str) -> String {
        fn shown(tree: &Tree) -> String {
            match tree {
                Tree::Number(number) => number.to_string(),
                Tree::Name(name, primes, _) => format!("{name}{}", "'".repeat(*primes)),
                Tree::Negative(a) => format!("(-{})", shown(a)),
                Tree::Call(function, a) => format!("{function:?}{}", shown(a)),
                Tree::Binary(sign, a, b) => format!("({}{sign}{})", shown(a), shown(b)),
                Tree::Power(a, power) => format!("{}^{power}", shown(a)),
            }
        }
        parse(&format!("{text} = f")).map_or_else(|error| error.to_string(), |all| shown(&all[0].left))
    }

    #[test]
    fn products_need_no_sign_and_powers_bind_most() {
        assert_eq!(left("x'' + 2 ζ ωₙ x' + ωₙ² x"), "((x''+(((2*zeta)*omega_n)*x'))+(omega_n^2*x))");
        assert_eq!(left("-x^2"), "(-x^2)");
        assert_eq!(left("1/2 x"), "((1/2)*x)");
        assert_eq!(left("g(1 - 2 x)"), "(g*(1-(2*x)))");
        assert_eq!(left("sin(x)²"), "Sinx^2");
        assert_eq!(left("x^-0.5 - -x"), "(x^-0.5-(-x))");
    }

    #[test]
    fn a_fault_is_said_at_its_character() {
        for (text, place, what) in [
            ("x'' + = f", 6, "a number, a name or a bracket is expected here"),
            ("x'' + (x = f", 9, "an operator or `)` is expected here"),
            ("x''", 3, "an operator or `=` is expected here"),
            ("x'' = f)", 7, "an operator, `;` or the end is expected here"),
            ("x'' + sin x = f", 6, "`sin` is a function: sin(…)"),
            ("x'' + x^c = f", 8, "a number as exponent is expected here"),
            ("x 2 = f", 2, "an operator or `=` is expected here"),
            ("", 0, "a number, a name or a bracket is expected here"),
        ] {
            let error = parse(text).expect_err(text);
            assert_eq!((error.place.map(|(place, _)| place), error.what.as_str()), (Some(place), what), "{text}");
        }
        let deep = format!("{}x{} = f", "(".repeat(500), ")".repeat(400));
        assert!(parse(&deep).expect_err("too deep").what.contains("at most 40 brackets"));
        let deep = format!("{}x = f", "-".repeat(900));
        assert!(parse(&deep).expect_err("too deep").what.contains("at most 40 signs"));
    }
}
