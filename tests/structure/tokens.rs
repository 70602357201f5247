//! The words and signs of a Rust source, without comments, literals and tests.

/// A word, or a sign; `::` is one sign.
pub(crate) type Token = String;

/// The tokens of a source, and the names of its modules that are compiled for tests alone.
pub(crate) fn product(source: &str) -> (Vec<Token>, Vec<Token>) {
    without_tests(&tokens(source))
}

/// The tokens of a source without comments and literals.
fn tokens(source: &str) -> Vec<Token> {
    let text: Vec<char> = source.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        at += match rest {
            ['/', '/', ..] => rest.iter().position(|c| *c == '\n').unwrap_or(rest.len()),
            ['/', '*', ..] => block_comment(rest),
            ['"', ..] => quoted(rest, '"'),
            ['r' | 'b' | 'c', ..] if raw(rest).is_some() => raw(rest).unwrap_or(rest.len()),
            ['\'', '\\', ..] => quoted(rest, '\''),
            ['\'', _, '\'', ..] => 3,
            [':', ':', ..] => {
                tokens.push("::".to_owned());
                2
            }
            [first, ..] if first.is_alphanumeric() || *first == '_' => {
                let length = rest.iter().position(|c| !c.is_alphanumeric() && *c != '_').unwrap_or(rest.len());
                tokens.push(rest[..length].iter().collect());
                length
            }
            [first, ..] => {
                if !first.is_whitespace() {
                    tokens.push(first.to_string());
                }
                1
            }
            [] => 1,
        };
    }
    tokens
}

/// The length of a comment that may have others inside.
fn block_comment(text: &[char]) -> usize {
    let (mut depth, mut at) = (0_usize, 0);
    while at < text.len() {
        match text[at..] {
            ['/', '*', ..] => (depth, at) = (depth + 1, at + 2),
            ['*', '/', ..] if depth == 1 => return at + 2,
            ['*', '/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    at
}

/// The length of a literal between quotes.
fn quoted(text: &[char], quote: char) -> usize {
    let mut at = 1;
    while at < text.len() && text[at] != quote {
        at += if text[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// The length of a raw literal as `r#"…"#`, if the text begins with one.
fn raw(text: &[char]) -> Option<usize> {
    let prefix = text.iter().take_while(|c| matches!(c, 'r' | 'b' | 'c')).count();
    let hashes = text[prefix..].iter().take_while(|c| **c == '#').count();
    if text[..prefix].last() != Some(&'r') || text.get(prefix + hashes) != Some(&'"') {
        return None;
    }
    let end: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
    let begin = prefix + hashes + 1;
    let length = text[begin..].windows(end.len()).position(|window| window == end)?;
    Some(begin + length + end.len())
}

/// Leaves out each item behind `#[cfg(test)]`, and tells which of them are modules.
fn without_tests(tokens: &[Token]) -> (Vec<Token>, Vec<Token>) {
    const CFG_TEST: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut modules) = (Vec::new(), Vec::new());
    let mut at = 0;
    while at < tokens.len() {
        if !tokens[at..].iter().map(String::as_str).take(7).eq(CFG_TEST) {
            kept.push(tokens[at].clone());
            at += 1;
            continue;
        }
        let item = &tokens[at + 7..];
        let length = item_length(item);
        if let Some(place) = item[..length].iter().position(|token| token == "mod")
            && !item[..place].iter().any(|token| token == "{")
        {
            modules.extend(item.get(place + 1).cloned());
        }
        at += 7 + length;
    }
    (kept, modules)
}

/// The length of an item: to its semicolon, or to the end of its first braces.
fn item_length(tokens: &[Token]) -> usize {
    const KINDS: [&str; 11] =
        ["use", "const", "static", "type", "mod", "fn", "impl", "struct", "enum", "trait", "macro_rules"];
    let kind = tokens.iter().position(|token| KINDS.contains(&token.as_str())).unwrap_or_default();
    let is_function = tokens.get(kind + 1).is_some_and(|token| token == "fn");
    let ends_at_braces = is_function || KINDS[4..].contains(&tokens.get(kind).map_or("", String::as_str));
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate() {
        match token.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 && (token == ";" || (token == "}" && ends_at_braces)) {
            return at + 1;
        }
    }
    tokens.len()
}

#[test]
fn comments_literals_and_tests_are_left_out() {
    let source = r##"
        // use a::b;
        /* use /* c */ d; */
        fn f<'a>(x: &'a str) -> char { let _ = ("use e;", r#"use "f";"#, '\'', '"'); 'x' }
        #[cfg(test)]
        use g::{h, i};
        #[cfg(test)]
        pub(crate) mod tests { use super::*; }
        #[cfg(test)]
        const fn l() -> [u8; 2] { use m::n; [0; 2] }
        use j::k;
    "##;
    let (tokens, tests) = product(source);
    let text = tokens.join(" ");
    assert!(text.ends_with("use j :: k ;"), "{text}");
    assert_eq!(text.matches("use").count(), 1, "{text}");
    assert_eq!(tests, ["tests"]);
}
