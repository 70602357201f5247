//! The finder: a field that finds any setting, view, scenario, lesson and command by words.

use egui::{Align2, Context, Key, Order, RichText, ScrollArea, TextEdit, Ui, Window, vec2};
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::{Address, Edit, addresses, other_choices, words_of};
use kalmanscope_lessons::{BUILT_IN, EQUATIONS};

use crate::request::{Request, Tabs, VIEWS};
use crate::session::Session;
use crate::text::{parse, sentence, significant, unit_in};
use crate::theme::Palette;
use crate::tutor::Catalogue;
use crate::views::view;
use crate::widgets::named;
use crate::{keys, theme};

/// The width of the window \[points\].
const WIDTH: f32 = 460.0;

const SHOWN: usize = 40;

#[derive(Default)]
pub(crate) struct Finder {
    text: String,
    place: usize,
    change: Option<Change>,
    has_begun: bool,
}

impl Finder {
    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        (session, catalogue): (&Session, &Catalogue),
        palette: &Palette,
        requests: &mut Vec<Request>,
    ) -> bool {
        let width = WIDTH.min(ctx.content_rect().width() - 24.0);
        let mut is_open = !ctx.input(|input| input.key_pressed(Key::Escape));
        let window = Window::new("Finder").title_bar(false).resizable(false).order(Order::Foreground);
        window.anchor(Align2::CENTER_TOP, vec2(0.0, 60.0)).fixed_size(vec2(width, 0.0)).show(ctx, |ui| {
            ui.set_width(width);
            match &mut self.change {
                Some(change) => is_open &= change.ui(ui, session.scenario(), requests),
                None => is_open &= self.list_ui(ui, (session, catalogue), palette, requests),
            }
        });
        is_open
    }

    fn list_ui(
        &mut self,
        ui: &mut Ui,
        (session, catalogue): (&Session, &Catalogue),
        palette: &Palette,
        requests: &mut Vec<Request>,
    ) -> bool {
        // Arrows choose an entry, they do not move the cursor.
        let [up, down, enter] = ui.input_mut(|input| {
            [Key::ArrowUp, Key::ArrowDown, Key::Enter].map(|key| input.consume_key(egui::Modifiers::NONE, key))
        });
        let field = TextEdit::singleline(&mut self.text).hint_text("a setting, view, scenario, lesson or command");
        let field = named(ui.add(field.desired_width(f32::INFINITY).char_limit(60)), "Find by words");
        if !std::mem::replace(&mut self.has_begun, true) || !field.has_focus() {
            field.request_focus();
        }
        if field.changed() {
            self.place = 0;
        }
        let all = entries(session, catalogue);
        let found: Vec<&Entry> = found(&all, &self.text).into_iter().take(SHOWN).collect();
        self.place =
            (self.place + usize::from(down)).min(found.len().saturating_sub(1)) - usize::from(up).min(self.place);
        let mut chosen = if enter { found.get(self.place).copied() } else { None };
        ScrollArea::vertical().max_height(320.0).auto_shrink([false, true]).show(ui, |ui| {
            for (place, entry) in found.iter().enumerate() {
                let row = entry_ui(ui, entry, place == self.place, palette);
                if place == self.place && (up || down) {
                    row.scroll_to_me(None);
                }
                if row.clicked() {
                    chosen = Some(*entry);
                }
            }
            if found.is_empty() {
                ui.weak("Nothing has these words.");
            }
        });
        match chosen.map(|entry| &entry.choice) {
            None => return true,
            Some(Choice::Setting(address)) => {
                self.change = Some(Change { address: address.clone(), text: String::new(), is_refused: false });
                return true;
            }
            Some(Choice::Edit(edit)) => {
                let edited = edit.apply(session.scenario()).ok();
                requests.extend(edited.and_then(|edited| Request::edit(session.scenario(), edited)));
            }
            Some(Choice::Request(request)) => requests.push((**request).clone()),
        }
        false
    }
}

fn entry_ui(ui: &mut Ui, entry: &Entry, is_on: bool, palette: &Palette) -> egui::Response {
    let row = ui.selectable_label(is_on, entry.title.as_str());
    let font = egui::TextStyle::Small.resolve(ui.style());
    let at = row.rect.right_center() + vec2(8.0, 0.0);
    ui.painter().text(at, Align2::LEFT_CENTER, entry.kind, font, palette.weak);
    row.ctx.accesskit_node_builder(row.id, |node| node.set_label(format!("{}, {}", entry.title, entry.kind)));
    if entry.hint.is_empty() { row } else { row.on_hover_text(entry.hint.as_str()) }
}

struct Change {
    address: Address,
    text: String,
    is_refused: bool,
}

impl Change {
    fn ui(&mut self, ui: &mut Ui, scenario: &Scenario, requests: &mut Vec<Request>) -> bool {
        let Self { address, text, is_refused } = self;
        let title = title(scenario, address);
        let unit = unit_in(scenario, address.unit());
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
        let mut edited = scenario.clone();
        address.set(&mut edited, value);
        requests.extend(Request::edit(scenario, edited));
        false
    }
}

struct Entry {
    title: String,
    kind: &'static str,
    hint: String,
    words: String,
    choice: Choice,
}

enum Choice {
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

fn title(scenario: &Scenario, address: &Address) -> String {
    let key = address.to_string();
    let filter = scenario.filters.iter().find(|filter| key.starts_with(&filter.address("")));
    let name = sentence(&address.name());
    filter.map_or_else(|| name.clone(), |filter| format!("{name}, {}", filter.name))
}

fn entries(session: &Session, catalogue: &Catalogue) -> Vec<Entry> {
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
    let views = VIEWS.iter().flat_map(|(_, views)| *views).flat_map(|Tabs { name, tabs }| {
        tabs.iter().map(move |kind| {
            let [about, ..] = view(*kind).help;
            let entry = Entry::new(view(*kind).name, "view", about, Request::ShowView(*kind));
            Entry { words: format!("{} {}", entry.words, name.to_lowercase()), ..entry }
        })
    });
    let scenarios = BUILT_IN.iter().chain(EQUATIONS);
    let scenarios = scenarios.map(|one| Entry::new(one.title, "scenario", one.description(), Request::Open(*one)));
    let lessons = catalogue.lessons.iter().enumerate();
    let lessons =
        lessons.map(|(place, one)| Entry::new(&one.title, "lesson", &one.summary, Request::StartLesson(place)));
    let commands = keys::commands(session)
        .map(|(what, key, request)| Entry::new(sentence(what), "command", format!("Key: {key}"), request));
    settings.chain(choices).chain(views).chain(scenarios).chain(lessons).chain(commands).collect()
}

fn found<'a>(entries: &'a [Entry], text: &str) -> Vec<&'a Entry> {
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
