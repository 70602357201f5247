//! The keyboard: a table of all keys and their requests, which is also the list on screen.

use egui::{Align2, Context, Key, Label, Modifiers, RichText, ScrollArea, Ui, Vec2, Window, vec2};

use crate::request::{LegendEntry, Request};
use crate::ruler::RulerEnd;
use crate::session::{Mode, Session};
use crate::{theme, tutor};

struct Shortcut {
    name: &'static str,
    what: &'static str,
    keys: &'static [Key],
    modifiers: Modifiers,
    request: fn(&Session) -> Request,
}

const fn plain(
    name: &'static str,
    what: &'static str,
    keys: &'static [Key],
    request: fn(&Session) -> Request,
) -> Shortcut {
    Shortcut { name, what, keys, modifiers: Modifiers::NONE, request }
}

impl Shortcut {
    const fn with(self, modifiers: Modifiers) -> Self {
        Self { modifiers, ..self }
    }
}

const GROUPS: &[(&str, &[Shortcut])] = &[
    (
        "Playback",
        &[
            plain("Space", "play or pause", &[Key::Space], |_| Request::TogglePlay),
            plain("→", "one sample forward", &[Key::ArrowRight], |_| Request::Step),
            plain("←", "one sample back", &[Key::ArrowLeft], |_| Request::StepBack),
            plain("R", "back to the start", &[Key::R, Key::Home], |_| Request::Restart),
            plain("L", "live, or the whole record", &[Key::L], |session| {
                Request::SetMode(if session.mode() == Mode::Live { Mode::Whole } else { Mode::Live })
            }),
            // On an American keyboard + is = with Shift.
            plain("+", "faster", &[Key::Plus, Key::Equals], |session| Request::SetSpeed(session.next_speed(true))),
            plain("−", "slower", &[Key::Minus], |session| Request::SetSpeed(session.next_speed(false))),
        ],
    ),
    (
        "Settings",
        &[
            plain("S", "show or hide the settings", &[Key::S], |_| Request::ToggleControls),
            plain("X", "keep a snapshot of the settings, or exchange them with it", &[Key::X], |_| {
                Request::SwapSnapshot
            }),
            // Before Ctrl+Z, which egui also matches with Shift.
            plain("Ctrl+Shift+Z", "make the change again", &[Key::Z], |_| Request::Redo)
                .with(Modifiers::COMMAND.plus(Modifiers::SHIFT)),
            plain("Ctrl+Z", "undo the last change of a setting", &[Key::Z], |_| Request::Undo).with(Modifiers::COMMAND),
        ],
    ),
    (
        "Views",
        &[
            plain("Page down", "the next view alone, then all", &[Key::PageDown], |_| Request::TurnView(true)),
            plain("Page up", "the view before", &[Key::PageUp], |_| Request::TurnView(false)),
            plain("P", "presenter mode: large type", &[Key::P], |_| Request::TogglePresenter),
            plain("Esc", "leave this list, stop computing, or leave an enlarged view", &[Key::Escape], |_| {
                Request::Leave
            }),
            plain("/", "find a setting, view, scenario, lesson, export or command", &[Key::Slash], |_| Request::Find),
            plain("?", "this list", &[Key::Questionmark], |_| Request::ToggleKeys),
        ],
    ),
    (
        "In a lesson",
        &[
            plain("N", "show me, make the change, or go to the next step", &[Key::N], |_| Request::TurnLesson(true)),
            plain("Backspace", "the step before", &[Key::Backspace], |_| Request::TurnLesson(false)),
            plain("Q", "leave the lesson", &[Key::Q], |_| Request::LeaveLesson),
        ],
    ),
    (
        "Times",
        &[
            plain("A", "mark the time shown as A, or remove A", &[Key::A], |_| Request::ToggleMark(RulerEnd::A)),
            plain("B", "the same for B", &[Key::B], |_| Request::ToggleMark(RulerEnd::B)),
        ],
    ),
    (
        "Files",
        &[
            plain("Ctrl+O", "open a file: a record, a scenario, a lesson or a session", &[Key::O], |_| {
                Request::ChooseFile
            })
            .with(Modifiers::COMMAND),
            plain("C", "copy a link to this picture", &[Key::C], |_| Request::CopyLink),
            plain("E", "export: figures and files", &[Key::E], |_| Request::ToggleExports),
        ],
    ),
];

const DIGITS: [Key; 6] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];

const GESTURES: &[(&str, &[(&str, &str)])] = &[
    (
        "In a plot",
        &[
            ("Click", "go to that time"),
            ("Shift and click", "mark A, then B: values and what lies between"),
            ("Drag", "zoom in"),
            ("Right drag", "move it"),
            ("Double click", "all of it again"),
            ("Click on its symbol", "that plot alone, or all again"),
        ],
    ),
    ("On a number", &[("Double click", "back to what it was"), ("Alt and wheel", "turn it")]),
];

pub(crate) fn commands(session: &Session) -> impl Iterator<Item = (&'static str, &'static str, Request)> {
    let all = GROUPS.iter().flat_map(|(_, shortcuts)| *shortcuts);
    all.map(|shortcut| (shortcut.what, shortcut.name, (shortcut.request)(session)))
}

pub(crate) fn keys(ctx: &egui::Context, session: &Session, requests: &mut Vec<Request>) {
    if ctx.text_edit_focused() {
        return;
    }
    // Space presses the button that has the focus, and arrows move a slider.
    let has_focus = ctx.memory(|memory| memory.focused().is_some_and(|id| id != tutor::text_id()));
    let is_taken = |keys: &[Key]| {
        has_focus && keys.iter().any(|key| matches!(key, Key::Space | Key::ArrowLeft | Key::ArrowRight | Key::Escape))
    };
    ctx.input_mut(|input| {
        let all = GROUPS.iter().flat_map(|(_, shortcuts)| *shortcuts);
        for Shortcut { keys, modifiers, request, .. } in all.filter(|shortcut| !is_taken(shortcut.keys)) {
            // Shift is allowed, because many keyboards need it for + and ?.
            let alone = !input.modifiers.command && !input.modifiers.alt;
            let pressed = keys.iter().any(|&key| {
                if modifiers.is_none() { alone && input.key_pressed(key) } else { input.consume_key(*modifiers, key) }
            });
            if pressed {
                requests.push(request(session));
            }
        }
        for (&key, filter) in DIGITS.iter().zip(&session.scenario().filters) {
            if input.modifiers.is_none() && input.key_pressed(key) {
                requests.push(Request::ToggleEntry(LegendEntry::Filter(filter.id)));
            }
        }
    });
}

const TWO_COLUMNS: f32 = 660.0;

/// The groups in the left one of two columns, which have about half of all rows.
const LEFT: usize = 3;

const COLUMN: f32 = 400.0;
const NAMES: f32 = 112.0;

/// The distance of the list from the window's edges, its title and its margins included \[points\].
const MARGINS: Vec2 = vec2(36.0, 84.0);

const GAPS: Vec2 = vec2(24.0, 8.0);

type Group = (&'static str, Vec<(&'static str, &'static str)>);

pub(crate) fn window_ui(ctx: &Context, open: &mut bool) {
    let room = ctx.content_rect().size() - MARGINS;
    let groups = groups();
    let (left, right) = groups.split_at(if room.x >= TWO_COLUMNS { LEFT } else { groups.len() });
    let columns = [left, right].into_iter().filter(|groups| !groups.is_empty());
    let width = (room.x / columns.clone().count() as f32 - GAPS.x).clamp(1.0, COLUMN);
    let window = Window::new("Keys").collapsible(false).resizable(false).open(open);
    window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).show(ctx, |ui| {
        let height = room.y.max(40.0);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = GAPS.x;
                for groups in columns {
                    ui.allocate_ui(vec2(width, 0.0), |ui| column_ui(ui, groups, width));
                }
            });
        });
    });
}

fn groups() -> Vec<Group> {
    let keys = GROUPS.iter().map(|(title, shortcuts)| {
        let mut rows: Vec<_> = shortcuts.iter().map(|shortcut| (shortcut.name, shortcut.what)).collect();
        if *title == "Views" {
            rows.push(("1 to 6", "show or hide a filter"));
        }
        (*title, rows)
    });
    keys.chain(GESTURES.iter().map(|(title, rows)| (*title, rows.to_vec()))).collect()
}

fn column_ui(ui: &mut Ui, groups: &[Group], width: f32) {
    ui.vertical(|ui| {
        ui.set_width(width);
        ui.spacing_mut().item_spacing.x = 10.0;
        ui.spacing_mut().interact_size.y = 0.0;
        for (title, rows) in groups {
            ui.label(RichText::new(*title).small().weak());
            for (name, what) in rows {
                ui.horizontal_top(|ui| {
                    ui.allocate_ui(vec2(NAMES, 0.0), |ui| {
                        ui.set_width(NAMES);
                        ui.add(Label::new(RichText::new(*name).family(theme::strong())).wrap());
                    });
                    ui.add(Label::new(*what).wrap());
                });
            }
            ui.add_space(GAPS.y);
        }
    });
}
