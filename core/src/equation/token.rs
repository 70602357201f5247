//! The words and signs of an equation. A name has a key, however it is typed.

use super::EquationError;

const LENGTH: usize = 1000;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    /// A name by its key, and the number of its primes or dots.
    Name(String, usize),
    Power(u32),
    /// One of `+ - * / ^ ( ) = ;`.
    Sign(char),
    End,
}

pub(super) type Placed = (usize, Token);

pub(super) fn tokens(text: &str) -> Result<Vec<Placed>, EquationError> {
    let characters: Vec<char> = text.chars().collect();
    let count = characters.len();
    if count > LENGTH {
        return Err(EquationError::new(format!("an equation has at most {LENGTH} characters, not {count}")));
    }
    let mut reader = TokenReader { characters, place: 0 };
    let mut all = Vec::new();
    loop {
        reader.skip(char::is_whitespace);
        let place = reader.place;
        let token = reader.token()?;
        let is_end = token == Token::End;
        all.push((place, token));
        if is_end {
            return Ok(all);
        }
    }
}

struct TokenReader {
    characters: Vec<char>,
    place: usize,
}

impl TokenReader {
    fn peek(&self) -> Option<char> {
        self.characters.get(self.place).copied()
    }

    fn skip(&mut self, is: impl Fn(char) -> bool) -> usize {
        let begin = self.place;
        while self.peek().is_some_and(&is) {
            self.place += 1;
        }
        self.place - begin
    }

    fn since(&self, begin: usize) -> String {
        self.characters[begin..self.place].iter().collect()
    }

    fn token(&mut self) -> Result<Token, EquationError> {
        let Some(c) = self.peek() else { return Ok(Token::End) };
        if c.is_ascii_digit() || c == '.' {
            return self.number();
        }
        if c.is_ascii_alphabetic() || greek(c).is_some() || dotted(c).is_some() {
            return Ok(self.name(c));
        }
        if superscript(c).is_some() {
            return Ok(self.power());
        }
        self.place += 1;
        Ok(Token::Sign(match c {
            '+' | '/' | '^' | '(' | ')' | '=' | ';' => c,
            '-' | '−' | '–' => '-',
            '*' | '·' | '⋅' | '×' => '*',
            _ => {
                let allowed = "allowed are names, numbers, + - * / ^ ( ) = ; and superscripts";
                return Err(EquationError::at(self.place - 1, format!("`{c}` is not allowed: {allowed}")));
            }
        }))
    }

    fn number(&mut self) -> Result<Token, EquationError> {
        let begin = self.place;
        self.skip(|c| c.is_ascii_digit() || c == '.');
        // `2e` may be followed by a name, as in `2 e`: an exponent has digits.
        let exponent = self.place;
        if matches!(self.peek(), Some('e' | 'E')) {
            self.place += 1;
            if matches!(self.peek(), Some('+' | '-')) {
                self.place += 1;
            }
            if self.skip(|c| c.is_ascii_digit()) == 0 {
                self.place = exponent;
            }
        }
        let text = self.since(begin);
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number.map(Token::Number).ok_or_else(|| EquationError::at(begin, format!("`{text}` is not a number")))
    }

    fn power(&mut self) -> Token {
        let mut power: u32 = 0;
        while let Some(digit) = self.peek().and_then(superscript) {
            power = power.saturating_mul(10).saturating_add(digit);
            self.place += 1;
        }
        Token::Power(power)
    }

    /// A name: Latin letters together, or one Greek letter, with digits and subscripts; then its primes or dots.
    fn name(&mut self, first: char) -> Token {
        let begin = self.place;
        self.place += 1;
        let (mut letters, mut dots) = match dotted(first) {
            Some((letter, dots)) => (letter.to_string(), dots),
            None => (first.to_string(), 0),
        };
        if first.is_ascii_alphabetic() {
            self.skip(|c| c.is_ascii_alphanumeric() || c == '_');
            letters = self.since(begin);
        }
        let more = self.place;
        self.skip(|c| subscript(c).is_some());
        letters += &self.since(more);
        if !first.is_ascii_alphabetic() {
            let more = self.place;
            let is_indexed = self.peek() == Some('_');
            self.skip(|c| c.is_ascii_digit() || is_indexed && (c == '_' || c.is_ascii_alphanumeric()));
            letters += &self.since(more);
        }
        while let Some(more) = match self.peek() {
            Some('\'' | '′' | '’' | '\u{0307}') => Some(1),
            Some('"' | '″' | '\u{0308}') => Some(2),
            _ => None,
        } {
            dots += more;
            self.place += 1;
        }
        Token::Name(key(&letters), dots)
    }
}

/// Greek letters; of the capitals, those that no Latin letter looks like.
const GREEK: &str = "αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ";

const NAMES: [&str; 34] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "omicron", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta",
    "Lambda", "Xi", "Pi", "Sigma", "Phi", "Psi", "Omega",
];

const SUBSCRIPTS: [&str; 2] = ["₀₁₂₃₄₅₆₇₈₉ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ", "0123456789aehijklmnoprstuvx"];

const SUPERSCRIPTS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";

fn place(letter: char, letters: &str) -> Option<usize> {
    letters.chars().position(|other| other == letter)
}

fn greek(letter: char) -> Option<&'static str> {
    // The micro sign is often typed for μ.
    place(if letter == 'µ' { 'μ' } else { letter }, GREEK).map(|place| NAMES[place])
}

fn subscript(c: char) -> Option<char> {
    place(c, SUBSCRIPTS[0]).and_then(|place| SUBSCRIPTS[1].chars().nth(place))
}

fn superscript(c: char) -> Option<u32> {
    place(c, SUPERSCRIPTS).map(|digit| digit as u32)
}

fn dotted(c: char) -> Option<(char, usize)> {
    let of = |letters, plain: &str, dots| Some((plain.chars().nth(place(c, letters)?)?, dots));
    of("ẋẏżṗṙṡẇ", "xyzprsw", 1).or_else(|| of("ẍÿ", "xy", 2))
}

/// The key of a name: `ωₙ` and `omega_n` are one.
pub(super) fn key(typed: &str) -> String {
    let mut key = String::new();
    let mut is_below = false;
    for c in typed.chars() {
        match (greek(c), subscript(c)) {
            (Some(name), _) => key.push_str(name),
            (_, Some(below)) => {
                if !is_below && below.is_ascii_alphabetic() {
                    key.push('_');
                }
                key.push(below);
            }
            _ => key.push(c),
        }
        is_below = subscript(c).is_some();
    }
    match key.as_str() {
        "wn" | "w_n" | "omegan" => "omega_n".to_owned(),
        _ => key,
    }
}

/// The letters of a key and its subscript: `omega_n` is ω and n, `x1` is x and 1.
pub(super) fn parts(key: &str) -> (String, String) {
    let (name, below) = key.split_once('_').unwrap_or_else(|| {
        let letters = key.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        key.split_at(letters)
    });
    let letter = GREEK.chars().zip(NAMES).find(|(_, greek)| *greek == name);
    (letter.map_or_else(|| name.to_owned(), |(greek, _)| greek.to_string()), below.to_owned())
}

pub(super) fn symbol(key: &str) -> String {
    let (first, below) = parts(key);
    let small = |c: char| ('\u{2080}'..='\u{209c}').chain('ᵢ'..='ᵥ').find(|&small| subscript(small) == Some(c));
    match below.chars().map(small).collect::<Option<String>>() {
        Some(below) => first + &below,
        None => format!("{first}_{below}"),
    }
}

pub(super) fn dots(letter: char, count: usize) -> String {
    match (letter, count) {
        (_, 0) => letter.to_string(),
        ('x', 1) => "ẋ".to_owned(),
        ('x', 2) => "ẍ".to_owned(),
        ('z', 1) => "ż".to_owned(),
        ('y', 2) => "ÿ".to_owned(),
        (_, 1) => format!("{letter}\u{307}"),
        _ => format!("{letter}\u{308}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_numbers_and_signs_are_distinguished() {
        let of = |text: &str| tokens(text).map(|all| all.into_iter().map(|(_, token)| token).collect::<Vec<_>>());
        let name = |key: &str, primes| Token::Name(key.to_owned(), primes);
        assert_eq!(
            of("2ζωₙ²ẋ − 1.5e-3·x1''"),
            Ok(vec![
                Token::Number(2.0),
                name("zeta", 0),
                name("omega_n", 0),
                Token::Power(2),
                name("x", 1),
                Token::Sign('-'),
                Token::Number(1.5e-3),
                Token::Sign('*'),
                name("x1", 2),
                Token::End
            ])
        );
        assert_eq!(of("ω_n x\u{0308}"), Ok(vec![name("omega_n", 0), name("x", 2), Token::End]));
        assert_eq!(of("x $ 2").map_err(|error| error.place), Err(Some((2, String::new()))));
        assert_eq!(of("1.2.3").map_err(|error| error.place), Err(Some((0, String::new()))));
        assert!(of(&"x".repeat(2000)).is_err());
    }

    #[test]
    fn a_name_has_one_key_however_it_is_typed() {
        for (typed, as_key, shown) in [
            ("ωₙ", "omega_n", "ωₙ"),
            ("wn", "omega_n", "ωₙ"),
            ("omega_n", "omega_n", "ωₙ"),
            ("ζ", "zeta", "ζ"),
            ("µ", "mu", "μ"),
            ("x₁", "x1", "x₁"),
            ("c12", "c12", "c₁₂"),
            ("k_b", "k_b", "k_b"),
            ("damping", "damping", "damping"),
        ] {
            assert_eq!((key(typed).as_str(), symbol(as_key).as_str()), (as_key, shown), "{typed}");
        }
        assert_eq!("²³⁹".chars().map(superscript).collect::<Vec<_>>(), [Some(2), Some(3), Some(9)]);
    }
}
