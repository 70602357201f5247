//! Names of a typed equation that are nearly those of functions and states.

const FUNCTIONS: [&str; 9] = ["tanh", "sin", "cos", "tan", "exp", "log", "sqrt", "abs", "sign"];

/// Names that are no states, with what stands for the state.
const STATES: [(&str, &str); 3] = [("X", "the state is x"), ("v", "the velocity is x'"), ("F", "the force is f")];

fn names(equation: &str) -> impl Iterator<Item = (&str, bool)> {
    let is_letter = |c: char| c.is_alphabetic() || c.is_ascii_digit() || c == '_';
    let words = equation.split(move |c| !is_letter(c)).filter(|word| word.starts_with(char::is_alphabetic));
    words.map(|word| {
        let end = word.as_ptr() as usize - equation.as_ptr() as usize + word.len();
        (word, equation[end..].trim_start().starts_with('('))
    })
}

pub(super) fn no_function(equation: &str) -> Option<String> {
    let (name, function) = names(equation).filter(|(_, is_called)| *is_called).find_map(|(name, _)| {
        let is_meant = |function: &&&str| name != **function && is_near(&name.to_lowercase(), function);
        Some((name, FUNCTIONS.iter().find(is_meant).filter(|_| !FUNCTIONS.contains(&name))?))
    })?;
    Some(format!("“{name}(” is no function: is it {function}?"))
}

pub(super) fn similar_name(equation: &str) -> Option<String> {
    let meant = |name: &str| STATES.iter().find(|(other, _)| *other == name);
    let (name, meaning) = names(equation).find_map(|(name, _)| meant(name))?;
    Some(format!("{name} is a parameter here; {meaning}."))
}

fn is_near(name: &str, other: &str) -> bool {
    let sorted = |text: &str| {
        let mut letters: Vec<char> = text.chars().collect();
        letters.sort_unstable();
        letters
    };
    let is_longer = |long: &str, short: &str| {
        long.char_indices().any(|(at, letter)| [&long[..at], &long[at + letter.len_utf8()..]].concat() == short)
    };
    name.len() > 2 && (sorted(name) == sorted(other) || is_longer(name, other) || is_longer(other, name))
}
