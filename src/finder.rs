//! The finder: a field that finds any setting, view, scenario, lesson, export and command by words.

use egui::{Align2, Button, Context, Key, Order, RichText, ScrollArea, TextEdit, Ui, Window, vec2};
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::{self, Address, Edit, addresses, other_choices, words_of};
use kalmanscope_lessons::{BUILT_IN, EQUATIONS};

use crate::request::{Arrangement, Request, Tabs, VIEWS};
use crate::session::Session;
use crate::text::{parse, sentence, significant, unit_in};
use crate::tutor::Catalogue;
use crate::views::view;
use crate::widgets::named;
use crate::{export, keys, theme};

const WIDTH: f32 = 460.0;

/// Limits the entries, and those in sight.
const SHOWN: usize = 100;
const ROWS: f32 = 10.0;

/// Other words for entries whose title contains a text.
const SYNONYMS: [(&str, &str); 16] = [
    ("theme", "colours night appearance"),
    ("link", "share url address"),
    ("Report", "pdf print diagnosis"),
    ("(SVG)", "figure picture image export"),
    ("(CSV)", "data table export excel"),
    ("settings", "options panel"),
    ("play or pause", "run stop start"),
    ("Innovations", "residual prediction error"),
    ("NIS and NEES", "consistency chi-squared"),
    ("Autocorrelation", "whiteness"),
    ("Scores", "rmse results table"),
    ("Map", "grid sweep heat"),
    ("Monte Carlo", "seeds population ensemble"),
    ("Frequency response", "bode transfer resonance hz spectrum"),
    ("Spectrogram", "hz spectrum time"),
    ("take back", "undo"),
];

#[derive(Default)]
pub(crate) struct Finder {
    text: String,
    place: usize,
    change: Option<FinderChange>,
    has_begun: bool,
}

impl Finder {
    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        (session, catalogue): (&Session, &Catalogue),
        requests: &mut Vec<Request>,
    ) -> bool {
        let width = WIDTH.min(ctx.content_rect().width() - 24.0);
        let mut is_open = !ctx.input(|input| input.key_pressed(Key::Escape));
        let window = Window::new("Finder").title_bar(false).resizable(false).order(Order::Foreground);
        window.anchor(Align2::CENTER_TOP, vec2(0.0, 60.0)).fixed_size(vec2(width, 0.0)).show(ctx, |ui| {
            ui.set_width(width);
            match &mut self.change {
                Some(change) => is_open &= change.ui(ui, session.scenario(), requests),
                None => is_open &= self.list_ui(ui, (session, catalogue), requests),
            }
        });
        is_open
    }

    fn list_ui(
        &mut self,
        ui: &mut Ui,
        (session, catalogue): (&Session, &Catalogue),
        requests: &mut Vec<Request>,
    ) -> bool {
        // Arrows choose an entry, they do not move the cursor.
        let [up, down, enter] = ui.input_mut(|input| {
            [Key::ArrowUp, Key::ArrowDown, Key::Enter].map(|key| input.consume_key(egui::Modifiers::NONE, key))
        });
        let field =
            TextEdit::singleline(&mut self.text).hint_text("a setting, view, scenario, lesson, export or command");
        let field = named(ui.add(field.desired_width(f32::INFINITY).char_limit(60)), "Find by words");
        if !std::mem::replace(&mut self.has_begun, true) || !field.has_focus() {
            field.request_focus();
        }
        if field.changed() {
            self.place = 0;
        }
        let all = entries(session, catalogue, theme::other(ui.ctx()));
        let found: Vec<&FinderEntry> = found(&all, &self.text).into_iter().take(SHOWN).collect();
        self.place =
            (self.place + usize::from(down)).min(found.len().saturating_sub(1)) - usize::from(up).min(self.place);
        let mut chosen = if enter { found.get(self.place).copied() } else { None };
        let height = ROWS * (ui.spacing().interact_size.y + ui.spacing().item_spacing.y);
        // A floating bar would cover the kinds of the entries at the right.
        ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
        let list = ScrollArea::vertical().max_height(height).min_scrolled_height(height).auto_shrink([false, true]);
        list.show(ui, |ui| {
            for (place, entry) in found.iter().enumerate() {
                let row = entry_ui(ui, entry, place == self.place);
                if place == self.place && (up || down) {
                    row.scroll_to_me(None);
                }
                if row.clicked() {
                    chosen = Some(*entry);
                }
            }
            if found.is_empty() {
                ui.weak("No match");
            }
        });
        match chosen.map(|entry| &entry.choice) {
            None => return true,
            Some(FinderChoice::Setting(address)) => {
                self.change = Some(FinderChange { address: address.clone(), text: String::new(), is_refused: false });
                return true;
            }
            Some(FinderChoice::Edit(edit)) => {
                let mut change = setting::Change::default();
                change.edit(edit.clone());
                requests.push(Request::Edit(change));
            }
            Some(FinderChoice::Request(request)) => requests.push((**request).clone()),
            Some(FinderChoice::Theme(theme)) => ui.ctx().set_theme(*theme),
        }
        false
    }
}

fn entry_ui(ui: &mut Ui, entry: &FinderEntry, is_on: bool) -> egui::Response {
    let kind = RichText::new(entry.kind).small();
    let kind = if is_on { kind } else { kind.weak() };
    let row = Button::selectable(is_on, entry.title.as_str()).right_text(kind).truncate();
    let row = ui.add(row.min_size(vec2(ui.available_width(), ui.spacing().interact_size.y)));
    row.ctx.accesskit_node_builder(row.id, |node| node.set_label(format!("{}, {}", entry.title, entry.kind)));
    if entry.hint.is_empty() { row } else { row.on_hover_text(entry.hint.as_str()) }
}

struct FinderChange {
    address: Address,
    text: String,
    is_refused: bool,
}

impl FinderChange {
    fn ui(&mut self, ui: &mut Ui, scenario: &Scenario, requests: &mut Vec<Request>) -> bool {
        let Self { address, text, is_refused } = self;
        let title = title(scenario, address);
        let unit = unit_in(scenario, address.unit);
        let now = significant(address.get(scenario), 5);
        ui.label(RichText::new(format!("{title}: {now} {unit}")).family(theme::strong()));
        let is_entered = ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Enter));
        let field = TextEdit::singleline(text).hint_text("a number, then Enter").desired_width(f32::INFINITY);
        let field = named(ui.add(field.char_limit(30)), format!("{title}, new value"));
        if !field.has_focus() {
            field.request_focus();
        }
        let value = parse(text);
        *is_refused = value.is_none() && (is_entered || (*is_refused && !field.changed()));
        if *is_refused {
            ui.colored_label(ui.visuals().warn_fg_color, "This is no number.");
        }
        let Some(value) = value.filter(|_| is_entered) else { return true };
        requests.push(Request::set(address.clone(), value));
        false
    }
}

struct FinderEntry {
    title: String,
    kind: &'static str,
    hint: String,
    words: String,
    choice: FinderChoice,
}

enum FinderChoice {
    Theme(egui::Theme),
    Setting(Address),
    Edit(Edit),
    Request(Box<Request>),
}

fn entry(title: impl Into<String>, kind: &'static str, hint: impl Into<String>, request: Request) -> FinderEntry {
    let (title, hint) = (title.into(), hint.into());
    let words = format!("{title} {kind}").to_lowercase();
    FinderEntry { title, kind, hint, words, choice: FinderChoice::Request(Box::new(request)) }
}

fn title(scenario: &Scenario, address: &Address) -> String {
    let key = address.to_string();
    let filter = scenario.filters.iter().find(|filter| key.starts_with(&filter.address("")));
    let name = sentence(&address.name);
    filter.map_or_else(|| name.clone(), |filter| format!("{name}, {}", filter.name))
}

fn entries(session: &Session, catalogue: &Catalogue, (theme, name): (egui::Theme, &str)) -> Vec<FinderEntry> {
    let scenario = session.scenario();
    let settings = addresses(scenario).into_iter().map(|address| FinderEntry {
        title: title(scenario, &address),
        kind: "setting",
        hint: String::new(),
        words: words_of(scenario, &address),
        choice: FinderChoice::Setting(address),
    });
    let choices = other_choices(scenario).into_iter().map(|edit| {
        let filter = scenario.filters.iter().find(|filter| edit.key.starts_with(&filter.address("")));
        let words = sentence(&edit.in_words(scenario));
        let title = filter.map_or_else(|| words.clone(), |filter| format!("{words}, {}", filter.name));
        let choice = FinderChoice::Edit(edit);
        FinderEntry { words: title.to_lowercase(), title, kind: "choice", hint: String::new(), choice }
    });
    let views = VIEWS.iter().flat_map(|(_, views)| *views).flat_map(|Tabs { name, tabs }| {
        tabs.iter().map(move |kind| {
            let [about, ..] = view(*kind).help;
            let entry = entry(view(*kind).name, "view", about, Request::ShowView(*kind));
            FinderEntry { words: format!("{} {}", entry.words, name.to_lowercase()), ..entry }
        })
    });
    let scenarios = BUILT_IN.iter().chain(EQUATIONS);
    let scenarios = scenarios.map(|one| entry(one.title, "scenario", one.description(), Request::Open(*one)));
    let lessons = catalogue.lessons.iter().enumerate();
    let lessons = lessons.map(|(place, one)| entry(&one.title, "lesson", &one.summary, Request::StartLesson(place)));
    let commands = keys::commands(session)
        .map(|(what, key, request)| entry(sentence(what), "command", format!("Key: {key}"), request));
    let arrangements = Arrangement::ALL.into_iter();
    let arrangements = arrangements.map(|one| entry(one.name(), "arrangement", "", Request::Arrange(one)));
    let exports = export::entries().map(|(request, name, hint)| entry(name, "export", hint, request));
    let theme = FinderEntry { choice: FinderChoice::Theme(theme), ..entry(name, "command", "", Request::Find) };
    let own = views.chain(arrangements).chain(scenarios).chain(lessons).chain(exports).chain(commands).chain([theme]);
    let mut all: Vec<FinderEntry> = settings.chain(choices).chain(own).collect();
    for entry in &mut all {
        for (_, words) in SYNONYMS.iter().filter(|(part, _)| entry.title.contains(part)) {
            entry.words = format!("{} {words}", entry.words);
        }
    }
    all
}

fn found<'a>(entries: &'a [FinderEntry], text: &str) -> Vec<&'a FinderEntry> {
    let text = text.to_lowercase();
    let words: Vec<&str> = text.split_whitespace().collect();
    let rank = |entry: &&FinderEntry| {
        let title = entry.title.to_lowercase();
        let in_title = words.iter().filter(|word| title.contains(**word)).count();
        let begins = words.first().is_some_and(|word| title.starts_with(word));
        (words.len() - in_title, !begins)
    };
    let with = |hints: bool| -> Vec<&FinderEntry> {
        let has = |entry: &FinderEntry, word: &str| {
            let title = entry.title.to_lowercase();
            entry.words.contains(word) || title.contains(word) || hints && entry.hint.to_lowercase().contains(word)
        };
        entries.iter().filter(|entry| words.iter().all(|word| has(entry, word))).collect()
    };
    // Hints have many words: they count only where no title has the words.
    let mut found = with(false);
    if found.is_empty() {
        found = with(true);
    }
    // Stable: entries of one rank keep their order.
    found.sort_by_key(rank);
    found
}
