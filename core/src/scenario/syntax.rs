//! What is wrong with a scenario file, in its own words: line, key, value and what is allowed.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue, Error};

/// The message for a file that is no scenario.
pub(super) fn message(text: &str, error: &Error) -> String {
    let place = error.span().and_then(|span| {
        let document = DeTable::parse(text).ok()?;
        Some((path_to(&span, document.get_ref())?, span))
    });
    let Some((path, span)) = place else {
        // Not even TOML: the parser's own message shows the place.
        return error.to_string().trim_end().to_owned();
    };
    let line = 1 + text.bytes().take(span.start).filter(|&b| b == b'\n').count();
    let piece = text.get(span).unwrap_or_default();
    format!("line {line}: {}", explained(&path, &shown(piece), error.message()))
}

/// What serde says, as `KEY is VALUE, but must be ALLOWED`.
fn explained(path: &str, value: &str, message: &str) -> String {
    if path == "force" && !message.starts_with("unknown variant") && !message.starts_with("unexpected keys") {
        return format!(
            "`force` is {value}, but must be \"none\" or a table with exactly one of `white_noise`, `sine`, `chirp`, \
             `impulse_train`, `step`"
        );
    }
    let expected = message.split_once(", expected ").map(|(_, expected)| expected);
    if let Some(field) = message.strip_prefix("missing field ") {
        return format!("`{path}` lacks the key {field}");
    }
    if let Some(keys) = message.split_once(", available keys: ").map(|(_, keys)| keys) {
        let keys: Vec<String> = keys.split(", ").map(|key| format!("`{key}`")).collect();
        return format!("unknown key `{path}`; it can be {}", keys.join(", "));
    }
    // The kind of a signal or force is a key, too.
    let unknown_key = message.starts_with("unknown field")
        || (message.starts_with("unknown variant") && path.ends_with(&format!(".{value}")));
    match expected {
        Some(expected) if unknown_key => {
            format!("unknown key `{path}`; it can be {}", expected.trim_start_matches("one of "))
        }
        Some(expected) => format!("`{path}` is {value}, but must be {}", in_words(expected)),
        None if message == "wanted string or table" => format!("`{path}` is {value}, but must be a string"),
        None => format!("`{path}` is {value}: {message}"),
    }
}

/// The names that serde gives to Rust's types, in TOML's.
fn in_words(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u64" => "a whole number from 0 to 2⁶³ - 1",
        "a sequence" => "a list",
        _ if expected.starts_with("struct ") => "a table",
        other => other,
    }
}

/// The beginning of a piece of the file, short enough for a message.
fn shown(piece: &str) -> String {
    let mut line = piece.lines().next().unwrap_or_default().to_owned();
    if let Some((end, _)) = line.char_indices().nth(40) {
        line.truncate(end);
        line.push('…');
    }
    line
}

/// The path of the smallest key or value around a place in the file.
fn path_to(place: &Range<usize>, document: &DeTable<'_>) -> Option<String> {
    let mut best = None;
    search_table(place, document, "", &mut best);
    best.map(|(_, path)| path)
}

type Best = Option<(usize, String)>;

fn search_table(place: &Range<usize>, table: &DeTable<'_>, path: &str, best: &mut Best) {
    for (key, value) in table {
        let name = key.get_ref();
        let path = if path.is_empty() { name.to_string() } else { format!("{path}.{name}") };
        consider(place, &key.span(), &path, best);
        search_value(place, value, &path, best);
    }
}

fn search_value(place: &Range<usize>, value: &Spanned<DeValue<'_>>, path: &str, best: &mut Best) {
    consider(place, &value.span(), path, best);
    match value.get_ref() {
        DeValue::Table(table) => search_table(place, table, path, best),
        DeValue::Array(array) => {
            for (i, value) in array.iter().enumerate() {
                search_value(place, value, &format!("{path}[{i}]"), best);
            }
        }
        _ => {}
    }
}

/// Takes the path if the span is around the place and no longer than the best so far: of equals the inner, which comes
/// later.
fn consider(place: &Range<usize>, span: &Range<usize>, path: &str, best: &mut Best) {
    let around = span.start <= place.start && place.end <= span.end;
    if around && best.as_ref().is_none_or(|(length, _)| span.len() <= *length) {
        *best = Some((span.len(), path.to_owned()));
    }
}
