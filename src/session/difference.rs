//! Names the settings in which two scenarios differ.

use kalmanscope_core::internals::sort_short_by_key;
use kalmanscope_core::{Document, Scenario, setting};

use crate::text::significant;

/// Limits the settings that are named.
const NAMED: usize = 2;

/// The settings in which `before` differs from `now`, with their values before: `EKF λ = 1`. `None` if nothing differs.
pub(super) fn difference(before: &Scenario, now: &Scenario) -> Option<String> {
    let mut all: Vec<String> = Vec::new();
    let several = before.filters.len() > 1;
    for filter in &before.filters {
        let Some(other) = now.filters.iter().find(|other| other.id == filter.id) else {
            all.push(format!("with {}", filter.name));
            continue;
        };
        let mut of_filter = Vec::new();
        compare(&value(filter), &value(other), &mut Vec::new(), &mut of_filter);
        let owner = if several { format!("{} ", filter.name) } else { String::new() };
        all.extend(of_filter.into_iter().map(|text| owner.clone() + &text));
    }
    for filter in now.filters.iter().filter(|filter| before.filters.iter().all(|other| other.id != filter.id)) {
        all.push(format!("without {}", filter.name));
    }
    let bare = |scenario: &Scenario| value(&Scenario { filters: Vec::new(), ..scenario.clone() });
    compare(&bare(before), &bare(now), &mut Vec::new(), &mut all);
    let more = if all.len() > NAMED { ", …" } else { "" };
    (!all.is_empty()).then(|| all.into_iter().take(NAMED).collect::<Vec<_>>().join(", ") + more)
}

fn value(of: &impl serde::Serialize) -> Document {
    Document::of(of).unwrap_or(Document::Null)
}

/// Appends every setting below `path` in which the two differ.
fn compare(before: &Document, now: &Document, path: &mut Vec<String>, all: &mut Vec<String>) {
    match (before, now) {
        _ if before == now => {}
        (Document::Table(one), Document::Table(other)) => {
            let mut keys: Vec<&String> = one.iter().chain(other).map(|(key, _)| key).collect();
            sort_short_by_key(&mut keys, |key| *key);
            keys.dedup();
            for key in keys {
                path.push(key.clone());
                let of = |document: &Document| document.get(key).cloned().unwrap_or(Document::Null);
                compare(&of(before), &of(now), path, all);
                path.pop();
            }
        }
        (Document::List(one), Document::List(other)) if one.len() == other.len() => {
            for (i, (one, other)) in one.iter().zip(other).enumerate() {
                path.push((i + 1).to_string());
                compare(one, other, path, all);
                path.pop();
            }
        }
        _ => all.push(format!("{} = {}", name(path), words(before))),
    }
}

/// The name of a setting: the field's symbols if there are any, else the words of its key.
fn name(path: &[String]) -> String {
    path.iter()
        .map(|key| setting::symbol(key).map_or_else(|| key.replace('_', " "), str::to_owned))
        .collect::<Vec<_>>()
        .join(" ")
}

fn words(value: &Document) -> String {
    match value {
        Document::Null => "none".to_owned(),
        Document::Flag(on) => if *on { "yes" } else { "no" }.to_owned(),
        Document::Integer(number) => significant(*number as f64, 4),
        Document::Large(number) => significant(*number as f64, 4),
        Document::Single(number) => significant(f64::from(*number), 4),
        Document::Number(number) => significant(*number, 4),
        Document::Text(text) => text.clone(),
        Document::List(_) | Document::Table(_) => "other".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::Channel;

    #[test]
    fn a_change_is_named_by_what_was_before() {
        let now = Scenario::default();
        assert_eq!(difference(&now, &now), None);
        let mut before = now.clone();
        before.filters[0].fading = 1.0;
        assert_eq!(difference(&before, &now).unwrap(), "EKF λ = 1");
        before.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 9.0;
        before.seed = 7;
        assert_eq!(difference(&before, &now).unwrap(), "EKF λ = 1, EKF guess ωₙ = 9, …");
        let mut fewer = now.clone();
        let removed = fewer.filters.remove(1);
        assert_eq!(difference(&now, &fewer).unwrap(), format!("with {}", removed.name));
        assert_eq!(difference(&fewer, &now).unwrap(), format!("without {}", removed.name));
    }
}
