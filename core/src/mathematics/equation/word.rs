//! Names in equations: as they are typed, and as keys.

/// Greek letters; of the capitals, those that no Latin letter looks like.
const GREEK: &str = "αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ";

const NAMES: [&str; 34] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "omicron", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta",
    "Lambda", "Xi", "Pi", "Sigma", "Phi", "Psi", "Omega",
];

/// Subscripts, each with its character on the line.
const SUBSCRIPTS: [&str; 2] = ["₀₁₂₃₄₅₆₇₈₉ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ", "0123456789aehijklmnoprstuvx"];

const SUPERSCRIPTS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";

fn place(letter: char, letters: &str) -> Option<usize> {
    letters.chars().position(|other| other == letter)
}

pub(super) fn greek(letter: char) -> Option<&'static str> {
    // The micro sign is often typed for μ.
    place(if letter == 'µ' { 'μ' } else { letter }, GREEK).map(|place| NAMES[place])
}

pub(super) fn subscript(c: char) -> Option<char> {
    place(c, SUBSCRIPTS[0]).and_then(|place| SUBSCRIPTS[1].chars().nth(place))
}

pub(super) fn superscript(c: char) -> Option<u32> {
    place(c, SUPERSCRIPTS).map(|digit| digit as u32)
}

/// The letter below the dots of a character that has some, and their number.
pub(super) fn dotted(c: char) -> Option<(char, usize)> {
    match c {
        'ẋ' => Some(('x', 1)),
        'ẍ' => Some(('x', 2)),
        'ż' => Some(('z', 1)),
        'ẏ' => Some(('y', 1)),
        'ÿ' => Some(('y', 2)),
        'ṗ' => Some(('p', 1)),
        'ṙ' => Some(('r', 1)),
        'ṡ' => Some(('s', 1)),
        'ẇ' => Some(('w', 1)),
        _ => None,
    }
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

/// A letter with up to two dots: one character where there is one, else with combining dots.
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
