//! The entries of the finder.

use kalmanscope_core::Scenario;
use kalmanscope_core::setting::{Address, Edit, addresses, other_choices, words_of};
use kalmanscope_lessons::{BUILT_IN, EQUATIONS};

use crate::keys;
use crate::request::{Request, ViewKind};
use crate::session::Session;
use crate::text::sentence;
use crate::tutor::Catalogue;
use crate::views::view;

pub(super) struct Entry {
    pub(super) title: String,
    pub(super) kind: &'static str,
    pub(super) hint: String,
    words: String,
    pub(super) choice: Choice,
}

pub(super) enum Choice {
    Setting(Address),
    Edit(Edit),
    Request(Box<Request>),
}

impl Entry {
    fn new(title: impl Into<String>, kind: &'static str, hint: impl Into<String>, request: Request) -> Self {
        let (title, hint) = (title.into(), hint.into());
        let words = format!("{title} {kind} {hint}").to_lowercase();
        Self { title, kind, hint, words, choice: Choice::Request(Box::new(request)) }
    }
}

pub(super) fn title(scenario: &Scenario, address: &Address) -> String {
    let key = address.to_string();
    let filter = scenario.filters.iter().find(|filter| key.starts_with(&filter.address("")));
    let name = sentence(&address.name());
    filter.map_or_else(|| name.clone(), |filter| format!("{name}, {}", filter.name))
}

pub(super) fn entries(session: &Session, catalogue: &Catalogue) -> Vec<Entry> {
    let scenario = session.scenario();
    let settings = addresses(scenario).into_iter().map(|address| Entry {
        title: title(scenario, &address),
        kind: "setting",
        hint: String::new(),
        words: words_of(scenario, &address),
        choice: Choice::Setting(address),
    });
    let choices = other_choices(scenario).into_iter().map(|edit| {
        let filter = scenario.filters.iter().find(|filter| edit.key.starts_with(&filter.address("")));
        let words = sentence(&edit.in_words(scenario));
        let title = filter.map_or_else(|| words.clone(), |filter| format!("{words}, {}", filter.name));
        Entry { words: title.to_lowercase(), title, kind: "choice", hint: String::new(), choice: Choice::Edit(edit) }
    });
    let views = ViewKind::ALL.into_iter().map(|kind| {
        let [about, ..] = view(kind).help;
        Entry::new(view(kind).name, "view", about, Request::ShowView(kind))
    });
    let scenarios = BUILT_IN.iter().chain(EQUATIONS);
    let scenarios = scenarios.map(|one| Entry::new(one.title, "scenario", one.description(), Request::Open(*one)));
    let lessons = catalogue.lessons().iter().enumerate();
    let lessons =
        lessons.map(|(place, one)| Entry::new(&one.title, "lesson", &one.summary, Request::StartLesson(place)));
    let commands = keys::commands(session)
        .map(|(what, key, request)| Entry::new(sentence(what), "command", format!("Key: {key}"), request));
    settings.chain(choices).chain(views).chain(scenarios).chain(lessons).chain(commands).collect()
}

pub(super) fn found<'a>(entries: &'a [Entry], text: &str) -> Vec<&'a Entry> {
    let text = text.to_lowercase();
    let words: Vec<&str> = text.split_whitespace().collect();
    let rank = |entry: &Entry| {
        let title = entry.title.to_lowercase();
        let in_title = words.iter().filter(|word| title.contains(**word)).count();
        let begins = words.first().is_some_and(|word| title.starts_with(word));
        (words.len() - in_title, !begins)
    };
    let mut found: Vec<&Entry> = entries
        .iter()
        .filter(|entry| {
            words.iter().all(|word| entry.words.contains(word) || entry.title.to_lowercase().contains(word))
        })
        .collect();
    // Stable: entries of one rank keep their order.
    found.sort_by_key(|entry| rank(entry));
    found
}
