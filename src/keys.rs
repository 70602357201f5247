//! The keyboard: a table of all keys and their requests, which is also the list on screen.

mod list;

pub(crate) use list::window_ui;

use egui::{Key, Modifiers};
use kalmanscope_core::setting::Change;
use kalmanscope_core::{Channel, Hold, Scenario};

use crate::request::{LegendEntry, Request};
use crate::ruler::End;
use crate::session::{Mode, Session};

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
            plain("+", "faster", &[Key::Plus, Key::Equals], |session| Request::SetSpeed(session.next_speed(true))),
            plain("−", "slower", &[Key::Minus], |session| Request::SetSpeed(session.next_speed(false))),
        ],
    ),
    (
        "Settings",
        &[
            plain("S", "show or hide the settings", &[Key::S], |_| Request::ToggleControls),
            plain("X", "the other of two settings, A and B", &[Key::X], |_| Request::SwapSettings),
            Shortcut {
                name: "Ctrl+Shift+Z",
                what: "make the change again",
                keys: &[Key::Z],
                modifiers: Modifiers::COMMAND.plus(Modifiers::SHIFT),
                request: |_| Request::Redo,
            },
            Shortcut {
                name: "Ctrl+Z",
                what: "take back the last change of a setting",
                keys: &[Key::Z],
                modifiers: Modifiers::COMMAND,
                request: |_| Request::Undo,
            },
            plain("H", "the input held, or linear between samples", &[Key::H], |session| {
                edit(session, with_other_hold)
            }),
            plain("G", "the gain of the input estimated, or known", &[Key::G], |session| {
                edit(session, with_other_gain)
            }),
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
            plain("/", "find a setting, view, scenario, lesson or command", &[Key::Slash], |_| Request::Find),
            plain("?", "this list", &[Key::Questionmark], |_| Request::ToggleKeys),
        ],
    ),
    (
        "Times",
        &[
            plain("A", "mark the time that is shown as A, or take A away", &[Key::A], |_| Request::ToggleMark(End::A)),
            plain("B", "the same for B", &[Key::B], |_| Request::ToggleMark(End::B)),
        ],
    ),
    (
        "Files",
        &[
            Shortcut {
                name: "Ctrl+O",
                what: "open a file: a record, a scenario, a lesson or a session",
                keys: &[Key::O],
                modifiers: Modifiers::COMMAND,
                request: |_| Request::ChooseFile,
            },
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
    let has_focus = ctx.memory(|memory| memory.focused().is_some());
    let is_taken = |keys: &[Key]| {
        has_focus && keys.iter().any(|key| matches!(key, Key::Space | Key::ArrowLeft | Key::ArrowRight | Key::Escape))
    };
    ctx.input_mut(|input| {
        let all = GROUPS.iter().flat_map(|(_, shortcuts)| *shortcuts);
        for Shortcut { keys, modifiers, request, .. } in all.filter(|shortcut| !is_taken(shortcut.keys)) {
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

fn edit(session: &Session, edited: fn(&Scenario) -> Scenario) -> Request {
    let before = session.scenario();
    Request::Edit(Change::between(before, &edited(before)))
}

pub(crate) fn with_other_hold(scenario: &Scenario) -> Scenario {
    let hold = match scenario.hold {
        Hold::Zero => Hold::First,
        Hold::First => Hold::Zero,
    };
    Scenario { hold, ..scenario.clone() }
}

pub(crate) fn with_other_gain(scenario: &Scenario) -> Scenario {
    let mut scenario = scenario.clone();
    let all = scenario.filters.iter().all(|filter| filter.augment.contains(&Channel::INPUT_GAIN));
    for filter in &mut scenario.filters {
        filter.augment.retain(|channel| *channel != Channel::INPUT_GAIN);
        filter.augment.extend((!all).then_some(Channel::INPUT_GAIN));
    }
    scenario
}
