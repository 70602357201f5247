//! Text in pages and pictures.

/// Text without markup, and without characters that HTML and XML do not allow.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(letter),
            '\u{fffe}' | '\u{ffff}' => escaped.push(char::REPLACEMENT_CHARACTER),
            control if control.is_control() => escaped.push(char::REPLACEMENT_CHARACTER),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_and_forbidden_characters_are_harmless() {
        assert_eq!(escaped("<a href=\"x\">&'ωₙ'\n"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;ωₙ&#39;\n");
        assert_eq!(escaped("a\u{0}b\u{fffe}c"), "a\u{fffd}b\u{fffd}c");
    }
}
